// Forces of wheels on rails with Piotrowski and Kik's pressures, all wheels of a side in one call.
#pragma once
#include "contact/kinematics/core/left_pair.hpp"
#include "contact/models/standard/core/strip_loads.hpp"

namespace wr {

// Parameters common to all wheels of a pair of profiles.
struct Parameters {
    Shape wheel, rail;                  // profiles
    double radius = 0.0;                // of the wheel, m
    Lines lines;                        // on which the penetration is sampled
    double merge = 0.0;                 // m, maxima closer than that are one contact
    PairElasticity elastic;             // constants of both bodies
    long method = NO_FRICTION;          // of the tangential problem
    double mu = 0.0;                    // friction coefficient
    std::array<double, 2> reduction{};  // factors of Polach's formula
    long cells = 0;                     // along each strip

    auto fields() { return std::tie(wheel, rail, radius, lines, merge, elastic, method, mu, reduction, cells); }
    bool fits() const { return lines.of(rail) && cells > 0; }
    WheelRail pair() const { return {wheel, rail, radius}; }
    PairFriction friction() const { return {elastic, method, mu, reduction, cells}; }
};

// Forces of w wheels, and the regions of all.
struct WheelForces {
    Array<double, 2> wrench;  // (w, 6) force N and moment N m
    // (w, 8), largest penetration m; 1 for a wheel inside the rail or over an end of a profile, otherwise 0; numbers of
    // contacts and of cells; largest semi-axes m along and across; smallest rolling speed m/s; largest pressure Pa
    Array<double, 2> values;
    Array<long, 2> starts;  // (w + 1, 6), first rows of each wheel in the arrays that follow
    // fields of `WheelRegions`, wheel after wheel
    Array<double, 2> top, low;
    Array<double, 1> edges;
    Array<double, 2> contacts;
    Array<long, 1> contact;
    Array<double, 2> strips;

