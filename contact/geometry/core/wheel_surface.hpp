// Points and axes on the surface of a wheel, its profile revolved about y.
#pragma once
#include <cmath>
#include <tuple>

#include "contact/kinematics/core/motion.hpp"
#include "meshes/curves/core/curve.hpp"

namespace wr {

constexpr double NEXT = 1e-3;  // m: points closer than that have neighbouring closest points

// Profiles of a wheel and a rail, and the wheel's nominal rolling radius m.
struct WheelRail {
    const Shape& wheel;
    const Shape& rail;
    double radius;
};

// A point m of a surface, its axis forward along x and its outward normal.
template <class T>
struct Place {
    Vec<T> point, forward, normal;

    Vec<T> lateral() const { return cross(forward, normal); }
};

// Place at x m along the circle of a profile's point.
template <class Z, class P, class X>
auto on_circle(const OnCurve<Z>& at, double radius, const Pose<P>& pose, const X& x) {
    using std::sin, std::cos;
    using T = decltype(Z{} * P{} * X{});
    const auto& [forth, axle, up] = pose.rotation;
    auto r = at.point.z + radius;
    X sine = sin(x / radius), cosine = cos(x / radius);
    auto back = r * sine, down = r * cosine, inward = at.tangent.y * sine, low = at.tangent.y * cosine;
    return Place<T>{pose.origin + back * forth + at.point.y * axle - down * up, cosine * forth + sine * up,
                    inward * forth - at.tangent.z * axle - low * up};
}

// Write a point and its axes, longitudinal, lateral and outward, into row i of (n, 3) m and (n, 3, 3).
inline void write_frame(const Place<double>& at, const View<double, 2>& points, const View<double, 3>& axes, long i) {
    auto store = [](const View<double, 1>& to, const Vec<double>& a) { to(0) = a.x, to(1) = a.y, to(2) = a.z; };
    store(points[i], at.point);
    store(axes[i][0], at.forward), store(axes[i][1], at.lateral()), store(axes[i][2], at.normal);
}

// Write point and axes at s, x m on a wheel, arc length on the profile and along the rolling circle, into row i.
inline void wheel_place(const Shape& wheel, double radius, const Pose<double>& pose, double s, double x,
                        const View<double, 2>& points, const View<double, 3>& axes, long i) {
    write_frame(on_circle(local(wheel, s), radius, pose, x), points, axes, i);
}

// Points (n, 3) m and axes (n, 3, 3) at s, x (n,) m on a wheel, s limited to the profile's ends.
inline std::tuple<Array<double, 2>, Array<double, 3>> wheel_points(const Shape& wheel, double radius,
                                                                   const Pose<double>& pose, const Numbers& s,
                                                                   const Numbers& x) {
    long n = s.size(), j = 0;
    Array<double, 2> points(n, 3);
    Array<double, 3> axes(n, 3, 3);
    for (long i = 0; i < n; ++i) {
        double limited = std::min(std::max(s(i), wheel.first()), wheel.last());
        j = i > 0 ? next_piece(wheel, limited, j) : piece(wheel, limited);
        write_frame(on_circle(local(wheel, limited, j), radius, pose, x(i)), points, axes, i);
    }
    return {points, axes};
}

// Length on the surface at s (n,) m over length on the rolling circle.
inline Array<double, 1> stretched(const Shape& wheel, double radius, const Numbers& s) {
    Array<double, 1> factor(s.size());
    for (long i = 0; i < s.size(); ++i) factor(i) = 1.0 + local(wheel, s(i)).point.z / radius;
    return factor;
}

// Arc lengths and lateral positions (n, 2) m of points (n, 3) m on the profiles of wheel and rail, whose closest points
// are taken; s (n,) m: arc lengths on the wheel, limited to its ends.
inline std::tuple<Array<double, 2>, Array<double, 2>> profile_places(const Shape& wheel, const Shape& rail,
                                                                     const Numbers& s, const Rows& points) {
    long n = s.size(), sample = -1;
    Array<double, 2> on_wheel(n, 2), on_rail(n, 2);
    Point<double> last;
    for (long i = 0; i < n; ++i) {
        Point<double> q{points(i, 1), points(i, 2)}, away = q - last;
        if (!(std::hypot(away.y, away.z) < NEXT)) sample = -1;
        sample = sample_from(rail, q, sample);
        last = q;
        on_wheel(i, 0) = std::min(std::max(s(i), wheel.first()), wheel.last());
        on_rail(i, 0) = foot(rail, q, rail.samples(sample)).s;
        on_wheel(i, 1) = local(wheel, on_wheel(i, 0)).point.y;
        on_rail(i, 1) = local(rail, on_rail(i, 0)).point.y;
    }
    return {on_wheel, on_rail};
}

}  // namespace wr
