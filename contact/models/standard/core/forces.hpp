// Tractions on the cells of strips, and their resultants, from strip pressures and rigid velocities.
#pragma once
#include <span>
#include <utility>
#include <vector>

#include "contact/models/standard/core/creep_coefficients.hpp"
#include "contact/models/standard/core/fastsim.hpp"
#include "contact/models/standard/core/normal.hpp"
#include "contact/models/standard/core/polach.hpp"

namespace wr {

constexpr long NO_FRICTION = 0, FASTSIM = 1, POLACH = 2;
constexpr double PARABOLA = 0.375 * std::numbers::pi;  // peak over that of a half ellipse of the same area and length

// Tangential method and friction coefficients.
struct StripFriction {
    long method = NO_FRICTION;
    Numbers of_cells;                   // (n m,), for FASTSIM
    Numbers of_contacts;                // (k,), for Polach's formula
    std::array<double, 2> reduction{};  // factors k_A and k_S of Polach's formula

    auto fields() { return std::tie(method, of_cells, of_contacts, reduction); }
};

// A point m on the wheel's surface and its axes, longitudinal, lateral and outward.
template <class T>
struct Frame {
    Vec<T> point;
    Vec<T> axes[3];

    Frame() = default;
    explicit Frame(const Place<T>& at) : point(at.point), axes{at.forward, at.lateral(), at.normal} {}
};

// Points (n, 3) m on the wheel's surface and axes (n, 3, 3) there, rows longitudinal, lateral and outward.
struct StripFrames {
    Rows point;
    Blocks axes;

