// Patches of contacts on strips.
#pragma once
#include <numeric>

#include "contact/models/standard/core/wheel_rail.hpp"
#include "contact/results/core/patch_sums.hpp"

namespace wr {

constexpr double LEAST_LENGTH = 0.01;  // of the semi-axis along x: shorter strips are no part of a patch

// Number (k,) of the patch of each contact, with weights (k,), by decreasing load: contacts whose pressures overlap
// share one.
inline Array<long, 1> patch_numbers(const StripPressures& strips, const Numbers& weight) {
    long k = weight.size();
    constexpr double INFINITE = std::numeric_limits<double>::infinity();
    std::vector<double> first(k, INFINITE), last(k, -INFINITE), load(k);
    std::vector<long> order(k);
    Array<long, 1> patch(k);
    std::iota(patch.begin(), patch.end(), 0L), std::iota(order.begin(), order.end(), 0L);
    for (long i = 0; i < strips.s.size(); ++i)
        if (long c = strips.contact(i); strips.half(i) > LEAST_LENGTH * strips.along(c))
            first[c] = std::min(first[c], strips.s(i)), last[c] = std::max(last[c], strips.s(i));
    for (long c = 0; c < k; ++c)
        for (long other = 0; other < c; ++other)
            if (first[c] < last[other] && first[other] < last[c])
                std::replace(patch.begin(), patch.end(), long(patch(c)), long(patch(other)));
    for (long c = 0; c < k; ++c) load[patch(c)] += strips.load(c) * weight(c);
    std::stable_sort(order.begin(), order.end(), [&](long a, long b) { return load[a] > load[b]; });
    std::vector<long> rank(k);
    for (long place = 0; place < k; ++place) rank[order[place]] = place;
    for (long& own : patch) own = rank[own];
    return patch;
}

// Largest pressure Pa of a contact along the line s m, linear between its strips; 0 beyond them.
inline double pressure_at(const StripPressures& strips, long contact, double s) {
    constexpr double INFINITE = std::numeric_limits<double>::infinity();
    double below = -INFINITE, above = INFINITE, low = 0.0, high = 0.0;
    for (long i = 0; i < strips.s.size(); ++i) {
        if (strips.contact(i) != contact) continue;
        double at = strips.s(i), peak = strips.scale(i) * strips.half(i);
        if (below < at && at <= s) below = at, low = peak;
        if (s <= at && at < above) above = at, high = peak;
    }
    if (below == above) return low;
    return std::isfinite(above - below) ? low + (high - low) * (s - below) / (above - below) : 0.0;
}

// Largest pressure Pa along strip i: of contacts that are about to merge, and press on the same places, the sum;
// weights (k,) of the contacts, and patch (k,) of each.
inline double joint_pressure(const StripPressures& strips, const Numbers& weight, const Indices& patch, long i) {
    long own = strips.contact(i);
    double total = strips.scale(i) * strips.half(i), joint = weight(own) * total;
    bool alone = true;
    for (long c = 0; c < weight.size(); ++c)
        if (c != own && patch(c) == patch(own)) joint += weight(c) * pressure_at(strips, c, strips.s(i)), alone = false;
    return alone ? total : joint;
}

// Arc lengths and lateral positions (n, 2) m of n strips on the profiles of wheel and rail.
struct ProfilePlaces {
    Rows wheel, rail;
};

// Sums over the cells of every patch, rows (p, 26) of `store_patch` by decreasing load.
//
// Parameters: weights (k,) of the contacts; n strips of the contacts, and their cells; frames and places of the strips;
// rigid motion of wheel and rail.
inline Array<double, 2> patch_rows(const Numbers& weight, const StripPressures& strips, const StripTractions& cells,
                                   const std::vector<Frame<double>>& frames, const ProfilePlaces& places,
                                   const RigidMotion<double>& v) {
    long n = strips.s.size(), size = cells.area.size(), m = n ? size / n : 0;
    PatchPoints points;
    points.point = cells.point, points.area = cells.area, points.step = cells.length;
    points.pressure = cells.pressure, points.traction = cells.traction, points.sticks = cells.sticks;
    points.elastic = Array<double, 1>(size);  // of half-spaces: none
    points.axes = Array<double, 3>(size, 3, 3), points.level = Array<double, 2>(size, 3);
    points.on_wheel = Array<double, 2>(size, 2), points.on_rail = Array<double, 2>(size, 2);
    for (long q = 0; q < size; ++q) {
        long i = q / m;
        for (int a = 0; a < 3; ++a) store_vector(frames[i].axes[a], points.axes[q][a]);
        store_vector(frames[i].axes[0], points.level[q]);
        for (int c = 0; c < 2; ++c)
            points.on_wheel(q, c) = places.wheel(i, c), points.on_rail(q, c) = places.rail(i, c);
    }
    double speed = 0.0;
    if (std::any_of(cells.traction.begin(), cells.traction.end(), [](double t) { return t != 0.0; }))
        speed = std::accumulate(cells.speed.begin(), cells.speed.end(), 0.0) / double(cells.speed.size());
    auto patch = patch_numbers(strips, weight);
    long count = weight.size() ? *std::max_element(patch.begin(), patch.end()) + 1 : 0;
    Array<double, 2> rows(count, PATCH_NUMBERS);
    for (long place = 0; place < count; ++place) {
        Array<bool, 1> inside(size);
        double peak = 0.0;
        for (long i = 0; i < n; ++i) {
            if (patch(strips.contact(i)) != place) continue;
            auto own = inside.part(i * m, (i + 1) * m);
            std::fill(own.begin(), own.end(), true);
            peak = std::max(peak, joint_pressure(strips, weight, patch, i));
        }
        store_patch(patch_sums(inside, points, v, speed), peak, rows[place]);
    }
    return rows;
}

// Rows of all patches of a wheel from its regions, by decreasing load, as `patch_rows`.
inline Array<double, 2> wheel_patches(const Parameters& p, const LeftPair<double>& own, const WheelRegions& found) {
    auto zones = penetration_regions(found);
    auto strips = virtual_penetration(zones, p.elastic.E_star);
    auto frames = strip_frames(p.pair(), own.pose, zones, strips);
    long n = strips.s.size();
    Array<double, 1> of_cells(n * p.cells), of_contacts(zones.peak.size());
    std::fill(of_cells.begin(), of_cells.end(), p.mu), std::fill(of_contacts.begin(), of_contacts.end(), p.mu);
    StripFriction friction{p.method, of_cells, of_contacts, p.reduction};
    auto tractions = strip_forces(strips, zones.weight, frames, own.motion, p.elastic, friction, p.cells);
    Array<double, 2> points(n, 3);
    for (long q = 0; q < n; ++q) store_vector(frames.middles[q].point, points[q]);
    auto [wheel, rail] = profile_places(p.wheel, p.rail, strips.s, points);
    return patch_rows(zones.weight, strips, tractions, frames.middles, {wheel, rail}, own.motion);
}

}  // namespace wr
