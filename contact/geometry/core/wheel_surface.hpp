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

// A line of a wheel in a rail's cross-section: its point at an angle along the rolling circle is origin + r (forth sin
// - upward cos) + axle y, y and r its place across and its distance from the axle.
//
// Along a rail with the curvature k in plan y is less by k x^2 / 2. With x = a + r sin, a = o_x + y e_x for the axle's
// direction e, that is k (a^2 / 2 + a r sin + r^2 (1 - cos)) up to the fourth order of the angle: a circle again.
template <class T>
struct SeenLine {
    Point<T> origin, forth, axle, upward;
    double plan;
    T ahead{}, r{}, along_axle{};  // a, r, and the axle's component along the rail

    // Directions of the circle at an angle: along it, and away from the axle.
    Point<T> forward(double sine, double cosine) const {
        return {forth.y * cosine + upward.y * sine, forth.z * cosine + upward.z * sine};
    }
    template <class X>
    auto up(const X& sine, const X& cosine) const {
        return Point<decltype(T{} * X{})>{forth.y * sine - upward.y * cosine, forth.z * sine - upward.z * cosine};
    }
    // The point, for `up` there.
    template <class Z, class U>
    Point<U> place(const Point<Z>& point, double radius, const Point<U>& up) const {
        Z r = point.z + radius;
        return {origin.y + r * up.y + axle.y * point.y, origin.z + r * up.z + axle.z * point.y};
    }
    // Its change along the profile with a tangent, for `up` there.
    template <class Z, class X>
    Point<T> change(const Point<Z>& tangent, const Point<T>& up, const X& sine, const X& cosine) const {
        Point<T> along{tangent.z * up.y + tangent.y * axle.y, tangent.z * up.z + tangent.y * axle.z};
        if (plan != 0.0) along.y = along.y - bent(tangent, sine, cosine);
        return along;
    }
    // What the rail's curvature takes from it, beyond that in `up`.
    template <class Z, class X>
    T bent(const Point<Z>& tangent, const X& sine, const X& cosine) const {
        return plan * (tangent.z * r * (2.0 - cosine) + tangent.y * along_axle * (ahead + r * sine));
    }
};

// The line through a point of the wheel's profile.
template <class Z, class P>
auto seen_line(const Point<Z>& point, double radius, const Pose<P>& pose) {
    using T = decltype(Z{} * P{});
    const auto& [origin, m, plan] = pose;
    SeenLine<T> line{{origin.y, origin.z}, {m.x.y, m.x.z}, {m.y.y, m.y.z}, {m.z.y, m.z.z}, plan};
    if (plan != 0.0) {
        line.r = point.z + radius, line.along_axle = m.y.x, line.ahead = origin.x + point.y * m.y.x;
        line.origin.y = line.origin.y - plan * (0.5 * line.ahead * line.ahead + line.r * line.r);
        line.forth.y = line.forth.y - plan * line.ahead, line.upward.y = line.upward.y - plan * line.r;
    }
    return line;
}

// As `on_circle`, the point as seen in the rail's cross-section, see `SeenLine`.
template <class Z, class P, class X>
auto seen_on_circle(const OnCurve<Z>& at, double radius, const Pose<P>& pose, const X& x) {
    using std::sin, std::cos;
    auto place = on_circle(at, radius, pose, x);
    if (pose.plan != 0.0) {
        auto seen = seen_line(at.point, radius, pose);
        X sine = sin(x / radius), cosine = cos(x / radius);
        place.point.y = seen.place(at.point, radius, seen.up(sine, cosine)).y;
    }
    return place;
}

// Relative curvature along the rail of a line of the wheel, times its distance r m from the axle: the component of its
// normal that is level along the rail, plus what the rail's curvature in plan adds on a slope.
template <class Z>
Z level_share(const Point<Z>& tangent, const Z& r, double plan) {
    return plan != 0.0 ? tangent.y - plan * r * tangent.z : tangent.y;
}

// Write a point and its axes, longitudinal, lateral and outward, into row i of (n, 3) m and (n, 3, 3).
inline void write_frame(const Place<double>& at, const View<double, 2>& points, const View<double, 3>& axes, long i) {
    auto store = [](const View<double, 1>& to, const Vec<double>& a) { to(0) = a.x, to(1) = a.y, to(2) = a.z; };
    store(points[i], at.point);
    store(axes[i][0], at.forward), store(axes[i][1], at.lateral()), store(axes[i][2], at.normal);
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