    auto fields() { return std::tie(point, axes); }
    bool fits() const { return point.shape[1] == 3 && axes.shape == std::array<long, 3>{point.size(), 3, 3}; }
    std::vector<Frame<double>> frames() const {
        std::vector<Frame<double>> all(point.size());
        for (long i = 0; i < point.size(); ++i) {
            all[i].point = vec_of(point[i]);
            for (int a = 0; a < 3; ++a) all[i].axes[a] = vec_of(axes[i][a]);
        }
        return all;
    }
};

// Frames in the middles of strips, and at the maxima of the penetration, where the contacts' rolling speeds are taken.
template <class T>
struct PatchFrames {
    std::vector<Frame<T>> middles, peaks;
};

// A number that varies with the pose as one that varies with pose and motion: T of G.
template <class T, class G>
T as(const G& a) {
    if constexpr (std::is_same_v<T, G>)
        return a;
    else
        return widened<T::COUNT>(a, 0);
}
template <class T, class G>
Vec<T> as(const Vec<G>& a) {
    return {as<T>(a.x), as<T>(a.y), as<T>(a.z)};
}

// Rolling contact of one patch.
template <class T>
struct RollingPatch {
    T speed;                  // rolling speed, m/s
    Creepages<T> creepages;   // longitudinal, lateral, and spin 1/m, means of the strips by their normal forces
    T along, across;          // semi-axes of the ellipse with the pressure's second moments, m
    T load;                   // normal force, N
    std::array<T, 3> kalker;  // coefficients C11, C22, C23
    ElasticFoundation<T> flexibility;
};

inline double speed_at(const RigidMotion<double>& v, const Frame<double>& at) {
    return rolling_speed(v, at.point, at.axes[0]);
}
inline Creepages<double> creepages_at(const RigidMotion<double>& v, const Frame<double>& at, double speed) {
    return creepages(v, at.point, at.axes, speed);
}

// Means over a patch by the normal forces of its strips, from start to before stop; those of each are stored.
//
// A surface is curved across a wide patch. Where it sticks, the force of a strip is in proportion to its creepage and
// to the square of its length, as its normal force is, so that the force of the patch is that of the mean.
template <class T, class G, class Motion>
Creepages<T> mean_creepages(const Pressures<G>& strips, long start, long stop, const std::vector<Frame<G>>& middles,
                            const Motion& v, const T& speed, std::vector<Creepages<T>>& all) {
    T total{}, xi{}, eta{}, phi{};
    for (long i = start; i < stop; ++i) {
        T load = as<T>(G(strips.half(i) * strips.half(i) * strips.width(i)));
        const auto& own = all[i] = creepages_at(v, middles[i], speed);
        total += load, xi += load * own.longitudinal, eta += load * own.lateral, phi += load * own.spin;
    }
    return {xi / total, eta / total, phi / total};
}

// Patch of a contact with strips from start to before stop; frames and pressures vary with the pose at most, T with the
// motion, too.
template <class T, class G, class Motion>
RollingPatch<T> rolling_patch(const Pressures<G>& strips, long contact, long start, long stop,
                              const PatchFrames<G>& frames, const Motion& v, const PairElasticity& elastic,
                              std::vector<Creepages<T>>& all) {
    T speed = speed_at(v, frames.peaks[contact]);
    const G &a = strips.along(contact), &b = strips.across(contact);
    auto kalker = coefficients(elastic.table, G(a / b));
    auto [along, across, spin] = foundation(a, b, elastic.G, kalker);
    return {speed,
            mean_creepages(strips, start, stop, frames.middles, v, speed, all),
            as<T>(a),
            as<T>(b),
            as<T>(strips.load(contact)),
            {as<T>(kalker[0]), as<T>(kalker[1]), as<T>(kalker[2])},
            {as<T>(along), as<T>(across), as<T>(spin)}};
}

// Longitudinal and lateral force N on a patch by Polach's formula, for a friction coefficient.
inline std::array<double, 2> polach_force(const RollingPatch<double>& patch, double G, double friction,
                                          const std::array<double, 2>& reduction) {
    const auto& [xi, eta, phi] = patch.creepages;
    return polach({xi, eta, phi}, {patch.along, patch.across}, friction * patch.load, G, patch.kalker, reduction);
}

// Means (m,) over m equal cells from -1 to 1 of sqrt(1 - t^2).
inline std::vector<double> half_ellipse_means(long cells) {
    std::vector<double> arch;
    for (long j = 0; j < cells; ++j) {
        double low = 2.0 * double(j) / double(cells) - 1.0, high = 2.0 * double(j + 1) / double(cells) - 1.0;
        arch.push_back(0.25 * double(cells) *
                       (high * std::sqrt(std::max(1.0 - high * high, 0.0)) + std::asin(std::min(high, 1.0)) -
                        low * std::sqrt(std::max(1.0 - low * low, 0.0)) - std::asin(low)));
    }
    return arch;
}

// Means (m,) over m equal cells from -1 to 1 of 1 - t^2.
inline std::vector<double> parabola_means(long cells) {
    std::vector<double> dome;
    for (long j = 0; j < cells; ++j) {
        double low = 2.0 * double(j) / double(cells) - 1.0, high = 2.0 * double(j + 1) / double(cells) - 1.0;
        dome.push_back(1.0 - (high * high + high * low + low * low) / 3.0);
    }
    return dome;
}

// Place m of the middle of cell j of m along a strip of a half length m.
inline double place_of(double half, long j, long m) { return half * ((2.0 * double(j) + 1.0) / double(m) - 1.0); }

// Tractions of k contacts on n cells, strip by strip from the trailing end, and their resultants.
struct StripTractions {
    Array<double, 1> force, moment;   // (3,) N and N m, about the origin
    Array<double, 1> speed;           // (k,) m/s, rolling speed of the contacts
    Array<double, 2> point;           // (n, 3) m
    Array<double, 1> length, area;    // (n,) m, and m2 times the weight of the contact
    Array<double, 1> pressure;        // (n,) Pa
    Array<double, 2> traction, slip;  // (n, 2) Pa, and over the rolling speed
    Array<bool, 1> sticks;            // (n,), whether the slip is zero

