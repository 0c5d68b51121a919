// Newton iterations on fixed strips, with the factors of an earlier state while steps contract.
#pragma once
#include "contact/models/lattice/solver/core/chords.hpp"
#include "contact/models/lattice/solver/core/renewal.hpp"

namespace wr {

constexpr int HALVINGS = 6;            // of a step in the line search
constexpr double DECREASE = 0.25;      // of the following step, of that of the linearised equations
constexpr double NEAR_SOLUTION = 0.1;  // step below which strips may enter
constexpr double RENEWED = 0.5;  // of a step with renewed factors: largest following one with which they serve again

// State after a step, which is shortened where the following one is not shorter, and further full ones.
// Affine-invariant line search: Deuflhard, Newton Methods for Nonlinear Problems, 2011, sec. 3.3.
inline Steps searched(const Array<double, 2>& values, const Array<double, 2>& step, const EquationData& data,
                      const Factors& factors, const Evaluation& evaluation, double tolerance) {
    auto best = further_steps(values, step, evaluation, data, factors, tolerance);
    if (best.converged || best.first <= 1.0 - DECREASE) return best;
    if (!(best.first < 1.0)) best.first = INFINITE;
    long evaluations = best.evaluations;
    double before = relative_size(values, step).norm, factor = longest(values, step);
    if (factor == 1.0) factor = 0.5;
    for (int n = 0; n < HALVINGS; ++n, factor *= 0.5) {
        auto trial = moved(values, step, factor, data.places.whole);
        ++evaluations;
        auto there = evaluate(trial, data);
        if (!there.inside) continue;
        auto following = newton_step(factors, there.residual);
        auto after = relative_size(values, following);
        if (!(after.norm / before > best.first))
            best = {false, trial, following, best.leaves, after.largest, after.norm / before, there, 0};
        if (after.norm <= (1.0 - DECREASE * factor) * before) break;
    }
    best.evaluations = evaluations;
    return best;
}

// Iterations from values (S, block) until something happens to the strips. kept: from an earlier state of the same
// strips; entered: whether strips that may enter have been looked for since the strips changed.
//
// As long as steps with old factors contract, the Jacobian is kept. Where they do not since cells have begun to slip or
// to stick, the factors are renewed for these; otherwise the Jacobian is computed anew.
inline Progress iterate(Array<double, 2> values, const EquationData& data, const KeptFactors& kept, bool entered,
                        const Limits& limits) {
    Progress at{CONVERGED, values, Array<bool, 1>(values.size()), INFINITE, kept, 0, 0, 0};
    auto& [valid, factors, evaluation] = at.kept;
    auto stopped = [&](Event event) {
        at.event = event;
        return at;
    };
    while (at.iterations < limits.iterations) {
        bool exact = true, first = at.iterations++ == 0;
        if (valid) {
            bool fresh = false;
            std::tie(fresh, factors) = renewed(factors, slopes_of_friction(at.values, evaluation, data), data.rho);
            exact = !fresh;
        }
        if (exact) {
            auto linear = linearised(at.values, data);
            ++at.linearisations;
            evaluation = linear.evaluation;
            if (!evaluation.inside) return stopped(OUTSIDE);
            bool regular = false;
            std::tie(regular, factors) = factorised(linear);
            if (!regular) return stopped(SINGULAR);
        }
        auto step = newton_step(factors, evaluation.residual);
        at.size = relative_size(at.values, step).largest;
        if (!std::isfinite(at.size)) return stopped(NOT_FINITE);
        if (first && at.size > limits.farthest) return stopped(TOO_LONG);
        at.leaves = leaving(at.values, step, at.size, data.places.whole);
        if (any(at.leaves)) return stopped(LEAVES);
        auto ahead = searched(at.values, step, data, factors, evaluation, limits.tolerance);
        at.evaluations += ahead.evaluations;
        if (!std::isfinite(ahead.first) && !ahead.converged) return stopped(OUTSIDE);
        valid = exact || ahead.size < RENEWED * at.size;
        at.values = ahead.values, at.size = ahead.size, at.leaves = ahead.leaves, evaluation = ahead.evaluation;
        if (ahead.converged) {
            at.values = moved(at.values, ahead.step, 1.0, data.places.whole);
            return stopped(CONVERGED);
        }
        if (any(at.leaves)) return stopped(LEAVES);
        if (at.size < NEAR_SOLUTION && !entered) return stopped(ENTRY);
    }
    at.leaves = Array<bool, 1>(values.size());
    return stopped(PAUSED);
}

}  // namespace wr
