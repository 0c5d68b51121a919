// Python's face of the equations of strips.
#include "lattice.hpp"
#include "contact/models/lattice/system/core/cells.hpp"
#include "contact/models/lattice/system/core/contact_lines.hpp"
#include "contact/models/lattice/system/core/penetrated_width.hpp"

using namespace wr;

void bind_solver(nb::module_& m);

namespace {

void require_step(Rows values, Rows step) {
    require(step.shape == values.shape && values.shape[1] >= MOMENTS, "values, steps: must be (S, block)");
}

void bind_system(nb::module_& m) {
    m.attr("SLOPES") = SLOPES;
    structure<EquationData>(m, "EquationData", {"tables", "surface", "motion", "places", "basis", "law", "rho"},
                            "Data of the equations of some strips at a pose; rho (M,) 1/Pa of the friction residual.");
    structure<StripCells>(
        m, "StripCells", {"inside", "points", "penetration", "slip", "displacement", "margin", "patch"},
        "Cells n = S M of S strips, strip by strip from the trailing end: whether all distances lie in the tables; "
        "points in their middles; undeformed penetration (n,) m; slip (n, 2) over the rolling speed; displacement "
        "(n, 3) m, upper minus lower body; margin (n,) Pa to the bound of friction; patch (S,) of the strips.");
    m.def(
        "evaluate",
        [](Rows values, const EquationData& data) {
            require_values(values, data);
            return evaluate(values, data);
        },
        "values"_a, "data"_a, Unlocked(), "`Evaluation` of a state with values (S, block).");
    m.def(
        "linearised",
        [](Rows values, const EquationData& data) {
            require_values(values, data);
            return linearised(values, data);
        },
        "values"_a, "data"_a, Unlocked(), "`Linearisation` of a state with values (S, block).");
    m.def(
        "rigid_slip",
        [](Rows values, const EquationData& data) {
            require_values(values, data);
            RigidSlip at(values, data);
            return std::pair{at.slip, at.slope};
        },
        "values"_a, "data"_a, Unlocked(),
        "Rigid slip (S, 2, M) over the speed at the cells, and its derivative 1/m along x.");
    m.def(
        "opening",
        [](double load, double onset, double whole) {
            auto at = opening(load, onset, whole);
            return std::pair{at.gap, at.slope};
        },
        "load"_a, "onset"_a, "whole"_a,
        "Mean gap m left on a strip, and its derivative by the load Pa m, amplitude times half length; onset m; whole "
        "Pa m, the load on the whole width.");
    m.def(
        "pressed",
        [](Numbers depth, Numbers compliance, Numbers onset) {
            require(compliance.size() == depth.size() && onset.size() == depth.size(), "compliance, onset: as depth");
            Array<double, 1> roots(depth.size());
            for (long i = 0; i < roots.size(); ++i) roots(i) = pressed(depth(i), compliance(i), onset(i));
            return roots;
        },
        "depth"_a, "compliance"_a, "onset"_a, Unlocked(),
        "Touching parts (S,) of the width, or roots of the load over that on the whole width where this is larger: "
        "penetration depth (S,) m without load, displacement compliance (S,) m under the load on the whole width, and "
        "onset (S,) m.");
    structure<PartialWidths>(
        m, "PartialWidths", {"onset", "whole"},
        "Onset (K,) m of strips, their mean gap when they begin to touch at one edge, and the depth "
        "(K,) m of the parabola along them when they touch on their whole width.");
    structure<PartialWidthChanges>(m, "PartialWidthChanges", {"onset", "whole"},
                                   "Relative derivatives (S, n) of `PartialWidths`.");
    m.def(
        "partial_widths",
        [](Numbers depth, Numbers curvature, Numbers middle, Numbers width) {
            long K = depth.size();
            require(curvature.size() == K && middle.size() == K && width.size() == K, "curvature to width: as depth");
            return partial_widths(depth, curvature, middle, width);
        },
        "depth"_a, "curvature"_a, "middle"_a, "width"_a, Unlocked(),
        "`PartialWidths` of strips: undeformed penetration depth (K,) m, -inf far from contact; relative curvature "
        "(K,) 1/m along x; middle and width (K,) m.");
    m.def(
        "partial_width_changes",
        [](Rows depth, Numbers curvature, Rows middle, Numbers width, Blocks change) {
            std::array three{depth.size(), 3L};
            require(depth.shape == three && middle.shape == three && change.shape[1] == 3, "depth, middle: (S, 3)");
            require(curvature.size() == three[0] && width.size() == three[0] && change.size() == three[0], "(S,)");
            return partial_width_changes(depth, curvature, middle, width, change);
        },
        "depth"_a, "curvature"_a, "middle"_a, "width"_a, "change"_a, Unlocked(),
        "`PartialWidthChanges` of strips: depth and middle (S, 3) m, of them and the next ones on either side; "
        "curvature (S,) 1/m and width (S,) m; derivatives change (S, 3, n) of the penetration.");
    m.def(
        "opening_changes",
        [](double load, double onset, double whole) {
            OpeningChanges at(load, onset, whole);
            return std::pair{at.onset, at.whole};
        },
        "load"_a, "onset"_a, "whole"_a,
        "Derivatives m of `opening` by relative changes of onset and whole, for a load below the latter.");
    m.def(
        "relative_size",
        [](Rows values, Rows step) {
            require_step(values, step);
            auto at = relative_size(values, step);
            return std::pair{at.largest, at.norm};
        },
        "values"_a, "step"_a, Unlocked(),
        "Largest entry and norm of a step (S, block) over the largest amplitude of the pressure, or half length.");
    m.def(
        "leaving",
        [](Rows values, Rows step, double size, Numbers whole) {
            require_step(values, step);
            require(whole.size() == values.size(), "whole: must be (S,)");
            return leaving(values, step, size, whole);
        },
        "values"_a, "step"_a, "size"_a, "whole"_a, Unlocked(), "Strips (S,) that leave by a step of a relative size.");
    m.def(
        "moved",
        [](Rows values, Rows step, double factor, Numbers whole) {
            require_step(values, step);
            require(whole.size() == values.size(), "whole: must be (S,)");
            return moved(values, step, factor, whole);
        },
        "values"_a, "step"_a, "factor"_a, "whole"_a, Unlocked(),
        "Values (S, block) after a fraction of a step; whole (S,) Pa m, loads on the whole width.");
}

LiftedPenetration lifted(const SurfaceData& surface, Numbers origin, Rows rotation, double plan, Rows lift) {
    require(origin.size() == 3 && rotation.shape == std::array{3L, 3L}, "origin, rotation: must be (3,) and (3, 3)");
    require(lift.size() == 2 && lift.shape[1] > 0, "lift: must be (2, R)");
    return {surface, pose_of(origin, rotation, plan), lift[0], lift[1]};
}

void bind_width(nb::module_& m) {
    m.def(
        "maxima",
        [](const SurfaceData& surface, Numbers origin, Rows rotation, double plan, Rows lift, Numbers middle,
           Numbers width, Numbers depth) {
            require(width.size() == middle.size() && depth.size() == middle.size(), "middle, width, depth: (K,)");
            auto found = maxima(lifted(surface, origin, rotation, plan, lift), middle, width, depth);
            Array<double, 2> bounds(long(found.size()), 2);
            Array<bool, 1> continues(bounds.size());
            for (long p = 0; p < bounds.size(); ++p)
                bounds(p, 0) = found[p].low, bounds(p, 1) = found[p].high, continues(p) = found[p].continues;
            return std::pair{bounds, continues};
        },
        "surface"_a, "origin"_a, "rotation"_a, "plan"_a, "lift"_a, "middle"_a, "width"_a, "depth"_a, Unlocked(),
        "Pieces of the undeformed penetration with one maximum each, in order: their bounds (P, 2) m, and whether they "
        "continue the last one across a saddle (P,). Pose of the upper body; lift (2, R) m, places of lines, and by "
        "how "
        "much the penetration is less there; middle and width (K,) m of the strips, and their mean depth (K,) m less "
        "the lift.");
    m.def(
        "penetrated_width",
        [](const SurfaceData& surface, Numbers origin, Rows rotation, double plan, Rows lift, Numbers middle,
           Numbers width, Rows bounds, View<const bool, 1> continues, bool slopes) {
            require(width.size() == middle.size() && width.size() > 0, "middle, width: must be (K,)");
            require(bounds.shape == std::array{continues.size(), 2L}, "bounds, continues: must be (P, 2) and (P,)");
            std::vector<Piece> pieces;
            pieces.reserve(bounds.size());
            for (long p = 0; p < bounds.size(); ++p) pieces.push_back({bounds(p, 0), bounds(p, 1), continues(p)});
            return penetrated_width(lifted(surface, origin, rotation, plan, lift), middle, width, pieces, slopes);
        },
        "surface"_a, "origin"_a, "rotation"_a, "plan"_a, "lift"_a, "middle"_a, "width"_a, "bounds"_a, "continues"_a,
        "slopes"_a, Unlocked(),
        "Number of strips across the penetration, and its derivative (6 + R,) by pose and lift if slopes, else zeros: "
        "surface to width as for `maxima`, whose results are bounds (P, 2) m and continues (P,).");
}

}  // namespace

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
    bind_system(m);
    bind_width(m);
    bind_solver(m);
}
