// Resultants of patches as sums over their contact points.
#pragma once
#include <array>
#include <cmath>
#include <limits>

#include "contact/kinematics/core/motion.hpp"
#include "contact/results/core/patch_points.hpp"

namespace wr {

constexpr long PATCH_NUMBERS = 26;  // of `store_patch`

// Sums over the points of a patch; see `wheelrail.contact.results.result.Patch` for what they are there.
struct PatchSums {
    double area = 0.0, stick_area = 0.0;  // m2
    double peak = 0.0;                    // Pa, the largest pressure
    Array<double, 1> force{3};            // N
    Array<double, 2> axes{3, 3};          // rows forward, left and upward of the mean contact plane
    double slope = 0.0;                   // of the common surface of the deformed bodies over that plane
    Array<double, 1> point{3};            // m, centre of pressure
    Array<double, 1> wheel{2}, rail{2};   // m, its arc length and lateral position on both profiles
    Array<double, 1> bands{4};            // m, smallest and largest lateral position on the wheel, and on the rail
    Array<double, 1> semi_axes{2};        // m
    std::array<double, 3> creepage{};
    // W, the frictional heat of steady rolling: to this, sums of traction times slip converge, from 7 % below with 12 x
    // 16 cells. It is the work of the tractions on the rigid slip, and their elastic work but for that which vanishes:
    // by Betti's theorem neither tractions nor pressure work on those displacements by themselves that pass by
    // unchanged, but tractions do on those by the pressure, which they shift along x, and a compressed wheel rolls on a
    // smaller radius, u_r / R.
    double power = 0.0;
    long strips = 0;

