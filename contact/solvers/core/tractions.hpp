// Tractions at the contact points from their compliance: exact contact, exact and regularised friction.
//
// Unknowns are the pressures p and tangential tractions q. Penetration d and slip s are linear in them by the relative
// compliance:  d = d0 + D q - N p,  s = c + S q + T p.
// The pressure is solved exactly for any q, and Newton runs on q alone.
#pragma once
#include "contact/solvers/core/friction_problem.hpp"

namespace wr {

constexpr double STEPS_TOLERANCE = 1e-3;  // of the residual relative to the norm of the bounds, of a start
constexpr int NEWTON_STEPS = 60, FULL_STEPS = 15;
constexpr int STALLS = 3;              // steps without descent that end the iteration
constexpr int HALVING = 8;             // steps within which the residual must halve
constexpr int BOUND_ITERATIONS = 60;   // of the fixed-point iteration of the bounds
constexpr double NEAR_BOUND = 0.1;     // of the bound: residual below which Newton's method is tried again
constexpr double CHORD = 0.1;          // largest reduction of the residual at which a step with old factors is accepted
constexpr double LEAST_NORM = 1e-300;  // keeps divisors positive

inline Array<double, 2> moved_by(const Array<double, 2>& q, double factor, const Array<double, 2>& step) {
    auto moved = Array<double, 2>::copy(q);
    for (long i = 0; i < moved.count(); ++i) moved.data[i] += factor * step.data[i];
    return moved;
}

// Semi-smooth Newton with Armijo backtracking from a state; its bound stays fixed if held. Throws NotConverged.
inline FrictionState damped(FrictionProblem& friction, FrictionState t) {
    std::vector<double> norms;
    bool chords = true;
    int stalls = 0;
    for (int k = 0; k < NEWTON_STEPS; ++k) {
        norms.push_back(t.norm);
        if (k >= HALVING && t.norm > 0.5 * norms[k - HALVING]) break;
        if (t.norm <= STEPS_TOLERANCE * std::max(norm(t.bound), LEAST_NORM)) return t;
        if (stalls == STALLS) break;
        if (chords)
            if (auto step = friction.chord(t)) {
                auto trial = friction.at(moved_by(t.q, 1.0, *step), t.active);
                if (trial.norm <= CHORD * t.norm) {
                    t = trial;
                    continue;
                }
                chords = false;  // the sets of sticking and sliding points change: new factors are needed
            }
        auto step = friction.step(t);
        FrictionState trial;
        std::optional<Array<double, 1>> bound;
        if (t.held) bound = t.bound;
        for (double damping = 1.0;; damping /= 2.0) {
            trial = friction.at(moved_by(t.q, damping, step), t.active, bound);
            if (trial.norm <= (1.0 - 1e-4 * damping) * t.norm) break;
            if (damping < 1e-3) {
                ++stalls;
                break;
            }
        }
        t = trial;
    }
    throw NotConverged("friction did not converge");
}

// Full Newton steps from a state, without descent of |F|. Throws NotConverged.
inline FrictionState undamped(FrictionProblem& friction, FrictionState t) {
    for (int k = 0; k < FULL_STEPS; ++k) {
        t = friction.at(moved_by(t.q, 1.0, friction.step(t)), t.active);
        if (t.norm <= STEPS_TOLERANCE * std::max(norm(t.bound), LEAST_NORM)) return t;
    }
    throw NotConverged("friction did not converge in full steps");
}

// Outcome of an iteration; none where it did not converge.
template <class F>
auto attempted(const F& iteration) -> std::optional<decltype(iteration())> {
    try {
        return iteration();
    } catch (const NotConverged&) {
        return {};
    }
}

// State with F(q) = 0, from tractions q (2, n) and an initial guess of the active points.
//
// Where pressure depends on friction, damped steps may converge slowly along a kink of |F| of a point that begins to
// slip: full steps cross it. Where friction falls steeply, F folds and Newton may end in a local minimum of |F| that is
// no zero. Then the tractions are solved for fixed bounds and the bounds updated, starting with Coulomb's: more slip
// means less friction and less friction more slip, so that the bounds decrease monotonically to the largest that agree
// with their own slip; Newton takes over near it. Throws NotConverged.
inline FrictionState tangential_contact(FrictionProblem& friction, const Array<double, 2>& q, const Mask& active) {
    if (auto found = attempted([&] { return damped(friction, friction.at(q, active)); })) return *found;
    if (!friction.depends_on_speed())  // full steps could converge to another of several solutions
        if (auto found = attempted([&] { return undamped(friction, friction.at(q, active)); })) return *found;
    auto t = friction.at(Array<double, 2>(q.shape), active);
    auto bound = friction.bound_at_rest(t.pressure);
    for (int k = 0; k < BOUND_ITERATIONS; ++k) {
        t = damped(friction, friction.at(t.q, t.active, bound));
        t = friction.at(t.q, t.active);
        if (k == BOUND_ITERATIONS - 1) break;
        bound = t.bound;
        if (t.norm > NEAR_BOUND * norm(bound)) continue;
        if (auto found = attempted([&] { return damped(friction, t); })) return *found;
    }
    return damped(friction, t);
}

// Solution at n points.
struct Tractions {
    Array<double, 1> pressure;    // (n,) Pa
    Array<double, 2> tangential;  // (2, n) Pa on the wheel, longitudinal and lateral
};

// Part of a matrix, rows and columns from the first ones on, times a factor.
inline Array<double, 2> block_of(Rows matrix, std::array<long, 2> first, std::array<long, 2> size, double factor) {
    Array<double, 2> block(size);
    for (long r = 0; r < size[0]; ++r)
        for (long c = 0; c < size[1]; ++c) block(r, c) = factor * matrix(first[0] + r, first[1] + c);
    return block;
}

// Points that may be active at first, by their penetrations.
inline Mask first_active(Numbers penetration) {
    double largest = *std::max_element(penetration.begin(), penetration.end());
    Mask active(penetration.size());
    for (long i = 0; i < penetration.size(); ++i) active[i] = penetration(i) > 0.4 * largest;
    return active;
}

// Pressures alone, from N (n, n) m/Pa and the undeformed penetration (n,) m. Throws NotConverged.
inline Tractions solve_pressures(const Array<double, 2>& compliance, Numbers penetration) {
    NormalResponse normal(compliance);
    return {normal.pressures(penetration, first_active(penetration)).pressure, Array<double, 2>(2, penetration.size())};
}

// Pressures and tractions. matrix (3 n, 3 n), from tractions on the wheel, component by component, to slips and
// penetration; its last columns act on -p. penetration: (n,) m, undeformed. rigid: (2 n,), creepage. speed: m/s, for
// friction that depends on the slip velocity. Throws NotConverged, SingularMatrix.
inline Tractions solve_tractions(Rows matrix, Numbers penetration, const Array<double, 1>& rigid,
                                 const ResidualCode& law, double speed) {
    long n = penetration.size();
    auto compliance = block_of(matrix, {2 * n, 2 * n}, {n, n}, 1.0),
         slip = block_of(matrix, {0, 0}, {2 * n, 2 * n}, 1.0);
    auto shift = block_of(matrix, {0, 2 * n}, {2 * n, n}, -1.0);
    auto coupling = block_of(matrix, {2 * n, 0}, {n, 2 * n}, 1.0);
    auto largest = [](const Array<double, 2>& of) {
        double most = 0.0;
        for (double value : of) most = std::max(most, std::abs(value));
        return most;
    };
    bool coupled = largest(coupling) > ROUND_OFF * largest(compliance);
    NormalResponse normal(compliance);
    Array<double, 2> none(0, 0), q(2, n);
    auto active = first_active(penetration);
    if (coupled) {
        PressureResponse response{&normal, Array<double, 1>::copy(penetration), coupling};
        FrictionProblem friction(slip, rigid, shift, response, law, speed);
        auto state = tangential_contact(friction, q, active);
        return {state.pressure, state.q};
    }
    // the pressure does not depend on friction: only points that carry it remain
    auto [pressure, loaded] = normal.pressures(penetration, active);
    auto creep = product(shift, pressure);
    for (long i = 0; i < 2 * n; ++i) creep(i) = rigid(i) + creep(i);
    auto index = numbers_of(loaded), rows = index;
    for (long i : index) rows.push_back(n + i);
    long k = long(index.size());
    Array<double, 1> own(k), own_creep(2 * k);
    for (long i = 0; i < k; ++i) own(i) = pressure(index[i]);
    for (long i = 0; i < 2 * k; ++i) own_creep(i) = creep(rows[i]);
    FrictionProblem friction(chosen_of(slip, rows), own_creep, none, {nullptr, own, none}, law, speed);
    auto state = tangential_contact(friction, Array<double, 2>(2, k), Mask(k, true));
    for (long i = 0; i < 2 * k; ++i) q(i / k, index[i % k]) = state.q.data[i];
    return {pressure, q};
}

}  // namespace wr
