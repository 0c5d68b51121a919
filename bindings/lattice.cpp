// Python's face of the equations of strips and their solution.
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "contact/models/lattice/solver/core/advance.hpp"
#include "contact/models/lattice/solver/core/renewal.hpp"
#include "contact/models/lattice/system/core/cells.hpp"
#include "contact/models/lattice/system/core/contact_lines.hpp"
#include "contact/models/lattice/system/core/penetrated_width.hpp"
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

namespace {

using Released = nb::call_guard<nb::gil_scoped_release>;

void require(bool fits, const char* text) {
    if (!fits) throw nb::value_error(text);
}

void require_values(Rows values, const EquationData& data) {
    require(data.fits(values), "values: must be (S, block) of the strips of the data");
}

void require_step(Rows values, Rows step) {
    require(step.shape == values.shape && values.shape[1] >= MOMENTS, "values, steps: must be (S, block)");
}

void bind_system(nb::module_& m) {
    m.attr("SLOPES") = SLOPES;
    m.attr("OPENING") = OPENING;
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
        "values"_a, "data"_a, Released(), "`Evaluation` of a state with values (S, block).");
    m.def(
        "linearised",
        [](Rows values, const EquationData& data) {
            require_values(values, data);
            return linearised(values, data);
        },
        "values"_a, "data"_a, Released(), "`Linearisation` of a state with values (S, block).");
    m.def(
        "slopes_of_friction",
        [](Rows values, const Evaluation& evaluation, const EquationData& data) {
            require_values(values, data);
            require(evaluation.slip.shape == std::array{data.strips(), 2L, data.basis.M()},
                    "evaluation: of another state");
            return slopes_of_friction(values, evaluation, data);
        },
        "values"_a, "evaluation"_a, "data"_a, Released(),
        "Slopes (S, M, 18) of the friction residual by traction (4), slip (4), speed (2), and the pressure modes (2 "
        "each); M = 0 without friction.");
    m.def(
        "rigid_slip",
        [](Rows values, const EquationData& data) {
            require_values(values, data);
            RigidSlip at(values, data);
            return std::pair{at.slip, at.slope};
        },
        "values"_a, "data"_a, Released(),
        "Rigid slip (S, 2, M) over the speed at the cells, and its derivative 1/m along x.");
    m.def(
        "strip_loads",
        [](Rows values, const StripPlaces& places, const StripBasis& basis, bool rolls) {
            require(values.shape == std::array{places.middle.size(), basis.block(rolls)}, "values: must be (S, block)");
            return strip_loads(values, places, basis, rolls);
        },
        "values"_a, "places"_a, "basis"_a, "rolls"_a, Released(),
        "Loads (S, 2) N of strips: lateral tractions, and pressure.");
    m.def(
        "resultants",
        [](Rows values, const EquationData& data) {
            require_values(values, data);
            return resultants(values, data);
        },
        "values"_a, "data"_a, Released(), "Force N and moment N m about the origin (6,) on the upper body.");
    m.def(
        "strip_cells",
        [](Rows values, const EquationData& data) {
            require_values(values, data);
            return strip_cells(values, data);
        },
        "values"_a, "data"_a, Released(), "`StripCells` of a state with values (S, block).");
    m.def(
        "contact_lines",
        [](const SurfaceData& surface, const Motion& motion, const Lattice& lattice, double margin, long apart) {
            require(lattice.middle.size() > 0 && apart > 0, "lattice, apart: at least one strip");
            return contact_lines(surface, motion, lattice, margin, apart);
        },
        "surface"_a, "motion"_a, "lattice"_a, "margin"_a, "apart"_a, Released(),
        "`ContactLines` of the strips of a lattice; margin m: largest gap between strips that matter; apart: strips "
        "between those at which the penetration is estimated first.");
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
        "depth"_a, "compliance"_a, "onset"_a, Released(),
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
        "depth"_a, "curvature"_a, "middle"_a, "width"_a, Released(),
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
        "depth"_a, "curvature"_a, "middle"_a, "width"_a, "change"_a, Released(),
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
        "values"_a, "step"_a, Released(),
        "Largest entry and norm of a step (S, block) over the largest amplitude of the pressure, or half length.");
    m.def(
        "inner_product",
        [](Rows values, Rows first, Rows second) {
            require_step(values, first), require_step(values, second);
            return inner_product(values, first, second);
        },
        "values"_a, "first"_a, "second"_a, Released(), "That of two steps (S, block), of the norm of `relative_size`.");
    m.def(
        "leaving",
        [](Rows values, Rows step, double size, Numbers whole) {
            require_step(values, step);
            require(whole.size() == values.size(), "whole: must be (S,)");
            return leaving(values, step, size, whole);
        },
        "values"_a, "step"_a, "size"_a, "whole"_a, Released(), "Strips (S,) that leave by a step of a relative size.");
    m.def(
        "moved",
        [](Rows values, Rows step, double factor, Numbers whole) {
            require_step(values, step);
            require(whole.size() == values.size(), "whole: must be (S,)");
            return moved(values, step, factor, whole);
        },
        "values"_a, "step"_a, "factor"_a, "whole"_a, Released(),
        "Values (S, block) after a fraction of a step; whole (S,) Pa m, loads on the whole width.");
}

