// Interpenetration regions by the method of virtual penetration: around every local maximum of the penetration.
//
// J. Piotrowski, W. Kik, Vehicle System Dynamics 46 (2008) 27-48, doi:10.1080/00423110701586444.
#pragma once
#include "contact/geometry/core/merging.hpp"
#include "contact/geometry/core/overlap.hpp"
#include "contact/geometry/core/surface_gap.hpp"

namespace wr {

constexpr long HALF = 8;  // strips of half a region
// Their positions and widths from 0 to 1, denser at the maximum: squares of Gauss's points h, and h times their
// weights.
constexpr std::array<double, HALF> POSITIONS{0.00039422387424656525, 0.010336130351845793, 0.05627987350995162,
                                             0.16669474576905177,    0.3501293882647017,   0.5818122834262806,
                                             0.8070026077654725,     0.960684080371783};
constexpr std::array<double, HALF> WIDTHS{0.0020098998513175858, 0.022608759545903162, 0.07442181813145646,
                                          0.14807750661769123,   0.21460627676067082,  0.23928482774643114,
                                          0.19977227490747157,   0.09921863643905804};
constexpr double MIN_PENETRATION = 1e-15;  // m: smallest penetration of a strip, for a length above zero
constexpr double MIN_SLOPE_COSINE = 0.05;  // cosine of the wheel's slope: lower bound for the radius along the rail

// Interpenetration regions of a wheel on a rail, with contacts and strips.
struct WheelRegions {
    double approach = 0.0;  // m, largest penetration; without, minus the gap
    bool beyond = false;    // whether the penetration reaches an end of the wheel's profile or of the rail's, is larger
                            // than that of all maxima, or the wheel lies inside the rail
    Array<double, 2> top;   // (k, 3) m, maxima: position, penetration and x
    Array<double, 2> low;   // (k - 1, 3) m, minima between them, likewise; with the penetration 0 where there is a gap
    Array<double, 1> edges;     // (h,) m, outer ends of the halves of regions: for each maximum with a weight, those on
                                // both sides of each maximum in its reach
    Array<double, 2> contacts;  // (c, 4) m, position, x, penetration, and weight
    Array<long, 1> contact;     // (n,), contact of each strip; as many in each half
    Array<double, 2> strips;    // (n, 5) m, position, x, width, penetration of the virtual bodies, and radius along x

