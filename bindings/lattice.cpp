// Python's face of the equations of strips and their solution.
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

void bind_lattice(nb::module_& m) { (void)m; }