void bind_factors(nb::module_& m) {
    m.def("factorised", &factorised, "at"_a, "solver"_a, Released(),
          "Whether a Jacobian is regular, and its `Factors`.");
    m.def(
        "newton_step",
        [](const Factors& factors, const Lapack& solver, Rows residual) {
            require(residual.count() == factors.rows.size(), "residual: must be (S, block)");
            return newton_step(factors, solver, residual);
        },
        "factors"_a, "solver"_a, "residual"_a, Released(),
        "Step (S, block) that cancels the linearised residual (S, block).");
    m.def(
        "solve_transposed",
        [](const Factors& factors, const Lapack& solver, Rows jacobian, Rows right) {
            long n = factors.rows.size();
            require(jacobian.shape == std::array{n, n} && right.shape[1] == n,
                    "jacobian, right: must be (n, n), (k, n)");
            return solve_transposed(factors, solver, jacobian, right);
        },
        "factors"_a, "solver"_a, "jacobian"_a, "right"_a, Released(),
        "Solutions (k, n) in double precision of the transposed equations for right-hand sides (k, n), with the "
        "Jacobian (n, n) of factors that are not corrected.");
    m.def(
        "renewed",
        [](const Factors& factors, const Array<double, 3>& slopes, Numbers rho, const Lapack& solver) {
            require(slopes.shape == factors.slopes.shape && rho.size() == slopes.shape[1],
                    "slopes: must be (S, M, 18)");
            return renewed(factors, slopes, rho, solver);
        },
        "factors"_a, "slopes"_a, "rho"_a, "solver"_a, Released(),
        "Factors with the present slopes (S, M, 18) of the friction residual, and before them whether there are any.");
}

Array<long, 1> array_of(const std::vector<long>& numbers) {
    Array<long, 1> copy(long(numbers.size()));
    std::copy(numbers.begin(), numbers.end(), copy.begin());
    return copy;
}

void require_strips(Indices strips, long K) {
    for (long k : strips) require(k >= 0 && k < K, "strips: numbers beyond the lattice");
}

LiftedPenetration lifted(const SurfaceData& surface, Numbers origin, Rows rotation, Rows lift) {
    require(origin.size() == 3 && rotation.shape == std::array{3L, 3L}, "origin, rotation: must be (3,) and (3, 3)");
    require(lift.size() == 2 && lift.shape[1] > 0, "lift: must be (2, R)");
    return {surface, pose_of(origin, rotation), lift[0], lift[1]};
}

