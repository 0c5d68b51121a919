// Law of friction in the cells of strips.
#pragma once
#include <cmath>

#include "contact/laws/core/law.hpp"

namespace wr {

// Margins (n,) Pa from the tractions to their bounds where cells stick, b rho + eps > |y|, y = rho q - s; zero under
// slip. Tractions q (2, n) Pa, slips s (2, n) over the speed m/s, pressures p (n,) Pa, not negative, and rho (n,) 1/Pa.
inline Array<double, 1> margins(const ResidualCode& law, Rows q, Rows s, Numbers p, Numbers rho, double speed) {
    Array<double, 1> bound(p.size()), margin(p.size());
    friction_bounds(law, s, p, speed, bound);
    for (long i = 0; i < p.size(); ++i) {
        double size = std::hypot(rho(i) * q(0, i) - s(0, i), rho(i) * q(1, i) - s(1, i));
        if (size < rho(i) * bound(i) + law.regularisation)
            margin(i) = std::max(bound(i) - std::hypot(q(0, i), q(1, i)), 0.0);
    }
    return margin;
}

}  // namespace wr
