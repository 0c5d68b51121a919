// Penetration on sampled lines of a wheel's profile, and the lines that may touch the rail at a pose.
#pragma once
#include "contact/geometry/core/rigid_search.hpp"

namespace wr {

constexpr double SCANNED = 1e-5;  // m, last change of its x on sampled lines: the penetration is exact to 1e-10 m
constexpr double FAR = 1e-3;      // m: at larger distances, the same change suffices for the distance to 1e-6 m
constexpr double INSIDE = 1e-3;   // m under the rail's surface along the vertical: of a wheel inside it, not of errors
constexpr double NONE = -1.0;     // m: penetration of lines that are left out

// Bounds of some lines: lateral position nearest to the ordinary lines, smallest and largest z, m.
struct Box {
    double side = 0.0, low = 0.0, high = 0.0;

    auto fields() { return std::tie(side, low, high); }
};

// First of some lines, and one past the last.
using Part = std::pair<long, long>;

// Lines of the wheel's whole profile on which the penetration is sampled, complex numbers y + iz.
struct Lines {
    using Complex = View<const std::complex<double>, 1>;

    Numbers s;                 // (n,) m, arc lengths on the wheel's profile
    Complex point, tangent;    // (n,) m and 1, there
    Complex rail_tangent;      // (m,), at the rail's samples
    Numbers rail_curvature;    // (m,) 1/m, there, positive where it is convex
    long first = 0, stop = 0;  // of the ordinary lines, which are always looked at
    Box flange, field;         // bounds of the lines before first, and from stop on
    double widest = 0.0;       // m, largest distance of a line from y = 0
    Rows outline;  // (4, m) m, lateral positions of the rail's samples, increasing, heights, largest heights up to
                   // there and from there on

