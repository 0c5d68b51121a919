// Python's face of tables of pairs of strips.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>

#include "contact/models/lattice/influence/core/body_displacement.hpp"
#include "contact/models/lattice/influence/core/bulk.hpp"
#include "contact/models/lattice/influence/core/cell_compliance.hpp"
#include "contact/models/lattice/influence/core/pair_samples.hpp"
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

namespace {

template <int N>
using Shape_ = std::array<long, N>;

void require_lines(const Numbers& arc) { require(arc.size() > 1, "arc: must have two lines"); }

void require_samples(const LatticeStrips& strips, const Deviation& upper, const Deviation& lower,
                     const Coefficients& values) {
    for (const auto* body : {&upper, &lower})
        require(body->none() || body->share.size() == strips.size(), "share: must be of all strips");
    require(values.shape[1] == DEGREE + 1 && values.shape[2] == COMPONENTS, "values: must be (cells, 6, 8)");
}

}  // namespace

// Tables of pairs of strips, and the deviations of bodies in them.
void bind_tables(nb::module_& m) {
    m.def(
        "start_of",
        [](const LatticeStrips& strips, long i, long j) {
            require(i >= 0 && i <= j && j < strips.size(), "i, j: must be strips i <= j");
            return start_of(strips, i, j);
        },
        "strips"_a, "i"_a, "j"_a, "Length m of the first octave of cells of a pair.");
    m.def("count_of", &count_of, "start"_a, "Number of cells up to REACH, for the length m of the first octave.");
    m.def(
        "pair_coefficients",
        [](const LatticeStrips& strips, long i, long j, const HalfSpaces& bodies, const Deviation& upper,
           const Deviation& lower, const CellRule& rule, const Coefficients& values) {
            require(i >= 0 && i <= j && j < strips.size(), "i, j: must be strips i <= j");
            require_samples(strips, upper, lower, values);
            pair_coefficients(strips, i, j, bodies, {&upper, &lower}, rule, values);
        },
        "strips"_a, "i"_a, "j"_a, "bodies"_a, "upper"_a, "lower"_a, "rule"_a, "values"_a, Unlocked(),
        "Write the coefficients (cells, DEGREE + 1, COMPONENTS) of a pair i <= j of strips.");
    m.def(
        "fill",
        [](const LatticeStrips& strips, const View<const long, 2>& pairs, const HalfSpaces& bodies,
           const Deviation& upper, const Deviation& lower, const CellRule& rule, const Indices& first,
           const Coefficients& values) {
            require(pairs.shape[1] == 2 && first.size() == pairs.size() + 1,
                    "pairs, first: must be (P, 2) and (P + 1,)");
            require_samples(strips, upper, lower, values);
            for (long p = 0; p < pairs.size(); ++p)
                require(pairs(p, 0) >= 0 && pairs(p, 0) <= pairs(p, 1) && pairs(p, 1) < strips.size() &&
                            first(p) >= 0 && first(p) <= first(p + 1) && first(p + 1) <= values.size(),
                        "pairs, first: strips i <= j, and ascending cells of the values");
            for (long p = 0; p < pairs.size(); ++p)
                pair_coefficients(strips, pairs(p, 0), pairs(p, 1), bodies, {&upper, &lower}, rule,
                                  values.part(first(p), first(p + 1)));
        },
        "strips"_a, "pairs"_a, "bodies"_a, "upper"_a, "lower"_a, "rule"_a, "first"_a, "values"_a, Unlocked(),
        "Write the coefficients of pairs (P, 2) into the tables' values (cells, DEGREE + 1, COMPONENTS) from cells "
        "first "
        "(P + 1,) on.");
    m.def(
        "join_cells",
        [](const Coefficients& values, const Numbers& width, long even, const CellRule& rule) {
            require(values.shape[1] == DEGREE + 1 && width.size() == values.size(),
                    "values, width: must be (n, DEGREE + 1, m) and (n,)");
            join_cells(values, width, even, rule);
        },
        "values"_a, "width"_a, "even"_a, "rule"_a, Unlocked(),
        "Make polynomials (n, DEGREE + 1, m) of cells with widths (n,) continuously differentiable, in place; even: "
        "number of functions, the first ones, whose slope at the first bound is 0.");
    m.def("pair_geometry", &pair_geometry, "x"_a, "row"_a, "column"_a,
          "Antiderivatives (5), twice along the strips and as means over both, of x^2/r^3, y^2/r^3, x y/r^3, x/r^2 and "
          "y/r^2 at a distance x m, of strips with lateral bounds m, the same, or side by side.");
    m.def("pair_antiderivative", &pair_antiderivative, "geometry"_a, "nu"_a,
          "G (6), whose second derivative is the mean compliance between two strips; unit modulus.");
    m.def("complete_means", &complete_means, "means"_a, Unlocked(),
          "Compute the coefficients of all pairs in all cells.");
    m.def(
        "strips_on_lines",
        [](const Lattice& lattice, const View<const bool, 1>& chosen, const Numbers& feet) {
            require(chosen.size() == lattice.middle.size() && feet.size() == chosen.size(),
                    "chosen, feet: must be (K,)");
            auto on = strips_on_lines(lattice, chosen, feet);
            return std::tuple{on.place, on.middle, on.width, std::pair{on.low, on.high}};
        },
        "lattice"_a, "chosen"_a, "feet"_a, Unlocked(),
        "Numbers (K,) of chosen strips among these, their middles on the lower body and widths (C,) m, and the ends m "
        "of "
        "the part that they cover; feet: (K,) m, arc length of all strips' middles on the lower body.");
    m.def(
        "hats",
        [](const Numbers& arc, const Numbers& s) {
            require_lines(arc);
            return hats(arc, s);
        },
        "arc"_a, "s"_a, Unlocked(),
        "Values (S, n) at s (S,) m of the functions linear between lines (n,) m, 1 at one and 0 at the others.");
    m.def(
        "strip_shares",
        [](const Numbers& arc, const Numbers& middle, const Numbers& width) {
            require_lines(arc), require(middle.size() == width.size(), "middle, width: must be (S,)");
            return strip_shares(arc, middle, width);
        },
        "arc"_a, "middle"_a, "width"_a, Unlocked(),
        "Weights (S, n) of lines (n,) m in the means over strips of functions linear between the lines.");
    m.def(
        "share_slopes",
        [](const Numbers& arc, const Numbers& middle, const Numbers& width) {
            require_lines(arc), require(middle.size() == width.size(), "middle, width: must be (S,)");
            return share_slopes(arc, middle, width);
        },
        "arc"_a, "middle"_a, "width"_a, Unlocked(), "Derivatives (S, n) 1/m of strip_shares by the middles.");
    m.def(
        "bulk_displacements",
        [](const Numbers& arc, const Blocks& compliance, const Numbers& place, const Numbers& middle,
           const Numbers& width, const Rows& loads) {
            require_lines(arc);
            require(compliance.shape == Shape_<3>{arc.size(), arc.size(), 2}, "compliance: must be (ns, ns, 2)");
            require(middle.size() == width.size() && loads.shape == Shape_<2>{middle.size(), 2},
                    "middle, width, loads: must be (S,), (S,) and (S, 2)");
            return bulk_displacements(arc, compliance, place, middle, width, loads);
        },
        "arc"_a, "compliance"_a, "place"_a, "middle"_a, "width"_a, "loads"_a, Unlocked(),
        "Displacement (R,) m of a body at some places m, linear between its lines (ns,) m, by loads (S, 2) N on strips "
        "with middles and widths (S,) m; compliance (ns, ns, 2) m/N of pairs of lines.");
    m.def(
        "bulk_places",
        [](const BulkCompliance& body, const Numbers& middle, const Numbers& width, const Numbers& foot) {
            require(width.size() == middle.size() && foot.size() == middle.size(), "middle, width, foot: must be (n,)");
            return bulk_places(body, middle, width, foot);
        },
        "body"_a, "middle"_a, "width"_a, "foot"_a, Unlocked(),
        "Arc length (n,) m on a body of the middles of strips with widths (n,) m, at most on its last lines; middle, "
        "foot: (n,) m, on the upper and on the lower body.");
}
