// Python's face of sums over patches.
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

void bind_results(nb::module_& m) { (void)m; }
