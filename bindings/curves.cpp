// Python's face of curves.
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>

#include "meshes/curves/core/curve.hpp"
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

namespace {

using Complex = View<const std::complex<double>, 1>;

}  // namespace

void bind_curves(nb::module_& m) {
    m.attr("SAMPLE_SPACING") = SPACING;
    structure<Shape>(
        m, "Shape", {"breaks", "middles", "table", "samples", "sampled", "hollow", "corners"},
        "A curve of m pieces: breaks (m + 1,) and middles (m,) m in arc length, table (m, 3, 8) of "
        "coefficients of y + iz and its first two derivatives, samples (n,) m and points y + iz sampled "
        "(n,) m there, whether it is hollow: a point has several closest points nearby, and corners (k,) m, "
        "arc lengths where the surface turns outwards at once.");
    m.def(
        "closest",
        [](const Shape& shape, const Complex& q, const Numbers& guess) {
            require(guess.size() == 0 || guess.size() == q.size(), "guess: must have a number for every point");
            return closest(shape, q, guess);
        },
        "shape"_a, "q"_a, "guess"_a, Unlocked(),
        "Arc lengths m, distances m (positive outwards) and whether inside (n,) of the closest points to points q (n,) "
        "m as y + iz, from arc lengths guess (n,) m, or (0,) for the nearest samples.");
}
