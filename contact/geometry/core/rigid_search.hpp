// Contact points of a rigid wheel on a rigid rail: local maxima of the penetration profile, on the exact curves.
//
// The penetration is the depth of the wheel's lowest points below the rail's surface. Its slope is exact as well: that
// of the wheel's profile relative to the rail's normal. Maxima, minima and edges therefore do not depend on the initial
// sampling.
#pragma once
#include <span>

#include "contact/geometry/core/wheel_surface.hpp"

namespace wr {

constexpr long MAXIMA = 8;             // at most, more than a wheel and a rail can have
constexpr double NEAR = -1e-4;         // m: sampled maxima lower than that are not refined
constexpr double CLOSE = 1e-9;         // m: smallest distance of a maximum and a minimum
constexpr int ITERATIONS = 12;         // for the lowest point of a yawed wheel
constexpr double LOWEST = 1e-7;        // m, last change of its x by Newton's method: the error is quadratic in it
constexpr double LAST = 1e-10;         // m, last change of its x in turns with the closest point
constexpr int TURNS = 24, DIRECT = 3;  // of closest points and angles in turns; those without a secant's step
constexpr double LARGEST = 40.0;       // times the change of the angle, of such a step
constexpr double LARGE = 0.1;          // rad, beyond the difference between neighbouring lines
constexpr double FARTHEST = 10.0;      // times the longest step: not the neighbourhood of the guess

// Lowest point of a line of the wheel: penetration m, beside the rail minus the distance from its end; slope by s,
// place m along the rolling circle, and the rail's nearest sample.
struct Lowest {
    double depth, slope, x;
    long sample;
};

// Newton's step to the lowest point of a line in the rail's arc length m and the angle along the rolling circle at
// once: the rail's tangent is perpendicular to the distance of both points (`beside`), and its normal to the wheel's
// forward direction (`level`).
template <class T>
struct LowestStep {
    Point<T> forward, up, away;  // of the wheel; from the rail's point to the wheel's
    T beside, height, level, second, step, turn;
    double determinant;
};

template <class Z, class P>
auto lowest_step(const OnCurve<Z>& wheel, double radius, const Pose<P>& pose, double sine, double cosine,
                 const OnCurve<double>& rail) {
    using T = decltype(Z{} * P{});
    const auto& [forth, axle, upward] = pose.rotation;
    Z r = wheel.point.z + radius;
    LowestStep<T> at;
    at.forward = {forth.y * cosine + upward.y * sine, forth.z * cosine + upward.z * sine};
    at.up = {forth.y * sine - upward.y * cosine, forth.z * sine - upward.z * cosine};
    at.away = {pose.origin.y + r * at.up.y + axle.y * wheel.point.y - rail.point.y,
               pose.origin.z + r * at.up.z + axle.z * wheel.point.y - rail.point.z};
    at.beside = dot(rail.tangent, at.away), at.height = cross(rail.tangent, at.away);
    at.second = 1.0 - dot(rail.bend, at.away);
    at.level = cross(rail.tangent, at.forward);
    // in values: both residuals vanish at the solution, so that derivatives of the matrix do not count
    double down = cross(rail.tangent, value(at.up)), across = value(r) * dot(rail.tangent, value(at.forward));
    double bend = cross(rail.bend, value(at.forward)), second = value(at.second);
    at.determinant = second * down - across * bend;
    at.step = (at.beside * down + across * at.level) / at.determinant;
    at.turn = (second * at.level + bend * at.beside) / at.determinant;
    return at;
}

// Sine and cosine of the next angle along the rolling circle, of closest points and angles in turns.
//
// Parameters: number of turns before; sines of this turn and of the one before; changes by these turns; sine and cosine
// after this turn. On the steep flange of a wheel that yaws the closest point runs along with the angle: turns alone
// stall there, or run away. A secant's step takes their change to zero.
inline void next_turn(int turn, double at, double last, double change, double changed, double& sine, double& cosine) {
    double bend = turn >= DIRECT && at != last ? (change - changed) / (at - last) : 0.0;
    if (bend >= -1.0 / LARGEST) return;
    sine = std::min(std::max(at - change / bend, -1.0), 1.0);
    cosine = std::copysign(std::sqrt(1.0 - sine * sine), cosine);
}

// As `lowest`, at corners and beside the ends of the rail too: closest points of the rail and angles in turns. Beside
// the ends the penetration is minus the distance from them, the smallest that is found.
inline Lowest lowest_at_foot(const Shape& rail, double radius, const Pose<double>& pose, const OnCurve<double>& line,
                             double x, long sample) {
    const auto& [origin, m] = pose;
    const auto& [z, t, k] = line;
    double r = z.z + radius, at = rail.samples(sample), bottom = x;
    long j = piece(rail, at);
    bool inside = true;
    Lowest found{0.0, 0.0, x, sample}, beside{-std::numeric_limits<double>::infinity(), 0.0, x, sample};
    double sine = std::sin(x / radius), cosine = std::cos(x / radius), at_sine = 0.0, change = 0.0;
    for (int turn = 0; turn < TURNS; ++turn) {
        Point<double> q{origin.y + m.x.y * r * sine + m.y.y * z.y - m.z.y * r * cosine,
                        origin.z + m.x.z * r * sine + m.y.z * z.y - m.z.z * r * cosine};
        auto closest = foot_from(rail, q, at, j);
        at = closest.s, j = closest.piece, inside = closest.inside;
        double height = closest.distance;
        auto end = local(rail, at, j);
        Point<double> n{-end.tangent.z, end.tangent.y};
        if (!inside) {
            Point<double> away = q - end.point;
            height = std::hypot(away.y, away.z);
            if (height > 0.0) n = {away.y / height, away.z / height};
        }
        double ty = m.x.y * t.z * sine + m.y.y * t.y - m.z.y * t.z * cosine;
        double tz = m.x.z * t.z * sine + m.y.z * t.y - m.z.z * t.z * cosine;
        found.depth = -height, found.slope = -(ty * n.y + tz * n.z);
        if (!inside && found.depth > beside.depth)
            beside.depth = found.depth, beside.slope = found.slope, beside.x = bottom;
        double forward = n.y * m.x.y + n.z * m.x.z, upward = n.y * m.z.y + n.z * m.z.z;
        if (upward == 0.0) break;
        double before = bottom;
        bottom = -radius * std::atan(forward / upward);
        if (std::abs(bottom - before) < LAST) break;
        double size = std::copysign(std::sqrt(forward * forward + upward * upward), upward);
        double last = at_sine, changed = change;
        at_sine = sine, sine = -forward / size, cosine = upward / size;
        change = sine - at_sine;
        next_turn(turn, at_sine, last, change, changed, sine, cosine);
        bottom = radius * std::atan(sine / cosine);
    }
    found.x = bottom;
    return inside ? found : beside;
}

// Lowest point of a line of the wheel, where the wheel's forward direction is parallel to the rail: Newton's method.
//
// Parameters: place of the line on the wheel's profile, initial guess x m along the rolling circle, and initial guess
// of the rail's nearest sample, negative without.
inline Lowest lowest(const Shape& rail, double radius, const Pose<double>& pose, const OnCurve<double>& line, double x,
                     long sample) {
    double r = line.point.z + radius, sine = std::sin(x / radius), cosine = std::cos(x / radius), at = 0.0;
    long j = -1;
    for (int n = 0; n < ITERATIONS; ++n) {
        if (j < 0) {
            const auto& [origin, m] = pose;
            Point<double> up{m.x.y * sine - m.z.y * cosine, m.x.z * sine - m.z.z * cosine};
            Point<double> q{origin.y + r * up.y + m.y.y * line.point.y, origin.z + r * up.z + m.y.z * line.point.y};
            sample = sample_from(rail, q, sample);
            at = rail.samples(sample);
            j = piece(rail, at);
        }
        auto on = local(rail, at, j);
        auto own = lowest_step(line, radius, pose, sine, cosine, on);
        double step = own.step, turn = own.turn;
        double size = std::max(std::abs(step) / (2.0 * SPACING), std::abs(turn) / LARGE);
        if (!(own.second > 0.0 && 0.0 > own.determinant && size < FARTHEST)) break;
        if (size > 1.0)  // on steep flanges of wheels that yaw the closest point runs far along with the angle
            step = step / size, turn = turn / size;
        if (std::abs(step) < SMALL_STEP && radius * std::abs(turn) < LOWEST) {
            const auto& axle = pose.rotation.y;
            double ty = line.tangent.z * own.up.y + line.tangent.y * axle.y;
            double tz = line.tangent.z * own.up.z + line.tangent.y * axle.z;
            double slope = ty * on.tangent.z - tz * on.tangent.y + step * (ty * on.bend.z - tz * on.bend.y);
            // The last step raises the point by half of what the slopes of its height, which it takes to zero, say.
            double height = own.height + 0.5 * (turn * r * own.level + step * cross(on.bend, own.away));
            return {-height, slope, radius * (std::atan(sine / cosine) + turn), sample};
        }
        at += step;
        if (!(rail.first() < at && at < rail.last())) break;
        j = next_piece(rail, at, j);
        size = 1.0 / std::sqrt(1.0 + turn * turn);
        double turned = size * (sine + turn * cosine);
        cosine = size * (cosine - turn * sine), sine = turned;
    }
    return lowest_at_foot(rail, radius, pose, line, x, sample);
}

// As `lowest`, of the line at s m on the wheel's profile.
inline Lowest deepest(const WheelRail& pair, const Pose<double>& pose, double s, double x, long sample) {
    return lowest(pair.rail, pair.radius, pose, local(pair.wheel, s), x, sample);
}

// Maximum or minimum of the penetration: position m on the wheel's profile, penetration m and place m along the rolling
// circle.
template <class T = double>
struct Extremum {
    T s{}, depth{}, x{};
};

// Where the slope changes its sign between low and high m, by false position (Illinois); rise, fall: slopes there; x,
// sample: initial guesses.
inline Extremum<> stationary_point(const WheelRail& pair, const Pose<double>& pose, double low, double high,
                                   double rise, double fall, double x, long sample) {
    double s = low, depth = 0.0;
    int side = 0;
    for (int n = 0; n < 80; ++n) {
        s = fall != rise ? high - fall * (high - low) / (fall - rise) : 0.5 * (low + high);
        s = std::min(std::max(s, low), high);
        auto at = deepest(pair, pose, s, x, sample);
        depth = at.depth, x = at.x, sample = at.sample;
        if (at.slope == 0.0 || high - low < 1e-14) break;
        double moved = 0.0;
        if ((at.slope > 0.0) == (rise > 0.0)) {
            moved = s - low, low = s, rise = at.slope;
            if (side == 1) fall *= 0.5;
            side = 1;
        } else {
            moved = high - s, high = s, fall = at.slope;
            if (side == -1) rise *= 0.5;
            side = -1;
        }
        if (moved < 1e-12) break;
    }
    return {s, depth, x};
}

// Position m at which the penetration equals a level m, by Newton's method with bounds m; `outer` if it is not less
// there. The level is exceeded at inner; the iteration starts at the outer bound, where the profile is steep. x,
// sample: initial guesses.
inline double level_crossing(const WheelRail& pair, const Pose<double>& pose, double inner, double outer, double level,
                             double x, long sample) {
    double s = outer;
    for (int n = 0; n < 60; ++n) {
        auto at = deepest(pair, pose, s, x, sample);
        x = at.x, sample = at.sample;
        if (at.depth >= level) {
            if (s == outer) return outer;
            inner = s;
        } else {
            outer = s;
        }
        double next = at.slope != 0.0 ? s - (at.depth - level) / at.slope : 0.5 * (inner + outer);
        if (!(std::min(inner, outer) <= next && next <= std::max(inner, outer))) next = 0.5 * (inner + outer);
        double moved = std::abs(next - s);
        s = next;
        if (moved < 1e-10) break;  // the next one is quadratic in it
    }
    return s;
}

// Penetration (n,) m at every line, its slope, x m, and the rail's nearest sample, -1 beside the rail.
struct Scan {
    Array<double, 1> depth, slope, x;
    Array<long, 1> sample;