    auto fields() { return std::tie(wrench, values, starts, top, low, edges, contacts, contact, strips); }
    bool fits() const {
        long w = wrench.size(),
             sizes[] = {top.size(), low.size(), edges.size(), contacts.size(), contact.size(), strips.size()};
        if (wrench.shape[1] != 6 || values.shape != std::array<long, 2>{w, 8} ||
            starts.shape != std::array<long, 2>{w + 1, 6} || top.shape[1] != 3 || low.shape[1] != 3 ||
            contacts.shape[1] != 4 || strips.shape[1] != 5)
            return false;
        for (int k = 0; k < 6; ++k) {
            if (starts(0, k) != 0 || starts(w, k) != sizes[k]) return false;
            for (long i = 0; i < w; ++i)
                if (starts(i, k) > starts(i + 1, k)) return false;
        }
        return true;
    }
    bool touches(long i) const { return values(i, 2) > 0.0; }
};

// Place on the wheel's surface at s, x m; s is limited to the profile's ends.
template <class T>
Frame<T> surface_frame(const WheelRail& pair, const Pose<T>& pose, const T& s, const T& x) {
    double first = pair.wheel.first(), last = pair.wheel.last(), limited = std::clamp(value(s), first, last);
    if constexpr (std::is_same_v<T, double>) {
        return Frame<T>(on_circle(local(pair.wheel, limited), pair.radius, pose, x));
    } else {
        bool inside = first < value(s) && value(s) < last;
        return Frame<T>(on_circle(at_place(pair.wheel, inside ? s : T(limited)), pair.radius, pose, x));
    }
}

// Frames on the wheel's surface in the middles of strips, and at the maxima of the penetration.
template <class T, class Zones>
PatchFrames<T> strip_frames(const WheelRail& pair, const Pose<T>& pose, const Zones& zones,
                            const Pressures<T>& strips) {
    PatchFrames<T> frames;
    for (long i = 0; i < strips.s.size(); ++i)
        frames.middles.push_back(surface_frame(pair, pose, T(strips.s(i)), T(strips.x(i))));
    for (long c = 0; c < zones.peak.size(); ++c)
        frames.peaks.push_back(surface_frame(pair, pose, T(zones.peak(c)), T(zones.peak_x(c))));
    return frames;
}

// Regions of a wheel; its force and moment about the pair's centre, and its values are filled, see `WheelForces`.
inline WheelRegions store_force(const Parameters& p, const LeftPair<double>& own, const View<double, 1>& wrench,
                                const View<double, 1>& values) {
    auto found = wheel_regions(p.pair(), own.pose, p.lines, p.merge);
    values(0) = found.approach, values(1) = found.beyond ? 1.0 : 0.0, values(2) = double(found.contacts.size());
    values(3) = double(found.contact.size() * p.cells);
    if (found.contacts.size() == 0) return found;
    auto zones = penetration_regions(found);
    auto strips = virtual_penetration(zones, p.elastic.E_star);
    auto sum = strip_loads<double>(strips, zones.weight, strip_frames(p.pair(), own.pose, zones, strips), own.motion,
                                   p.friction());
    auto moment = sum.moment - cross(own.centre, sum.force);
    wrench(0) = sum.force.x, wrench(1) = sum.force.y, wrench(2) = sum.force.z;
    wrench(3) = moment.x, wrench(4) = moment.y, wrench(5) = moment.z;
    values(4) = *std::max_element(strips.along.begin(), strips.along.end());
    values(5) = *std::max_element(strips.across.begin(), strips.across.end());
    values(6) = sum.slowest, values(7) = 0.0;
    for (long i = 0; i < strips.s.size(); ++i) values(7) = std::max(values(7), strips.scale(i) * strips.half(i));
    return found;
}

// Copy rows behind the rows of other wheels.
template <class T, int N>
void append(const View<T, N>& to, long first, const View<T, N>& from) {
    std::copy(from.begin(), from.end(), to.part(first, first + from.size()).begin());
}

// Forces of all wheels and moments about the pairs' centres; mirror: whether these are those in the mirror y = 0,
// regions remain those of the pairs.
inline WheelForces wheel_forces(const Parameters& p, const WheelPairs& pairs, bool mirror) {
    long w = pairs.size();
    WheelForces forces;
    forces.wrench = Array<double, 2>(w, 6), forces.values = Array<double, 2>(w, 8);
    forces.starts = Array<long, 2>(w + 1, 6);
    std::vector<WheelRegions> all;
    for (long i = 0; i < w; ++i) {
        auto wrench = forces.wrench[i];
        const auto& found = all.emplace_back(store_force(p, pairs[i], wrench, forces.values[i]));
        long sizes[] = {found.top.size(),      found.low.size(),     found.edges.size(),
                        found.contacts.size(), found.contact.size(), found.strips.size()};
        for (int k = 0; k < 6; ++k) forces.starts(i + 1, k) = forces.starts(i, k) + sizes[k];
        if (mirror) wrench(1) = -wrench(1), wrench(3) = -wrench(3), wrench(5) = -wrench(5);
    }
    auto n = forces.starts[w];
    forces.top = Array<double, 2>(n(0), 3), forces.low = Array<double, 2>(n(1), 3);
    forces.edges = Array<double, 1>(n(2)), forces.contacts = Array<double, 2>(n(3), 4);
    forces.contact = Array<long, 1>(n(4)), forces.strips = Array<double, 2>(n(5), 5);
    for (long i = 0; i < w; ++i) {
        auto a = forces.starts[i];
        append<double, 2>(forces.top, a(0), all[i].top), append<double, 2>(forces.low, a(1), all[i].low);
        append<double, 1>(forces.edges, a(2), all[i].edges);
        append<double, 2>(forces.contacts, a(3), all[i].contacts);
        append<long, 1>(forces.contact, a(4), all[i].contact), append<double, 2>(forces.strips, a(5), all[i].strips);
    }
    return forces;
}

// Regions of wheel i.
inline WheelRegions regions_of(const WheelForces& forces, long i) {
    auto a = forces.starts[i], b = forces.starts[i + 1];
    auto rows = [&](const auto& of, int k) {
        using A = std::decay_t<decltype(of)>;
        return A::copy(of.part(a(k), b(k)));
    };
    WheelRegions own;
    own.approach = forces.values(i, 0), own.beyond = forces.values(i, 1) > 0.0;
    own.top = rows(forces.top, 0), own.low = rows(forces.low, 1), own.edges = rows(forces.edges, 2);
    own.contacts = rows(forces.contacts, 3), own.contact = rows(forces.contact, 4);
    own.strips = rows(forces.strips, 5);
    return own;
}

}  // namespace wr
