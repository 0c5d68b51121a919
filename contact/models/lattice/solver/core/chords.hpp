// Chord steps: Newton steps with an earlier factorisation.
//
// Broyden's good method: every step corrects the Jacobian by a rank-one update, so that steps contract the faster, the
// more of them there are. P. Deuflhard, Newton Methods for Nonlinear Problems, 2011, sec. 2.1.4 (QNERR).
#pragma once
#include <vector>

#include "contact/models/lattice/solver/core/progress.hpp"
#include "contact/models/lattice/system/core/equations.hpp"

namespace wr {

constexpr int CHORDS = 8;            // steps with the same factors
constexpr double CONTRACTION = 0.5;  // of a step, for another one with the same factors: Deuflhard's
constexpr double LEFT = 0.3;         // of the tolerance, error left by the last step if following ones contract like it

// Full steps while contracting, until convergence or until a strip leaves or grows too much: from values (S, block),
// their evaluation, and the first step (S, block). tolerance: of the last step, relative.
inline Steps further_steps(const Array<double, 2>& start, const Array<double, 2>& first_step,
                           const Evaluation& evaluation, const EquationData& data, const Factors& factors,
                           double tolerance) {
    const auto& whole = data.places.whole;
    auto [size, before] = relative_size(start, first_step);
    Steps at{false, start, first_step, {}, size, INFINITE, evaluation, 0};
    std::vector<Array<double, 2>> steps;
    std::vector<double> squares;
    double rate = 0.0;
    while (true) {
        at.leaves = leaving(at.values, at.step, at.size, whole);
        at.converged = at.size < tolerance && at.size * rate < LEFT * tolerance * (1.0 - rate);
        if (at.converged || at.evaluations == CHORDS || any(at.leaves) || longest(at.values, at.step) < 1.0) break;
        auto trial = moved(at.values, at.step, 1.0, whole);
        auto ahead = evaluate(trial, data);
        steps.push_back(at.step), squares.push_back(before * before);
        ++at.evaluations;
        if (!ahead.inside) break;
        auto following = newton_step(factors, ahead.residual);
        for (std::size_t i = 1; i < steps.size(); ++i) {
            double weight = inner_product(start, following, steps[i - 1]) / squares[i - 1];
            for (long k = 0; k < following.count(); ++k) following.data[k] += weight * steps[i].data[k];
        }
        auto after = relative_size(start, following);
        rate = after.norm / before;
        if (at.evaluations == 1) at.first = rate;
        if (rate < 1.0) at.values = trial, at.step = following, at.evaluation = ahead, at.size = after.largest;
        if (!(rate < CONTRACTION)) break;
        double over = 1.0 - inner_product(start, following, steps.back()) / squares.back();
        at.step = Array<double, 2>(following.shape);
        for (long k = 0; k < following.count(); ++k) at.step.data[k] = following.data[k] / over;
        auto next = relative_size(start, at.step);
        at.size = next.largest, before = next.norm;
    }
    at.converged = at.converged && !any(at.leaves);
    return at;
}

// Steps from values (S, block) with the factors of an earlier state; farthest: first step beyond which the state is of
// no use.
inline Steps chords(const Array<double, 2>& values, const EquationData& data, const Factors& factors, double tolerance,
                    double farthest) {
    auto evaluation = evaluate(values, data);
    Array<bool, 1> none(values.size());
    if (!evaluation.inside) return {false, values, values, none, INFINITE, INFINITE, evaluation, 1};
    auto step = newton_step(factors, evaluation.residual);
    double size = relative_size(values, step).largest;
    if (!(size < farthest)) return {false, values, step, none, size, INFINITE, evaluation, 1};
    auto ahead = further_steps(values, step, evaluation, data, factors, tolerance);
    ++ahead.evaluations;
    return ahead;
}

}  // namespace wr
