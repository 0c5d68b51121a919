// Strips that enter: unloaded ones whose surfaces would still penetrate at an edge beside the loaded ones.
#pragma once
#include "contact/models/lattice/solver/core/cold_start.hpp"
#include "contact/models/lattice/solver/core/remaining.hpp"

namespace wr {

// half length of the cells of a strip that enters over that of a parabola of its remaining penetration
constexpr double CELLS_OVER_PARABOLA = 1.5;

// Penetration that unloaded strips may have at an edge, the sum of fractions of the approach and of their onset.
struct Excess {
    double approach, onset;
};
constexpr Excess LEAST_EXCESS{1e-7, 1e-3};  // the load is 2e-7 of that on the whole width
constexpr Excess UNCERTAIN{1e-5, 0.1};      // where a strip cannot stay loaded either: 2e-3

// Length of a loaded strip over the width of the next one: the gap that modes and cells leave beside longer ones has
// several maxima there, and an outermost strip several places.
constexpr double MANY_WIDTHS = 20.0;

inline Probes probes_of(const LatticeProblem& problem) {
    return {problem.lattice(), problem.all().first, problem.all().second};
}

// Unloaded strips with a penetration above a least one, and the ranges of penetration. Throws OutsideSurface.
inline StripRanges overlaps(LatticeProblem& problem, const Remaining& rest, const Excess& least = LEAST_EXCESS) {
    if (!rest.inside) throw OutsideSurface(PATCH_TOO_LONG);
    StripRanges found;
    for (long i = 0; i < rest.strips.size(); ++i) {
        double enough = least.approach * problem.approach() + least.onset * problem.lines.onset(rest.strips(i));
        if (!(rest.depth(i) > enough)) continue;
        double half = CELLS_OVER_PARABOLA * std::sqrt(2.0 * rest.depth(i) / rest.curvature(i));
        half = std::min(half, rest.half(i));
        found.strips.push_back(rest.strips(i));
        found.low.push_back(rest.place(i) - half), found.high.push_back(rest.place(i) + half);
    }
    return found;
}

// The same of a state; barred: strips that must not enter.
inline StripRanges penetrating(LatticeProblem& problem, const LatticeState& state, const Strips& barred,
                               const Excess& least = LEAST_EXCESS) {
    while (true) {
        auto found =
            search(state.values, problem.of(state.strips), probes_of(problem), problem.lines, indices_of(barred));
        if (found.complete) return overlaps(problem, found.rest, least);
        problem.tables().complete(found.strips);
    }
}

// Penetration (n, C) m of unloaded strips that the tractions of the loaded ones leave, means over equal cells of a
// basis along their ranges. Throws OutsideSurface.
inline Array<double, 2> remaining_penetration(LatticeProblem& problem, const LatticeState& state, const StripRanges& at,
                                              const StripBasis& cells) {
    std::set<long> all(state.strips.begin(), state.strips.end());
    all.insert(at.strips.begin(), at.strips.end());
    problem.tables().complete({all.begin(), all.end()});
    auto [inside, depth] = excess(state.values, problem.of(state.strips), problem.lattice(), problem.lines.onset, cells,
                                  indices_of(at.strips), {at.low.data(), {at.size()}}, {at.high.data(), {at.size()}});
    if (!inside) throw OutsideSurface(PATCH_TOO_LONG);
    for (double& d : depth)
        if (!std::isfinite(d)) d = -problem.approach();
    return depth;
}

// Strips under their remaining penetration, by complementarity on cells, while the loaded strips do not change; none
// without any. Throws Unsolved.
inline LatticeState entered(LatticeProblem& problem, const LatticeState& state, StripRanges at) {
    long n = at.size();
    const auto& cells = problem.all().second;
    long C = cells.M();
    if (!n) return {};
    Array<double, 2> depth;
    for (int widening = 0; widening < WIDENINGS; ++widening) {
        depth = remaining_penetration(problem, state, at, cells);
        bool cut = false;
        for (long i = 0; i < n; ++i) cut = cut || depth(i, 0) > 0.0 || depth(i, C - 1) > 0.0;
        if (!cut || widening == WIDENINGS - 1) break;
        for (long i = 0; i < n; ++i) at.widen(i, depth(i, 0) > 0.0, depth(i, C - 1) > 0.0, problem.lines.window);
    }
    auto places = problem.places(at.strips);
    auto grid = grid_of(at, cells, places);
    auto [inside, matrix] = cell_operator(problem.pairs(at.strips), grid, cells, false);
    if (!inside) throw OutsideSurface(PATCH_TOO_LONG);
    NormalResponse normal(matrix);
    auto pressed_by = [&](Numbers d) {
        Mask active(d.size());
        for (long i = 0; i < d.size(); ++i) active[i] = d(i) > 0.0;
        return normal.pressures(d, active).pressure;
    };
    auto pressure = pressed_by(flat(depth));
    for (long i = 0; i < n; ++i) {
        if (!(places.whole(i) > 0.0)) continue;
        auto own = depth[i];
        double sum = 0.0, deepest = *std::max_element(own.begin(), own.end());
        for (long c = 0; c < C; ++c) sum += pressure(i * C + c);
        double cell = (at.high[i] - at.low[i]) / double(C);
        double whole = 2.0 / std::numbers::pi * cell * sum;  // load under this penetration of the whole width
        double compliance = whole > 0.0 ? deepest * (places.whole(i) / whole) : deepest;
        double part = std::min(pressed(deepest, compliance, places.onset(i)), 1.0);
        for (double& d : own) d -= places.onset(i) * (1.0 - std::pow(1.0 - part, OPENING));
    }
    pressure = pressed_by(flat(depth));
    return state_of_cells(problem, at, {pressure.data, {n, C}}, Array<double, 3>(2, n, C));
}

// Outermost strips (S,) beside much longer ones that may be in equilibrium at another place, too: those with negative
// pressure at an end, and those that overlap more beyond their ends than between them, by one of their cells or more.
inline Array<bool, 1> misplaced(LatticeProblem& problem, const LatticeState& state) {
    const auto& [strips, values] = state;
    long S = long(strips.size()), last = values.shape[1] - 1, first = last - 1 - MODES;
    const auto& data = problem.of(strips);
    Array<bool, 1> moves(S);
    auto next = [&](long i, long n) { return n >= 0 && n < S && std::abs(strips[i] - strips[n]) == 1; };
    for (long i = 0; i < S; ++i) {
        if (next(i, i - 1) == next(i, i + 1)) continue;
        long n = next(i, i + 1) ? i + 1 : i - 1;
        double half = half_length(values, i);
        if (half_length(values, n) < std::max(0.5 * MANY_WIDTHS * data.places.width(i), half)) continue;
        double slope[2] = {0.0, 0.0};  // of the pressure at its ends
        for (int m = 0; m < MODES; ++m) {
            double part = (m + 1) * values(i, first + m);
            slope[0] += m % 2 ? -part : part, slope[1] += part;
        }
        double cell = 2.0 * half / double(problem.all().cells());
        double low[] = {values(n, last - 1), values(i, last) + cell},
               high[] = {values(i, last - 1) - cell, values(n, last)};
        long both[] = {strips[i], strips[i]};
        auto rest = excess(values, data, problem.lattice(), problem.lines.onset, problem.all().second, {both, {2}},
                           {low, {2}}, {high, {2}})
                        .second;
        double onset = data.places.onset(i);
        double between = onset - opening(values(i, first) * half, onset, data.places.whole(i)).gap;
        for (int k = 0; k < 2; ++k) {
            bool overlaps = low[k] < high[k] && *std::max_element(rest[k].begin(), rest[k].end()) > between;
            moves(i) = moves(i) || slope[k] < 0.0 || overlaps;
        }
    }
    return moves;
}

}  // namespace wr
