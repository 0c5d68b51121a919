// Accelerations of all bodies of a vehicle, and their exact derivatives: the same functions with T = double and T =
// Dual.
#pragma once
#include "vehicle/multibody/core/loads.hpp"
#include "vehicle/multibody/core/suspension.hpp"

namespace wr {

// Force N and moment N m about its centre on a body.
template <class T>
struct Wrench {
    Vec<T> force, moment;

    void add(const Vec<T>& f, const Vec<T>& m) { force = force + f, moment = moment + m; }
};

struct Vehicle {
    // Directions of derivatives of a body: its coordinates, their rates, and time; of two bodies, and of springs.
    static constexpr int TIME = 12, OWN = 13, PAIR = 2 * OWN, WITH_SERIES = PAIR + 3, WITH_LOAD = OWN + 6;

    Track track;
    std::vector<Body> bodies;
    std::vector<Law> laws;
    std::vector<Element> elements;
    std::vector<std::array<int, 2>> pairs;  // elements that are mirror images of each other; -1 without
    std::vector<RotationalSpring> springs;
    std::vector<Torque> torques;
    std::vector<Force> forces;
    double radius, gravity, release;  // nominal, m; m/s2; rad/s, see `axle_torque`
    int kept;                         // body whose place the speed hold keeps; -1: none
    double hold_stiffness, hold_damping;
    int internal;  // number of internal variables of elements

    int count() const { return int(bodies.size()); }
    int accelerated() const { return 6 * count() + internal; }
    int states() const { return 12 * count() + internal; }

    // Distance m of the common axes: that of the reference motion, from which a vehicle that runs free drifts far away,
    // to the nearest 100 m.
    static double near(double distance, const double* state) {
        return distance + 100.0 * std::floor(0.01 * state[0] + 0.5);
    }

    Section<double> section(int i, double distance, const double* state) const {
        return track.section(distance + bodies[i].place + state[6 * i], near(distance, state));
    }

    BodyState<double> body_state(int i, const Travel<double>& travel, const double* state,
                                 const Section<double>& section) const {
        BodyState<double> at{{}, {}, travel, section, {}, {}};
        for (int k = 0; k < 6; ++k) at.q[k] = state[6 * i + k], at.rate[k] = state[6 * (count() + i) + k];
        at.complete(bodies[i], radius);
        return at;
    }

    // The same with derivatives; rates: derivative of the reference motion by time.
    template <class T>
    BodyState<T> body_state(int i, const Travel<double>& travel, const Travel<double>& rates,
                            const double* state) const {
        BodyState<T> at;
        for (int k = 0; k < 6; ++k) {
            at.q[k] = variable<T>(state[6 * i + k], k);
            at.rate[k] = variable<T>(state[6 * (count() + i) + k], 6 + k);
        }
        at.travel = {variable<T>(travel.distance, TIME, rates.distance), variable<T>(travel.speed, TIME, rates.speed),
                     variable<T>(travel.acceleration, TIME, rates.acceleration), variable<T>(travel.time, TIME)};
        T s = at.travel.distance + bodies[i].place + at.q[0];
        auto along = track.section(variable<Dual<1>>(value(s), 0), near(travel.distance, state));
        auto at_s = [&s](const Vec<Dual<1>>& a) {
            return Vec<T>{s.chain(a.x.v, a.x.d[0]), s.chain(a.y.v, a.y.d[0]), s.chain(a.z.v, a.z.d[0])};
        };
        at.section = {at_s(along.position),
                      {at_s(along.axes.x), at_s(along.axes.y), at_s(along.axes.z)},
                      at_s(along.rate),
                      at_s(along.rate_slope)};
        at.complete(bodies[i], radius);
        return at;
    }

    // Internal variables of an element.
    template <class T>
    Internal<T> internal_of(const Element& e, const double* state) const {
        const double* own = state + 12 * count();
        auto series = [&](int j) {
            int m = e.directions[j].series;
            return m < 0 ? T(0.0) : variable<T>(own[m], PAIR + j);
        };
        auto slider = [&](int j) {
            int m = e.directions[j].friction.slider;
            return m < 0 ? 0.0 : own[m];
        };
        auto flow = [&](int j) {
            int m = e.directions[j].surge.flow;
            return m < 0 ? 0.0 : own[m];
        };
        return {{series(0), series(1), series(2)}, {slider(0), slider(1), slider(2)}, {flow(0), flow(1), flow(2)}};
    }

    // Calls `act(upper, lower, force, on_upper, on_lower)` for forces and moments between two bodies in common axes,
    // and `each(e, state)` for every element. Those of mirror images are added first: the sums of the mirrored motion
    // are the mirrored sums, bit for bit.
    template <class T, class MotionOf, class Act, class Each>
    void suspension(const double* state, const MotionOf& motion, const Act& act, const Each& each) const {
        for (const auto& pair : pairs) {
            int u = elements[pair[0]].upper, l = elements[pair[0]].lower;
            Motion<T> upper = motion(u, 0), lower = motion(l, 1);
            Vec<T> force, on_upper, on_lower;
            for (int e : pair) {
                if (e < 0) continue;
                auto s = element_state(elements[e], laws, upper, lower, bodies[l].wheelset,
                                       internal_of<T>(elements[e], state));
                force = force + s.force, on_upper = on_upper + s.on_upper, on_lower = on_lower + s.on_lower;
                each(elements[e], s);
            }
            act(u, l, force, on_upper, on_lower);
        }
        for (const auto& spring : springs) {
            auto moment = spring_moment(spring, motion(spring.upper, 0), motion(spring.lower, 1));
            act(spring.upper, spring.lower, Vec<T>{}, moment, moment);
        }
    }

