// Sliders of frictional elements after a step: the play operator along the motion.
#pragma once
#include <algorithm>

#include "vehicle/multibody/core/vehicle.hpp"

namespace wr {

// Deflection m of a spring and its rate m/s, and the deflection m of the spring at which its slider is drawn along.
struct Stretch {
    double x, rate, reach;
};

// Place m of a slider, and its distance m from where it were had the deflection not turned back within the step.
struct Settled {
    double place, turned;
};

// Place of a slider after a step of a duration s, over which the deflection is the cubic through values and rates at
// both ends: it is drawn along to each extreme value in turn.
inline Settled settled(double place, const Stretch& start, const Stretch& end, double duration) {
    double a = duration * start.rate, b = duration * end.rate, rise = end.x - start.x;
    double c2 = 3.0 * rise - 2.0 * a - b, c3 = a + b - 2.0 * rise;  // x = start.x + a u + c2 u^2 + c3 u^3
    auto drawn = [&](double from, double u) {
        double x = u < 1.0 ? start.x + u * (a + u * (c2 + u * c3)) : end.x;
        double reach = start.reach + u * (end.reach - start.reach);
        return std::clamp(from, x - reach, x + reach);
    };
    double straight = drawn(place, 1.0), found = drawn(place, 0.0);
    // Roots of a + 2 c2 u + 3 c3 u^2, also where it is nearly linear.
    double root = c2 * c2 - 3.0 * a * c3;
    if (root > 0.0) {
        double q = -(c2 + std::copysign(std::sqrt(root), c2));
        double first = c3 != 0.0 ? q / (3.0 * c3) : 2.0, second = q != 0.0 ? a / q : 2.0;
        for (double u : {std::min(first, second), std::max(first, second)})
            if (u > 0.0 && u < 1.0) found = drawn(found, u);
    }
    found = drawn(found, 1.0);
    return {found, std::abs(found - straight)};
}

// Moves the sliders among the internal variables (m,) of an element, at its start, to where they are at the end of a
// step; fills the distances (m,) `turned`.
inline void settle(const Element& e, const ElementState<double>& start, const ElementState<double>& end,
                   double duration, double* internal, double* turned) {
    auto one = [&](int j, double x0, double v0, double limit0, double x, double v, double limit) {
        const auto& f = e.directions[j].friction;
        if (f.slider < 0) return;
        auto s = settled(internal[f.slider], {x0, v0, limit0 / f.stiffness}, {x, v, limit / f.stiffness}, duration);
        internal[f.slider] = s.place, turned[f.slider] = s.turned;
    };
    const auto &x0 = start.deflection, &v0 = start.deflection_rate, &l0 = start.friction_limit;
    const auto &x = end.deflection, &v = end.deflection_rate, &l = end.friction_limit;
    one(0, x0.x, v0.x, l0.x, x.x, v.x, l.x);
    one(1, x0.y, v0.y, l0.y, x.y, v.y, l.y);
    one(2, x0.z, v0.z, l0.z, x.z, v.z, l.z);
}

}  // namespace wr
