// Tractions of rolling contact by Kalker's simplified theory, strip by strip: FASTSIM.
//
// J. J. Kalker, Vehicle System Dynamics 11 (1982) 1-13, doi:10.1080/00423118208968684. Three flexibilities, one each
// for longitudinal and lateral creepage and for spin, from the coefficients of the ellipse with the patch's second
// moments.
//
// Where surfaces stick, tractions q fall along the strip by e, the rate of displacements over their flexibilities: a
// complex number, as q is. The rigid slip w has another direction. With e = w / L at every place, L a complex
// flexibility, slip against q gives q' = -e - k (e / w) q, k >= 0: where all slides, q is opposite to w, not to e. Of
// e / w only the angle counts; instead of its tangent the sums take `turn`, which is smooth where e or w vanishes.
//
// Tractions are bounded by friction times a parabola along each strip with the strip's normal force: Kalker's
// paraboloid has the patch's, so that strips at its sides slide with less than friction times their load, those in its
// middle with more. Integration in the slip zone is of second order: 16 cells are as accurate as 64 are with steps of
// first order.
#pragma once
#include <algorithm>
#include <numbers>
#include <span>

#include "contact/kinematics/core/motion.hpp"
#include "contact/models/standard/core/abreast.hpp"

namespace wr {

constexpr double TINY = 1e-300;

// Flexibilities m/Pa: displacement by traction, of pure longitudinal and lateral creepage and of spin.
template <class T>
struct ElasticFoundation {
    T along, across, spin;
};

// Flexibilities of an elliptic patch with semi-axes a, b m (Kalker 1990, eq. 2.79), from the shear modulus Pa and C11,
// C22, C23.
template <class T>
ElasticFoundation<T> foundation(const T& a, const T& b, double G, const std::array<T, 3>& kalker) {
    using std::sqrt;
    return {8.0 * a / (3.0 * G * kalker[0]), 8.0 * a / (3.0 * G * kalker[1]),
            std::numbers::pi * a * sqrt(a / b) / (4.0 * G * kalker[2])};
}

template <class T>
struct Traction {
    T x{}, y{};
};

// Traction one cell further from the leading end, of one strip or of several side by side.
//
// Parameters: traction before; rigid slip w over the flexibility of spin; by what rates of displacement over their own
// flexibilities are less; step along the strip; bound of the traction.
template <class T>
Traction<T> next_traction(const Traction<T>& q, const Traction<T>& w, const Traction<T>& apart, double step,
                          double bound) {
    using std::sqrt;
    T ex = w.x - apart.x, ey = w.y - apart.y;
    T elastic_x = q.x - step * ex, elastic_y = q.y - step * ey;
    T square = elastic_x * elastic_x + elastic_y * elastic_y;
    auto sticks = value(square) <= bound * bound;
    if (all(sticks)) return {elastic_x, elastic_y};
    // sine of the angle between both rates, less where their sizes differ: smooth where one is zero
    T over = 1.0 / (ex * ex + ey * ey + w.x * w.x + w.y * w.y + TINY);
    T turn = 2.0 * (ey * apart.x - ex * apart.y) * over;
    // half of the slip along the previous traction, half along the new one: directions are of second order in the step;
    // the cut is infinite where there is no traction before
    T cut = 0.5 * (sqrt(square) - bound) / sqrt(q.x * q.x + q.y * q.y);
    cut = select(value(cut) < 0.5, cut, T(0.5));
    T nx = elastic_x - cut * (q.x - turn * q.y), ny = elastic_y - cut * (q.y + turn * q.x);
    T beyond = (nx * nx + ny * ny) / (bound * bound) - 1.0;
    T part = beyond / (1.0 + sqrt(1.0 + (1.0 + turn * turn) * beyond));
    T real = (1.0 + part) / (1.0 + beyond), imaginary = part * turn / (1.0 + beyond);
    return {select(sticks, elastic_x, real * nx + imaginary * ny),
            select(sticks, elastic_y, real * ny - imaginary * nx)};
}

// Fill tractions on the faster body and slips in the middles of m uniform cells of a strip, from the trailing end.
//
// Parameters: half length, m; mean creepages of the patch; those in the middle of this strip; flexibilities, m/Pa;
// bounds (m,) Pa of the traction; tractions (m, 2) Pa and slips (m, 2) over the speed, filled: means of both halves of
// the cells, with which tractions lose the power of the rigid slip.
inline void strip_tractions(double half, const Creepages<double>& creep, const Creepages<double>& own,
                            const ElasticFoundation<double>& flexible, std::span<const double> bounds,
                            const View<double, 2>& traction, const View<double, 2>& slip) {
    const auto& [along, across, spin] = flexible;
    long m = long(bounds.size());
    double h = 2.0 * half / double(m), before = 0.0, step = 0.5 * h, x = half - 0.25 * h;
    Traction<double> q,
        apart{creep.longitudinal * (1.0 / spin - 1.0 / along), creep.lateral * (1.0 / spin - 1.0 / across)};
    double softest = std::max({along, across, spin}), stiffest = std::min({along, across, spin});
    for (long i = m - 1; i >= -1; --i) {
        Traction<double> w{own.longitudinal / spin, (own.lateral + own.spin * x) / spin};
        double ex = w.x - apart.x, ey = w.y - apart.y;
        double elastic_x = q.x - step * ex, elastic_y = q.y - step * ey;
        double square = elastic_x * elastic_x + elastic_y * elastic_y;
        double after = std::sqrt(square);  // to no traction at the trailing end
        if (i >= 0) {
            q = next_traction(q, w, apart, step, bounds[i]);
            after = square <= bounds[i] * bounds[i] ? 0.0 : after - bounds[i];
            traction(i, 0) = q.x, traction(i, 1) = q.y;
        }
        double rate = std::sqrt(ex * ex + ey * ey), rigid = spin * std::sqrt(w.x * w.x + w.y * w.y);
        after *= std::min(std::max(rigid / std::max(rate, TINY), stiffest), softest) / step;
        if (i < m - 1) {
            double mean = before > 0.0 ? -0.5 * (before + after) / bounds[i + 1] : 0.0;
            slip(i + 1, 0) = mean * traction(i + 1, 0), slip(i + 1, 1) = mean * traction(i + 1, 1);
            if (before == 0.0) after *= 2.0;  // slip that begins behind the middle of a cell is that of the next one
        }
        before = after;
        x -= i == m - 1 || i == 0 ? 0.75 * h : h;
        step = i > 0 ? h : 0.5 * h;
    }
}

}  // namespace wr
