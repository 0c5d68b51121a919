// Residual and Jacobian of all equations of a state with values (S, block), from the compliance and the surfaces.
//
// Moments of the gap:  int (d + u_n) T_k / sqrt(1 - xi^2) = 0, d the undeformed penetration and u_n the relative normal
// displacement by all tractions. Friction: F(q, s, p) = 0 in every cell, s the rigid slip plus the elastic one over the
// rolling speed. Ends of strips are unknowns like the others.
#pragma once
#include "contact/models/lattice/influence/core/operator.hpp"
#include "contact/models/lattice/influence/core/short_strips.hpp"
#include "contact/models/lattice/system/core/partial_width.hpp"
#include "contact/models/lattice/system/core/state.hpp"
#include "contact/models/lattice/system/core/strips.hpp"

namespace wr {

// Add the moments (S, MOMENTS) of the penetration on two lines a strip, and its slopes (S, STATIONS) along x. Whether
// it is defined.
inline bool add_penetration(Rows values, const EquationData& data, View<double, 2> moments, View<double, 2> slope) {
    const auto& basis = data.basis;
    auto pose = data.motion.pose();
    Walk walk(data.surface);
    bool inside = true;
    for (long i = 0; i < values.size(); ++i)
        for (int g = 0; g < 2; ++g) {
            double s = data.places.middle(i) + (2 * g - 1) * GAUSS * data.places.width(i);
            for (long k = 0; k < STATIONS; ++k) {
                double x = along_strip(values, i, basis.stations(k));
                auto depth = penetration_at(walk, pose, s, variable<Dual<1>>(x, 0)).depth;
                inside = inside && std::isfinite(depth.v);
                slope(i, k) += 0.5 * depth.d[0];
                for (int m = 0; m < MOMENTS; ++m) moments(i, m) += 0.5 * basis.penetration(m, k) * depth.v;
            }
        }
    return inside;
}

// Rigid slip (S, 2, M) over the speed at the cells, and its derivative 1/m along x.
struct RigidSlip {
    Array<double, 3> slip, slope;

    auto fields() { return std::tie(slip, slope); }

    RigidSlip() = default;
    RigidSlip(Rows values, const EquationData& data) : slip(data.strips(), 2L, data.basis.M()), slope(slip.shape) {
        auto pose = data.motion.pose();
        auto velocities = data.motion.velocities();
        double speed = data.motion.speed;
        Walk walk(data.surface);
        for (long i = 0; i < slip.size(); ++i)
            for (long r = 0; r < data.basis.M(); ++r) {
                double x = along_strip(values, i, middle_of_cell(data.basis, r));
                auto at = place_at(walk, pose, data.places.middle(i), variable<Dual<1>>(x, 0));
                auto shift = shift_at(at.point, at.forward, at.lateral(), vec_of(data.places.level[i]), velocities);
                slip(i, 0, r) = shift.along.v / speed, slip(i, 1, r) = shift.across.v / speed;
                slope(i, 0, r) = shift.along.d[0] / speed, slope(i, 1, r) = shift.across.d[0] / speed;
            }
    }
};

// Cells n = S M of a state with friction: tractions (2, n) Pa, slips (2, n) over the speed, pressures (2, n) Pa at
// their ends and rho (n,) 1/Pa. What is negative at one end is taken from the other, so that the mean is kept; the mean
// of a trial state may be negative, too: its bound is zero.
struct CellStates {
    Array<double, 2> q, s, p;
    Array<double, 1> rho;

