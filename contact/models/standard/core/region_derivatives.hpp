// Interpenetration regions of a wheel on a rail with their derivatives by the wheel's pose.
//
// Maxima, ends and lowest points are defined by equations, which are solved in doubles. One more Newton step in dual
// numbers, for the lowest point of a line, and the derivatives of an equation over its slope along the line give those
// of its solution (implicit functions). Where an inequality holds instead, as at corners, the place stays there.
#pragma once
#include "contact/models/standard/core/regions.hpp"

namespace wr {

constexpr int MOTIONS = 6;            // of a rigid body: translations along the axes of the rail, rotations about them
using ByPose = Dual<MOTIONS>;         // varies by these
using OnLine = Dual<MOTIONS + 1>;     // and by the place s of a line of the wheel
constexpr int ALONG_WHEEL = MOTIONS;  // that variable

constexpr double JUMP = 1e-7;    // slope at a maximum or minimum beyond rounding: it jumps there
constexpr double BESIDE = 1e-8;  // m, from such a place
constexpr double LEVEL = 1e-9;   // slope of an equation, 1 or 1/m, that is rounding

// Penetration m of a line of the wheel at its lowest point, its slope by s, x m there, and its place on the profile.
template <class T>
struct LineDepth {
    T depth, slope, x;
    OnCurve<T> profile;
};

// Depth, slope and places of a line with known lowest point. At a corner or an end of the rail the closest point is
// held: the distance from it turns. Below a corner both sides are as near, and remain so along the line.
template <class T>
LineDepth<T> line_depth(const WheelRail& pair, const Pose<T>& pose, const OnCurve<T>& line, const Lowest& known) {
    using std::sqrt;
    double sine = std::sin(known.x / pair.radius), cosine = std::cos(known.x / pair.radius);
    auto rail = local(pair.rail, known.at, known.piece);
    auto seen = seen_line(line.point, pair.radius, pose);
    auto step = lowest_step(line, pair.radius, seen, sine, cosine, rail);
    auto along = [&](const Point<T>& up, const T& turn) {  // change of the place with s, after a turn
        return seen.change(line.tangent, up, T(sine + turn * cosine), T(cosine - turn * sine));
    };
    auto by_turn = [&](const T& turn, const T& depth, const T& slope) {
        return LineDepth<T>{depth, slope, known.x + pair.radius * turn, line};
    };
    if (!known.held && std::isnan(known.across)) {
        auto t = along(step.up, step.turn);
        T slope = t.y * rail.tangent.z - t.z * rail.tangent.y + step.step * (t.y * rail.bend.z - t.z * rail.bend.y);
        return by_turn(step.turn, -step.height, slope);
    }
    const auto& [forward, up, away] = std::tie(step.forward, step.up, step.away);
    T r = line.point.z + pair.radius;
    if (known.held) {
        T turn = dot(away, forward) / (value(dot(away, up)) - value(r) * squared(value(forward)));
        auto there = away + (r * turn) * forward;
        T depth = std::copysign(1.0, known.depth) * sqrt(dot(there, there));
        return by_turn(turn, depth, dot(along(up + turn * forward, turn), there) / depth);
    }
    auto other = local(pair.rail, known.across);
    auto across = lowest_step(line, pair.radius, seen, sine, cosine, other);
    T turn = (step.height - across.height) / (value(r * (across.level - step.level)));
    auto t = along(up + turn * forward, turn), ahead = forward - turn * up;
    auto tangent = [&](const OnCurve<double>& on, const LowestStep<T>& own) {
        T change = (own.beside + r * turn * dot(on.tangent, forward)) / own.second;
        return on.tangent + change * on.bend;
    };
    auto one = tangent(rail, step), two = tangent(other, across);
    T a = cross(one, ahead), b = cross(two, ahead);
    return by_turn(turn, -step.height - r * turn * a, (b * cross(one, t) - a * cross(two, t)) / (a - b));
}

// Place s m at which a function of the line equals a level: of the implicit function; where the function is level, the
// place stays.
inline ByPose solution(double s, const OnLine& f, const ByPose& level) {
    ByPose r(s);
    if (std::abs(f.d[ALONG_WHEEL]) > LEVEL)
        for (int i = 0; i < MOTIONS; ++i) r.d[i] = (level.d[i] - f.d[i]) / f.d[ALONG_WHEEL];
    return r;
}

// A function of the line at a place that varies.
inline ByPose on_place(const OnLine& f, const ByPose& s) {
    ByPose r(f.v);
    for (int i = 0; i < MOTIONS; ++i) r.d[i] = f.d[i] + f.d[ALONG_WHEEL] * s.d[i];
    return r;
}

// Regions of a wheel at a pose, found in doubles, not beyond the lines; merge as for `wheel_regions`.
class VariedRegions {
  public:
    VariedRegions(const WheelRail& pair, const Pose<double>& pose, const Numbers& lines, double merge,
                  const WheelRegions& found)
        : pair(pair),
          at_pose(pose),
          pose(varied<ByPose>(pose)),
          line_pose(varied<OnLine>(pose)),
          lines(lines),
          merge(merge),
          found(found),
          count(found.top.size()),
          tops(extrema_of(found.top)),
          lows(extrema_of(found.low)),
          top(tops.size()),
          low(lows.size()) {
        for (long k = 0; k < count; ++k) top[k] = stationary(tops[k]);
        for (long k = 0; k < count - 1; ++k) low[k] = lows[k].depth > 0.0 ? stationary(lows[k]) : constant(lows[k]);
    }

