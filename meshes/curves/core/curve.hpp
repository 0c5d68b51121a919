// Curves of piecewise polynomials in arc length, and their closest points: Newton's method on the curve, started from
// fine samples.
#pragma once
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <tuple>

#include "support/core/arrays.hpp"
#include "support/core/plane.hpp"

namespace wr {

constexpr double SPACING = 1e-4;      // m, of the samples, and the longest step
constexpr long STRIDE = 8;            // samples between those of the first, coarse search
constexpr double SMALL_STEP = 3e-8;   // m; the error after one more step is quadratic in it, below 1e-12 m
constexpr int FAST = 4, SAFE = 1000;  // steps
constexpr double SHARPEST = 4.0;      // depths: closest points on both sides of a corner of 30 degrees

// A curve of m pieces, for the core.
struct Shape {
    Numbers breaks;                               // (m + 1,) m, arc length of the ends of the pieces
    Numbers middles;                              // (m,) m
    View<const std::complex<double>, 3> table;    // (m, 3, 8), coefficients of y + iz and its first two derivatives
    Numbers samples;                              // (n,) m, arc length
    View<const std::complex<double>, 1> sampled;  // (n,) m, points y + iz there
    bool hollow = false;  // whether it turns back, as in a groove: a point has several closest points nearby
    Numbers corners;      // (k,) m, arc lengths where the surface turns outwards at once

