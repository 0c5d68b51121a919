// Python's face of curves and surfaces.
#include "meshes/curves/core/curve.hpp"
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

void bind_geometry(nb::module_& m) {
    structure<Shape>(m, "Shape", {"breaks", "middles", "table", "samples", "sampled", "hollow"},
                     "A curve of m pieces for the core.");
}
