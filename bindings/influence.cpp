// Python's face of displacements by loads on strips.
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

void bind_influence(nb::module_& m) { (void)m; }
