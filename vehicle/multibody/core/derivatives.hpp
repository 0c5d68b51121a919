// Exact derivatives of the accelerations of a vehicle. A body's equations depend on its own coordinates and on forces
// and moments, which depend on the motions of two bodies: the derivatives by all are products of small matrices.
#pragma once
#include "vehicle/multibody/core/vehicle.hpp"

namespace wr {

template <int M, int N>
Vec<Dual<M>> widened(const Vec<Dual<N>>& a, int first) {
    return {widened<M>(a.x, first), widened<M>(a.y, first), widened<M>(a.z, first)};
}
template <int M, int N>
Motion<Dual<M>> widened(const Motion<Dual<N>>& m, int first) {
    auto w = [first](const auto& a) { return widened<M>(a, first); };
    return {w(m.position), w(m.velocity), {w(m.axes.x), w(m.axes.y), w(m.axes.z)}, w(m.rate)};
}

// Forces and moments on n bodies in common axes, and their derivatives by body directions and deflections of Maxwell
// springs.
class WrenchSlopes {
  public:
    WrenchSlopes(int n, int maxwell)
        : values(n), n(n), maxwell(maxwell), slopes(n * n), coupled(n * n), series(std::size_t(6) * n * maxwell) {}

    std::vector<Wrench<double>> values;

    // Adds a force and a moment on a body that depend on one or two bodies, whose directions follow each other.
    template <class T>
    void add(int body, std::initializer_list<int> by, double sign, const Vec<T>& force, const Vec<T>& moment) {
        const T* parts[] = {&force.x, &force.y, &force.z, &moment.x, &moment.y, &moment.z};
        values[body].add(sign * Vec<double>{force.x.v, force.y.v, force.z.v},
                         sign * Vec<double>{moment.x.v, moment.y.v, moment.z.v});
        int first = 0;
        for (int other : by) {
            auto& block = slopes[n * body + other];
            coupled[n * body + other] = true;
            for (int c = 0; c < 6; ++c)
                for (int d = 0; d < Vehicle::OWN; ++d) block[c][d] += sign * parts[c]->d[first + d];
            first += Vehicle::OWN;
        }
    }

    // Adds the derivatives by spring m of a Maxwell element, a direction of force and moment.
    template <class T>
    void add_series(int body, int m, int direction, double sign, const Vec<T>& force, const Vec<T>& moment) {
        const T* parts[] = {&force.x, &force.y, &force.z, &moment.x, &moment.y, &moment.z};
        for (int c = 0; c < 6; ++c) series[(6 * body + c) * maxwell + m] += sign * parts[c]->d[direction];
    }

    bool couples(int body, int other) const { return coupled[n * body + other]; }

    // Derivative by direction d of another body of a quantity with derivatives (6,) by force and moment on a body.
    double by_motion(const double* by_load, int body, int other, int d) const {
        const auto& block = slopes[n * body + other];
        double sum = 0.0;
        for (int c = 0; c < 6; ++c) sum += by_load[c] * block[c][d];
        return sum;
    }
    double by_series(const double* by_load, int body, int m) const {
        double sum = 0.0;
        for (int c = 0; c < 6; ++c) sum += by_load[c] * series[(6 * body + c) * maxwell + m];
        return sum;
    }

  private:
    int n, maxwell;
    std::vector<std::array<std::array<double, Vehicle::OWN>, 6>> slopes;
    std::vector<char> coupled;
    std::vector<double> series;
};

// Derivatives of the accelerations (6 n + m,) by states (12 n + m,), of which sliders stay in place, and by time along
// the reference motion. Also of each body's acceleration by force and moment of its contacts.
struct VehicleDerivatives {
    static constexpr int OWN = Vehicle::OWN, TIME = Vehicle::TIME, PAIR = Vehicle::PAIR;
    using One = Dual<OWN>;
    using Two = Dual<Vehicle::WITH_SERIES>;
    using Loaded = Dual<Vehicle::WITH_LOAD>;

    const Vehicle& vehicle;
    const double* const state;
    const int n, wide;
    std::vector<double> by_state, by_time, by_wrench;  // (6 n + m, 12 n + m), (6 n + m,), (n, 6, 6)

    VehicleDerivatives(const Vehicle& vehicle, const Travel<double>& travel, const Travel<double>& rates,
                       const double* state, const double* contacts)
        : vehicle(vehicle),
          state(state),
          n(vehicle.count()),
          wide(vehicle.states()),
          by_state(std::size_t(vehicle.accelerated()) * wide),
          by_time(vehicle.accelerated()),
          by_wrench(std::size_t(36) * n) {
        std::vector<BodyState<One>> all;
        all.reserve(n);
        for (int i = 0; i < n; ++i) all.push_back(vehicle.body_state<One>(i, travel, rates, state));
        WrenchSlopes total(n, vehicle.internal);
        vehicle.suspension<Two>(
            state, [&](int i, int end) { return widened<Vehicle::WITH_SERIES>(all[i].motion, OWN * end); },
            [&](int u, int l, const auto& force, const auto& on_upper, const auto& on_lower) {
                total.add(u, {u, l}, 1.0, force, on_upper), total.add(l, {u, l}, -1.0, force, on_lower);
            },
            [&](const Element& e, const auto& s) { add_maxwell(e, s, total); });
        add_loads(all, total);
        for (int i = 0; i < n; ++i)
            add_body(i, vehicle.body_state<Loaded>(i, travel, rates, state), total, contacts + 6 * i);
    }

