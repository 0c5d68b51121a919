// Python's face of the solution of the equations of strips.
#include "contact/models/lattice/solver/core/advance.hpp"
#include "contact/models/lattice/solver/core/renewal.hpp"
#include "lattice.hpp"

using namespace wr;

namespace {

void bind_structures(nb::module_& m) {
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

Array<long, 1> array_of(const std::vector<long>& numbers) {
    Array<long, 1> copy(long(numbers.size()));
    std::copy(numbers.begin(), numbers.end(), copy.begin());
    return copy;
}

void bind_factors(nb::module_& m) {
    m.def("factorised", &factorised, "at"_a, "solver"_a, Unlocked(),
          "Whether a Jacobian is regular, and its `Factors`.");
    m.def(
        "newton_step",
        [](const Factors& factors, const Lapack& solver, Rows residual) {
            require(residual.count() == factors.rows.size(), "residual: must be (S, block)");
            return newton_step(factors, solver, residual);
        },
        "factors"_a, "solver"_a, "residual"_a, Unlocked(),
        "Step (S, block) that cancels the linearised residual (S, block).");
    m.def(
        "solve_transposed",
        [](const Factors& factors, const Lapack& solver, Rows jacobian, Rows right) {
            long n = factors.rows.size();
            require(jacobian.shape == std::array{n, n} && right.shape[1] == n,
                    "jacobian, right: must be (n, n), (k, n)");
            return solve_transposed(factors, solver, jacobian, right);
        },
        "factors"_a, "solver"_a, "jacobian"_a, "right"_a, Unlocked(),
        "Solutions (k, n) in double precision of the transposed equations for right-hand sides (k, n), with the "
        "Jacobian (n, n) of factors that are not corrected.");
    m.def(
        "renewed",
        [](const Factors& factors, const Array<double, 3>& slopes, Numbers rho, const Lapack& solver) {
            require(slopes.shape == factors.slopes.shape && rho.size() == slopes.shape[1],
                    "slopes: must be (S, M, 18)");
            return renewed(factors, slopes, rho, solver);
        },
        "factors"_a, "slopes"_a, "rho"_a, "solver"_a, Unlocked(),
        "Factors with the present slopes (S, M, 18) of the friction residual, and before them whether there are any.");
}

void require_lattice(const EquationData& data, const Lattice& lattice, long K) {
    require(data.tables.place.size() == K && lattice.middle.size() == K, "tables, lattice: must have K strips");
}

void bind_iteration(nb::module_& m) {
    std::pair<const char*, Event> events[] = {
        {"CONVERGED", CONVERGED}, {"ENTRY", ENTRY},       {"LEAVES", LEAVES},     {"PAUSED", PAUSED},
        {"OUTSIDE", OUTSIDE},     {"SINGULAR", SINGULAR}, {"TOO_LONG", TOO_LONG}, {"NOT_FINITE", NOT_FINITE}};
    for (auto [name, event] : events) m.attr(name) = int(event);
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
        "values"_a, "data"_a, "factors"_a, "solver"_a, "tolerance"_a, "farthest"_a, Unlocked(),
        "`Steps` from values (S, block) with the factors of an earlier state; tolerance of the last step, relative; "
        "farthest: first step beyond which the state is of no use.");
    m.def(
        "maximum",
        [](Numbers means, double low, double high) {
            require(means.size() > 2, "means: at least three");
            auto at = maximum(means, low, high);
            return std::tuple{at.height, at.place, at.curvature};
        },
        "means"_a, "low"_a, "high"_a, Unlocked(),
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
        "values"_a, "data"_a, "lattice"_a, "onset"_a, "basis"_a, "strips"_a, "low"_a, "high"_a, Unlocked(),
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
        "values"_a, "data"_a, "probes"_a, "lines"_a, "barred"_a, Unlocked(),
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
                                    kept.evaluation.slip.shape == std::array{values.size(), 2L, data.basis.M()} &&
                                    fit(kept.factors, values.size(), data.mode() / 2, values.shape[1])),
                    "kept: factors of other strips");
            return advance(values, data, kept, earlier, entered, limits, solver, probes, lines, barred);
        },
        "values"_a, "data"_a, "kept"_a, "earlier"_a, "entered"_a, "limits"_a, "solver"_a, "probes"_a, "lines"_a,
        "barred"_a, Unlocked(),
        "Iterations from values (S, block) until something happens to the strips and, where they converge or others "
        "may enter, `search` of these. kept: factors of an earlier state of the same strips; earlier: whether these "
        "are "
        "values and factors of the solution at another pose, with which the first steps are taken; entered: whether "
        "strips that may enter have been looked for since the strips changed.");
}

}  // namespace

void bind_solver(nb::module_& m) {
    bind_structures(m);
    bind_factors(m);
    bind_iteration(m);
}
