// Python's face of sums over patches.
#include "contact/results/core/patch_points.hpp"
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

void bind_results(nb::module_& m) {
    structure<PatchPoints>(
        m, "PatchPoints",
        {"point", "axes", "level", "area", "step", "on_wheel", "on_rail", "pressure", "traction", "sticks"},
        "Loaded contact points: point (n, 3) m; axes (n, 3, 3), rows longitudinal, lateral, outward from the wheel; "
        "longitudinal axes level (n, 3) for the velocity of the rail; area (n,) m2; step (n,) m, length of the point's "
        "cell along the rolling direction; on_wheel and on_rail (n, 2) m, arc length and lateral position on the "
        "profiles; pressure (n,) Pa; traction (n, 2) Pa on the wheel; sticks (n,), whether the surfaces stick.");
}