    auto fields() { return std::tie(depth, slope, x, sample); }
    bool fits() const {
        long n = depth.size();
        return n > 0 && slope.size() == n && x.size() == n && sample.size() == n;
    }
    // Whether its samples are among those of a rail.
    bool of(const Shape& rail) const {
        return std::all_of(sample.begin(), sample.end(), [&](long i) { return -1 <= i && i < rail.samples.size(); });
    }
};

// Maxima of the penetration above zero, minima between them, the line before each maximum, and the largest penetration
// m. A gap between two maxima has the penetration 0.
struct Maxima {
    long count = 0;
    std::array<Extremum<>, MAXIMA> top{}, low{};
    std::array<long, MAXIMA> before{};
    double approach = 0.0;

    std::span<const Extremum<>> tops() const { return {top.data(), std::size_t(count)}; }
    std::span<const Extremum<>> lows() const { return {low.data(), std::size_t(std::max(count - 1, 0L))}; }
};

// Maxima on lines (m,) m, arc lengths on the wheel's profile, from their scan.
inline Maxima local_maxima(const WheelRail& pair, const Pose<double>& pose, const Numbers& lines, const Scan& samples) {
    const auto& [depth, slope, where, sample] = samples;
    auto slope_at = [&](double s, long line) { return deepest(pair, pose, s, where(line), sample(line)).slope; };
    Maxima found;
    found.approach = *std::max_element(depth.begin(), depth.end());
    long n = lines.size();
    for (long i = 0; i < n - 1; ++i) {
        if (!(slope(i) > 0.0 && 0.0 >= slope(i + 1)) || std::max(depth(i), depth(i + 1)) < NEAR ||
            found.count == MAXIMA)
            continue;
        long j = i, k = i + 1;
        double rise = slope_at(lines(j), j), fall = slope_at(lines(k), k);
        if (rise <= 0.0 && j > 0) --j, rise = slope_at(lines(j), j);  // the samples are not accurate enough
        if (fall > 0.0 && k < n - 1) ++k, fall = slope_at(lines(k), k);
        if (!(rise > 0.0 && 0.0 >= fall)) continue;
        auto top = stationary_point(pair, pose, lines(j), lines(k), rise, fall, where(i), sample(i));
        found.approach = std::max(found.approach, top.depth);
        if (top.depth <= 0.0) continue;
        if (found.count > 0) {
            k = found.before[found.count - 1] + 1;
            for (j = k; j <= i; ++j)
                if (depth(j) < depth(k)) k = j;
            auto& low = found.low[found.count - 1];
            low = {lines(k), std::max(depth(k), 0.0), where(k)};
            if (depth(k) > 0.0) {  // inside the region of penetration: refine it
                double left = std::max(lines(k - 1), found.top[found.count - 1].s + CLOSE);
                double right = std::min(lines(k + 1), top.s - CLOSE);
                fall = slope_at(left, k), rise = slope_at(right, k);
                if (fall < 0.0 && 0.0 < rise)
                    low = stationary_point(pair, pose, left, right, fall, rise, where(k), sample(k));
            }
        }
        found.top[found.count] = top, found.before[found.count] = i;
        ++found.count;
    }
    return found;
}

}  // namespace wr