void bind_width(nb::module_& m) {
    m.def(
        "strips_across",
        [](Numbers depth, Numbers slenderness) {
            require(slenderness.size() == depth.size(), "slenderness: must be as long as depth");
            return strips_across(depth, slenderness);
        },
        "depth"_a, "slenderness"_a, Released(),
        "Number of strips across, counted by their slenderness (K,), by their mean penetrations depth (K,) m, for "
        "contacts that are wide.");
    m.def(
        "strips_beside_bulk",
        [](Rows values, const EquationData& data, const ContactLines& lines, const Lattice& lattice,
           Numbers slenderness, const std::vector<BulkCompliance>& bodies) {
            long K = lines.depth.size();
            require_values(values, data), require_strips(data.places.strip, K);
            require(lattice.middle.size() == K && slenderness.size() == K, "lattice, slenderness: must be (K,)");
            return strips_beside_bulk(values, data, lines, lattice, slenderness, bodies);
        },
        "values"_a, "data"_a, "lines"_a, "lattice"_a, "slenderness"_a, "bodies"_a, Released(),
        "`strips_across` of the penetration less the displacement of finite bodies by the loads of a state with values "
        "(S, block), after whether their compliance is known there.");
    m.def(
        "maxima",
        [](const SurfaceData& surface, Numbers origin, Rows rotation, Rows lift, Numbers middle, Numbers width,
           Numbers depth) {
            require(width.size() == middle.size() && depth.size() == middle.size(), "middle, width, depth: (K,)");
            auto found = maxima(lifted(surface, origin, rotation, lift), middle, width, depth);
            Array<double, 2> bounds(long(found.size()), 2);
            Array<bool, 1> continues(bounds.size());
            for (long p = 0; p < bounds.size(); ++p)
                bounds(p, 0) = found[p].low, bounds(p, 1) = found[p].high, continues(p) = found[p].continues;
            return std::pair{bounds, continues};
        },
        "surface"_a, "origin"_a, "rotation"_a, "lift"_a, "middle"_a, "width"_a, "depth"_a, Released(),
        "Pieces of the undeformed penetration with one maximum each, in order: their bounds (P, 2) m, and whether they "
        "continue the last one across a saddle (P,). Pose of the upper body; lift (2, R) m, places of lines, and by "
        "how "
        "much the penetration is less there; middle and width (K,) m of the strips, and their mean depth (K,) m less "
        "the lift.");
    m.def(
        "penetrated_width",
        [](const SurfaceData& surface, Numbers origin, Rows rotation, Rows lift, Numbers middle, Numbers width,
           Rows bounds, View<const bool, 1> continues, bool slopes) {
            require(width.size() == middle.size() && width.size() > 0, "middle, width: must be (K,)");
            require(bounds.shape == std::array{continues.size(), 2L}, "bounds, continues: must be (P, 2) and (P,)");
            std::vector<Piece> pieces;
            for (long p = 0; p < bounds.size(); ++p) pieces.push_back({bounds(p, 0), bounds(p, 1), continues(p)});
            return penetrated_width(lifted(surface, origin, rotation, lift), middle, width, pieces, slopes);
        },
        "surface"_a, "origin"_a, "rotation"_a, "lift"_a, "middle"_a, "width"_a, "bounds"_a, "continues"_a, "slopes"_a,
        Released(),
        "Number of strips across the penetration, and its derivative (6 + R,) by pose and lift if slopes, else zeros: "
        "surface to width as for `maxima`, whose results are bounds (P, 2) m and continues (P,).");
}

void require_lattice(const EquationData& data, const Lattice& lattice, long K) {
    require(data.tables.place.size() == K && lattice.middle.size() == K, "tables, lattice: must have K strips");
}