    // Force N along the track that keeps the place of a body in the reference motion.
    template <class T>
    T hold(const BodyState<T>& at) const {
        return -hold_stiffness * at.q[0] - hold_damping * at.rate[0];
    }

    // Second derivatives of the coordinates of a body.
    // Parameters: force and moment of suspension and loads in common axes; contact: in its track frame.
    template <class T>
    void accelerate_body(int i, const BodyState<T>& at, const Wrench<T>& total, const Wrench<T>& contact,
                         T* results) const {
        auto force = total.force;
        force.z = force.z - gravity * bodies[i].mass;
        force = back(at.section.axes, force) + contact.force;
        if (kept == i) force.x += hold(at);
        accelerate(bodies[i], radius, at, force, back(at.section.axes, total.moment) + contact.moment, results);
    }

    std::vector<BodyState<double>> body_states(const Travel<double>& travel, const double* state,
                                               const double* sections) const {
        std::vector<BodyState<double>> all;
        all.reserve(bodies.size());
        for (int i = 0; i < count(); ++i) {
            const double* r = sections + 18 * i;
            auto row = [r](int k) { return Vec<double>{r[3 * k], r[3 * k + 1], r[3 * k + 2]}; };
            all.push_back(body_state(i, travel, state, {row(0), {row(1), row(2), row(3)}, row(4), row(5)}));
        }
        return all;
    }

    // Forces and moments of torques and forces on the bodies, in common axes. Those of a body are added first: a pair
    // at both sides then has the mirrored sum in the mirrored motion, bit for bit.
    std::vector<Wrench<double>> loads(const std::vector<BodyState<double>>& all) const {
        std::vector<Wrench<double>> own(all.size());
        for (const auto& torque : torques) {
            const auto &wheelset = all[torque.wheelset], &other = all[torque.reaction];
            auto moment = axle_torque(torque, wheelset, other.motion, radius, release) * wheelset.motion.axes.y;
            own[torque.wheelset].moment = own[torque.wheelset].moment + moment;
            own[torque.reaction].moment = own[torque.reaction].moment - moment;
        }
        for (const auto& force : forces) {
            const auto& at = all[force.body];
            auto in_common = at.section.axes * components(force, at);
            own[force.body].add(in_common, force_moment(force, at.motion, bodies[force.body].wheelset, in_common));
        }
        return own;
    }

    // Forces and moments of suspension and loads on the bodies, in common axes; fills rates (m,) of the internal
    // variables of elements, of which sliders have none.
    std::vector<Wrench<double>> wrenches(const std::vector<BodyState<double>>& all, const double* state,
                                         double* series_rates) const {
        std::vector<Wrench<double>> total(all.size());
        suspension<double>(
            state, [&](int i, int) -> const Motion<double>& { return all[i].motion; },
            [&](int u, int l, const auto& force, const auto& on_upper, const auto& on_lower) {
                total[u].add(force, on_upper), total[l].add(-1.0 * force, -1.0 * on_lower);
            },
            [&](const Element& e, const ElementState<double>& s) { store_rates(e, s, state, series_rates); });
        auto applied = loads(all);
        for (int i = 0; i < count(); ++i) total[i].add(applied[i].force, applied[i].moment);
        return total;
    }

    // Accelerations (6 n,) of the coordinates less nominal ones, then the rates (m,) of the internal variables
    // of elements. In place of those of held coordinates, which are zero, stand the generalised forces of their
    // constraints. Parameters: state (12 n + m,), sections (n, 6, 3), contacts (n, 2, 3) in the bodies' track frames.
    void accelerations(const Travel<double>& travel, const double* state, const double* sections,
                       const double* contacts, double* results) const {
        auto all = body_states(travel, state, sections);
        auto total = wrenches(all, state, results + 6 * count());
        for (int i = 0; i < count(); ++i) {
            const double* c = contacts + 6 * i;
            accelerate_body(i, all[i], total[i], {{c[0], c[1], c[2]}, {c[3], c[4], c[5]}}, results + 6 * i);
        }
    }

    // Acceleration m/s2 of a surging mass at its velocity m/s, moved by its spring at a deflection m.
    template <class T>
    T surge_rate(const Direction& d, const T& deflection, const T& velocity) const {
        return (d.series_stiffness * deflection - surge_force(d, laws, velocity)) / d.surge.mass;
    }

    void store_rates(const Element& e, const ElementState<double>& s, const double* state, double* results) const {
        const double values[] = {s.series_rate.x, s.series_rate.y, s.series_rate.z}, *own = state + 12 * count();
        for (int j = 0; j < 3; ++j) {
            const auto& d = e.directions[j];
            if (d.series >= 0) results[d.series] = values[j];
            if (d.surge.flow >= 0) results[d.surge.flow] = surge_rate(d, own[d.series], own[d.surge.flow]);
        }
    }
};

}  // namespace wr
