// Python's face of derivatives of solutions by pose and motion.
#include "contact/models/lattice/derivatives/core/tangent.hpp"

#include <nanobind/stl/pair.h>

#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

namespace {

void require(bool fits) {
    if (!fits) throw nb::value_error("tangent: lengths or indices do not fit");
}

}  // namespace

void bind_derivatives(nb::module_& m) {
    structure<TangentPlaces>(m, "TangentPlaces", {"lines", "lattice", "arc"},
                             "Where all strips touch, the lattice, and lines (ns,) m of the lower body, none where the "
                             "compliance does not depend on places there.");
    structure<TangentSums>(m, "TangentSums", {"inside", "regular", "changes", "factors"},
                           "Derivatives (k, 12) of sums by pose and motion, and the factors of the Jacobian, if all "
                           "distances lie in the tables and it is regular.");
    structure<ResultantSlopes>(m, "ResultantSlopes", {"total", "slopes"},
                               "Force N and moment N m about the origin (6,) on the upper body, and their derivative "
                               "(6, S block) by the unknowns.");
    m.def(
        "residual_changes",
        [](Rows values, const EquationData& data, const TangentPlaces& places, Blocks slopes) {
            long M = data.rolls() ? data.basis.M() : 0;
            require(data.fits(values) && fit(data, places) &&
                    slopes.shape == std::array{data.strips(), M, long(SLOPES)});
            return residual_changes(values, data, places.lines, places.lattice, places.arc, slopes);
        },
        "values"_a, "data"_a, "places"_a, "slopes"_a, Unlocked(),
        "Derivative (S, block, 12) of the residual by pose and motion at fixed unknowns (S, block), with slopes (S, M, "
        "SLOPES) of the friction residual.");
    m.def(
        "derivatives_of_resultants",
        [](Rows values, const EquationData& data, const TangentPlaces& places, const Lapack& solver) {
            require(data.fits(values) && fit(data, places));
            ResultantSlopes by(values, data);
            return std::pair{by.total, TangentSums(values, data, places, solver, by.slopes)};
        },
        "values"_a, "data"_a, "places"_a, "solver"_a, Unlocked(),
        "Force and moment (6,) about the origin, and `TangentSums` of these.");
    m.def(
        "derivatives_of_sums",
        [](Rows values, const EquationData& data, const TangentPlaces& places, const Lapack& solver, Rows weights) {
            require(data.fits(values) && fit(data, places) && weights.shape[1] == values.count());
            return TangentSums(values, data, places, solver, weights);
        },
        "values"_a, "data"_a, "places"_a, "solver"_a, "weights"_a, Unlocked(),
        "`TangentSums` of the unknowns (S, block) with weights (k, S block).");
}
