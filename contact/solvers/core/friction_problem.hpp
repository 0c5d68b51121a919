// Tangential problem: semi-smooth Newton equations of exact and regularised friction.
//
// The law q = -b s / max(|s|, eps), |q| <= b, which for eps = 0 leaves q undetermined at s = 0, is equivalent to
//
//     q = b y / max(|y|, b rho + eps),   y = rho q - s,
//
// for any rho > 0 [1/Pa]: a projection on the disc of radius b = mu(|s| V, p) p, smooth away from the switch. The
// pressure is a function of the tractions, so Newton runs on q alone.
#pragma once
#include <cmath>
#include <optional>

#include "contact/laws/core/law.hpp"
#include "contact/solvers/core/normal_contact.hpp"

namespace wr {

// State of the tangential problem at given tractions.
struct FrictionState {
    Array<double, 2> q;         // (2, n) Pa, tractions
    Array<double, 1> pressure;  // (n,) Pa
    Mask active;                // (n,)
    Array<double, 2> s;         // (2, n), slips over the rolling speed
    Array<double, 1> bound;     // (n,) Pa
    Array<double, 2> F;         // (2, n) Pa, residual
    double norm = 0.0;          // of F
    bool held = false;          // whether the bound is fixed
};

inline double norm(Numbers values) { return std::sqrt(dot(values, values)); }

// A view of all numbers one after the other.
template <class T, int N>
View<T, 1> flat(const View<T, N>& of) {
    return {of.data, {of.count()}};
}

// Pressures independent of the tractions, or N p = d + D q on the active points.
struct PressureResponse {
    NormalResponse* normal = nullptr;  // none: given pressures
    Array<double, 1> penetration;      // (n,) m, or the given pressures Pa
    Array<double, 2> coupling;         // D (n, 2 n) m/Pa

    NormalResponse::Solution at(Numbers q, const Mask& active) const {
        if (!normal) {
            Mask loaded(penetration.size());
            for (long i = 0; i < penetration.size(); ++i) loaded[i] = penetration(i) > 0.0;
            return {penetration, loaded};
        }
        auto total = product(coupling, q);
        for (long i = 0; i < total.size(); ++i) total(i) += penetration(i);
        return normal->pressures(total, active);
    }
    // dp/dq (a, 2 n) of the a active points.
    Array<double, 2> slope(const Mask& active) const {
        auto index = numbers_of(active);
        long a = long(index.size()), m = coupling.shape[1];
        Array<double, 2> columns(m, a), rows(a, m);
        for (long i = 0; i < a; ++i)
            for (long c = 0; c < m; ++c) columns(c, i) = coupling(index[i], c);
        if (a) normal->solve(active, columns);
        for (long i = 0; i < a; ++i)
            for (long c = 0; c < m; ++c) rows(i, c) = columns(c, i);
        return rows;
    }
};

// F(q) and its derivative at n points.
class FrictionProblem {
  public:
    // slip: S (2 n, 2 n) 1/Pa, by the tractions. rigid: (2 n,), rigid slip over the rolling speed. shift: T (2 n, n)
    // 1/Pa, slip by the pressure; without rows if contained in rigid. speed: m/s; slip velocities are zero without it.
    FrictionProblem(const Array<double, 2>& slip, const Array<double, 1>& rigid, const Array<double, 2>& shift,
                    const PressureResponse& pressure, const ResidualCode& law, double speed)
        : slip(slip), rigid(rigid), shift(shift), pressure(pressure), law(law), speed(speed), rho(rigid.size() / 2) {
        long n = rho.size();
        double largest = 0.0;
        for (long i = 0; i < n; ++i) {
            rho(i) = 0.5 * (slip(i, i) + slip(n + i, n + i));
            largest = std::max(largest, std::abs(rho(i)));
        }
        for (double& own : rho) own = std::max(own, 1e-3 * largest);
    }

    bool depends_on_speed() const { return law.code->depends_on_speed; }

    // Bound (n,) Pa without slip, of pressures (n,) Pa.
    Array<double, 1> bound_at_rest(Numbers p) const {
        Array<double, 1> rest(p.size()), bound(p.size());
        law.code->coefficient(p.size(), rest.data, p.data, law.parameters.data, bound.data);
        for (long i = 0; i < p.size(); ++i) bound(i) *= p(i);
        return bound;
    }

