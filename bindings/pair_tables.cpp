// Python's face of tables of pairs of strips.
#include <nanobind/stl/array.h>

#include "contact/models/lattice/influence/core/pair_samples.hpp"
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

namespace {

void require_samples(const LatticeStrips& strips, const Deviation& upper, const Deviation& lower,
                     const Coefficients& values) {
    for (const auto* body : {&upper, &lower})
        require(body->none() || body->share.size() == strips.size(), "share: must be of all strips");
    require(values.shape[1] == DEGREE + 1 && values.shape[2] == COMPONENTS, "values: must be (cells, 6, 8)");
}

}  // namespace

// Tables of pairs of strips, with the deviations of bodies.
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
}
