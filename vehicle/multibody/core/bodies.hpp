// Motion of a rigid body in the track frame at its own distance, and its accelerations: docs/theory/multibody.md.
#pragma once
#include "vehicle/multibody/core/track.hpp"

namespace wr {

struct Body {
    double place, height;  // m, of the centre of mass along the vehicle and above top of rail
    double mass;           // kg
    Vec<double> inertia;   // kg m2
    bool wheelset;
    std::array<bool, 6> held;  // coordinates
};

// Reference motion along the track: distance m, speed m/s, acceleration m/s2; and time s.
template <class T>
struct Travel {
    T distance, speed, acceleration, time;
};

// Position m, velocity m/s, axes and their angular velocity rad/s of a body, in common axes.
template <class T>
struct Motion {
    Vec<T> position, velocity;
    Matrix<T> axes;
    Vec<T> rate;
};

// Motion of a body in its track frame.
template <class T>
struct Frame {
    T speed;                     // m/s of the frame along the track
    Vec<T> offset, offset_rate;  // centre of mass from the centre line, m, and its rate in the frame, m/s
    Vec<T> rate;                 // rad/s, of the frame
    Vec<T> yaw_rate, roll_rate;  // rad/s
    Vec<T> roll_axis, axle;      // axes of roll and spin
    T spin;                      // rad/s about the axle
    Matrix<T> rotation;          // axes of the body; those of wheelsets do not spin
};

// A body with its coordinates q and their rates at a section of the track.
template <class T>
struct BodyState {
    T q[6], rate[6];
    Travel<T> travel;
    Section<T> section;
    Frame<T> frame;
    Motion<T> motion;

    void complete(const Body& body, double radius) {
        using std::sin, std::cos;
        T cr = cos(q[3]), sr = sin(q[3]), cy = cos(q[5]), sy = sin(q[5]), zero(0.0), speed = travel.speed + rate[0];
        T pitch = body.wheelset ? zero : q[4];
        Vec<T> roll_axis{cy, sy, zero}, axle{-sy * cr, cy * cr, sr};
        T spin = body.wheelset ? rate[4] + travel.speed / radius : rate[4];
        frame = {speed,
                 {zero, q[1], body.height + q[2]},
                 {zero, rate[1], rate[2]},
                 speed * section.rate,
                 {zero, zero, rate[5]},
                 rate[3] * roll_axis,
                 roll_axis,
                 axle,
                 spin,
                 body_rotation(q[3], pitch, q[5])};
        auto velocity = frame.offset_rate + cross(frame.rate, frame.offset);
        velocity.x += speed;
        auto turn = frame.rate + frame.roll_rate + frame.yaw_rate;
        if (!body.wheelset) turn = turn + spin * axle;
        motion = {section.position + section.axes * frame.offset, section.axes * velocity,
                  section.axes * frame.rotation, section.axes * turn};
    }

    // Angular velocity rad/s of the body against the track frame, less that of nominal rolling, in the axes of the
    // frame.
    Vec<T> turning() const { return frame.yaw_rate + frame.roll_rate + rate[4] * frame.axle; }

    // Angular velocity rad/s of the body, spin included, in the track frame.
    Vec<T> angular() const { return frame.rate + frame.yaw_rate + frame.roll_rate + frame.spin * frame.axle; }
};

// Acceleration m/s2 of a body whose coordinates do not accelerate, path m/s2 along the track, in its track frame.
template <class T>
Vec<T> convective(const BodyState<T>& at, const T& path) {
    const auto& f = at.frame;
    auto change = path * at.section.rate + (f.speed * f.speed) * at.section.rate_slope;
    return cross(change, f.offset) + cross(f.rate, cross(f.rate, f.offset)) + 2.0 * cross(f.rate, f.offset_rate) +
           Vec<T>{T(0.0), f.speed * f.rate.z, -f.speed * f.rate.y};
}

// Angular acceleration rad/s2 of a body whose coordinates do not accelerate.
template <class T>
Vec<T> convective_turn(const BodyState<T>& at, const T& path) {
    const auto& f = at.frame;
    auto before_roll = f.rate + f.yaw_rate, before_spin = before_roll + f.roll_rate;
    return path * at.section.rate + (f.speed * f.speed) * at.section.rate_slope + cross(f.rate, f.yaw_rate) +
           (cross(before_roll, f.roll_rate) + cross(before_spin, f.spin * f.axle));
}

// Solution x of d_k . (sum_j m_j x_j - right) = 0 for free coordinates k, x_k nominal for held ones. Results are what
// the coordinates do beside the nominal motion: second derivatives; of held ones what holds them.
template <class T>
Vec<T> constrained(const Matrix<T>& d, const Matrix<T>& m, const Vec<T>& right, const bool* held, const Vec<T>& nominal,
                   T* results) {
    Vec<T> a = held[0] ? Vec<T>{1.0, 0.0, 0.0} : back(m, d.x), b = held[1] ? Vec<T>{0.0, 1.0, 0.0} : back(m, d.y),
           c = held[2] ? Vec<T>{0.0, 0.0, 1.0} : back(m, d.z);
    auto normal = cross(b, c);
    T size = 1.0 / dot(a, normal);
    Vec<T> sides{held[0] ? nominal.x : dot(d.x, right), held[1] ? nominal.y : dot(d.y, right),
                 held[2] ? nominal.z : dot(d.z, right)};
    Vec<T> x = Matrix<T>{size * normal, size * cross(c, a), size * cross(a, b)} * sides;
    auto misfit = m * x - right;
    results[0] = held[0] ? dot(d.x, misfit) : x.x - nominal.x;
    results[1] = held[1] ? dot(d.y, misfit) : x.y - nominal.y;
    results[2] = held[2] ? dot(d.z, misfit) : x.z - nominal.z;
    return x;
}

// Second derivatives (6,) of the coordinates of a body less nominal ones, under a force N and a moment N m in its track
// frame; of held coordinates the generalised forces of their constraints.
template <class T>
void accelerate(const Body& body, double radius, const BodyState<T>& at, const Vec<T>& force, const Vec<T>& moment,
                T* results) {
    const auto& f = at.frame;
    const T &path = at.travel.acceleration, zero(0.0), one(1.0);
    auto lever = cross(at.section.rate, f.offset);
    Matrix<T> along{{1.0 + lever.x, lever.y, lever.z}, {zero, one, zero}, {zero, zero, one}};
    auto linear = constrained(along, {body.mass * along.x, body.mass * along.y, body.mass * along.z},
                              force - body.mass * convective(at, zero), body.held.data(), {path, zero, zero}, results);

    Vec<T> vertical{zero, zero, one};
    auto angular = back(f.rotation, at.angular());
    auto free = back(f.rotation, moment) - cross(angular, times(body.inertia, angular)) -
                times(body.inertia, back(f.rotation, convective_turn(at, linear.x)));
    Matrix<T> turn{back(f.rotation, f.roll_axis), back(f.rotation, f.axle), back(f.rotation, vertical)};
    T rolling = body.wheelset ? path / radius : zero;
    constrained(turn, {times(body.inertia, turn.x), times(body.inertia, turn.y), times(body.inertia, turn.z)}, free,
                body.held.data() + 3, {zero, rolling, zero}, results + 3);
}

}  // namespace wr