    auto fields() { return std::tie(breaks, middles, table, samples, sampled, hollow, corners); }
    bool fits() const {
        long m = middles.size();
        return m > 0 && breaks.size() == m + 1 && table.shape == std::array<long, 3>{m, 3, 8} && samples.size() > 0 &&
               samples.size() == sampled.size();
    }
    double first() const { return breaks(0); }
    double last() const { return breaks(breaks.size() - 1); }
};

// Position m, first and second derivative by arc length, at a place of a curve.
template <class T>
struct OnCurve {
    Point<T> point, tangent, bend;
};

// Closest point of a curve to a point.
struct Foot {
    double s = 0.0;         // m, arc length
    double distance = 0.0;  // m, positive on the outward side
    bool inside = true;     // false where it is an end of the curve and the point lies beyond it
    long piece = 0;
    bool held = false;  // at a corner or an end, where the tangent is not perpendicular to the distance
};

// Index of the piece that contains s.
inline long piece(const Shape& shape, double s) {
    long low = 0, high = shape.middles.size() - 1;
    while (low < high) {
        long middle = (low + high + 1) / 2;
        if (shape.breaks(middle) <= s)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

// As `piece`, from piece j on: for an s that lies in it or nearby.
inline long next_piece(const Shape& shape, double s, long j) {
    long last = shape.middles.size() - 1;
    while (j < last && shape.breaks(j + 1) <= s) ++j;
    while (j > 0 && shape.breaks(j) > s) --j;
    return j;
}

// Position and derivatives at s in piece j.
template <class T>
OnCurve<T> local(const Shape& shape, const T& s, long j) {
    using std::fma;
    T x = s - shape.middles(j);
    auto table = shape.table[j];
    OnCurve<T> at;
    Point<T>* parts[] = {&at.point, &at.tangent, &at.bend};
    for (int n = 7; n >= 0; --n)
        for (int k = 0; k < 3; ++k) {
            const std::complex<double>& c = table(k, n);
            *parts[k] = {fma(parts[k]->y, x, c.real()), fma(parts[k]->z, x, c.imag())};
        }
    return at;
}

template <class T>
OnCurve<T> local(const Shape& shape, const T& s) {
    return local(shape, s, piece(shape, value(s)));
}

// Index of the nearest sample: every STRIDE-th first, then all around those that are near enough.
inline long nearest_sample(const Shape& shape, const Point<double>& q) {
    long n = shape.sampled.size(), at = 0;
    double best = std::numeric_limits<double>::infinity();
    auto squared_to = [&](long i) { return squared(point_of(shape.sampled(i)) - q); };
    for (long i = 0; i < n; i += STRIDE)
        if (double d = squared_to(i); d < best) best = d, at = i;
    double bound = std::sqrt(best) + STRIDE * SPACING;
    bound *= bound;
    for (long i = 0; i < n; i += STRIDE) {
        if (!(squared_to(i) <= bound)) continue;
        for (long k = std::max(i - STRIDE + 1, 0L); k < std::min(i + STRIDE, n); ++k)
            if (double d = squared_to(k); d < best) best = d, at = k;
    }
    return at;
}

// Index of the nearest sample by descent from sample to sample: for a point next to one with a known index, unless the
// curve is hollow.
inline long nearer_sample(const Shape& shape, const Point<double>& q, long at) {
    if (shape.hollow) return nearest_sample(shape, q);
    long n = shape.sampled.size();
    auto squared_to = [&](long i) { return squared(point_of(shape.sampled(i)) - q); };
    double best = squared_to(at);
    for (long direction : {-1L, 1L})
        while (0 <= at + direction && at + direction < n) {
            double d = squared_to(at + direction);
            if (d >= best) break;
            best = d, at += direction;
        }
    return at;
}

// The nearest sample from that of a neighbour, negative without one.
inline long sample_from(const Shape& shape, const Point<double>& q, long neighbour) {
    return neighbour < 0 ? nearest_sample(shape, q) : nearer_sample(shape, q, neighbour);
}

// Point q minus curve along tangent and normal, and Newton's step for the least distance.
template <class T>
struct NewtonStep {
    T along, across, step;
};

template <class T>
NewtonStep<T> newton_step(const OnCurve<double>& at, const Point<T>& q) {
    Point<T> away = q - at.point;
    T along = dot(at.tangent, away);
    // |q - z|^2 / 2 has the slope -along and the second derivative 1 - z'' (q - z)
    T second = 1.0 - dot(at.bend, away);
    if (value(second) < 1e-3) second = T(1e-3);
    return {along, cross(at.tangent, away), along / second};
}

// As `foot`, with steps limited to one smooth piece; the next step is taken on the adjacent piece.
inline Foot held(const Shape& shape, const Point<double>& q, double s) {
    long top = shape.middles.size() - 1, j = piece(shape, s);
    bool stationary = false;
    double along = 0.0, across = 0.0;
    for (int n = 0; n < SAFE; ++n) {
        auto at = newton_step(local(shape, s, j), q);
        along = at.along, across = at.across;
        double low = shape.breaks(j), high = shape.breaks(j + 1);
        double next = std::min(std::max(s + std::min(std::max(at.step, -SPACING), SPACING), low), high);
        bool converged = std::abs(at.step) < SMALL_STEP || next == s;
        if (converged && stationary) break;  // on both sides: a corner or an end
        if (next == high) ++j;
        if (next == low) --j;
        j = std::clamp(j, 0L, top);
        s = next, stationary = converged;
    }
    if (std::abs(along) <= 2 * SMALL_STEP) return {s, across, true, piece(shape, s)};
    bool inside = shape.first() < s && s < shape.last();
    return {s, std::copysign(std::sqrt(along * along + across * across), across), inside, piece(shape, s), true};
}

// The closest point to q, from an initial arc length in or near piece j.
inline Foot foot_from(const Shape& shape, const Point<double>& q, double start, long j) {
    double first = shape.first(), last = shape.last(), s = start;
    for (int n = 0; n < FAST; ++n) {
        j = next_piece(shape, s, j);
        auto at = newton_step(local(shape, s, j), q);
        s = std::min(std::max(s + std::min(std::max(at.step, -SPACING), SPACING), first), last);
        if (std::abs(at.step) < SMALL_STEP) return {s, at.across, true, next_piece(shape, s, j)};
    }
    return held(shape, q, start);
}

// Change of the closest point m, whose value is zero: one more step of Newton's method in dual numbers at the solution
// found in doubles, which makes derivatives exact. At a corner or an end the point stays.
template <class T>
T foot_change(const OnCurve<double>& at, const Point<T>& q) {
    T change(0.0);
    if constexpr (!std::is_same_v<T, double>) {
        auto next = newton_step(at, q);
        if (std::abs(value(next.along)) <= 2 * SMALL_STEP) change = next.step, change.v = 0.0;
    }
    return change;
}

// The closest point to q, from an initial arc length.
inline Foot foot(const Shape& shape, const Point<double>& q, double start) {
    return foot_from(shape, q, start, piece(shape, start));
}

// Corner near s m, for a point at a distance m: within the curve it may have a closest point on either side; NaN
// without.
inline double corner_near(const Shape& shape, double s, double distance) {
    for (double corner : shape.corners)
        if (std::abs(s - corner) < SPACING + SHARPEST * std::abs(distance)) return corner;
    return std::numeric_limits<double>::quiet_NaN();
}

// `Closest` of points (n,) m, from arc lengths guess (n,) m, or (0,) for the nearest samples: arc lengths (n,) m,
// distances (n,) m, and where the closest point is not an end beyond which the point lies (n,).
inline std::tuple<Array<double, 1>, Array<double, 1>, Array<bool, 1>> closest(
    const Shape& shape, const View<const std::complex<double>, 1>& points, const Numbers& guess) {
    long n = points.size();
    Array<double, 1> s(n), distance(n);
    Array<bool, 1> inside(n);
    for (long i = 0; i < n; ++i) {
        auto q = point_of(points(i));
        double start = guess.size() ? guess(i) : shape.samples(nearest_sample(shape, q));
        auto at = foot(shape, q, std::min(std::max(start, shape.first()), shape.last()));
        s(i) = at.s, distance(i) = at.distance, inside(i) = at.inside;
    }
    return {s, distance, inside};
}

}  // namespace wr