    // State at tractions q (2, n) Pa, with an initial guess of the active points; bound (n,) Pa: fixed ones.
    FrictionState at(const Array<double, 2>& q, const Mask& active,
                     const std::optional<Array<double, 1>>& bound = {}) const {
        long n = rho.size();
        auto [p, loaded] = pressure.at(flat(q), active);
        FrictionState t{q, p, loaded, Array<double, 2>(2, n), {}, Array<double, 2>(2, n), 0.0, bound.has_value()};
        auto by_tractions = product(slip, flat(q));
        for (long i = 0; i < 2 * n; ++i) t.s.data[i] = rigid(i) + by_tractions(i);
        if (shift.size()) {
            auto by_pressure = product(shift, p);
            for (long i = 0; i < 2 * n; ++i) t.s.data[i] += by_pressure(i);
        }
        double eps = law.regularisation;
        if (bound) {
            t.bound = *bound;
            law.code->bounded_residual(n, q.data, t.s.data, t.bound.data, rho.data, eps, t.F.data);
        } else {
            t.bound = Array<double, 1>(n);
            law.code->residual(n, q.data, t.s.data, p.data, rho.data, speed, eps, law.parameters.data, t.bound.data,
                               t.F.data);
        }
        t.norm = norm(flat(t.F));
        return t;
    }

    // Newton step (2, n) Pa from a state. Throws SingularMatrix.
    Array<double, 2> step(const FrictionState& t) {
        const auto& [index, by_traction, by_pressure] = linearised(t);
        long k = long(index.size()), n = rho.size();
        Array<double, 2> slopes(k, 12);
        double eps = law.regularisation;
        if (t.held)
            law.code->bounded_slopes(k, index.data(), n, t.q.data, t.s.data, t.bound.data, rho.data, eps, slopes.data);
        else
            law.code->slopes(k, index.data(), n, t.q.data, t.s.data, t.pressure.data, rho.data, speed, eps,
                             law.parameters.data, slopes.data);
        factors.reset();
        Jacobian made{Array<double, 2>(2 * k, 2 * k), Array<int, 1>(2 * k)};
        assembled(slopes, by_traction, t.held ? Array<double, 2>(0, 0) : by_pressure, made.columns);
        if (!factorise<double>(made.columns, made.pivots))
            throw SingularMatrix("the Jacobian of the friction problem is singular");
        factors = made;
        return solved(t, index, made);
    }

    // Step with the factors of an earlier Jacobian; none if there are none for the same points.
    std::optional<Array<double, 2>> chord(const FrictionState& t) {
        if (!factors || t.held) return {};
        const auto& index = linearised(t).index;
        if (!factors) return {};  // they belonged to other points
        return solved(t, index, *factors);
    }

  private:
    // Numbers (k,) of points with possible traction, ds/dq (2 k, 2 k), and dp/dq (k, 2 k). Without rows where the
    // pressure does not depend on the tractions.
    struct Linearisation {
        std::vector<long> index;
        Array<double, 2> slip, pressure;
    };
    struct Jacobian {
        Array<double, 2> columns;
        Array<int, 1> pivots;
    };

    const Linearisation& linearised(const FrictionState& t) {
        long n = rho.size();
        Mask loaded(n);
        for (long i = 0; i < n; ++i)
            loaded[i] = t.active[i] || t.q(0, i) != 0.0 || t.q(1, i) != 0.0 || t.bound(i) > 0.0;
        if (known && known_active == t.active && known_loaded == loaded) return *known;
        auto index = numbers_of(loaded), rows = index;
        for (long i : index) rows.push_back(n + i);
        Linearisation made{index, chosen_of(slip, rows), Array<double, 2>(0, 0)};
        long k = long(index.size());
        if (pressure.normal && shift.size()) {
            made.pressure = Array<double, 2>(k, 2 * k);
            auto gradient = pressure.slope(t.active);
            for (long i = 0, a = 0; i < k; ++i) {
                if (!t.active[index[i]]) continue;
                for (long c = 0; c < 2 * k; ++c) made.pressure(i, c) = gradient(a, rows[c]);
                ++a;
            }
            for (long r = 0; r < 2 * k; ++r)
                for (long i = 0; i < k; ++i) {
                    double by = t.active[index[i]] ? shift(rows[r], index[i]) : 0.0;
                    if (by == 0.0) continue;
                    auto to = made.slip[r];
                    auto from = made.pressure[i];
                    for (long c = 0; c < 2 * k; ++c) to(c) += by * from(c);
                }
        }
        known = made, known_active = t.active, known_loaded = loaded, factors.reset();
        return *known;
    }

    Array<double, 2> solved(const FrictionState& t, const std::vector<long>& index, const Jacobian& at) const {
        long k = long(index.size());
        Array<double, 2> right(1, 2 * k), step(2, rho.size());
        for (long c = 0; c < 2 * k; ++c) right(0, c) = -t.F(c / k, index[c % k]);
        solve_transposed<double>(at.columns, at.pivots, right);
        for (long c = 0; c < 2 * k; ++c) step(c / k, index[c % k]) = right(0, c);
        return step;
    }

    Array<double, 2> slip;
    Array<double, 1> rigid;
    Array<double, 2> shift;
    PressureResponse pressure;
    const ResidualCode& law;
    double speed;
    Array<double, 1> rho;
    std::optional<Linearisation> known;
    Mask known_active, known_loaded;
    std::optional<Jacobian> factors;
};

}  // namespace wr
