// Interpenetration regions of a wheel on a rail with their derivatives by the wheel's pose.
//
// Maxima, ends and lowest points are defined by equations, which are solved in doubles. One more Newton step in dual
// numbers, for the lowest point of a line, and the derivatives of an equation over its slope along the line give those
// of its solution (implicit functions).
#pragma once
#include "contact/models/standard/core/regions.hpp"

namespace wr {

constexpr int MOTIONS = 6;            // of a rigid body: translations along the axes of the rail, rotations about them
using ByPose = Dual<MOTIONS>;         // varies by these
using OnLine = Dual<MOTIONS + 1>;     // and by the place s of a line of the wheel
constexpr int ALONG_WHEEL = MOTIONS;  // that variable

// Penetration m of a line of the wheel at its lowest point, its slope by s, x m there, and its place on the profile.
template <class T>
struct LineDepth {
    T depth, slope, x;
    OnCurve<T> profile;
};

// Those of the line at s m, whose lowest point is known to be at x m; the rail's nearest sample, negative without one,
// becomes that of this line.
template <class T>
LineDepth<T> line_depth(const WheelRail& pair, const Pose<T>& pose, const T& s, double x, long& sample) {
    auto line = at_place(pair.wheel, s);
    double sine = std::sin(x / pair.radius), cosine = std::cos(x / pair.radius), r = value(line.point.z) + pair.radius;
    const auto& [forth, axle, up] = pose.rotation;
    auto at = [&](const T& o, const T& along, const T& axial, const T& upward) {
        return value(o) + r * (value(along) * sine - value(upward) * cosine) + value(axial) * value(line.point.y);
    };
    Point<double> q{at(pose.origin.y, forth.y, axle.y, up.y), at(pose.origin.z, forth.z, axle.z, up.z)};
    sample = sample_from(pair.rail, q, sample);
    auto closest = foot(pair.rail, q, pair.rail.samples(sample));
    auto rail = local(pair.rail, closest.s, closest.piece);
    auto step = lowest_step(line, pair.radius, pose, sine, cosine, rail);
    T y = line.tangent.z * step.up.y + line.tangent.y * axle.y,
      z = line.tangent.z * step.up.z + line.tangent.y * axle.z;
    T slope = y * rail.tangent.z - z * rail.tangent.y + step.step * (y * rail.bend.z - z * rail.bend.y);
    return {-step.height, slope, x + pair.radius * step.turn, line};
}

// Place s m at which a function of the line equals a level: of the implicit function.
inline ByPose solution(double s, const OnLine& f, const ByPose& level) {
    ByPose r(s);
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
          lows(extrema_of(found.low)) {
        for (long k = 0; k < count; ++k) top[k] = stationary(tops[k]);
        for (long k = 0; k < count - 1; ++k) low[k] = lows[k].depth > 0.0 ? stationary(lows[k]) : constant(lows[k]);
    }

    Regions<ByPose> regions() {
        Regions<ByPose> zones(found.strips.size(), found.contacts.size());
        auto all = std::span(top).first(count), between = std::span(low).first(std::max(count - 1, 0L));
        auto weight = merging_weights<ByPose>(all, between, merge);
        long contact = 0, half = 0;
        for (long k = 0; k < count; ++k) {
            if (value(weight[k]) <= 0.0 || contact == zones.peak.size()) continue;
            zones.peak(contact) = top[k].s, zones.peak_x(contact) = top[k].x;
            zones.depth(contact) = top[k].depth, zones.weight(contact) = weight[k];
            for (long j = 0; j < count; ++j)
                if (extends<ByPose>(all, between, k, j, merge))
                    for (long direction : {-1L, 1L})
                        if (half < found.edges.size()) store_half(zones, contact, k, j, direction, half++);
            ++contact;
        }
        return zones;
    }

  private:
    using Numbers8 = std::array<Extremum<>, MAXIMA>;

    const WheelRail pair;
    const Pose<double> at_pose;
    const Pose<ByPose> pose;
    const Pose<OnLine> line_pose;
    const Numbers& lines;
    double merge;
    const WheelRegions& found;
    long count, near = -1;
    Numbers8 tops, lows;
    std::array<Extremum<ByPose>, MAXIMA> top, low;

    static Extremum<ByPose> constant(const Extremum<>& at) { return {at.s, at.depth, at.x}; }

    // A maximum or minimum of the penetration.
    Extremum<ByPose> stationary(const Extremum<>& at) {
        auto line = line_depth(pair, line_pose, variable<OnLine>(at.s, ALONG_WHEEL), at.x, near);
        ByPose s = solution(at.s, line.slope, 0.0), depth = on_place(line.depth, s);
        depth.v = at.depth;
        return {s, depth, on_place(line.x, s)};
    }

    // Outer end m of a half around maximum j, down to a level of the penetration.
    ByPose edge(long j, long direction, long half, const ByPose& level) {
        double s = found.edges(half);
        auto lows_found = std::span<const Extremum<>>(lows).first(std::max(count - 1, 0L));
        if (s != half_limit(lines, lows_found, j, direction)) {
            double x = found.strips((half + 1) * HALF - 1, 1);  // of the outermost strip
            auto lowest = deepest(pair, at_pose, s, x, near);
            near = lowest.sample;
            auto line = line_depth(pair, line_pose, variable<OnLine>(s, ALONG_WHEEL), lowest.x, near);
            return solution(s, line.depth, level);
        }
        long between = direction < 0 ? j - 1 : j;
        return 0 <= between && between < count - 1 ? low[between].s : ByPose(s);
    }

    // Strips of a half around maximum j in the region of maximum k.
    void store_half(Regions<ByPose>& zones, long contact, long k, long j, long direction, long half) {
        ByPose level = (1.0 - VIRTUAL) * top[k].depth, valley(std::numeric_limits<double>::infinity());
        if (j != k) {
            auto between = std::span<const Extremum<ByPose>>(low).first(count - 1);
            valley = low[saddle_between(between, k, j)].depth - level;
        }
        ByPose outward = edge(j, direction, half, level) - top[j].s;
        for (long q = 0; q < HALF; ++q) {
            long i = half * HALF + q;
            ByPose s = top[j].s + outward * POSITIONS[q];
            auto line = line_depth(pair, pose, s, found.strips(i, 1), near);
            auto depth = covered<ByPose>(line.depth - level, valley, distance(s, top[k].s), merge);
            const auto& profile = line.profile;
            auto cosine = value(profile.tangent.y) > MIN_SLOPE_COSINE ? profile.tangent.y : ByPose(MIN_SLOPE_COSINE);
            zones.contact(i) = contact, zones.s(i) = s, zones.x(i) = line.x;
            zones.width(i) = double(direction) * outward * WIDTHS[q];
            zones.penetration(i) = value(depth) > MIN_PENETRATION ? depth : ByPose(MIN_PENETRATION);
            zones.radius(i) = (profile.point.z + pair.radius) / cosine;
        }
    }
};

}  // namespace wr
