// Pose and motion of the left-hand pairs of wheelsets, and their derivatives by the wheelsets' states.
#pragma once
#include <array>
#include <tuple>

#include "contact/kinematics/core/motion.hpp"

namespace wr {

constexpr int COORDINATES = 9;  // of `WheelsetState`, the first of its values
constexpr int STATE = 17;       // values of a `WheelsetState`
constexpr int OWN = 15;         // values that one pair depends on

using Dimensions = std::array<double, 3>;  // m: wheel_y, rail_y and radius of a `Mounting`

// Pose and motion of a wheel as that of a left-hand pair in the frame of its rail, and the reference point of moments
// m.
template <class T>
struct LeftPair {
    Pose<T> pose;
    RigidMotion<T> motion;
    Vec<T> centre;
};

// Poses and motions of w wheels.
struct WheelPairs {
    Array<double, 2> origin;    // (w, 3) m of the wheels' frames
    Array<double, 3> rotation;  // (w, 3, 3)
    Array<double, 3> motion;    // (w, 6, 3), in the order of `RigidVelocities`
    Array<double, 2> centre;    // (w, 3) m
    Array<double, 1> plan;      // (w,) 1/m, curvatures of the rails

    WheelPairs() = default;
    explicit WheelPairs(long w) : origin(w, 3), rotation(w, 3, 3), motion(w, 6, 3), centre(w, 3), plan(w) {}
    auto fields() { return std::tie(origin, rotation, motion, centre, plan); }
    bool fits() const {
        long w = origin.size();
        return origin.shape[1] == 3 && rotation.shape == std::array<long, 3>{w, 3, 3} &&
               motion.shape == std::array<long, 3>{w, 6, 3} && centre.shape == origin.shape && plan.size() == w;
    }
    long size() const { return origin.size(); }
    LeftPair<double> operator[](long i) const {
        Blocks all = motion;
        Rows turned = Blocks(rotation)[i], rows = all[i];
        auto row = [&](long k) { return vec_of(rows[k]); };
        return {pose_of(Rows(origin)[i], turned, plan(i)),
                {{row(0), row(1), row(2)}, {row(3), row(4), row(5)}},
                vec_of(Rows(centre)[i])};
    }
    void store(long i, const LeftPair<double>& pair) const {
        auto put = [](const View<double, 1>& to, const Vec<double>& a) { to(0) = a.x, to(1) = a.y, to(2) = a.z; };
        const auto& [x, y, z] = pair.pose.rotation;
        put(origin[i], pair.pose.origin), put(centre[i], pair.centre);
        plan(i) = pair.pose.plan;
        put(rotation[i][0], {x.x, y.x, z.x}), put(rotation[i][1], {x.y, y.y, z.y}),
            put(rotation[i][2], {x.z, y.z, z.z});
        long k = 0;
        for (const auto* body : {&pair.motion.wheel, &pair.motion.rail})
            for (const auto* part : {&body->velocity, &body->rotation, &body->reference}) put(motion[i][k++], *part);
    }
};

// Inputs of the left-hand pair: 13 values of a `WheelsetState` (17,) and the displacement y, z m of its rail. Dual
// numbers vary by the coordinates. mirror: whether the pair is the mirror image in y = 0 of the right-hand one.
template <class T>
std::array<T, OWN> left_state(const Numbers& values, bool mirror) {
    std::array<T, OWN> own;
    for (int k = 0; k < OWN; ++k) own[k] = k < COORDINATES ? variable<T>(values(k), k) : T(values(k));
    if (mirror) {
        for (int k : {0, 2, 3, 4, 6, 7, 10, 12}) own[k] = -own[k];
        own[13] = -values(15), own[14] = values(16);
    }
    return own;
}

// Pose and motion in the left rail's frame (parallel to the track frame), eq. (5), of what `left_state` gives. The
// centre is that of the wheelset.
template <class T>
LeftPair<T> left_pair(const std::array<T, OWN>& own, const Dimensions& dimensions) {
    using std::sin, std::cos;
    double wheel_y = dimensions[0];
    T y = own[0], z = dimensions[2] + own[1], rail_y = dimensions[1] + own[13], rail_z = own[14], none(0.0);
    T c = cos(own[2]), s = sin(own[2]), cy = cos(own[3]), sy = sin(own[3]);
    Matrix<T> axes{{cy, sy, none}, {-sy * c, cy * c, s}, {sy * s, -cy * s, c}};
    const auto& axle = axes.y;
    LeftPair<T> pair;
    pair.centre = {none, y - rail_y, z - rail_z};
    pair.pose = {{wheel_y * axle.x, y + wheel_y * axle.y - rail_y, z + wheel_y * axle.z - rail_z}, axes};
    pair.motion.wheel = {{none, own[4], own[5]},
                         {own[6] * cy + own[8] * axle.x, own[6] * sy + own[8] * axle.y, own[7] + own[8] * axle.z},
                         pair.centre};
    // The rail is at rest in inertial space: in the moving frame it moves backwards and rotates against the frame.
    pair.motion.rail = {{-own[9], none, none}, {-own[10], -own[11], -own[12]}, {none, -rail_y, -rail_z}};
    pair.pose.plan = plan_curvature(pair.motion.rail);
    return pair;
}

// Pairs of one side of w wheelsets as left-hand ones, with moments about the wheelsets' centres.
//
// Parameters: values (w, 17) of `WheelsetState`, dimensions, and whether the side is the right one.
inline WheelPairs left_pairs(const Rows& states, const Dimensions& dimensions, bool mirror) {
    WheelPairs pairs(states.size());
    for (long i = 0; i < states.size(); ++i)
        pairs.store(i, left_pair(left_state<double>(states[i], mirror), dimensions));
    return pairs;
}

// Derivatives (6, 9) of force and moment by the wheelset's coordinates, from derivatives by the wheel's pose.
//
// Parameters:
//     tangent: (6, 12), about the wheelset's centre, of the left-hand pair, as `ContactResult.tangent`: by translation
//         and rotation of the wheel, its velocity and angular velocity. The wheelset rotates about its centre, which
//         remains the reference point of the wheel's motion.
//     wrench: (6,) N and N m of the wheel itself.
//     values: (17,) of the `WheelsetState`.
//     wheel_y: m, from the wheelset's centre to the wheel.
//     mirror: whether the wheel is the right one: the mirror image of its pair.
//     result: filled. The centre, about which the moment is, moves with y and z.
inline void store_by_state(const Rows& tangent, const Numbers& wrench, const Numbers& values, double wheel_y,
                           bool mirror, const View<double, 2>& result) {
    using T = Dual<COORDINATES>;
    auto pair = left_pair(left_state<T>(values, mirror), {wheel_y, 0.0, 0.0});
    const auto& [origin, rotation, plan] = pair.pose;
    auto turned = small_rotation(value(rotation), rotation);
    const Vec<T>* parts[] = {&origin, &turned, &pair.motion.wheel.velocity, &pair.motion.wheel.rotation};
    for (int r = 0; r < 6; ++r) {
        bool odd = mirror && (r == 1 || r == 3 || r == 5);  // of a mirror image change Fy, Mx and Mz
        for (int k = 0; k < COORDINATES; ++k) {
            double total = 0.0;
            for (int p = 0; p < 4; ++p) {
                total += tangent(r, 3 * p) * parts[p]->x.d[k];
                total += tangent(r, 3 * p + 1) * parts[p]->y.d[k];
                total += tangent(r, 3 * p + 2) * parts[p]->z.d[k];
            }
            result(r, k) = odd ? -total : total;
        }
    }
    double x = wrench(0), y = wrench(1), z = wrench(2);
    result(3, 0) -= z, result(5, 0) += x;  // F x e_y
    result(3, 1) += y, result(4, 1) -= x;  // .. and F x e_z
}

// Derivatives (w, 6, 9) of forces and moments by coordinates of the wheelsets; parameters of `store_by_state`.
inline Array<double, 3> by_states(const Blocks& tangents, const Rows& wrenches, const Rows& states, double wheel_y,
                                  bool mirror) {
    Array<double, 3> result(states.size(), 6, COORDINATES);
    for (long i = 0; i < states.size(); ++i)
        store_by_state(tangents[i], wrenches[i], states[i], wheel_y, mirror, result[i]);
    return result;
}

}  // namespace wr