    CellStates(Rows values, const Evaluation& evaluation, const EquationData& data)
        : q(2, values.size() * data.basis.M()), s(q.shape), p(q.shape), rho(q.shape[1]) {
        long M = data.basis.M();
        for (long n = 0; n < rho.size(); ++n) {
            long i = n / M, r = n % M;
            rho(n) = data.rho(r);
            double ends[2] = {0.0, 0.0};
            for (int k = 0; k < 2; ++k) {
                for (int m = 0; m < MODES; ++m) ends[k] += values(i, 2 * M + m) * data.basis.ends(r, k, m);
                q(k, n) = values(i, k * M + r), s(k, n) = evaluation.slip(i, k, r);
            }
            for (int k = 0; k < 2; ++k) p(k, n) = std::max(ends[k] + std::min(ends[1 - k], 0.0), 0.0);
        }
    }
};

// Complete the residual by that of friction.
inline void add_friction(const CellStates& cells, const EquationData& data, View<double, 2> residual) {
    long M = data.basis.M(), n = cells.rho.size();
    Array<double, 2> F(2, n);
    friction_residual(data.law, cells.q, cells.s, cells.p, cells.rho, data.motion.speed, F);
    for (long c = 0; c < n; ++c)
        for (int k = 0; k < 2; ++k) residual(c / M, k * M + c % M) = F(k, c);
}

// Slopes (S, M, SLOPES) of the friction residual by traction (4), slip (4), speed (2), and the pressure modes (2 each);
// M = 0 without friction.
inline Array<double, 3> slopes_of_friction(const CellStates& cells, const EquationData& data) {
    const auto& ends = data.basis.ends;
    long M = data.basis.M(), n = cells.rho.size();
    Array<double, 2> at(n, 14);
    friction_slopes(data.law, cells.q, cells.s, cells.p, cells.rho, data.motion.speed, at);
    Array<double, 3> slopes(data.strips(), M, SLOPES);
    for (long c = 0; c < n; ++c) {
        auto of = at[c], to = slopes[c / M][c % M];
        for (int k = 0; k < 8; ++k) to(k) = of(k);
        to(8) = of(12), to(9) = of(13);
        for (int k = 0; k < 2; ++k)
            for (int m = 0; m < (cells.p(k, c) > 0.0 ? MODES : 0); ++m) {
                double by_mode = ends(c % M, k, m) + (cells.p(1 - k, c) > 0.0 ? 0.0 : ends(c % M, 1 - k, m));
                to(10 + 2 * m) += of(8 + 2 * k) * by_mode;
                to(11 + 2 * m) += of(9 + 2 * k) * by_mode;
            }
    }
    return slopes;
}

inline Array<double, 3> slopes_of_friction(Rows values, const Evaluation& evaluation, const EquationData& data) {
    if (!data.rolls()) return Array<double, 3>(data.strips(), 0, SLOPES);
    return slopes_of_friction(CellStates(values, evaluation, data), data);
}

// Complete an evaluation whose V is known, but for the residual of friction.
inline void complete(Rows values, const StripGrid& grid, const EquationData& data, Evaluation& e) {
    const auto& [basis, places] = std::tie(data.basis, data.places);
    long S = values.size(), M = basis.M(), at = data.mode(), last = values.shape[1] - 1;
    Array<double, 2> moments(S, MOMENTS);
    e.residual = Array<double, 2>(S, data.block()), e.slip = Array<double, 3>(S, 2, M);
    e.depth_slope = Array<double, 2>(S, STATIONS), e.pressure = cell_pressures(values, basis, data.rolls());
    add_slips(e.V, grid, basis, e.slip, moments);
    e.inside = add_penetration(values, data, moments, e.depth_slope) && e.inside;
    if (data.rolls()) {
        RigidSlip rigid(values, data);
        for (long n = 0; n < e.slip.count(); ++n) e.slip.data[n] += rigid.slip.data[n];
        e.rigid_slope = rigid.slope;
    } else {
        e.rigid_slope = Array<double, 3>(S, 2, M);
    }
    for (long i = 0; i < S; ++i) {
        for (int m = 0; m < MOMENTS; ++m) e.residual(i, at + m) = moments(i, m);
        double load = 0.5 * values(i, at) * (values(i, last) - values(i, last - 1));
        e.residual(i, at) += opening(load, places.onset(i), places.whole(i)).gap;
    }
}

// Whether all distances lie in the tables, and the antiderivative V (S, M + 3, 3) of the displacements.
// jumps: (S, M + 1, 3) N/m of `force_jumps`.
inline std::pair<bool, Array<double, 3>> displacements(Rows values, const StripGrid& grid, Blocks jumps,
                                                       const EquationData& data) {
    auto [inside, V] = antiderivatives(data.tables, grid, jumps);
    return {inside && add_short_strips(data.tables, grid, values, data.basis, data.rolls(), V), V};
}

inline Evaluation evaluate(Rows values, const EquationData& data) {
    auto grid = strip_grid(values, data.places, data.basis);
    auto jumps = force_jumps(values, data.places, data.basis, data.rolls());
    Evaluation e;
    std::tie(e.inside, e.V) = displacements(values, grid, jumps, data);
    complete(values, grid, data, e);
    if (data.rolls()) add_friction(CellStates(values, e, data), data, e.residual);
    return e;
}

// Add to an operator A (n, n), rows slips and moments by displacements, the effect of strip ends on penetration,
// opening and rigid slip.
inline void add_ends(Rows values, const Evaluation& e, const EquationData& data, View<double, 2> A) {
    const auto& [basis, places] = std::tie(data.basis, data.places);
    long M = basis.M(), block = data.block();
    for (long i = 0; i < values.size(); ++i) {
        long last = (i + 1) * block, low = last - 2, high = last - 1, first = last - MOMENTS;
        for (int k = 0; k < MOMENTS; ++k)
            for (long g = 0; g < STATIONS; ++g) {
                double part = basis.penetration(k, g) * e.depth_slope(i, g);
                A(first + k, low) += part * (1.0 - basis.stations(g));
                A(first + k, high) += part * basis.stations(g);
            }
        double amplitude = values(i, block - 2 - MODES), half = half_length(values, i);
        double slope = opening(amplitude * half, places.onset(i), places.whole(i)).slope;
        A(first, low - MODES) += slope * half;
        A(first, low) -= 0.5 * slope * amplitude;
        A(first, high) += 0.5 * slope * amplitude;
        for (long n = 0; n < data.mode(); ++n) {
            double mark = middle_of_cell(basis, n % M), along = e.rigid_slope(i, n / M, n % M);
            A(i * block + n, low) += along * (1.0 - mark);
            A(i * block + n, high) += along * mark;
        }
    }
}

// Replace the slip rows of an operator A (n, n) by rows of the friction residual with slopes (S, M, SLOPES).
inline void friction_rows(View<double, 2> A, Blocks slopes) {
    long S = slopes.size(), M = slopes.shape[1], block = A.size() / S;
    for (long i = 0; i < S; ++i)
        for (long r = 0; r < M; ++r) {
            long x = i * block + r, y = x + M, modes = i * block + 2 * M;
            auto d = slopes[i][r];
            auto first = A[x], second = A[y];
            double xx = d(4), xy = d(5), yx = d(6), yy = d(7);
            for (long c = 0; c < A.size(); ++c) {
                double along = first(c), across = second(c);
                first(c) = xx * along + xy * across;
                second(c) = yx * along + yy * across;
            }
            first(x) += d(0), first(y) += d(1), second(x) += d(2), second(y) += d(3);
            for (int m = 0; m < MODES; ++m) first(modes + m) += d(10 + 2 * m), second(modes + m) += d(11 + 2 * m);
        }
}

// Equations of a state, linearised.
inline Linearisation linearised(Rows values, const EquationData& data) {
    long S = data.strips(), M = data.basis.M(), n = values.count(), block = data.block();
    bool rolls = data.rolls();
    auto grid = strip_grid(values, data.places, data.basis);
    Array<double, 3> jumps = force_jumps(values, data.places, data.basis, rolls);
    Operator made{data.tables, grid, jumps, data.basis, rolls};
    Linearisation at;
    Evaluation& e = at.evaluation;
    auto& A = at.jacobian = made.A;
    e.V = made.V;
    e.inside = made.fill() && add_short_strips_derivative(data.tables, grid, values, data.basis, rolls, A, e.V);
    complete(values, grid, data, e);
    add_ends(values, e, data, A);
    at.slips = Array<float, 3>(S, data.mode(), n);
    for (long i = 0; i < S; ++i)
        for (long r = 0; r < data.mode(); ++r) {
            auto to = at.slips[i][r];
            auto from = A[i * block + r];
            for (long c = 0; c < n; ++c) to(c) = float(from(c));
        }
    at.slopes = Array<double, 3>(S, rolls ? M : 0, SLOPES);
    if (rolls) {
        CellStates cells(values, e, data);
        add_friction(cells, data, e.residual);
        at.slopes = slopes_of_friction(cells, data);
        friction_rows(A, at.slopes);
    }
    return at;
}

}  // namespace wr
