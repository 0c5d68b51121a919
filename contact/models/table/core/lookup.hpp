// Look-up of the values of a table of contact forces, with their derivatives by the table's variables.
#pragma once
#include "contact/models/table/core/interpolation.hpp"

namespace wr {

enum TableAxis { LEVEL = 3, LONGITUDINAL, LATERAL };  // after those of the position: y, roll, yaw
constexpr int CONTACT_NUMBERS = 9, FRICTION_NUMBERS = 6, FRICTION_AXES = 6;

// Level at which the interpolated height is z m: levels (n,), heights (n,) m, decreasing, z between the first and the
// last.
//
// Newton's method, kept in the interval by bisection; after a step below 1e-8 of the interval the next one would be
// below round-off.
inline double level_at(Numbers nodes, Numbers heights, double z) {
    long k = 0;
    while (k < nodes.size() - 2 && z <= heights(k + 1)) ++k;
    double low = nodes(k), high = nodes(k + 1), length = high - low;
    double level = low + length * (heights(k) - z) / (heights(k) - heights(k + 1));
    for (int step = 0; step < 60; ++step) {
        Stencil of(nodes, level);
        double height = 0.0, slope = 0.0;
        for (long n = 0; n < of.count; ++n) {
            height += of.weights[n] * heights(of.first + n);
            slope += of.slopes[n] * heights(of.first + n);
        }
        (height > z ? low : high) = level;
        double before = level;
        level += (z - height) / slope;
        if (!(low <= level && level <= high)) level = 0.5 * (low + high);
        if (std::abs(level - before) < 1e-8 * length) break;
    }
    return level;
}

// Contact without friction at y, roll, yaw and z of the tread, m, rad, rad, m.
struct TableContact {
    double depth;             // m, below first contact
    Array<double, 2> values;  // (1, 9), level, then those after the height; with slopes (5, 9), with their derivatives

    // The level is the depth where there is no contact, and grows linearly beyond the last one, with the values of
    // that.
    TableContact(const Grid& normal, const double* position, bool slopes) {
        double z = position[3];
        Numbers levels = normal.axis(LEVEL);
        long n = levels.size();
        auto blocks = between(normal, position, 0, n, slopes);
        Array<double, 1> heights(n);
        for (long k = 0; k < n; ++k) heights(k) = blocks(0, k * normal.columns);
        depth = heights(0) - z;
        double level = depth, last = levels(n - 1);
        if (z < heights(n - 1))
            level = last * (1.0 + (heights(n - 1) - z) / (heights(0) - heights(n - 1)));
        else if (depth > 0.0)
            level = level_at(levels, heights, z);
        Stencil of(levels, std::min(std::max(level, 0.0), last));
        values = along(blocks, of.first, of, normal.columns);
        if (slopes) {  // by level at first: the height of the level is z
            auto by_level = values[4];
            for (int k = 1; k < 4; ++k) {
                double change = -values(k, 0) / by_level(0);
                for (int c = 0; c < CONTACT_NUMBERS; ++c) values(k, c) += change * by_level(c);
                values(k, 0) = change;
            }
            double over = by_level(0);
            for (double& value : by_level) value /= over;
            by_level(0) = 1.0 / over;
        }
        values(0, 0) = level;
    }
};

// Values (1, columns) of a table at coordinates of all its axes; with slopes (axes + 1, columns), with their
// derivatives.
inline Array<double, 2> values_at(const Grid& grid, const double* at, bool slopes) {
    long last = grid.axes() - 1;
    Stencil of(grid.axis(last), at[last]);
    return along(between(grid, at, of.first, of.count, slopes), 0, of, grid.columns);
}

}  // namespace wr
