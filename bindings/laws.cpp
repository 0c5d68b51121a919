// Python's face of laws of friction.
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

void bind_laws(nb::module_& m) { (void)m; }
