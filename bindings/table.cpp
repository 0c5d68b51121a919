// Python's face of tables of contact forces.
#include <nanobind/stl/array.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "contact/models/table/core/force.hpp"
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

namespace {

// Bind a function of a pose and a motion: origin (3,) m and axes (3, 3) of the wheel; velocity m/s, angular velocity
// rad/s and reference m (3,) of the wheel and of the rail.
template <class Function>
void bind_at_pose(nb::module_& m, const char* name, Function function, const char* text) {
    m.def(
        name,
        [function](const TableData& data, Numbers origin, Rows rotation, Numbers velocity, Numbers rate,
                   Numbers reference, Numbers rail_velocity, Numbers rail_rate, Numbers rail_reference) {
            std::array twists{velocity, rate, reference, rail_velocity, rail_rate, rail_reference};
            bool right = origin.size() == 3 && rotation.shape == std::array{3L, 3L};
            for (const Numbers& of : twists) right = right && of.size() == 3;
            require(right, "pose, twists: must be (3,) and (3, 3), and six times (3,)");
            auto of = [&](int k) { return vec_of(twists[k]); };
            RigidMotion<double> motion{{of(0), of(1), of(2)}, {of(3), of(4), of(5)}};
            return function(data, pose_of(origin, rotation, 0.0), motion);
        },
        "data"_a, "origin"_a, "rotation"_a, "velocity"_a, "rate"_a, "reference"_a, "rail_velocity"_a, "rail_rate"_a,
        "rail_reference"_a, Unlocked(), text);
}

// Bind a function of the states of wheels.
template <class Function>
void bind_in_states(nb::module_& m, const char* name, Function function, const char* text) {
    m.def(
        name,
        [function](const TableData& data, const Rows& states, const Dimensions& dimensions, bool mirror) {
            require(states.shape[1] == STATE, "states: must be (w, 17)");
            return function(data, states, dimensions, mirror);
        },
        "data"_a, "states"_a, "dimensions"_a, "mirror"_a, Unlocked(), text);
}

}  // namespace

void bind_table(nb::module_& m) {
    m.attr("ARM") = TABLE_ARM;
    structure<Grid>(m, "Grid", {"nodes", "counts", "values", "columns"},
                    "Values on a tensor product of nodes: nodes of all axes, one after the other, each increasing; "
                    "their counts by axis, the first one changing slowest; values (nodes * columns,); numbers at a "
                    "node.");
    structure<TableData>(
        m, "TableData", {"normal", "friction", "coefficient", "radius", "lateral", "border"},
        "Grids of a `NormalTable` and a `FrictionTable`, coefficient of friction, radius m of the "
        "wheel, nominal lateral position m of its tread from the rail's origin, and widths (4,) of its "
        "border in y m, roll and yaw rad, and level, or (0,).");
    m.def(
        "interpolated",
        [](const Grid& grid, Numbers at, bool slopes) {
            require(at.size() == grid.axes(), "at: must have a coordinate for each axis");
            return values_at(grid, at.data, slopes);
        },
        "grid"_a, "at"_a, "slopes"_a, Unlocked(),
        "Values (1, columns) at coordinates (n,) of all n axes; with slopes (n + 1, columns), with their derivatives.");
    m.def(
        "level_at",
        [](Numbers nodes, Numbers heights, double z) {
            require(nodes.size() > 1 && heights.size() == nodes.size(), "heights: must be as many as levels, two");
            return level_at(nodes, heights, z);
        },
        "nodes"_a, "heights"_a, "z"_a,
        "Level at which the interpolated height is z m, from levels (n,) and decreasing heights (n,) m.");
    m.def("scale_of_creepage", &scale_of_creepage<double>, "level"_a, "coefficient"_a,
          "Creepage that saturates a wheel, about: proportional to friction and to the cube root of the load.");
    bind_at_pose(
        m, "table_force", &table_force,
        "Numbers (20,) of a `TableForce` at a pose, (3,) m and (3, 3), and motions of wheel and rail: velocity m/s, "
        "angular velocity rad/s and reference m (3,). Force is zero at negative levels and speeds; without friction "
        "and without contact the speed is 1. The last one is the share of the table beside an elastic contact.");
    bind_at_pose(
        m, "table_derivative", &table_derivative,
        "Derivative (7, 12) of force and moment, see `ContactResult.tangent`, zero without contact or speed, and of "
        "the share.");
    bind_in_states(
        m, "table_wheels", &table_wheels,
        "Numbers (w, 26) of w wheels of one side: force N and moment N m about the wheelset's centre in the axes of "
        "the track, then those of `table_force`; states, dimensions and mirror as for `left_pairs`.");
    bind_in_states(m, "table_slopes", &table_slopes,
                   "Derivatives (w, 6, 9) of force and moment of `table_wheels` by the wheelsets' coordinates.");
}
