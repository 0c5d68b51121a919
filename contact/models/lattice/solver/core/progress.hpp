// Limits of an iteration on fixed strips, and the event at its end.
#pragma once
#include "contact/models/lattice/solver/core/factors.hpp"

namespace wr {

// End of an iteration: CONVERGED; ENTRY: near to the solution of these strips, others may enter; LEAVES: strips leave;
// PAUSED: all iterations are used up; OUTSIDE: beyond the surfaces or the tables; SINGULAR: the Jacobian; TOO_LONG: the
// first step; NOT_FINITE: a step.
enum Event { CONVERGED, ENTRY, LEAVES, PAUSED, OUTSIDE, SINGULAR, TOO_LONG, NOT_FINITE };

// Factors of an earlier state, and the evaluation of the present state, if valid.
struct KeptFactors {
    bool valid = false;
    Factors factors;
    Evaluation evaluation;

    auto fields() { return std::tie(valid, factors, evaluation); }
};

struct Limits {
    double tolerance = 0.0;  // of the last step, relative; it is taken
    double farthest = 0.0;   // longest first step, relative
    long iterations = 0;     // linearisations and renewals at most

    auto fields() { return std::tie(tolerance, farthest, iterations); }
};

// State after some steps with the same factors.
struct Steps {
    bool converged = false;   // whether the next step and what it will leave are small enough
    Array<double, 2> values;  // (S, block), the state
    Array<double, 2> step;    // (S, block), the next one
    Array<bool, 1> leaves;    // (S,) strips that leave by it
    double size = 0.0;        // its relative size; infinite where none could be evaluated
    double first = 0.0;       // that of the step after the first one over that; infinite if it could not be evaluated
    Evaluation evaluation;    // at the values
    long evaluations = 0;     // of the residual

    auto fields() { return std::tie(converged, values, step, leaves, size, first, evaluation, evaluations); }
};

// Where the iteration has stopped.
struct Progress {
    long event = CONVERGED;
    Array<double, 2> values;  // (S, block), the state
    Array<bool, 1> leaves;    // (S,) strips that leave
    double size = 0.0;        // of the last step, relative
    KeptFactors kept;         // with which the next iteration from these values begins
    long iterations = 0, linearisations = 0, evaluations = 0;

    auto fields() { return std::tie(event, values, leaves, size, kept, iterations, linearisations, evaluations); }
};

}  // namespace wr
