// Torques on wheelsets with their reactions, and forces at points of bodies: docs/theory/multibody.md.
#pragma once
#include "vehicle/multibody/core/bodies.hpp"

namespace wr {

// Piecewise linear table over time s or distance m, constant before its first and behind its last point.
struct Table {
    bool by_distance;
    std::vector<double> places, values;

    template <class T>
    T operator()(const T& time, const T& distance) const {
        const T& at = by_distance ? distance : time;
        std::size_t i = 0, last = places.size() - 1;
        while (i < last && value(at) >= places[i + 1]) ++i;
        if (i == last || value(at) < places[i]) return T(values[i]);
        return values[i] + (values[i + 1] - values[i]) / (places[i + 1] - places[i]) * (at - places[i]);
    }
};

struct Torque {
    int wheelset, reaction;  // bodies
    bool brake;              // whether it is that of a friction brake
    Table size;              // N m
};

struct Force {
    int body;
    Vec<double> arm;                  // m, from the centre of mass, in the body's axes
    std::array<Table, 3> components;  // N, along the axes of the section
};

// Torque N m about the axle on a wheelset; below a rate of rotation, release rad/s, that of a brake falls to zero.
template <class T>
T axle_torque(const Torque& torque, const BodyState<T>& wheelset, const Motion<T>& other, double radius,
              double release) {
    T size = torque.size(wheelset.travel.time, wheelset.travel.distance + wheelset.q[0]);
    if (!torque.brake) return size;
    T spin = wheelset.rate[4] + wheelset.travel.speed / radius +
             dot(wheelset.motion.rate - other.rate, wheelset.motion.axes.y);
    if (value(spin) > release) return -size;
    return value(spin) > -release ? -(size * spin) / release : size;
}

// Components N of a force along the axes of the section.
template <class T>
Vec<T> components(const Force& force, const BodyState<T>& body) {
    const T& time = body.travel.time;
    T distance = body.travel.distance + body.q[0];
    return {force.components[0](time, distance), force.components[1](time, distance),
            force.components[2](time, distance)};
}

// Moment N m of a force about the centre of its body; on a wheelset, whose bearings turn, none about the axle.
template <class T>
Vec<T> force_moment(const Force& force, const Motion<T>& motion, bool wheelset, const Vec<T>& in_common_axes) {
    auto moment = cross(motion.axes * force.arm, in_common_axes);
    return wheelset ? moment - dot(moment, motion.axes.y) * motion.axes.y : moment;
}

}  // namespace wr
