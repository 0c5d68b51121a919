// Forces of the wheels of one side on moved rails, in one call, and their derivatives.
#pragma once
#include "contact/kinematics/core/moved_pair.hpp"
#include "contact/models/standard/core/wheel_tangents.hpp"

namespace wr {

// Pairs, axes (w, 3, 3) of their rails, and forces and moments about the wheelsets' centres in the track's axes,
// of right wheels those in the mirror y = 0.
inline std::tuple<WheelPairs, Array<double, 3>, WheelForces> moved_forces(const Parameters& p,
                                                                          const MovedStates& states) {
    auto [pairs, rails] = moved_pairs(states);
    auto forces = wheel_forces(p, pairs, false);
    double sign = states.mirror ? -1.0 : 1.0;
    for (long i = 0; i < states.size(); ++i) {
        auto rail = matrix_of(Blocks(rails)[i]);
        auto own = forces.wrench[i];
        auto force = rail * vec_of(own.part(0, 3)), moment = rail * vec_of(own.part(3, 6));
        own(0) = force.x, own(1) = sign * force.y, own(2) = force.z;
        own(3) = sign * moment.x, own(4) = moment.y, own(5) = sign * moment.z;
    }
    return {std::move(pairs), std::move(rails), std::move(forces)};
}

// Derivatives (m, 6, 18) of forces and moments of left-hand wheels, with states (m,) of the wheels; zero for wheels
// without contact; other parameters as for `wheel_tangents`, forces from `moved_forces`.
inline Array<double, 3> moved_tangents(const Parameters& p, const WheelPairs& pairs, const WheelForces& forces,
                                       const Indices& wheels, const MovedStates& states) {
    auto tangents = wheel_tangents(p, pairs, forces, wheels);
    Array<double, 2> wrenches(wheels.size(), 6);
    double sign = states.mirror ? -1.0 : 1.0;
    for (long m = 0; m < wheels.size(); ++m) {
        if (wheels(m) < 0) continue;
        auto wrench = forces.wrench[wheels(m)];
        for (int k = 0; k < 6; ++k) wrenches(m, k) = (k == 1 || k == 3 || k == 5 ? sign : 1.0) * wrench(k);
        about_centre(tangents[m], pairs.centre[wheels(m)]);
    }
    return moved_slopes(states, tangents, wrenches);
}

}  // namespace wr
