// Strips on a half-space: flexibility by distance along x in closed form, see
// `wheelrail.contact.elasticity.half_space`.
#pragma once
#include <array>
#include <cmath>
#include <numbers>

namespace wr {

using Bounds = std::array<double, 2>;  // m, lateral, of a strip

// Antiderivatives, twice in x and twice in y, of x^2/r^3, y^2/r^3 (sum: 1/r) and x y/r^3 at x, y >= 0.
inline std::array<double, 3> fourfold(double x, double y) {
    double r = std::sqrt(x * x + y * y);
    double over_x = x > 0.0 ? std::asinh(y / x) : 0.0, over_y = y > 0.0 ? std::asinh(x / y) : 0.0;
    double a = 0.5 * x * x * y * over_x, b = 0.5 * x * y * y * over_y, c = r * r * r / 6.0;
    double cross = -(x * y * r / 3.0 + x * x * x / 6.0 * over_x + y * y * y / 6.0 * over_y);
    return {c + b - 0.5 * y * y * r, c + a - 0.5 * x * x * r, cross};
}

// Antiderivatives, twice in x and twice in y, of x/r^2 and y/r^2 at x, y >= 0.
inline std::array<double, 2> fourfold_normal(double x, double y) {
    double logarithm = x + y > 0.0 ? 0.5 * std::log(x * x + y * y) : 0.0;
    double to_x = std::atan2(y, x), to_y = 0.5 * std::numbers::pi - to_x;  // angles with the axes
    double xxx = x * x * x, xxy = x * x * y, xyy = x * y * y, yyy = y * y * y;
    double along = (3.0 * xyy - xxx) * logarithm + 3.0 * xxy * to_x + yyy * to_y;
    double across = (3.0 * xxy - yyy) * logarithm + 3.0 * xyy * to_y + xxx * to_x;
    return {along / 6.0, across / 6.0};
}

// Antiderivatives, twice along the strips, as means over both, of x^2/r^3, y^2/r^3, x y/r^3, x/r^2, y/r^2. y: from the
// loaded to the displaced strip.
//
// x: m, distance along the strips. row, column: of the displaced and of the loaded strip, the same, or side by side.
inline std::array<double, 5> pair_geometry(double x, const Bounds& row, const Bounds& column) {
    std::array<double, 5> to{};
    for (int a = 0; a < 2; ++a)
        for (int b = 0; b < 2; ++b) {
            double distance = std::abs(row[a] - column[b]), sign = a == b ? -1.0 : 1.0;
            auto even = fourfold(std::abs(x), distance);
            auto odd = fourfold_normal(std::abs(x), distance);
            for (int k = 0; k < 3; ++k) to[k] += sign * even[k];
            for (int k = 0; k < 2; ++k) to[3 + k] += sign * odd[k];
        }
    double ahead = x >= 0.0 ? 1.0 : -1.0;
    double beside = row[0] == column[0] ? 0.0 : row[0] > column[0] ? 1.0 : -1.0;  // odd across
    to[2] *= ahead * beside, to[3] *= ahead, to[4] *= beside;
    double over = 1.0 / ((row[1] - row[0]) * (column[1] - column[0]));
    for (double& value : to) value *= over;
    return to;
}

// G, whose second derivative is the mean compliance between two strips; unit modulus. Along x, across, normal, along x
// by across, along x by normal, these two odd in x, and across by normal.
inline std::array<double, 6> pair_antiderivative(const std::array<double, 5>& geometry, double nu) {
    double scale = (1.0 + nu) / std::numbers::pi;
    auto [xx, yy, xy, xn, yn] = geometry;
    return {scale * ((1.0 - nu) * (xx + yy) + nu * xx),
            scale * ((1.0 - nu) * (xx + yy) + nu * yy),
            scale * (1.0 - nu) * (xx + yy),
            scale * nu * xy,
            scale * (0.5 - nu) * xn,
            scale * (0.5 - nu) * yn};
}

}  // namespace wr