  private:
    // Column of a direction of a body.
    int column(int body, int d) const { return d < 6 ? 6 * body + d : 6 * (n + body) + d - 6; }

    double& slope(int row, int body, int d) {
        return d == TIME ? by_time[row] : by_state[std::size_t(row) * wide + column(body, d)];
    }

    void add_maxwell(const Element& e, const ElementState<Two>& s, WrenchSlopes& total) {
        const Two* rates[] = {&s.series_rate.x, &s.series_rate.y, &s.series_rate.z};
        for (int j = 0; j < 3; ++j) {
            int m = e.directions[j].series, row = 6 * n + m;
            if (m < 0) continue;
            for (int d = 0; d < OWN; ++d)
                slope(row, e.upper, d) += rates[j]->d[d], slope(row, e.lower, d) += rates[j]->d[OWN + d];
            by_state[std::size_t(row) * wide + 12 * n + m] = rates[j]->d[PAIR + j];
            add_surge(e.directions[j]);
            total.add_series(e.upper, m, PAIR + j, 1.0, s.force, s.on_upper);
            total.add_series(e.lower, m, PAIR + j, -1.0, s.force, s.on_lower);
        }
    }

    void add_surge(const Direction& d) {
        int m = d.series, v = d.surge.flow;
        if (v < 0) return;
        const double* own = state + 12 * n;
        auto rate = vehicle.surge_rate(d, variable<Dual<2>>(own[m], 0), variable<Dual<2>>(own[v], 1));
        auto at = [&](int row, int column) -> double& {
            return by_state[std::size_t(6 * n + row) * wide + 12 * n + column];
        };
        at(m, v) = -1.0, at(v, m) = rate.d[0], at(v, v) = rate.d[1];
    }

    void add_loads(const std::vector<BodyState<One>>& all, WrenchSlopes& total) const {
        constexpr int M = Vehicle::WITH_SERIES;
        for (const auto& torque : vehicle.torques) {
            const auto& own = all[torque.wheelset];
            auto w = [](const One& x) { return widened<M>(x, 0); };
            BodyState<Two> wheelset;
            wheelset.q[0] = w(own.q[0]), wheelset.rate[4] = w(own.rate[4]);
            wheelset.travel = {w(own.travel.distance), w(own.travel.speed), Two(0.0), w(own.travel.time)};
            wheelset.motion = widened<M>(own.motion, 0);
            auto other = widened<M>(all[torque.reaction].motion, OWN);
            auto moment =
                axle_torque(torque, wheelset, other, vehicle.radius, vehicle.release) * wheelset.motion.axes.y;
            total.add(torque.wheelset, {torque.wheelset, torque.reaction}, 1.0, Vec<Two>{}, moment);
            total.add(torque.reaction, {torque.wheelset, torque.reaction}, -1.0, Vec<Two>{}, moment);
        }
        for (const auto& force : vehicle.forces) {
            const auto& at = all[force.body];
            auto in_common = at.section.axes * components(force, at);
            auto moment = force_moment(force, at.motion, vehicle.bodies[force.body].wheelset, in_common);
            total.add(force.body, {force.body}, 1.0, in_common, moment);
        }
    }

    void add_body(int i, const BodyState<Loaded>& at, const WrenchSlopes& total, const double* contact) {
        auto load = [](double x, int k) { return variable<Loaded>(x, OWN + k); };
        const auto& [f, m] = total.values[i];
        Wrench<Loaded> own{{load(f.x, 0), load(f.y, 1), load(f.z, 2)}, {load(m.x, 3), load(m.y, 4), load(m.z, 5)}};
        Loaded results[6];
        vehicle.accelerate_body(i, at, own,
                                {{contact[0], contact[1], contact[2]}, {contact[3], contact[4], contact[5]}}, results);
        const auto& axes = at.section.axes;
        const Vec<Loaded>* columns[] = {&axes.x, &axes.y, &axes.z};
        for (int r = 0; r < 6; ++r) {
            const double* by_load = results[r].d + OWN;
            int row = 6 * i + r;
            for (int d = 0; d < OWN; ++d) slope(row, i, d) += results[r].d[d];
            for (int j = 0; j < n; ++j)
                if (total.couples(i, j))
                    for (int d = 0; d < OWN; ++d) slope(row, j, d) += total.by_motion(by_load, i, j, d);
            for (int k = 0; k < vehicle.internal; ++k)
                by_state[std::size_t(row) * wide + 12 * n + k] += total.by_series(by_load, i, k);
            for (int c = 0; c < 6; ++c) {
                const double* part = by_load + 3 * (c / 3);
                const auto& axis = *columns[c % 3];
                by_wrench[36 * i + 6 * r + c] = part[0] * axis.x.v + part[1] * axis.y.v + part[2] * axis.z.v;
            }
        }
    }
};

}  // namespace wr
