// Python's face of sums over patches.
#include <nanobind/stl/pair.h>

#include "contact/models/lattice/core/patches.hpp"
#include "contact/results/core/patch_moments.hpp"
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

namespace {

// Bind a function of the squared lengths of adjacent strips and their lateral bounds.
template <class Function>
void bind_bounded(nb::module_& m, const char* name, Function function, const char* text) {
    m.def(
        name,
        [function](Numbers square, Numbers bounds) {
            require(bounds.size() == square.size() + 1, "bounds: must be one more than strips");
            return function(square, bounds);
        },
        "square"_a, "bounds"_a, text);
}

PatchSums on_material(PatchSums sums, const BodyDisplacements& of, Numbers s, Numbers load) {
    require(s.size() > 0 && load.size() == s.size() && of.wheel.size() == s.size(),
            "displacements, s, load: must be as long as each other");
    // the given sums remain unchanged
    sums.bands = Array<double, 1>::copy(sums.bands);
    sums.wheel = Array<double, 1>::copy(sums.wheel), sums.rail = Array<double, 1>::copy(sums.rail);
    put_on_material(sums, {of.wheel, of.rail, of.wheel_normal}, s, load);
    return sums;
}

}  // namespace

void bind_results(nb::module_& m) {
    m.attr("PATCH_NUMBERS") = PATCH_NUMBERS;
    structure<PatchPoints>(
        m, "PatchPoints",
        {"point", "axes", "level", "area", "step", "on_wheel", "on_rail", "pressure", "traction", "elastic", "sticks"},
        "Loaded contact points: point (n, 3) m; axes (n, 3, 3), rows longitudinal, lateral, outward from the wheel; "
        "longitudinal axes level (n, 3) for the velocity of the rail; area (n,) m2; step (n,) m, length of the point's "
        "cell along the rolling direction; on_wheel and on_rail (n, 2) m, arc length and lateral position on the "
        "profiles; pressure (n,) Pa; traction (n, 2) Pa on the wheel; elastic (n,) Pa, work on the displacements of "
        "steady rolling per length of travel and area; sticks (n,), whether the surfaces stick.");
    structure<PatchSums>(
        m, "PatchSums",
        {"area", "stick_area", "peak", "force", "axes", "slope", "point", "wheel", "rail", "bands", "semi_axes",
         "creepage", "power", "strips"},
        "Sums over the points of a patch, see `Patch`: area and stick area m2; largest pressure Pa; force (3,) N; axes "
        "(3, 3), rows forward, left and upward of the mean contact plane; slope of the common surface of the deformed "
        "bodies over it; centre of pressure (3,) m; arc length and lateral position (2,) m on wheel and rail; bands "
        "(4,) m, smallest and largest lateral position on both; semi-axes (2,) m; creepage (3,); power W; strips.");
    m.def(
        "patch_sums",
        [](View<const bool, 1> inside, const PatchPoints& points, const RigidVelocities& v, double speed) {
            require(inside.size() == points.size(), "inside: must be as long as points");
            return patch_sums(inside, points, v.motion(), speed);
        },
        "inside"_a, "points"_a, "v"_a, "speed"_a, Unlocked(),
        "Sums over the points inside (n,), under a rigid motion of wheel and rail at a rolling speed m/s; 0: no "
        "creepage and no power.");
    m.def(
        "store_patch",
        [](const PatchSums& sums, double peak, View<double, 1> row) {
            require(row.size() == PATCH_NUMBERS, "row: must have 26 numbers");
            store_patch(sums, peak, row);
        },
        "sums"_a, "peak"_a, "row"_a,
        "Fill a row (26,) of numbers for `patches_of`; peak Pa, in place of that of the sums.");
    m.def("on_material", &on_material, "sums"_a, "displacements"_a, "s"_a, "load"_a,
          "Sums of a patch with positions on the profiles of the material that touches, and the slope of the common "
          "surface: displacements of its n points or strips, their arc length s (n,) m on the wheel, load (n,) N.");
    bind_bounded(m, "patch_area", &patch_area,
                 "Area m2 of adjacent strips: squares (S,) m2 of their lengths, lateral bounds (S + 1,) m.");
    bind_bounded(
        m, "lateral_ends",
        [](Numbers square, Numbers bounds) {
            auto [low, high] = lateral_ends(square, bounds);
            return std::pair{low, high};
        },
        "Lateral ends m of the contact; parameters as for `patch_area`.");
    bind_bounded(m, "stick_area", &stick_area,
                 "Area m2 of stick zones from the squares (S,) m2 of their lengths in adjacent strips, zero where they "
                 "slip, with lateral bounds (S + 1,) m.");
    m.def(
        "stick_lengths",
        [](Rows margin, Rows length) {
            require(margin.shape == length.shape, "margin, length: must have the same shape");
            return stick_lengths(margin, length);
        },
        "margin"_a, "length"_a,
        "Lengths (S,) m of the stick zones of strips, from the margins (S, M) Pa of the tractions to their bounds, "
        "zero under slip, and the lengths (S, M) m of the cells.");
    structure<PatchRows>(m, "PatchRows", {"inside", "rows"},
                         "Whether all distances lie in the tables, and rows (k, 26) of `store_patch` of all patches, "
                         "by decreasing load.");
    m.def(
        "patch_rows",
        [](Rows values, const EquationData& data, const BodyTables& bodies, double modulus) {
            require(data.fits(values), "values: must be those of the strips");
            for (const auto* of : {&bodies.upper, &bodies.lower})
                require(of->place.size() == data.tables.place.size(), "bodies: must be those of the lattice");
            return patch_rows(values, data, bodies, modulus);
        },
        "values"_a, "data"_a, "bodies"_a, "modulus"_a, Unlocked(),
        "`PatchRows` of a solution with values (S, block): tables of each body; contact modulus Pa of both.");
}
