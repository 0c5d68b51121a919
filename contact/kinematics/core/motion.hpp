// Pose and rigid motion of wheel and rail, rolling speed and creepages at a point.
#pragma once
#include <tuple>

#include "support/core/arrays.hpp"
#include "support/core/vector.hpp"

namespace wr {

constexpr int CHANGES = 12;  // six rigid motions of the wheel, changes of its velocity and of its angular velocity

inline Vec<double> vec_of(const Numbers& a) { return {a(0), a(1), a(2)}; }
inline Matrix<double> matrix_of(const Rows& a) {
    return {{a(0, 0), a(1, 0), a(2, 0)}, {a(0, 1), a(1, 1), a(2, 1)}, {a(0, 2), a(1, 2), a(2, 2)}};
}
template <class T>
Vec<double> value(const Vec<T>& a) {
    return {value(a.x), value(a.y), value(a.z)};
}
template <class T>
Matrix<double> value(const Matrix<T>& m) {
    return {value(m.x), value(m.y), value(m.z)};
}
template <class T, class U>
Vec<T> vec_as(const Vec<U>& a) {
    return {T(a.x), T(a.y), T(a.z)};
}

// Position m and axes of a wheel's frame, the columns of its rotation, in that of a rail, whose profile lies at
// y = plan x^2 / 2 along the track: plan is its curvature in plan, 1/m, positive to the left.
template <class T>
struct Pose {
    Vec<T> origin;
    Matrix<T> rotation;
    double plan = 0.0;
};

inline Pose<double> pose_of(const Numbers& origin, const Rows& rotation, double plan) {
    return {vec_of(origin), matrix_of(rotation), plan};
}
template <class T>
Pose<double> value(const Pose<T>& pose) {
    return {value(pose.origin), value(pose.rotation), pose.plan};
}

// A pose that varies by the six rigid motions of a body about its origin, in the order of `ContactResult.tangent`:
// translations along the axes of space, rotations about them; variables from `first` on.
template <class T>
Pose<T> varied(const Pose<double>& pose, int first = 0) {
    const auto& [o, m, plan] = pose;
    Vec<T> turn{variable<T>(0.0, first + 3), variable<T>(0.0, first + 4), variable<T>(0.0, first + 5)};
    auto turned = [&](const Vec<double>& axis) { return axis + cross(turn, axis); };
    return {{variable<T>(o.x, first), variable<T>(o.y, first + 1), variable<T>(o.z, first + 2)},
            {turned(m.x), turned(m.y), turned(m.z)},
            plan};
}

// Rotation vector rad, in the axes of space, from axes to infinitesimally different ones.
template <class T>
Vec<T> small_rotation(const Matrix<double>& from, const Matrix<T>& to) {
    return 0.5 * (cross(from.x, to.x) + cross(from.y, to.y) + cross(from.z, to.z));
}

// Velocity field v + w x (X - reference) of a body: m/s, rad/s and m.
template <class T>
struct Twist {
    Vec<T> velocity, rotation, reference;
};

template <class T>
struct RigidMotion {
    Twist<T> wheel, rail;
};

// Curvature 1/m in plan of a rail that is at rest in space, from its velocities in a frame that moves along it; 0 at
// rest.
template <class T>
double plan_curvature(const Twist<T>& rail) {
    auto back = value(rail.velocity) - cross(value(rail.rotation), value(rail.reference));  // at the rail
    return back.x != 0.0 ? value(rail.rotation.z) / back.x : 0.0;
}

// Motions that vary by the twelve changes of `wheelrail.contact.kinematics.sensitivity`.
// Six are those of the pose, with which the wheel's reference point moves, three each of the wheel's velocity and
// angular velocity.
template <class T>
RigidMotion<T> varied(const RigidMotion<double>& motion, const Pose<double>& pose) {
    auto added = [](const Vec<double>& a, int first) {
        return Vec<T>{variable<T>(a.x, first), variable<T>(a.y, first + 1), variable<T>(a.z, first + 2)};
    };
    Vec<double> arm = motion.wheel.reference - pose.origin;
    Vec<T> origin = added(pose.origin, 0), turn = added({}, 3);
    const auto& [velocity, rotation, reference] = motion.rail;
    return {{added(motion.wheel.velocity, 6), added(motion.wheel.rotation, 9), origin + (arm + cross(turn, arm))},
            {vec_as<T>(velocity), vec_as<T>(rotation), vec_as<T>(reference)}};
}

// Velocity field of a body, for Python: (3,) each.
struct VelocityField {
    Numbers velocity, rotation, reference;

