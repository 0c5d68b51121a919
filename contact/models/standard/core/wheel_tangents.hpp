// Derivatives of the forces of wheels on rails by pose and motion: the functions of the forces with dual numbers.
#pragma once
#include "contact/models/standard/core/region_derivatives.hpp"
#include "contact/models/standard/core/wheel_rail.hpp"

namespace wr {

using ByMotion = Dual<CHANGES>;

// Motion of wheel and rail, which varies with the pose (the reference point of the wheel's moves with its frame) and in
// itself: products with places and axes, which vary with the pose only, have six directions instead of twelve.
struct VariedMotion {
    RigidMotion<ByPose> with_pose;  // by the six rigid motions
    RigidMotion<ByPose> by_itself;  // by velocity and angular velocity of the wheel
};

inline VariedMotion varied(const RigidMotion<double>& motion, const Pose<double>& pose) {
    auto constant = [](const Vec<double>& a) { return vec_as<ByPose>(a); };
    auto variables = [](const Vec<double>& a, int first) {
        return Vec<ByPose>{variable<ByPose>(a.x, first), variable<ByPose>(a.y, first + 1),
                           variable<ByPose>(a.z, first + 2)};
    };
    const auto& [wheel, rail] = motion;
    auto arm = wheel.reference - pose.origin;
    Twist<ByPose> other{constant(rail.velocity), constant(rail.rotation), constant(rail.reference)};
    return {{{constant(wheel.velocity), constant(wheel.rotation),
              variables(wheel.reference, 0) + cross(variables({}, 3), arm)},
             other},
            {{variables(wheel.velocity, 0), variables(wheel.rotation, 3), constant(wheel.reference)}, other}};
}

// One number of both derivatives.
inline ByMotion joined(const ByPose& with_pose, const ByPose& by_itself) {
    ByMotion r = as<ByMotion>(with_pose);
    std::copy(by_itself.d, by_itself.d + MOTIONS, r.d + MOTIONS);
    return r;
}

inline ByMotion speed_at(const VariedMotion& v, const Frame<ByPose>& at) {
    return joined(rolling_speed(v.with_pose, at.point, at.axes[0]),
                  rolling_speed(v.by_itself, value(at.point), value(at.axes[0])));
}

inline Creepages<ByMotion> creepages_at(const VariedMotion& v, const Frame<ByPose>& at, const ByMotion& speed) {
    if (!(value(speed) > 0.0)) return {};
    Vec<double> axes[] = {value(at.axes[0]), value(at.axes[1]), value(at.axes[2])};
    auto a = creepages(v.with_pose, at.point, at.axes, 1.0), b = creepages(v.by_itself, value(at.point), axes, 1.0);
    return {joined(a.longitudinal, b.longitudinal) / speed, joined(a.lateral, b.lateral) / speed,
            joined(a.spin, b.spin) / speed};
}

// Derivative (6, 12) of force and moment about the rail's origin of a wheel, with FASTSIM or without friction; filled.
inline void store_tangent(const Parameters& p, const LeftPair<double>& own, const WheelRegions& found,
                          const View<double, 2>& tangent) {
    auto zones = VariedRegions(p.pair(), own.pose, p.lines.s, p.merge, found).regions();
    auto strips = virtual_penetration(zones, p.elastic.E_star);
    auto frames = strip_frames(p.pair(), varied<ByPose>(own.pose), zones, strips);
    auto sum = strip_loads<ByMotion>(strips, zones.weight, frames, varied(own.motion, own.pose), p.friction());
    const ByMotion* rows[] = {&sum.force.x, &sum.force.y, &sum.force.z, &sum.moment.x, &sum.moment.y, &sum.moment.z};
    for (int r = 0; r < 6; ++r) std::copy(rows[r]->d, rows[r]->d + CHANGES, tangent[r].begin());
}

// Derivatives (m, 6, 12) of forces and moments about the rail's origin, with FASTSIM or without friction; zero for
// wheels without contact.
//
// Parameters: as for `wheel_forces`; the forces at these poses and motions; indices (m,) of the wheels, -1: none,
// without contact.
inline Array<double, 3> wheel_tangents(const Parameters& p, const WheelPairs& pairs, const WheelForces& forces,
                                       const Indices& wheels) {
    Array<double, 3> tangents(wheels.size(), 6, CHANGES);
    for (long m = 0; m < wheels.size(); ++m)
        if (long i = wheels(m); i >= 0 && forces.touches(i))
            store_tangent(p, pairs[i], regions_of(forces, i), tangents[m]);
    return tangents;
}

// Turn derivatives (6, 12) about the rail's origin into those about a constant centre (3,) m.
inline void about_centre(const View<double, 2>& tangent, const Numbers& centre) {
    for (int q = 0; q < CHANGES; ++q) {
        auto moment = cross(vec_of(centre), Vec<double>{tangent(0, q), tangent(1, q), tangent(2, q)});
        tangent(3, q) -= moment.x, tangent(4, q) -= moment.y, tangent(5, q) -= moment.z;
    }
}

// Derivatives (m, 6, 9) of forces and moments by wheelset coordinates, for states (m, 17) and dimensions; mirror:
// whether they are the right wheels.
inline Array<double, 3> tangents_in_states(const Parameters& p, const WheelPairs& pairs, const WheelForces& forces,
                                           const Indices& wheels, const Rows& states, const Dimensions& dimensions,
                                           bool mirror) {
    auto tangents = wheel_tangents(p, pairs, forces, wheels);
    Array<double, 2> wrenches(wheels.size(), 6);
    for (long m = 0; m < wheels.size(); ++m) {
        if (wheels(m) < 0) continue;
        auto wrench = forces.wrench[wheels(m)], c = pairs.centre[wheels(m)];
        std::copy(wrench.begin(), wrench.end(), wrenches[m].begin());
        about_centre(tangents[m], c);
    }
    return by_states(tangents, wrenches, states, dimensions[0], mirror);
}

}  // namespace wr
