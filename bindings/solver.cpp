// Python's face of the solution of the equations of strips.
#include "contact/models/lattice/solver/core/advance.hpp"
#include "contact/models/lattice/solver/core/renewal.hpp"
#include "lattice.hpp"

using namespace wr;

namespace {

void bind_factor_structures(nb::module_& m) {
    structure<Factors>(m, "Factors",
                       {"lu", "pivots", "rows", "columns", "slips", "slopes", "present", "spread", "gather"},
                       "LU factors of the Jacobian of a state.");
}

void bind_factors(nb::module_& m) {
    m.def("factorised", &factorised, "at"_a, Unlocked(), "Whether a Jacobian is regular, and its `Factors`.");
    m.def(
        "newton_step",
        [](const Factors& factors, Rows residual) {
            require(residual.count() == factors.rows.size(), "residual: must be (S, block)");
            return newton_step(factors, residual);
        },
        "factors"_a, "residual"_a, Unlocked(), "Step (S, block) that cancels the linearised residual (S, block).");
    m.def(
        "solve_transposed",
        [](const Factors& factors, Rows jacobian, Rows right) {
            long n = factors.rows.size();
            require(jacobian.shape == std::array{n, n} && right.shape[1] == n,
                    "jacobian, right: must be (n, n), (k, n)");
            return solve_transposed(factors, jacobian, right);
        },
        "factors"_a, "jacobian"_a, "right"_a, Unlocked(),
        "Solutions (k, n) in double precision of the transposed equations for right-hand sides (k, n), with the "
        "Jacobian (n, n) of factors that are not corrected.");
    m.def(
        "renewed",
        [](const Factors& factors, const Array<double, 3>& slopes, Numbers rho) {
            require(slopes.shape == factors.slopes.shape && rho.size() == slopes.shape[1],
                    "slopes: must be (S, M, 18)");
            return renewed(factors, slopes, rho);
        },
        "factors"_a, "slopes"_a, "rho"_a, Unlocked(),
        "Factors with the present slopes (S, M, 18) of the friction residual, and before them whether there are any.");
}

void bind_iteration(nb::module_& m) {
    structure<Steps>(m, "Steps",
                     {"converged", "values", "step", "leaves", "size", "first", "evaluation", "evaluations"},
                     "State after some steps with the same factors.");
    m.def(
        "chords",
        [](const Array<double, 2>& values, const EquationData& data, const Factors& factors, double tolerance,
           double farthest) {
            require_values(values, data);
            require(fit(factors, values.size(), data.mode() / 2, values.shape[1]), "factors: of other strips");
            return chords(values, data, factors, tolerance, farthest);
        },
        "values"_a, "data"_a, "factors"_a, "tolerance"_a, "farthest"_a, Unlocked(),
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
}

}  // namespace

void bind_solver(nb::module_& m) {
    bind_factor_structures(m);
    bind_factors(m);
    bind_iteration(m);
}
