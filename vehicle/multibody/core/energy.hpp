// Energy of the bodies and the powers of its change, relative to the frames of the track at their own distances.
#pragma once
#include <algorithm>
#include <tuple>

#include "vehicle/multibody/core/vehicle.hpp"

namespace wr {

// Kinetic energy J of the motion in the frames, and that of springs and static loads, zero in the nominal position;
// powers W of contacts, dampers, weight, the accelerations and relative motion of the frames, applied loads, friction.
struct EnergyRates {
    double kinetic = 0.0, elastic = 0.0, contacts = 0.0, dampers = 0.0, weight = 0.0, inertial = 0.0, applied = 0.0,
           friction = 0.0;
};

inline void add_direction(const Vehicle& vehicle, const Direction& d, double x, double rate, double series,
                          double series_rate, double flow, EnergyRates& sum) {
    sum.elastic += 0.5 * d.spring * x * x + (d.spring_law >= 0 ? vehicle.laws[d.spring_law].energy(x) : 0.0);
    if (d.series >= 0) {
        double tension = d.series_stiffness * series;
        sum.elastic += 0.5 * tension * series;
        if (d.surge.flow >= 0)
            sum.kinetic += 0.5 * d.surge.mass * flow * flow, sum.dampers -= surge_force(d, vehicle.laws, flow) * flow;
        else
            sum.dampers -= tension * (rate - series_rate);
    } else {
        sum.dampers -= (d.damper_law >= 0 ? vehicle.laws[d.damper_law](rate) : d.damper * rate) * rate;
    }
}

inline void add_friction(const Friction& f, double x, double rate, double slider, double limit, EnergyRates& sum) {
    if (f.slider < 0) return;
    double spring = f.stiffness * (x - slider), force = std::min(std::abs(spring), limit);
    sum.elastic += 0.5 * force * force / f.stiffness;
    if (slides(spring, limit, rate)) sum.friction -= force * std::abs(rate);
}

// Energies and powers of all elements and springs; adds their forces and moments on the bodies, in common axes, to
// total. Returns the power W that deflects them.
inline double add_suspension(const Vehicle& vehicle, const std::vector<BodyState<double>>& all, const double* state,
                             std::vector<Wrench<double>>& total, EnergyRates& sum) {
    double deflecting = 0.0;
    auto act = [&](int u, int l, const auto& force, const auto& on_upper, const auto& on_lower) {
        total[u].add(force, on_upper), total[l].add(-1.0 * force, -1.0 * on_lower);
    };
    auto each = [&](const Element& e, const ElementState<double>& s) {
        auto internal = vehicle.internal_of<double>(e, state);
        const auto& [series, slider, flow] = internal;
        const auto& [x, rate, turning] = std::tie(s.deflection, s.deflection_rate, s.series_rate);
        add_direction(vehicle, e.directions[0], x.x, rate.x, series.x, turning.x, flow.x, sum);
        add_direction(vehicle, e.directions[1], x.y, rate.y, series.y, turning.y, flow.y, sum);
        add_direction(vehicle, e.directions[2], x.z, rate.z, series.z, turning.z, flow.z, sum);
        add_friction(e.directions[0].friction, x.x, rate.x, slider.x, s.friction_limit.x, sum);
        add_friction(e.directions[1].friction, x.y, rate.y, slider.y, s.friction_limit.y, sum);
        add_friction(e.directions[2].friction, x.z, rate.z, slider.z, s.friction_limit.z, sum);
        sum.elastic -= e.static_load * x.z;
        deflecting += dot(s.own_force, rate);
    };
    vehicle.suspension<double>(state, [&](int i, int) -> const Motion<double>& { return all[i].motion; }, act, each);
    for (const auto& spring : vehicle.springs) {
        const auto &upper = all[spring.upper].motion, &lower = all[spring.lower].motion;
        auto turned = rotation_vector(relative(lower.axes, upper.axes)),
             rate = back(lower.axes, upper.rate - lower.rate);
        sum.elastic += 0.5 * dot(turned, times(spring.stiffness, turned));
        sum.dampers -= dot(rate, times(spring.damping, rate));
        deflecting += dot(spring_moment(spring, upper, lower), upper.rate - lower.rate);
    }
    return deflecting;
}

// Power W that the suspension takes from the relative motion of its bodies' frames. In transitions frames of bodies
// at different places turn against each other, and elements deflect without any motion of bodies in their frames.
// Parameters: total, forces and moments of the suspension on the bodies, in common axes; deflecting, W.
inline double power_of_frames(const std::vector<BodyState<double>>& all, const std::vector<Wrench<double>>& total,
                              double deflecting) {
    double within = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const auto& [axes, f] = std::tie(all[i].section.axes, all[i].frame);
        within += dot(back(axes, total[i].force), f.offset_rate) + dot(back(axes, total[i].moment), all[i].turning());
    }
    return within - deflecting;
}

inline EnergyRates energy_rates(const Vehicle& vehicle, const Travel<double>& travel, const double* state,
                                const double* sections, const double* contacts) {
    EnergyRates sum;
    auto all = vehicle.body_states(travel, state, sections);
    auto applied = vehicle.loads(all);
    std::vector<Wrench<double>> total(all.size());
    double deflecting = add_suspension(vehicle, all, state, total, sum);
    sum.inertial += power_of_frames(all, total, deflecting);
    for (int i = 0; i < vehicle.count(); ++i) {
        const auto& [body, at, f, c] = std::tie(vehicle.bodies[i], all[i], all[i].frame, applied[i]);
        const double* w = contacts + 6 * i;
        Wrench<double> contact{{w[0], w[1], w[2]}, {w[3], w[4], w[5]}}, whole_load = total[i];
        whole_load.add(c.force, c.moment);
        double own_rates[6];
        vehicle.accelerate_body(i, at, whole_load, contact, own_rates);
        double path = travel.acceleration + (body.held[0] ? 0.0 : own_rates[0]);  // of the frame, along the track
        auto velocity = f.offset_rate, turn = at.turning();
        auto own = back(f.rotation, turn), whole = back(f.rotation, at.angular());
        auto change = convective_turn(at, path);
        if (body.wheelset) change = change + (travel.acceleration / vehicle.radius) * f.axle;
        auto moment = times(body.inertia, back(f.rotation, change)) + cross(whole, times(body.inertia, whole));
        sum.kinetic += 0.5 * (body.mass * dot(velocity, velocity) + dot(own, times(body.inertia, own)));
        sum.contacts += dot(contact.force, velocity) + dot(contact.moment, turn);
        sum.weight -= vehicle.gravity * body.mass * dot(back(at.section.axes, Vec<double>{0.0, 0.0, 1.0}), velocity);
        sum.inertial -= body.mass * dot(convective(at, path), velocity) + dot(moment, own);
        sum.applied += dot(back(at.section.axes, c.force), velocity) + dot(back(at.section.axes, c.moment), turn);
    }
    return sum;
}

}  // namespace wr
