// Reasons why a contact is not solved.
#pragma once
#include <stdexcept>

namespace wr {

struct Unsolved : std::runtime_error {
    using std::runtime_error::runtime_error;
};
// An iteration did not converge.
struct NotConverged : Unsolved {
    using Unsolved::Unsolved;
};
// The penetration exceeds the part of the surface that carries contact points.
struct OutsideSurface : Unsolved {
    using Unsolved::Unsolved;
};
// Steady slip is defined for bodies that roll forward only.
struct NotRolling : Unsolved {
    using Unsolved::Unsolved;
};
struct SingularMatrix : Unsolved {
    using Unsolved::Unsolved;
};

}  // namespace wr
