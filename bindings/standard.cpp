// Python's face of the standard contact and of tables of forces.
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

void bind_standard(nb::module_& m) { (void)m; }
