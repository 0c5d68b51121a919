// Python's face of derivatives of solutions by pose and motion.
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

void bind_derivatives(nb::module_& m) { (void)m; }