    auto fields() { return std::tie(velocity, rotation, reference); }
    bool fits() const { return velocity.size() == 3 && rotation.size() == 3 && reference.size() == 3; }
    Twist<double> twist() const { return {vec_of(velocity), vec_of(rotation), vec_of(reference)}; }
};

// Rigid motion of wheel and rail, for Python: velocity m/s, angular velocity rad/s and reference point m, (3,) each.
struct RigidVelocities {
    Numbers wheel, wheel_turn, wheel_at, rail, rail_turn, rail_at;

    auto fields() { return std::tie(wheel, wheel_turn, wheel_at, rail, rail_turn, rail_at); }
    bool fits() const {
        for (const Numbers* a : {&wheel, &wheel_turn, &wheel_at, &rail, &rail_turn, &rail_at})
            if (a->size() != 3) return false;
        return true;
    }
    RigidMotion<double> motion() const {
        return {{vec_of(wheel), vec_of(wheel_turn), vec_of(wheel_at)},
                {vec_of(rail), vec_of(rail_turn), vec_of(rail_at)}};
    }
};

// Velocity m/s of a body's point along an axis.
template <class T, class P, class A>
auto velocity_along(const Twist<T>& body, const Vec<P>& point, const Vec<A>& axis) {
    const auto& [velocity, turn, at] = body;
    auto x = point.x - at.x, y = point.y - at.y, z = point.z - at.z;
    return (velocity.x + turn.y * z - turn.z * y) * axis.x + (velocity.y + turn.z * x - turn.x * z) * axis.y +
           (velocity.z + turn.x * y - turn.y * x) * axis.z;
}

// Velocity of the wheel relative to the rail along an axis, m/s.
template <class T, class P, class A>
auto relative_velocity(const RigidMotion<T>& v, const Vec<P>& point, const Vec<A>& axis) {
    return velocity_along(v.wheel, point, axis) - velocity_along(v.rail, point, axis);
}

// Angular velocity rad/s of the wheel relative to the rail about the upward normal, opposite to an outward axis.
template <class T, class A>
auto relative_rotation(const RigidMotion<T>& v, const Vec<A>& axis) {
    auto turn = v.wheel.rotation - v.rail.rotation;
    return -turn.x * axis.x - turn.y * axis.y - turn.z * axis.z;
}

// Rolling speed m/s: mean backward velocity of both bodies' material at a point.
template <class T, class P, class A>
auto rolling_speed(const RigidMotion<T>& v, const Vec<P>& point, const Vec<A>& forward) {
    return -0.5 * (velocity_along(v.wheel, point, forward) + velocity_along(v.rail, point, forward));
}

// Longitudinal and lateral creepage, and spin 1/m.
template <class T>
struct Creepages {
    T longitudinal{}, lateral{}, spin{};
};

// Creepages at a point m with axes, longitudinal, lateral and outward; zero without rolling.
template <class T, class P, class A, class S>
auto creepages(const RigidMotion<T>& v, const Vec<P>& point, const Vec<A> (&axes)[3], const S& speed) {
    using R = decltype(T{} * P{} * A{} * S{});
    if (!(value(speed) > 0.0)) return Creepages<R>{};
    return Creepages<R>{relative_velocity(v, point, axes[0]) / speed, relative_velocity(v, point, axes[1]) / speed,
                        relative_rotation(v, axes[2]) / speed};
}

}  // namespace wr
