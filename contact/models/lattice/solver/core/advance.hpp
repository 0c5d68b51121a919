// Iterations until something happens to the strips, and the strips that enter then.
#pragma once
#include "contact/models/lattice/solver/core/iteration.hpp"
#include "contact/models/lattice/solver/core/remaining.hpp"

namespace wr {

// Outcome of the iterations, and the remaining penetration of unloaded strips where evaluated.
struct Advance {
    Progress progress;      // of the iteration
    bool complete = false;  // whether the remaining penetration is known; not where it is not asked for or lacks tables
    Remaining rest;         // remaining penetration of the strips that may enter

    auto fields() { return std::tie(progress, complete, rest); }
};

// Newton iterations from values (S, block) until convergence or a change of strips, with `search` for entering strips.
//
// kept: factors of an earlier state of the same strips. earlier: whether these are values and factors of the solution
// at another pose: the first steps are taken with them, and are no iterations. There is none if the factors are not
// those of as many unknowns. entered: see `iterate`; probes, lines, barred: see `search`.
inline Advance advance(Rows initial, const EquationData& data, KeptFactors kept, bool earlier, bool entered,
                       const Limits& limits, const Probes& probes, const ContactLines& lines, Indices barred) {
    auto values = Array<double, 2>::copy(initial);
    long evaluations = 0, cells = data.rolls() ? data.basis.M() : 0;
    bool goes_on = !earlier;
    Progress progress{TOO_LONG, values, Array<bool, 1>(values.size()), INFINITE, kept, 0, 0, 0};
    if (earlier && fit(kept.factors, values.size(), cells, values.shape[1])) {
        auto steps = chords(values, data, kept.factors, limits.tolerance, limits.farthest);
        values = steps.values, evaluations = steps.evaluations;
        kept.valid = true, kept.evaluation = steps.evaluation;
        progress = {TOO_LONG, values, Array<bool, 1>(values.size()), steps.size, kept, 0, 0, evaluations};
        if (steps.converged) {
            progress.event = CONVERGED, progress.values = moved(values, steps.step, 1.0, data.places.whole);
        } else if (any(steps.leaves)) {
            progress.event = LEAVES, progress.leaves = steps.leaves;
        } else {
            goes_on = steps.size < limits.farthest;
        }
    }
    if (goes_on) {
        progress = iterate(values, data, kept, entered, limits);
        progress.evaluations += evaluations;
    }
    if (progress.event != CONVERGED && progress.event != ENTRY) return {progress, false, {}};
    auto found = search(progress.values, data, probes, lines, barred);
    return {progress, found.complete, found.rest};
}

}  // namespace wr
