// Python's face of rigid motions of wheels and rails.
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>

#include "contact/kinematics/core/moved_pair.hpp"
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

void bind_kinematics(nb::module_& m) {
    structure<VelocityField>(m, "VelocityField", {"velocity", "rotation", "reference"},
                             "Velocity field v + w x (X - reference) of a body: (3,) m/s, rad/s and m.");
    structure<RigidVelocities>(m, "RigidVelocities",
                               {"wheel", "wheel_turn", "wheel_at", "rail", "rail_turn", "rail_at"},
                               "Rigid motion of wheel and rail: velocity m/s, angular velocity rad/s and reference "
                               "point m, (3,) each.");
    structure<WheelPairs>(
        m, "WheelPairs", {"origin", "rotation", "motion", "centre", "plan"},
        "Poses and motions of w wheels, each as that of a left-hand pair in the frame of its rail: "
        "origin (w, 3) m and rotation (w, 3, 3) of the wheels' frames; motion (w, 6, 3), in the order "
        "of `RigidVelocities`; centre (w, 3) m, reference points of moments; plan (w,) 1/m, curvatures of the "
        "rails in plan.");
    m.def(
        "left_pairs",
        [](const Rows& states, const Dimensions& dimensions, bool mirror) {
            require(states.shape[1] == STATE, "states: must be (w, 17)");
            return left_pairs(states, dimensions, mirror);
        },
        "states"_a, "dimensions"_a, "mirror"_a, Unlocked(),
        "Pairs of one side of w wheelsets as left-hand ones, with moments about the wheelsets' centres: states (w, "
        "17), "
        "values of `WheelsetState`; dimensions m of a `Mounting`; mirror: whether the side is the right one.");
    m.def(
        "by_states",
        [](const Blocks& tangents, const Rows& wrenches, const Rows& states, double wheel_y, bool mirror) {
            long w = states.size();
            require(states.shape[1] == STATE && tangents.shape == std::array<long, 3>{w, 6, 12} &&
                        wrenches.shape == std::array<long, 2>{w, 6},
                    "tangents, wrenches, states: must be (w, 6, 12), (w, 6), (w, 17)");
            return by_states(tangents, wrenches, states, wheel_y, mirror);
        },
        "tangents"_a, "wrenches"_a, "states"_a, "wheel_y"_a, "mirror"_a, Unlocked(),
        "Derivatives (w, 6, 9) of forces and moments by coordinates of the wheelsets: tangents (w, 6, 12) about the "
        "wheelsets' centres, of the left-hand pairs; wrenches (w, 6) N and N m of the wheels themselves; states (w, "
        "17); wheel_y m; mirror: whether the wheels are the right ones.");
    structure<MovedStates>(
        m, "MovedStates", {"values", "moves", "dimensions", "foot", "mirror"},
        "One side of w wheelsets: values (w, 17) of `WheelsetState`; motions (w, 9) of hub (x, y, z "
        "m, rotation vector rad, in the wheelset's axes) and rail (y, z m, roll rad about its foot); dimensions m of a "
        "`Mounting`; foot (2,) m, y and z of the centre of the rail's roll in its frame; mirror: whether the side is "
        "the right one.");
    m.def("moved_pairs", &moved_pairs, "states"_a, Unlocked(),
          "Pairs in the frames of the moved rails, with the wheelsets' centres, and the axes (w, 3, 3) of the rails in "
          "the track's.");
    m.def("moved_loads", &moved_loads, "states"_a, Unlocked(),
          "Matrices (w, 9, 6) of the loads on hub and rail by wrenches on the wheel about the wheelset's centre in the "
          "track's axes: force and moment on the hub, in the wheelset's axes about the hub's centre; y and z force and "
          "roll moment on the rail about its foot.");
    m.def(
        "moved_load_slopes",
        [](const MovedStates& states, const Rows& wrenches) {
            require(wrenches.shape == std::array<long, 2>{states.size(), 6}, "wrenches: must be (w, 6)");
            return moved_load_slopes(states, wrenches);
        },
        "states"_a, "wrenches"_a, Unlocked(),
        "Derivatives (w, 9, 18) of these loads at constant wrenches (w, 6), by the coordinates of the wheelset and the "
        "motions of hub and rail.");
    m.def(
        "moved_slopes",
        [](const MovedStates& states, const Blocks& tangents, const Rows& wrenches) {
            require(tangents.shape == std::array<long, 3>{states.size(), 6, CHANGES} &&
                        wrenches.shape == std::array<long, 2>{states.size(), 6},
                    "tangents, wrenches: must be (w, 6, 12), (w, 6)");
            return moved_slopes(states, tangents, wrenches);
        },
        "states"_a, "tangents"_a, "wrenches"_a, Unlocked(),
        "Derivatives (w, 6, 18) of wrenches about the wheelsets' centres in the track's axes: tangents (w, 6, 12) "
        "about "
        "constant centres, in the axes of the moved rails; wrenches (w, 6) in the track's axes.");
}
