// Derivatives of the forces of wheels on rails by pose and motion: the functions of the forces with dual numbers.
#pragma once
#include "contact/models/standard/core/region_derivatives.hpp"
#include "contact/models/standard/core/wheel_rail.hpp"

namespace wr {

constexpr int CHANGES = 12;  // six rigid motions of the wheel, changes of its velocity and of its angular velocity
using ByMotion = Dual<CHANGES>;

inline ByMotion by_motion(const ByPose& a) { return widened<CHANGES>(a, 0); }
inline Vec<ByMotion> by_motion(const Vec<ByPose>& a) { return {by_motion(a.x), by_motion(a.y), by_motion(a.z)}; }

inline Array<ByMotion, 1> by_motion(const Array<ByPose, 1>& all) {
    Array<ByMotion, 1> wider(all.size());
    std::transform(all.begin(), all.end(), wider.begin(), [](const ByPose& a) { return by_motion(a); });
    return wider;
}

inline std::vector<Frame<ByMotion>> by_motion(const std::vector<Frame<ByPose>>& all) {
    std::vector<Frame<ByMotion>> wider(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        wider[i].point = by_motion(all[i].point);
        for (int a = 0; a < 3; ++a) wider[i].axes[a] = by_motion(all[i].axes[a]);
    }
    return wider;
}

inline Pressures<ByMotion> by_motion(const Pressures<ByPose>& p) {
    Pressures<ByMotion> wider;
    wider.contact = p.contact, wider.s = by_motion(p.s), wider.x = by_motion(p.x);
    wider.width = by_motion(p.width), wider.half = by_motion(p.half), wider.scale = by_motion(p.scale);
    wider.load = by_motion(p.load), wider.along = by_motion(p.along), wider.across = by_motion(p.across);
    return wider;
}

// Motion that varies; the reference point of the wheel's moves with its frame.
inline RigidMotion<ByMotion> varied(const RigidMotion<double>& motion, const Pose<double>& pose) {
    auto constant = [](const Vec<double>& a) { return vec_as<ByMotion>(a); };
    auto variables = [](const Vec<double>& a, int first) {
        return Vec<ByMotion>{variable<ByMotion>(a.x, first), variable<ByMotion>(a.y, first + 1),
                             variable<ByMotion>(a.z, first + 2)};
    };
    auto arm = motion.wheel.reference - pose.origin;
    auto moved = varied<ByMotion>(pose);
    Vec<ByMotion> none{}, turn = variables({}, 3);
    return {{variables(motion.wheel.velocity, MOTIONS), variables(motion.wheel.rotation, MOTIONS + 3),
             moved.origin + (constant(arm) + cross(turn, arm))},
            {constant(motion.rail.velocity), constant(motion.rail.rotation), constant(motion.rail.reference) + none}};
}

// Derivative (6, 12) of force and moment about the rail's origin of a wheel, with FASTSIM or without friction; filled.
inline void store_tangent(const Parameters& p, const LeftPair<double>& own, const WheelRegions& found,
                          const View<double, 2>& tangent) {
    auto zones = VariedRegions(p.pair(), own.pose, p.lines.s, p.merge, found).regions();
    auto strips = virtual_penetration(zones, p.elastic.E_star);
    auto frames = strip_frames(p.pair(), varied<ByPose>(own.pose), zones, strips);
    PatchFrames<ByMotion> moved{by_motion(frames.middles), by_motion(frames.peaks)};
    auto sum = strip_loads(by_motion(strips), by_motion(zones.weight), moved, varied(own.motion, own.pose),
                           p.friction());
    const ByMotion* rows[] = {&sum.force.x,  &sum.force.y,  &sum.force.z,
                              &sum.moment.x, &sum.moment.y, &sum.moment.z};
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

// Derivatives (m, 6, 9) of forces and moments by the coordinates of wheelsets with these states (m, 17) and dimensions;
// mirror: whether they are the right wheels.
inline Array<double, 3> tangents_in_states(const Parameters& p, const WheelPairs& pairs, const WheelForces& forces,
                                           const Indices& wheels, const Rows& states, const Dimensions& dimensions,
                                           bool mirror) {
    auto tangents = wheel_tangents(p, pairs, forces, wheels);
    Array<double, 2> wrenches(wheels.size(), 6);
    for (long m = 0; m < wheels.size(); ++m) {
        if (wheels(m) < 0) continue;
        auto wrench = forces.wrench[wheels(m)], c = pairs.centre[wheels(m)];
        std::copy(wrench.begin(), wrench.end(), wrenches[m].begin());
        auto own = tangents[m];
        for (int q = 0; q < CHANGES; ++q) {  // about the wheelsets' centres
            auto moment = cross(vec_of(c), Vec<double>{own(0, q), own(1, q), own(2, q)});
            own(3, q) -= moment.x, own(4, q) -= moment.y, own(5, q) -= moment.z;
        }
    }
    return by_states(tangents, wrenches, states, dimensions[0], mirror);
}

}  // namespace wr
