// Energy of the bodies and the powers that change it, relative to the frames of the track at their own distances.
#pragma once
#include <tuple>

#include "vehicle/multibody/core/vehicle.hpp"

namespace wr {

// Kinetic energy J of the motion in the frames; powers W of contacts, weight, guidance (the accelerations of the frames) and
// applied loads.
struct EnergyRates {
    double kinetic = 0.0, contacts = 0.0, weight = 0.0, guidance = 0.0, applied = 0.0;
};

inline EnergyRates energy_rates(const Vehicle& vehicle, const Travel<double>& travel, const double* state,
                                const double* sections, const double* contacts) {
    EnergyRates sum;
    auto all = vehicle.body_states(travel, state, sections);
    auto applied = vehicle.loads(all);
    for (int i = 0; i < vehicle.count(); ++i) {
        const auto& [body, at, f, c] = std::tie(vehicle.bodies[i], all[i], all[i].frame, applied[i]);
        const double *w = contacts + 6 * i, path = travel.acceleration;
        auto velocity = f.offset_rate, turn = f.yaw_rate + f.roll_rate + at.rate[4] * f.axle;
        auto own = back(f.rotation, turn), whole = back(f.rotation, at.angular());
        auto change = convective_turn(at, path);
        if (body.wheelset) change = change + (path / vehicle.radius) * f.axle;
        auto moment = times(body.inertia, back(f.rotation, change)) + cross(whole, times(body.inertia, whole));
        sum.kinetic += 0.5 * (body.mass * dot(velocity, velocity) + dot(own, times(body.inertia, own)));
        sum.contacts += dot(Vec<double>{w[0], w[1], w[2]}, velocity) + dot(Vec<double>{w[3], w[4], w[5]}, turn);
        sum.weight -= vehicle.gravity * body.mass * dot(back(at.section.axes, Vec<double>{0.0, 0.0, 1.0}), velocity);
        sum.guidance -= body.mass * dot(convective(at, path), velocity) + dot(moment, own);
        sum.applied += dot(back(at.section.axes, c.force), velocity) + dot(back(at.section.axes, c.moment), turn);
    }
    return sum;
}

}  // namespace wr