    auto fields() {
        return std::tie(area, stick_area, peak, force, axes, slope, point, wheel, rail, bands, semi_axes, creepage,
                        power, strips);
    }
    bool fits() const {
        return force.size() == 3 && axes.shape == std::array{3L, 3L} && point.size() == 3 && wheel.size() == 2 &&
               rail.size() == 2 && bands.size() == 4 && semi_axes.size() == 2;
    }
    Vec<double> axis(int k) const { return vec_of(axes[k]); }
    // Rotation rad of the contact plane about x.
    double inclination() const { return std::atan2(-axes(2, 1), axes(2, 2)); }
};

inline void store_vector(const Vec<double>& a, const View<double, 1>& to) { to(0) = a.x, to(1) = a.y, to(2) = a.z; }

// Power W of a point's tractions on the rigid slip, with the elastic work.
inline double point_power(const PatchPoints& points, long q, const RigidMotion<double>& v, double speed) {
    auto at = vec_of(points.point[q]), x = vec_of(points.axes[q][0]), y = vec_of(points.axes[q][1]);
    auto level = vec_of(points.level[q]);
    double by_x = velocity_along(v.wheel, at, x) - velocity_along(v.rail, at, level);
    double by_y = velocity_along(v.wheel, at, y) - velocity_along(v.rail, at, y);
    double rigid = points.traction(q, 0) * by_x + points.traction(q, 1) * by_y;
    return points.area(q) * (rigid + speed * points.elastic(q));
}

// Sums over the points inside (n,); rolling speed m/s; 0: no creepage and no power.
inline PatchSums patch_sums(View<const bool, 1> inside, const PatchPoints& points, const RigidMotion<double>& v,
                            double speed) {
    constexpr double INFINITY_M = std::numeric_limits<double>::infinity();
    PatchSums sums;
    double total = 0.0;
    for (int c = 0; c < 4; ++c) sums.bands(c) = c % 2 ? -INFINITY_M : INFINITY_M;
    for (long q = 0; q < inside.size(); ++q) {
        if (!inside(q)) continue;
        double size = points.area(q), p = points.pressure(q), load = p * size;
        double tx = points.traction(q, 0), ty = points.traction(q, 1);
        auto axes = points.axes[q];
        total += load;
        sums.area += size;
        sums.peak = std::max(sums.peak, p);
        if (points.sticks(q)) sums.stick_area += size;
        for (int c = 0; c < 3; ++c) {
            sums.force(c) += size * (tx * axes(0, c) + ty * axes(1, c)) - load * axes(2, c);
            sums.axes(2, c) -= load * axes(2, c);
            sums.point(c) += load * points.point(q, c);
        }
        for (int c = 0; c < 2; ++c) {
            sums.wheel(c) += load * points.on_wheel(q, c);
            sums.rail(c) += load * points.on_rail(q, c);
        }
        double half = 0.5 * size / points.step(q) * std::abs(axes(2, 2));  // of the width that belongs to a point
        for (int side = 0; side < 2; ++side) {
            double y = side ? points.on_rail(q, 1) : points.on_wheel(q, 1);
            sums.bands(2 * side) = std::min(sums.bands(2 * side), y - half);
            sums.bands(2 * side + 1) = std::max(sums.bands(2 * side + 1), y + half);
        }
        if (speed > 0.0) sums.power -= point_power(points, q, v, speed);
    }
    for (double& c : sums.point) c /= total;
    for (auto* of : {&sums.wheel, &sums.rail})
        for (double& c : *of) c /= total;
    auto up = sums.axis(2);
    double size = std::sqrt(dot(up, up));
    up = {up.x / size, up.y / size, up.z / size};
    Vec<double> forward{1.0 - up.x * up.x, -up.x * up.y, -up.x * up.z};
    size = std::sqrt(dot(forward, forward));
    forward = {forward.x / size, forward.y / size, forward.z / size};
    auto left = cross(up, forward);
    store_vector(forward, sums.axes[0]), store_vector(left, sums.axes[1]), store_vector(up, sums.axes[2]);
    double along = 0.0, across = 0.0;
    for (long q = 0; q < inside.size(); ++q) {
        if (!inside(q)) continue;
        double load = points.pressure(q) * points.area(q), x = points.point(q, 0) - sums.point(0),
               y = points.on_wheel(q, 0) - sums.wheel(0);
        along += load * (x * x), across += load * (y * y);
    }
    sums.semi_axes(0) = std::sqrt(5.0 * along / total), sums.semi_axes(1) = std::sqrt(5.0 * across / total);
    const Vec<double> outward[3] = {forward, left, {-up.x, -up.y, -up.z}};
    auto creep = creepages(v, vec_of(sums.point), outward, speed);
    sums.creepage = {creep.longitudinal, creep.lateral, creep.spin};
    return sums;
}

// Fill a row (26,) of numbers for `patches_of`; peak Pa, in place of that of the sums.
inline void store_patch(const PatchSums& sums, double peak, const View<double, 1>& row) {
    auto force = vec_of(sums.force);
    double forward = dot(sums.axis(0), force), left = dot(sums.axis(1), force), normal = dot(sums.axis(2), force);
    for (int c = 0; c < 3; ++c) row(3 + c) = sums.force(c), row(21 + c) = sums.creepage[c];
    row(0) = sums.area, row(1) = peak, row(2) = normal, row(6) = forward, row(7) = left;
    row(8) = sums.semi_axes(0), row(9) = sums.semi_axes(1), row(10) = sums.inclination() - sums.slope;
    row(11) = sums.wheel(0), row(12) = sums.rail(0), row(13) = sums.wheel(1), row(14) = sums.rail(1);
    for (int c = 0; c < 4; ++c) row(15 + c) = sums.bands(c);
    row(19) = sums.point(0), row(20) = sums.stick_area, row(24) = sums.power, row(25) = double(sums.strips);
}

// Displacements of n contact points, or of strips, see `BodyDisplacements`.
struct SurfaceDisplacements {
    Numbers wheel, rail, wheel_normal;
};

// Put sums on the material of both bodies that touches, with the slope of the common surface: that of the regression
// line of u_n over s. Displacements of n points or strips, their arc length s (n,) m on the wheel and load (n,) N.
//
// Contact points and strips are places in space, displacements are added in each body's own axes: u_n along its normal
// and u_t along its profile. To first order the wheel's material that touches at s is that of s - u_t, the material of
// the rail that at the projection of s minus its own lateral displacement, and the common surface is inclined to the
// wheel's undeformed one at s by du_n / ds.
inline void put_on_material(PatchSums& sums, const SurfaceDisplacements& displacements, Numbers s, Numbers load) {
    double total = 0.0, centre = 0.0, of_wheel = 0.0, of_rail = 0.0, moment = 0.0, inertia = 0.0;
    for (long i = 0; i < s.size(); ++i) {
        total += load(i);
        centre += load(i) * (s(i) - s(0));
        of_wheel += load(i) * displacements.wheel(i);
        of_rail += load(i) * displacements.rail(i);
    }
    centre /= total, of_wheel /= total, of_rail /= total;
    for (long i = 0; i < s.size(); ++i) {
        double lever = s(i) - s(0) - centre;
        moment += load(i) * lever * displacements.wheel_normal(i);
        inertia += load(i) * lever * lever;
    }
    double level = std::cos(sums.inclination());
    for (int c = 0; c < 4; ++c) sums.bands(c) -= (c < 2 ? of_wheel : of_rail) * level;
    sums.slope = inertia > 0.0 ? moment / inertia : 0.0;
    for (int c = 0; c < 2; ++c) {
        sums.wheel(c) -= of_wheel * (c ? level : 1.0);
        sums.rail(c) -= of_rail * (c ? level : 1.0);
    }
}

}  // namespace wr
