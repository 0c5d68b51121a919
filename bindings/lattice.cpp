// Python's face of the equations of strips and their solution.
#include <nanobind/stl/array.h>

#include "contact/models/lattice/solver/core/advance.hpp"
#include "contact/models/lattice/system/core/contact_lines.hpp"
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

void bind_lattice(nb::module_& m) {
    structure<StripPlaces>(m, "StripPlaces", {"middle", "width", "stretch", "level", "strip", "onset", "whole"},
                           "S loaded strips.");
    structure<Evaluation>(m, "Evaluation",
                          {"inside", "residual", "V", "pressure", "slip", "rigid_slope", "depth_slope"},
                          "Residual of a state and what belongs to it.");
    structure<Linearisation>(m, "Linearisation", {"evaluation", "jacobian", "slips", "slopes"},
                             "Equations of a state, linearised.");
    structure<ContactLines>(m, "ContactLines",
                            {"depth", "onset", "whole", "x", "curvature", "foot", "level", "covered", "near", "probed",
                             "approach", "window", "speed"},
                            "Where the strips of a lattice touch.");
    structure<Factors>(m, "Factors",
                       {"lu", "pivots", "rows", "columns", "slips", "slopes", "present", "spread", "gather"},
                       "LU factors of the Jacobian of a state.");
    structure<Lapack>(m, "Lapack", {"sgetrf", "sgetrs", "dgesv"}, "Addresses of functions of LAPACK.");
    structure<KeptFactors>(m, "KeptFactors", {"valid", "factors", "evaluation"},
                           "Factors of an earlier state, and the evaluation of the present one, if they are valid.");
    structure<Limits>(m, "Limits", {"tolerance", "farthest", "iterations"}, "Limits of the iteration.");
    structure<Progress>(m, "Progress",
                        {"event", "values", "leaves", "size", "kept", "iterations", "linearisations", "evaluations"},
                        "Where the iteration has stopped.");
    structure<Remaining>(m, "Remaining", {"inside", "strips", "depth", "place", "curvature", "half", "highest"},
                         "Penetration that remains on unloaded strips.");
    structure<Advance>(m, "Advance", {"progress", "complete", "rest"},
                       "Iterations and what they leave on strips that are not loaded.");
}
