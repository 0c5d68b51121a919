// Python's face of derivatives of solutions by pose and motion.
#include "contact/models/lattice/derivatives/core/tangent.hpp"

#include <nanobind/stl/pair.h>

#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

void bind_derivatives(nb::module_& m) {
    structure<TangentPlaces>(m, "TangentPlaces", {"lines", "lattice", "arc"},
                             "Where all strips touch, the lattice, and lines (ns,) m of the lower body, none where the "
                             "compliance does not depend on places there.");
    m.def(
        "residual_changes",
        [](Rows values, const EquationData& data, const TangentPlaces& places, Blocks slopes) {
            long M = data.rolls() ? data.basis.M() : 0;
            require(
                data.fits(values) && fit(data, places) && slopes.shape == std::array{data.strips(), M, long(SLOPES)},
                "values, places, slopes: do not fit");
            return residual_changes(values, data, places.lines, places.lattice, places.arc, slopes);
        },
        "values"_a, "data"_a, "places"_a, "slopes"_a, Unlocked(),
        "Derivative (S, block, 12) of the residual by pose and motion at fixed unknowns (S, block), with slopes (S, M, "
        "SLOPES) of the friction residual.");
}
