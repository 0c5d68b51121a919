// Loaded contact points, from which results of patches are summed.
#pragma once
#include <tuple>

#include "support/core/arrays.hpp"

namespace wr {

struct PatchPoints {
    Array<double, 2> point;              // (n, 3) m
    Array<double, 3> axes;               // (n, 3, 3), rows longitudinal, lateral, outward from the wheel
    Array<double, 2> level;              // (n, 3), longitudinal axes for the velocity of the rail
    Array<double, 1> area;               // (n,) m2
    Array<double, 1> step;               // (n,) m, length of the point's cell along the rolling direction
    Array<double, 2> on_wheel, on_rail;  // (n, 2) m, arc length and lateral position on the profiles
    Array<double, 1> pressure;           // (n,) Pa
    Array<double, 2> traction;           // (n, 2) Pa, on the wheel
    Array<double, 1> elastic;            // (n,) Pa, work on displacements of steady rolling per length of travel
    Array<bool, 1> sticks;               // (n,), whether the surfaces stick

    auto fields() {
        return std::tie(point, axes, level, area, step, on_wheel, on_rail, pressure, traction, elastic, sticks);
    }
    bool fits() const {
        long n = area.size();
        std::array<long, 2> vectors{n, 3}, pairs{n, 2};
        return point.shape == vectors && axes.shape == std::array<long, 3>{n, 3, 3} && level.shape == vectors &&
               step.size() == n && on_wheel.shape == pairs && on_rail.shape == pairs && pressure.size() == n &&
               traction.shape == pairs && elastic.size() == n && sticks.size() == n;
    }
    long size() const { return area.size(); }
};

}  // namespace wr