void bind_solver(nb::module_& m) {
    structure<Probes>(
        m, "Probes", {"lattice", "first", "second"},
        "Where the remaining penetration is evaluated: all strips, and equal cells along the probed range "
        "and around its maximum.");
    structure<Steps>(m, "Steps",
                     {"converged", "values", "step", "leaves", "size", "first", "evaluation", "evaluations"},
                     "State after some steps with the same factors.");
    m.def(
        "chords",
        [](const Array<double, 2>& values, const EquationData& data, const Factors& factors, const Lapack& solver,
           double tolerance, double farthest) {
            require_values(values, data);
            require(fit(factors, values.size(), data.mode() / 2, values.shape[1]), "factors: of other strips");
            return chords(values, data, factors, solver, tolerance, farthest);
        },
        "values"_a, "data"_a, "factors"_a, "solver"_a, "tolerance"_a, "farthest"_a, Released(),
        "`Steps` from values (S, block) with the factors of an earlier state; tolerance of the last step, relative; "
        "farthest: first step beyond which the state is of no use.");
    m.def(
        "maximum",
        [](Numbers means, double low, double high) {
            require(means.size() > 2, "means: at least three");
            auto at = maximum(means, low, high);
            return std::tuple{at.height, at.place, at.curvature};
        },
        "means"_a, "low"_a, "high"_a, Released(),
        "Maximum m, its place m and the curvature 1/m of the parabola with the largest of means (C,) m over cells from "
        "low to high m and the next ones.");
    m.def(
        "excess",
        [](Rows values, const EquationData& data, const Lattice& lattice, Numbers onset, const StripBasis& basis,
           const Array<long, 1>& strips, const Array<double, 1>& low, const Array<double, 1>& high) {
            require_values(values, data), require_lattice(data, lattice, onset.size());
            require_strips(strips, onset.size());
            require(low.size() == strips.size() && high.size() == strips.size(), "low, high: as long as strips");
            return excess(values, data, lattice, onset, basis, {strips, low, high});
        },
        "values"_a, "data"_a, "lattice"_a, "onset"_a, "basis"_a, "strips"_a, "low"_a, "high"_a, Released(),
        "Whether all points lie in the tables, and the remaining penetration (n, C) m at the edge where strips (n,) "
        "that are not loaded begin to touch, means over the cells of a basis from low to high (n,) m along them; onset "
        "(K,) m of all strips. Beyond the lower body it is -inf.");
    m.def(
        "search",
        [](Rows values, const EquationData& data, const Probes& probes, const ContactLines& lines, Indices barred) {
            require_values(values, data), require_lattice(data, probes.lattice, lines.near.size());
            require_strips(barred, lines.near.size());
            auto found = search(values, data, probes, lines, barred);
            return std::tuple{found.complete, found.rest, array_of(found.strips)};
        },
        "values"_a, "data"_a, "probes"_a, "lines"_a, "barred"_a, Released(),
        "Whether there are tables of all pairs, the `Remaining` penetration of the strips that may enter, and strips "
        "between which tables are missing, or that are free: values (S, block) of the loaded ones; barred (n,): strips "
        "that must not enter.");
    m.def(
        "advance",
        [](Rows values, const EquationData& data, const KeptFactors& kept, bool earlier, bool entered,
           const Limits& limits, const Lapack& solver, const Probes& probes, const ContactLines& lines,
           Indices barred) {
            require_values(values, data), require_lattice(data, probes.lattice, lines.near.size());
            require_strips(barred, lines.near.size());
            require(!kept.valid || (kept.evaluation.residual.shape == values.shape &&
                                    fit(kept.factors, values.size(), data.mode() / 2, values.shape[1])),
                    "kept: factors of other strips");
            return advance(values, data, kept, earlier, entered, limits, solver, probes, lines, barred);
        },
        "values"_a, "data"_a, "kept"_a, "earlier"_a, "entered"_a, "limits"_a, "solver"_a, "probes"_a, "lines"_a,
        "barred"_a, Released(),
        "Iterations from values (S, block) until something happens to the strips and, where they converge or others "
        "may enter, `search` of these. kept: factors of an earlier state of the same strips; earlier: whether these "
        "are "
        "values and factors of the solution at another pose, with which the first steps are taken; entered: whether "
        "strips that may enter have been looked for since the strips changed.");
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
    bind_system(m);
    bind_factors(m);
    bind_width(m);
    bind_solver(m);
}