    auto fields() {
        return std::tie(s, point, tangent, rail_tangent, rail_curvature, first, stop, flange, field, widest, outline);
    }
    bool fits() const {
        long n = s.size();
        return point.size() == n && tangent.size() == n && rail_tangent.size() == rail_curvature.size() && 0 <= first &&
               first < stop && stop <= n && outline.shape[0] == 4 && outline.shape[1] > 0;
    }
    // Whether the lines belong to a rail.
    bool of(const Shape& rail) const { return rail_tangent.size() == rail.samples.size(); }
};

// Whether lines in a box, next to the ordinary ones in direction hand of y, may come closer to the rail than a margin
// m.
//
// A point of theirs at a distance r from the axle and an angle t from the lowest place lies at the height
// o_z + R_zy y + r (R_zx sin t - R_zz cos t), and laterally at o_y + R_yy y + r (R_yx sin t - R_yz cos t).
inline bool meets(const Lines& lines, const Box& box, double hand, double radius, const Pose<double>& pose,
                  double margin) {
    const auto& [origin, m, plan] = pose;
    double r = radius + box.high, least = radius + box.low;
    double reach = r * std::sqrt(m.x.z * m.x.z + m.z.z * m.z.z);
    long count = lines.outline.shape[1];
    double centre = origin.z - margin - std::abs(m.y.z) * lines.widest, top = lines.outline(2, count - 1);
    if (centre - reach >= top) return false;
    // within the angles at which a point may be lower than the highest one of the rail
    double cosine = std::min(std::max((centre - top) / reach, 0.0), 1.0);
    double sine = std::sqrt(1.0 - cosine * cosine), away = r * std::abs(m.x.y) * sine;
    away += std::abs(m.z.y) * (r - least * cosine + r * std::abs(m.x.z));
    double along = std::abs(origin.x) + std::abs(m.y.x) * lines.widest + r * sine;
    away += 0.5 * std::abs(plan) * along * along;
    double side = origin.y + m.y.y * box.side - m.z.y * r + hand * (away + margin);
    long low = 0, high = count;  // number of the rail's samples before the side
    while (low < high) {
        long middle = (low + high) / 2;
        if (lines.outline(0, middle) < side)
            low = middle + 1;
        else
            high = middle;
    }
    if (hand > 0.0) return low > 0 && lines.outline(2, low - 1) > centre - reach;
    return low < count && lines.outline(3, low) > centre - reach;
}

// Range of lines that may come closer to the rail at a pose than a margin m (0: overlap): the ordinary ones, and all
// before or after them unless bounds of their places show that they do not.
inline Part lines_to_scan(const Lines& lines, double radius, const Pose<double>& pose, double margin = 0.0) {
    Part part{lines.first, lines.stop};
    if (part.first > 0 && meets(lines, lines.flange, 1.0, radius, pose, margin)) part.first = 0;
    if (part.second < lines.s.size() && meets(lines, lines.field, -1.0, radius, pose, margin))
        part.second = lines.s.size();
    return part;
}

// Penetration at some lines, to about 1e-9 m, from the rail's samples and its curvature there; beside the rail minus
// the distance from its end. Others are left out.
inline Scan scan(const Shape& rail, const Lines& lines, double radius, const Pose<double>& pose, const Part& part) {
    long n = lines.s.size(), last = rail.samples.size() - 1, sample = -1, advance = 0;
    Scan result{Array<double, 1>(n), Array<double, 1>(n), Array<double, 1>(n), Array<long, 1>(n)};
    std::fill(result.depth.begin(), result.depth.end(), NONE);
    std::fill(result.sample.begin(), result.sample.end(), -1L);
    double sine = 0.0, cosine = 1.0;
    for (long i = part.first; i < part.second; ++i) {
        auto z = point_of(lines.point(i)), t = point_of(lines.tangent(i));
        auto seen = seen_line(z, radius, pose);
        const auto& [origin, forth, axle, high, plan, ahead, own, along] = seen;
        long before = sample;
        double r = z.z + radius, at = 0.0, change = 0.0, a = 0.0, d = 0.0, curvature = 0.0;
        Point<double> offset, normal;
        bool ended = false;
        if (sample >= 0) sample = std::min(std::max(sample + advance, 0L), last);
        double first_sine = sine, first_cosine = cosine;
        for (int turn = 0; turn < TURNS; ++turn) {
            Point<double> q{origin.y + forth.y * r * sine + axle.y * z.y - high.y * r * cosine,
                            origin.z + forth.z * r * sine + axle.z * z.y - high.z * r * cosine};
            sample = sample_from(rail, q, sample);
            auto level = point_of(lines.rail_tangent(sample));
            offset = q - point_of(rail.sampled(sample)), curvature = lines.rail_curvature(sample);
            a = dot(offset, level), d = cross(level, offset);
            // to the closest point on the circle of curvature, in a hollow no further than the next sample
            a = std::min(std::max(a / (1.0 + curvature * d), -SPACING), SPACING);
            double bend = a * curvature, even = 1.0 - 0.5 * bend * bend;
            normal = {level.y * bend - level.z * even, level.y * even + level.z * bend};
            double forward = normal.y * forth.y + normal.z * forth.z, upward = normal.y * high.y + normal.z * high.z;
            if (upward == 0.0) break;
            double size = std::copysign(std::sqrt(forward * forward + upward * upward), upward);
            double before_last = at, changed = change;
            at = sine, sine = -forward / size, cosine = upward / size;
            change = sine - at;
            ended = std::abs(change) * radius < (d > FAR ? FAR : SCANNED);
            if (ended) break;
            next_turn(turn, at, before_last, change, changed, sine, cosine);
        }
        if (!ended) {  // on steep flanges of wheels that yaw
            long near = before >= 0 ? before : sample;
            OnCurve<double> line{z, t, {}};
            auto found = lowest_on(rail, radius, pose, line, first_sine, first_cosine, near, rail.samples(near));
            if (!std::isnan(found.depth)) {
                sample = sample_from(rail, local(rail, found.at, found.piece).point, near);
                advance = before >= 0 ? sample - before : 0;
                sine = std::sin(found.x / radius), cosine = std::cos(found.x / radius);
                result.depth(i) = found.depth, result.slope(i) = found.slope;
                result.x(i) = found.x, result.sample(i) = sample;
                continue;
            }
        }
        advance = before >= 0 ? sample - before : 0;
        if ((sample == 0 && a < 0.0) || (sample == last && a > 0.0)) {
            result.depth(i) = -std::hypot(offset.y, offset.z);
            sample = -1, sine = 0.0, cosine = 1.0;
            continue;
        }
        double ty = forth.y * t.z * sine + axle.y * t.y - high.y * t.z * cosine;
        double tz = forth.z * t.z * sine + axle.z * t.y - high.z * t.z * cosine;
        if (plan != 0.0) ty -= seen.bent(t, sine, cosine);
        result.depth(i) = -(d + 0.5 * curvature * a * a * (1.0 + curvature * d));
        result.slope(i) = -(ty * normal.y + tz * normal.z);
        result.x(i) = radius * std::asin(sine), result.sample(i) = sample;
        if (!ended) sample = -1, sine = 0.0, cosine = 1.0;  // the next search begins where none has failed
    }
    return result;
}

// Whether a part of the wheel below its axle lies under the rail's surface; samples: the scan of the lines: where they
// are above the rail, the wheel is.
inline bool inside(const Lines& lines, const Scan& samples, const Part& part, double radius, const Pose<double>& pose) {
    auto across = lines.outline[0], heights = lines.outline[1];
    const auto& [origin, m, plan] = pose;
    for (long i = part.first; i < part.second; ++i) {
        if (samples.sample(i) >= 0 && samples.depth(i) <= 0.0) continue;
        double along = lines.point(i).real(), r = lines.point(i).imag() + radius;
        double y = origin.y + m.y.y * along - m.z.y * r;
        if (!(across(0) < y && y < across(across.size() - 1))) continue;
        long k = std::lower_bound(across.begin(), across.end(), y) - across.begin();
        double share = (y - across(k - 1)) / (across(k) - across(k - 1));
        double surface = heights(k - 1) + share * (heights(k) - heights(k - 1));
        if (origin.z + m.y.z * along - m.z.z * r < surface - INSIDE) return true;
    }
    return false;
}

}  // namespace wr