    Regions<ByPose> regions() {
        Regions<ByPose> zones(found.strips.size(), found.contacts.size());
        auto weight = merging_weights<ByPose>(top, low, merge);
        long contact = 0, half = 0;
        for (long k = 0; k < count; ++k) {
            if (value(weight[k]) <= 0.0 || contact == zones.peak.size()) continue;
            zones.peak(contact) = top[k].s, zones.peak_x(contact) = top[k].x;
            zones.depth(contact) = top[k].depth, zones.weight(contact) = weight[k];
            for (long j = 0; j < count; ++j)
                if (extends<ByPose>(top, low, k, j, merge))
                    for (long direction : {-1L, 1L})
                        if (half < found.edges.size()) store_half(zones, contact, k, j, direction, half++);
            ++contact;
        }
        return zones;
    }

  private:
    const WheelRail pair;
    const Pose<double> at_pose;
    const Pose<ByPose> pose;
    const Pose<OnLine> line_pose;
    const Numbers& lines;
    double merge;
    const WheelRegions& found;
    long count, near = -1;
    std::vector<Extremum<>> tops, lows;
    std::vector<Extremum<ByPose>> top, low;

    static Extremum<ByPose> constant(const Extremum<>& at) { return {at.s, at.depth, at.x}; }

    // The line at s m, whose lowest point is near x m.
    template <class T>
    LineDepth<T> line_at(const Pose<T>& varying, const T& s, double x) {
        auto line = local(pair.wheel, value(s));
        auto known = lowest(pair.rail, pair.radius, at_pose, line, x, near);
        near = known.sample;
        return line_depth(pair, varying, at_place(line, s), known);
    }
    LineDepth<OnLine> line_at(double s, double x) { return line_at(line_pose, variable<OnLine>(s, ALONG_WHEEL), x); }

    // A maximum or minimum of the penetration. At a corner of the wheel, and below one of the rail, its slope jumps
    // through zero: both sides are as deep.
    Extremum<ByPose> stationary(const Extremum<>& at) {
        auto line = line_at(at.s, at.x);
        ByPose s = solution(at.s, line.slope, 0.0);
        if (std::abs(line.slope.v) > JUMP) {
            auto before = line_at(at.s - BESIDE, at.x), after = line_at(at.s + BESIDE, at.x);
            if ((before.slope.v > 0.0) != (after.slope.v > 0.0)) {
                s = solution(at.s, before.depth - after.depth, 0.0);
                line = std::abs(before.x.v - at.x) < std::abs(after.x.v - at.x) ? before : after;
            }
        }
        ByPose depth = on_place(line.depth, s);
        depth.v = at.depth;
        return {s, depth, on_place(line.x, s)};
    }

    // Outer end m of a half around maximum j, down to a level of the penetration.
    ByPose edge(long j, long direction, long half, const ByPose& level) {
        double s = found.edges(half);
        if (s != half_limit(lines, lows, j, direction)) {
            double x = found.strips((half + 1) * HALF - 1, 1);  // of the outermost strip
            return solution(s, line_at(s, x).depth, level);
        }
        long between = direction < 0 ? j - 1 : j;
        return 0 <= between && between < count - 1 ? low[between].s : ByPose(s);
    }

    // Strips of a half around maximum j in the region of maximum k.
    void store_half(Regions<ByPose>& zones, long contact, long k, long j, long direction, long half) {
        ByPose level = (1.0 - VIRTUAL) * top[k].depth, valley(std::numeric_limits<double>::infinity());
        if (j != k) valley = low[saddle_between<ByPose>(low, k, j)].depth - level;
        ByPose outward = edge(j, direction, half, level) - top[j].s;
        for (long q = 0; q < HALF; ++q) {
            long i = half * HALF + q;
            ByPose s = top[j].s + outward * POSITIONS[q];
            auto line = line_at(pose, s, found.strips(i, 1));
            auto depth = covered<ByPose>(line.depth - level, valley, distance(s, top[k].s), merge);
            const auto& profile = line.profile;
            auto r = profile.point.z + pair.radius, share = level_share(profile.tangent, r, pose.plan);
            zones.contact(i) = contact, zones.s(i) = s, zones.x(i) = line.x;
            zones.width(i) = double(direction) * outward * WIDTHS[q];
            zones.penetration(i) = value(depth) > MIN_PENETRATION ? depth : ByPose(MIN_PENETRATION);
            zones.radius(i) = r / (value(share) > MIN_SLOPE_COSINE ? share : ByPose(MIN_SLOPE_COSINE));
        }
    }
};

}  // namespace wr