    auto fields() { return std::tie(force, moment, speed, point, length, area, pressure, traction, slip, sticks); }
    bool fits() const {
        long n = area.size();
        return force.size() == 3 && moment.size() == 3 && point.shape == std::array<long, 2>{n, 3} &&
               length.size() == n && pressure.size() == n && traction.shape == std::array<long, 2>{n, 2} &&
               slip.shape == traction.shape && sticks.size() == n;
    }
    StripTractions() = default;
    StripTractions(long n, long k)
        : force(3),
          moment(3),
          speed(k),
          point(n, 3),
          length(n),
          area(n),
          pressure(n),
          traction(n, 2),
          slip(n, 2),
          sticks(n) {}
};

// Rigid slip velocities on the m cells of n strips (n m,), and of the contacts as a whole (k,), m/s.
inline std::pair<Array<double, 1>, Array<double, 1>> slip_velocities(const StripPressures& strips,
                                                                     const PatchFrames<double>& frames,
                                                                     const RigidMotion<double>& v, long m) {
    long n = strips.s.size(), k = strips.load.size(), start = 0, stop = 0;
    Array<double, 1> cells(n * m), whole(k);
    std::vector<Creepages<double>> all(n);
    for (long c = 0; c < k; ++c, start = stop) {
        stop = end_of(strips.contact, start, c);
        double speed = speed_at(v, frames.peaks[c]);
        if (!(speed > 0.0)) continue;
        auto [xi, eta, phi] = mean_creepages(strips, start, stop, frames.middles, v, speed, all);
        whole(c) = speed * std::hypot(xi, effective(eta, phi, strips.along(c)));
        for (long i = start; i < stop; ++i)
            for (long j = 0; j < m; ++j)
                cells(i * m + j) = speed * std::hypot(all[i].longitudinal,
                                                      all[i].lateral + all[i].spin * place_of(strips.half(i), j, m));
    }
    return {cells, whole};
}

// Fill force and moment from tractions and pressures of the cells, m for each strip with its frame.
inline void integrate_tractions(const StripTractions& cells, const std::vector<Frame<double>>& frames, long m) {
    Vec<double> force, moment;
    for (long q = 0; q < cells.area.size(); ++q) {
        const auto& [along, across, outward] = frames[q / m].axes;
        auto p = cells.area(q) *
                 (cells.traction(q, 0) * along + cells.traction(q, 1) * across - cells.pressure(q) * outward);
        force = force + p, moment = moment + cross(vec_of(cells.point[q]), p);
    }
    for (auto [to, from] : {std::pair{&cells.force, force}, std::pair{&cells.moment, moment}})
        (*to)(0) = from.x, (*to)(1) = from.y, (*to)(2) = from.z;
}

// Tractions of k contacts on the cells of n strips: m along each.
//
// Parameters: pressures; weights (k,) of the contacts' areas; frames; rigid motion of wheel and rail; constants of both
// bodies; method and friction coefficients. Contacts with a rolling speed that is not positive have no tangential
// tractions.
inline StripTractions strip_forces(const StripPressures& strips, const Numbers& share,
                                   const PatchFrames<double>& frames, const RigidMotion<double>& v,
                                   const PairElasticity& elastic, const StripFriction& tangential, long m) {
    long n = strips.s.size(), k = share.size(), start = 0, stop = 0;
    StripTractions cells(n * m, k);
    auto arch = half_ellipse_means(m), dome = parabola_means(m);
    std::vector<double> bounds(m);
    std::vector<Creepages<double>> all(n);
    for (long c = 0; c < k; ++c, start = stop) {
        stop = end_of(strips.contact, start, c);
        auto patch = rolling_patch(strips, c, start, stop, frames, v, elastic, all);
        cells.speed(c) = patch.speed;
        bool rolls = tangential.method != NO_FRICTION && patch.speed > 0.0;
        std::array<double, 2> force{};
        if (rolls && tangential.method == POLACH)
            force = polach_force(patch, elastic.G, tangential.of_contacts(c), tangential.reduction);
        for (long i = start; i < stop; ++i) {
            double half = strips.half(i), length = 2.0 * half / double(m), peak = strips.scale(i) * half;
            for (long j = 0; j < m; ++j) {
                long q = i * m + j;
                cells.length(q) = length, cells.area(q) = length * strips.width(i) * share(c);
                cells.pressure(q) = peak * arch[j];
                auto point = frames.middles[i].point + place_of(half, j, m) * frames.middles[i].axes[0];
                cells.point(q, 0) = point.x, cells.point(q, 1) = point.y, cells.point(q, 2) = point.z;
            }
            if (!rolls) continue;
            auto traction = cells.traction.part(i * m, (i + 1) * m), slip = cells.slip.part(i * m, (i + 1) * m);
            if (tangential.method == FASTSIM) {
                for (long j = 0; j < m; ++j) bounds[j] = tangential.of_cells(i * m + j) * PARABOLA * peak * dome[j];
                strip_tractions(half, patch.creepages, all[i], patch.flexibility, bounds, traction, slip);
            } else {  // proportional to the pressure
                for (long j = 0; j < m; ++j) {
                    for (int a = 0; a < 2; ++a) traction(j, a) = force[a] * cells.pressure(i * m + j) / patch.load;
                    slip(j, 0) = all[i].longitudinal, slip(j, 1) = all[i].lateral + all[i].spin * place_of(half, j, m);
                }
            }
            for (long j = 0; j < m; ++j) cells.sticks(i * m + j) = slip(j, 0) == 0.0 && slip(j, 1) == 0.0;
        }
    }
    integrate_tractions(cells, frames.middles, m);
    return cells;
}

}  // namespace wr
