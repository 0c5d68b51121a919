// Lowest points of lines of a wheel on a rail, on the exact curves.
#pragma once
#include <limits>

#include "contact/geometry/core/wheel_surface.hpp"

namespace wr {

constexpr int ITERATIONS = 12;         // for the lowest point of a yawed wheel
constexpr double LOWEST = 1e-7;        // m, last change of its x by Newton's method: the error is quadratic in it
constexpr double CROSSED = 1e-11;      // m, last change of its x below a corner of the rail
constexpr double LAST = 1e-10;         // m, last change of its x in turns with the closest point
constexpr int TURNS = 24, DIRECT = 3;  // of closest points and angles in turns; those without a secant's step
constexpr double LARGEST = 40.0;       // times the change of the angle, of such a step
constexpr double LARGE = 0.1;          // rad, beyond the difference between neighbouring lines
constexpr double FARTHEST = 10.0;      // times the longest step: not the neighbourhood of the guess

// Lowest point of a line of the wheel: penetration m, beside the rail minus the distance from its end; slope by s,
// place m along the rolling circle, the rail's nearest sample, its arc length m and piece there, whether these are held
// at a corner or an end, the arc length m on the other side of a corner if that is as near, otherwise NaN, and whether
// the search has ended.
struct Lowest {
    double depth, slope, x;
    long sample;
    double at;
    long piece;
    bool held = false;
    double across = std::numeric_limits<double>::quiet_NaN();
    bool ended = true;
};

// First and last of some pieces of a rail.
struct Pieces {
    long first = 0, last = std::numeric_limits<long>::max();
    long with(const Shape& rail, double s, long j) const { return std::clamp(next_piece(rail, s, j), first, last); }
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

template <class Z, class T>
auto lowest_step(const OnCurve<Z>& wheel, double radius, const SeenLine<T>& seen, double sine, double cosine,
                 const OnCurve<double>& rail) {
    Z r = wheel.point.z + radius;
    LowestStep<T> at;
    at.forward = seen.forward(sine, cosine), at.up = seen.up(sine, cosine);
    at.away = seen.place(wheel.point, radius, at.up) - rail.point;
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
// stall there, or run away. A secant's step takes their change to zero, at once where the changes grow.
inline void next_turn(int turn, double at, double last, double change, double changed, double& sine, double& cosine) {
    bool grows = turn > 0 && std::abs(change) > std::abs(changed);
    double bend = (grows || turn >= DIRECT) && at != last ? (change - changed) / (at - last) : 0.0;
    if (bend >= -1.0 / LARGEST) return;
    sine = std::min(std::max(at - change / bend, -1.0), 1.0);
    cosine = std::copysign(std::sqrt(1.0 - sine * sine), cosine);
}

// As `lowest`, at corners and beside the ends of the rail too: closest points of the rail and angles in turns.
// Beside the ends the penetration is minus the distance from them, the smallest that is found.
inline Lowest lowest_at_foot(const Shape& rail, double radius, const Pose<double>& pose, const OnCurve<double>& line,
                             double x, long sample) {
    const auto& [z, t, k] = line;
    auto seen = seen_line(z, radius, pose);
    const auto& [origin, forth, axle, high, plan, ahead, own, along] = seen;
    double r = z.z + radius, at = rail.samples(sample), bottom = x;
    long j = piece(rail, at);
    bool inside = true;
    Lowest found{0.0, 0.0, x, sample, at, j},
        beside{-std::numeric_limits<double>::infinity(), 0.0, x, sample, at, j, true};
    double sine = std::sin(x / radius), cosine = std::cos(x / radius), at_sine = 0.0, change = 0.0;
    found.ended = false;
    for (int turn = 0; turn < TURNS; ++turn) {
        Point<double> q{origin.y + forth.y * r * sine + axle.y * z.y - high.y * r * cosine,
                        origin.z + forth.z * r * sine + axle.z * z.y - high.z * r * cosine};
        auto closest = foot_from(rail, q, at, j);
        at = closest.s, j = closest.piece, inside = closest.inside;
        double height = closest.distance;
        auto end = local(rail, at, j);
        Point<double> n{-end.tangent.z, end.tangent.y};
        if (closest.held) {
            Point<double> away = q - end.point;
            if (!inside) height = std::hypot(away.y, away.z);
            if (height != 0.0) n = {away.y / height, away.z / height};
        }
        double ty = forth.y * t.z * sine + axle.y * t.y - high.y * t.z * cosine;
        double tz = forth.z * t.z * sine + axle.z * t.y - high.z * t.z * cosine;
        if (plan != 0.0) ty -= seen.bent(t, sine, cosine);
        found.depth = -height, found.slope = -(ty * n.y + tz * n.z), found.at = at, found.piece = j,
        found.held = closest.held;
        if (!inside && found.depth > beside.depth)
            beside.depth = found.depth, beside.slope = found.slope, beside.x = bottom, beside.at = at, beside.piece = j;
        double forward = n.y * forth.y + n.z * forth.z, upward = n.y * high.y + n.z * high.z;
        if (upward == 0.0) break;
        double before = bottom;
        bottom = -radius * std::atan(forward / upward);
        found.ended = std::abs(bottom - before) < LAST;
        if (found.ended) break;
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

// As `lowest`, by Newton's method only, on some pieces of the rail from an angle and an arc length m on; NaN where it
// fails.
inline Lowest lowest_on(const Shape& rail, double radius, const Pose<double>& pose, const OnCurve<double>& line,
                        double sine, double cosine, long sample, double at, const Pieces& pieces = {}) {
    double r = line.point.z + radius;
    auto seen = seen_line(line.point, radius, pose);
    long j = std::clamp(piece(rail, at), pieces.first, pieces.last);
    for (int n = 0; n < ITERATIONS; ++n) {
        auto on = local(rail, at, j);
        auto own = lowest_step(line, radius, seen, sine, cosine, on);
        double step = own.step, turn = own.turn;
        double size = std::max(std::abs(step) / (2.0 * SPACING), std::abs(turn) / LARGE);
        if (!(own.second > 0.0 && 0.0 > own.determinant && size < FARTHEST)) break;
        if (size > 1.0)  // on steep flanges of wheels that yaw the closest point runs far along with the angle
            step = step / size, turn = turn / size;
        if (std::abs(step) < SMALL_STEP && radius * std::abs(turn) < LOWEST) {
            auto t = seen.change(line.tangent, own.up, sine, cosine);
            double slope = t.y * on.tangent.z - t.z * on.tangent.y + step * (t.y * on.bend.z - t.z * on.bend.y);
            // The last step takes the slopes of the height to zero, and raises the point by half of their prediction.
            double height = own.height + 0.5 * (turn * r * own.level + step * cross(on.bend, own.away));
            return {-height, slope, radius * (std::atan(sine / cosine) + turn), sample, at + step, j};
        }
        at += step;
        if (!(rail.first() < at && at < rail.last())) break;
        j = pieces.with(rail, at, j);
        size = 1.0 / std::sqrt(1.0 + turn * turn);
        double turned = size * (sine + turn * cosine);
        cosine = size * (cosine - turn * sine), sine = turned;
    }
    constexpr double FAILED = std::numeric_limits<double>::quiet_NaN();
    return {FAILED, FAILED, FAILED, sample, at, j};
}

// Depths m, at angles along a line, below a rail surface that continues beyond a corner on one side.
struct Side {
    const Shape& rail;
    const Pieces pieces;
    double at;  // m, of the closest point
    OnCurve<double> on{};

    double depth(const Point<double>& q) {
        long j = pieces.with(rail, at, piece(rail, at));
        for (int n = 0;; ++n) {
            on = local(rail, at, j);
            auto next = newton_step(on, q);
            if (std::abs(next.step) < SMALL_STEP || n == ITERATIONS) return -next.across;
            at += next.step, j = pieces.with(rail, at, j);
        }
    }
};

// As `lowest`, within a corner of the rail that is near: the lower one of its sides counts. found: of any side.
inline Lowest lowest_at_corner(const Shape& rail, double radius, const Pose<double>& pose, const OnCurve<double>& line,
                               const Lowest& found) {
    double corner = corner_near(rail, found.at, found.depth);
    if (std::isnan(corner)) return found;
    auto seen = seen_line(line.point, radius, pose);
    double away = std::abs(found.at - corner);
    long first = piece(rail, corner);
    Side sides[] = {{rail, {0, first - 1}, corner - away}, {rail, {first, rail.middles.size() - 1}, corner + away}};
    Lowest own[2];
    double sine = std::sin(found.x / radius), cosine = std::cos(found.x / radius);
    for (int k = 0; k < 2; ++k) {
        own[k] = lowest_on(rail, radius, pose, line, sine, cosine, found.sample, sides[k].at, sides[k].pieces);
        if (!(own[k].depth > 0.0)) return found;
        sides[k].at = own[k].at;
    }
    Point<double> forward, up;
    auto difference = [&](double x) {  // of the depths below both sides
        sine = std::sin(x / radius), cosine = std::cos(x / radius);
        forward = seen.forward(sine, cosine), up = seen.up(sine, cosine);
        auto q = seen.place(line.point, radius, up);
        return sides[0].depth(q) - sides[1].depth(q);
    };
    double low = own[0].x, high = own[1].x, below = difference(low), above = difference(high);
    if (below <= 0.0) return own[0];
    if (above >= 0.0) return own[1];
    double x = low;
    for (int n = 0, side = 0; n < 60; ++n) {  // Illinois
        x = high - above * (high - low) / (above - below);
        double at = difference(x), moved = at > 0.0 ? x - low : high - x;
        if (at == 0.0 || std::abs(moved) < CROSSED) break;
        if (at > 0.0) {
            low = x, below = at;
            if (side == 1) above *= 0.5;
            side = 1;
        } else {
            high = x, above = at;
            if (side == -1) below *= 0.5;
            side = -1;
        }
    }
    auto t = seen.change(line.tangent, up, sine, cosine);
    const auto &one = sides[0].on.tangent, &other = sides[1].on.tangent;
    double a = cross(one, forward), b = cross(other, forward);
    auto q = seen.place(line.point, radius, up);
    return {-newton_step(sides[0].on, q).across,
            (b * cross(one, t) - a * cross(other, t)) / (a - b),
            x,
            found.sample,
            sides[0].at,
            first - 1,
            false,
            sides[1].at};
}

// Lowest point of a line of the wheel, where the wheel's forward direction is parallel to the rail: Newton's method.
//
// Parameters: place of the line on the wheel's profile, initial guess x m along the rolling circle, and initial guess
// of the rail's nearest sample, negative without.
inline Lowest lowest(const Shape& rail, double radius, const Pose<double>& pose, const OnCurve<double>& line, double x,
                     long sample) {
    auto seen = seen_line(line.point, radius, pose);
    double sine = std::sin(x / radius), cosine = std::cos(x / radius);
    auto q = seen.place(line.point, radius, seen.up(sine, cosine));
    sample = sample_from(rail, q, sample);
    auto found = lowest_on(rail, radius, pose, line, sine, cosine, sample, rail.samples(sample));
    if (std::isnan(found.depth)) found = lowest_at_foot(rail, radius, pose, line, x, sample);
    return rail.corners.size() ? lowest_at_corner(rail, radius, pose, line, found) : found;
}

}  // namespace wr
