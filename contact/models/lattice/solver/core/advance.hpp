// Iterations until something happens to the strips, and the strips that enter then.
#pragma once
#include "contact/models/lattice/solver/core/progress.hpp"
#include "contact/models/lattice/solver/core/remaining.hpp"

namespace wr {

// Iterations and, where others than the loaded strips may enter, what these leave on them.
struct Advance {
    Progress progress;      // of the iteration
    bool complete = false;  // whether the remaining penetration is known; not where it is not asked for or lacks tables
    Remaining rest;         // remaining penetration of the strips that may enter

    auto fields() { return std::tie(progress, complete, rest); }
};

}  // namespace wr