    auto fields() { return std::tie(approach, beyond, top, low, edges, contacts, contact, strips); }
    bool fits() const {
        long k = top.size(), n = strips.size(), c = contacts.size();
        return top.shape[1] == 3 && low.shape == std::array<long, 2>{std::max(k - 1, 0L), 3} &&
               n == HALF * edges.size() && contacts.shape[1] == 4 && c <= k && contact.size() == n &&
               strips.shape[1] == 5 &&
               std::all_of(contact.begin(), contact.end(), [&](long i) { return 0 <= i && i < c; });
    }
};

// Rows (k, 3) of maxima or minima.
inline Array<double, 2> rows_of(std::span<const Extremum<>> all) {
    Array<double, 2> rows(long(all.size()), 3L);
    for (long i = 0; i < rows.size(); ++i) rows(i, 0) = all[i].s, rows(i, 1) = all[i].depth, rows(i, 2) = all[i].x;
    return rows;
}

// Maxima or minima from rows (k, 3).
inline std::vector<Extremum<>> extrema_of(const Rows& rows) {
    std::vector<Extremum<>> all(rows.size());
    for (long i = 0; i < rows.size(); ++i) all[i] = {rows(i, 0), rows(i, 1), rows(i, 2)};
    return all;
}

// First line of part of a scan at which the penetration reaches an end of the wheel's or the rail's profile; -1
// without.
inline long first_beyond(const Scan& samples, const Part& part) {
    const auto& [depth, slope, x, sample] = samples;
    for (long i = part.first; i < part.second; ++i) {
        if (!(depth(i) > 0.0)) continue;
        if (i == 0 || i == depth.size() - 1) return i;
        long before = i - 1, after = i + 1;
        if (before >= part.first && sample(before) < 0 && 2.0 * depth(i) > depth(after)) return i;
        if (after < part.second && sample(after) < 0 && 2.0 * depth(i) > depth(before)) return i;
    }
    return -1;
}

// Message on interpenetration beyond the solved regions; names of the profiles.
inline std::string overlap(const WheelRail& pair, const Pose<double>& pose, const Lines& lines,
                           const std::string& wheel, const std::string& rail) {
    Part part = lines_to_scan(lines, pair.radius, pose);
    auto samples = scan(pair.rail, lines, pair.radius, pose, part);
    auto text = [&](long i, const std::string& reason) {
        return overlap_text(samples.depth(i), local(pair.wheel, lines.s(i)).point, reason);
    };
    if (long i = first_beyond(samples, part); i >= 0)
        return text(i, "where profile " + (i == 0 || i == lines.s.size() - 1 ? wheel : rail) + " ends");
    long i = std::max_element(samples.depth.begin(), samples.depth.end()) - samples.depth.begin();
    return samples.depth(i) > 0.0 ? text(i, "where no contact point was found") : TOO_DEEP;
}

// Position m up to which the half of a region around maximum j may extend, in direction -1 or 1: the minimum before the
// next maximum, or the end of the lines.
inline double half_limit(const Numbers& positions, std::span<const Extremum<>> low, long j, long direction) {
    if (direction < 0) return j > 0 ? low[j - 1].s : positions(0);
    return j < long(low.size()) ? low[j].s : positions(positions.size() - 1);
}

// Regions of a wheel; maxima of the penetration, which is sampled on the lines, closer than merge m are one contact.
inline WheelRegions wheel_regions(const WheelRail& pair, const Pose<double>& pose, const Lines& lines, double merge) {
    Part part = lines_to_scan(lines, pair.radius, pose);
    const Numbers& positions = lines.s;
    Scan samples = scan(pair.rail, lines, pair.radius, pose, part);
    Maxima found = local_maxima(pair, pose, positions, samples);
    const auto &top = found.top, &low = found.low;
    const auto& [depth, slope, where, sample] = samples;
    double deepest_top = 0.0;
    if (!top.empty())
        deepest_top =
            std::max_element(top.begin(), top.end(), [](auto& a, auto& b) { return a.depth < b.depth; })->depth;
    WheelRegions regions;
    regions.approach = found.approach;
    regions.beyond = first_beyond(samples, part) >= 0 || found.approach > deepest_top + SAMPLED;
    if (!regions.beyond && top.empty()) {
        regions.beyond = inside(lines, samples, part, pair.radius, pose);
        regions.approach = std::min(nearest_place(pair, pose, lines, part, samples).depth, 0.0);
    }
    regions.top = rows_of(top), regions.low = rows_of(low);
    if (regions.beyond) return regions;
    auto weight = merging_weights<double>(top, low, merge);
    std::vector<long> peaks;
    std::vector<std::array<long, 3>> parts;  // of regions: contact, its maximum, and that around which they are
    for (long k = 0; k < long(top.size()); ++k) {
        if (weight[k] <= 0.0) continue;
        for (long j = 0; j < long(top.size()); ++j)
            if (extends<double>(top, low, k, j, merge)) parts.push_back({long(peaks.size()), k, j});
        peaks.push_back(k);
    }
    regions.contacts = Array<double, 2>(long(peaks.size()), 4L);
    for (long c = 0; c < regions.contacts.size(); ++c) {
        long k = peaks[c];
        regions.contacts(c, 0) = top[k].s, regions.contacts(c, 1) = top[k].x, regions.contacts(c, 2) = top[k].depth;
        regions.contacts(c, 3) = weight[k];
    }
    long halves = 2 * long(parts.size()), half = 0, n = 0;
    regions.edges = Array<double, 1>(halves);
    regions.contact = Array<long, 1>(halves * HALF), regions.strips = Array<double, 2>(halves * HALF, 5L);
    for (auto [contact, k, j] : parts) {
        double level = (1.0 - VIRTUAL) * top[k].depth, middle = top[j].s;
        double valley = std::numeric_limits<double>::infinity();
        if (j != k) valley = low[saddle_between<double>(low, k, j)].depth - level;
        for (long direction : {-1L, 1L}) {
            double way = double(direction), stop = half_limit(positions, low, j, direction), inner = middle;
            long i = found.before[j] + (direction > 0);
            while ((positions(i) - stop) * way < 0.0 && ((positions(i) - middle) * way <= 0.0 || depth(i) >= level)) {
                if ((positions(i) - middle) * way > 0.0) inner = positions(i);
                i += direction;
            }
            double outer = (positions(i) - stop) * way < 0.0 ? positions(i) : stop;
            double edge = level_crossing(pair, pose, inner, outer, level, where(i), sample(i));
            regions.edges(half++) = edge;
            double x = top[j].x;
            long near = sample(found.before[j]), at = piece(pair.wheel, middle);
            for (long q = 0; q < HALF; ++q, ++n) {
                double s = middle + (edge - middle) * POSITIONS[q];
                at = next_piece(pair.wheel, s, at);
                auto line = local(pair.wheel, s, at);
                auto own = lowest(pair.rail, pair.radius, pose, line, x, near);
                x = own.x, near = own.sample;
                auto strip = regions.strips[n];
                regions.contact(n) = contact, strip(0) = s, strip(1) = x;
                strip(2) = std::abs(edge - middle) * WIDTHS[q];
                double depth_there = covered(own.depth - level, valley, std::abs(s - top[k].s), merge);
                strip(3) = std::max(depth_there, MIN_PENETRATION);
                double r = line.point.z + pair.radius;
                strip(4) = r / std::max(level_share(line.tangent, r, pose.plan), MIN_SLOPE_COSINE);
            }
        }
    }
    return regions;
}

}  // namespace wr
