// Start without an earlier result: complementarity, with friction, on equal cells of all strips that penetrate.
#pragma once
#include "contact/models/lattice/influence/core/cell_compliance.hpp"
#include "contact/models/lattice/system/core/problem.hpp"
#include "contact/solvers/core/tractions.hpp"

namespace wr {

constexpr int WIDENINGS = 4;  // of the cells until no pressure is left at their ends

// Strips (n,) with the ends low and high (n,) m of a range along each.
struct StripRanges {
    Strips strips;
    std::vector<double> low, high;

    long size() const { return long(strips.size()); }
    void widen(long i, bool at_low, bool at_high, const std::array<double, 2>& window) {
        double more = 0.5 * (high[i] - low[i]);
        if (at_low) low[i] -= more;
        if (at_high) high[i] += more;
        low[i] = std::clamp(low[i], window[0], window[1]), high[i] = std::clamp(high[i], window[0], window[1]);
    }
};

// Cells of a basis along ranges.
inline StripGrid grid_of(const StripRanges& at, const StripBasis& basis, const StripPlaces& places) {
    StripGrid grid{Array<double, 2>(at.size(), basis.row_marks.size()),
                   Array<double, 1>(at.size()),
                   places.width,
                   places.stretch,
                   places.strip,
                   places.middle};
    for (long i = 0; i < at.size(); ++i) {
        double length = at.high[i] - at.low[i], stretch = places.stretch(i);
        grid.length(i) = stretch * length;
        for (long r = 0; r < basis.row_marks.size(); ++r)
            grid.x(i, r) = stretch * (at.low[i] + length * basis.row_marks(r));
    }
    return grid;
}

// Ranges of strips in the region of penetration, no longer than that of the deepest strip: strips next to it on a steep
// flange penetrate over far more than the contact's length.
inline StripRanges first_ranges(const LatticeProblem& problem) {
    StripRanges at{problem.candidates, {}, {}};
    const auto& lines = problem.lines;
    long deepest = *std::max_element(at.strips.begin(), at.strips.end(),
                                     [&](long a, long b) { return lines.depth(a) < lines.depth(b); });
    auto half = [&](long k) { return std::sqrt(2.0 * lines.depth(k) / lines.curvature(k)); };
    for (long k : at.strips) {
        double own = std::min(half(k), half(deepest));
        at.low.push_back(lines.x(k) - own), at.high.push_back(lines.x(k) + own);
    }
    return at;
}

// Both, in the order of their strips.
inline StripRanges merged(const StripRanges& some, const StripRanges& more) {
    StripRanges all;
    std::vector<std::tuple<long, double, double>> rows;
    for (const auto* part : {&some, &more})
        for (long i = 0; i < part->size(); ++i) rows.emplace_back(part->strips[i], part->low[i], part->high[i]);
    std::sort(rows.begin(), rows.end());
    for (auto [strip, low, high] : rows) all.strips.push_back(strip), all.low.push_back(low), all.high.push_back(high);
    return all;
}

// Distance from the middle of the outer cell to the end of the pressure, whose square falls linearly, in cells, 0 to 1.
inline double beyond(double outer, double inner) {
    double rise = inner * inner - outer * outer;
    return rise > 0.0 ? std::clamp(outer * outer / rise, 0.0, 1.0) : 1.0;
}

// Ends m of the pressure (N,) on cells of a length m from a start m on.
// Extrapolated by the square of the pressure where there are three loaded cells.
inline std::array<double, 2> extent(Numbers p, const std::vector<long>& loaded, double start, double cell) {
    long a = loaded.front(), b = loaded.back();
    double low = start + double(a) * cell, high = start + double(b + 1) * cell;
    if (loaded.size() >= 3) {
        low += cell * (0.5 - beyond(p(a), p(a + 1)));
        high -= cell * (0.5 - beyond(p(b), p(b - 1)));
    }
    return {low, high};
}

// Strips with pressure, their ends where its square falls to zero, and modes of equal load; none without pressure.
//
// at: of the equal cells. pressure: (S, N) Pa. tractions: (2, S, N) Pa.
inline LatticeState state_of_cells(const LatticeProblem& problem, const StripRanges& at, Rows pressure,
                                   Blocks tractions) {
    const auto& basis = problem.all().basis;
    long M = problem.all().rolls() ? basis.M() : 0, N = pressure.shape[1], block = problem.all().block();
    std::vector<Array<double, 1>> rows;
    LatticeState state;
    for (long i = 0; i < at.size(); ++i) {
        auto p = pressure[i];
        std::vector<long> loaded;
        double sum = 0.0, largest = 0.0;
        for (long c = 0; c < N; ++c) {
            sum += p(c), largest = std::max(largest, p(c));
            if (p(c) > 0.0) loaded.push_back(c);
        }
        if (loaded.empty()) continue;
        double cell = (at.high[i] - at.low[i]) / double(N);
        auto [low, high] = extent(p, loaded, at.low[i], cell);
        Array<double, 1> values(block);
        values(block - 2) = low, values(block - 1) = high;
        values(2 * M) = 4.0 * sum * cell / (std::numbers::pi * (high - low));
        long n = long(loaded.size());
        Array<double, 1> middles(n), ratio(n);
        for (int k = 0; k < (M ? 2 : 0); ++k) {
            for (long c = 0; c < n; ++c) {
                long of = loaded[c];
                middles(c) = at.low[i] + cell * (double(of) + 0.5);
                ratio(c) = tractions(k, i, of) / std::max(p(of), 1e-3 * largest);
            }
            for (long r = 0; r < M; ++r) {
                double place = low + (high - low) * middle_of_cell(basis, r);
                values(k * M + r) = values(2 * M) * basis.mean(r, 0) * interpolated(place, middles, ratio);
            }
        }
        state.strips.push_back(at.strips[i]);
        rows.push_back(values);
    }
    state.values = Array<double, 2>(long(rows.size()), block);
    for (std::size_t i = 0; i < rows.size(); ++i)
        std::copy(rows[i].begin(), rows[i].end(), state.values[long(i)].begin());
    return state;
}

// Undeformed penetration (n,) m of cells with middles along strips, the mean of both places across.
inline Array<double, 1> cell_depths(LatticeProblem& problem, const StripPlaces& places, Rows middles) {
    long N = middles.shape[1], n = middles.count();
    Array<double, 1> depth(n);
    auto pose = problem.pose();
    for (double side : {-GAUSS, GAUSS}) {
        Walk walk(problem.all().surface);
        for (long c = 0; c < n; ++c) {
            long i = c / N;
            double s = places.middle(i) + side * places.width(i);
            depth(c) += penetration_at(walk, pose, s, middles.data[c]).depth;
        }
    }
    for (double& d : depth) {
        d *= 0.5;
        if (!std::isfinite(d)) d = -problem.approach();
    }
    return depth;
}

// Creepage (2 n,) of the same cells, longitudinal, then lateral.
inline Array<double, 1> cell_creepages(const LatticeProblem& problem, const StripPlaces& places, Rows middles) {
    long N = middles.shape[1], n = middles.count();
    double speed = problem.speed();
    auto pose = problem.pose();
    auto velocities = problem.given().velocities();
    Array<double, 1> rigid(2 * n);
    Walk walk(problem.all().surface);
    for (long c = 0; c < n; ++c) {
        long i = c / N;
        auto on = place_at(walk, pose, places.middle(i), middles.data[c]);
        auto shift = shift_at(on.point, on.forward, on.lateral(), vec_of(places.level[i]), velocities);
        rigid(c) = shift.along / speed, rigid(n + c) = shift.across / speed;
    }
    return rigid;
}

// Tractions of the cells, see `solve_tractions`; without convergence, friction uncoupled from the pressure; failing
// that, the pressure alone.
inline Tractions start_tractions(const LatticeProblem& problem, const Array<double, 2>& matrix, Numbers depth,
                                 const Array<double, 1>& rigid) {
    const auto& law = problem.all().law;
    long n = depth.size();
    if (!problem.all().rolls()) return solve_pressures(matrix, depth);
    double speed = problem.speed();
    if (auto found = attempted([&] { return solve_tractions(matrix, depth, rigid, law, speed); })) return *found;
    auto uncoupled = Array<double, 2>::copy(matrix);
    for (long i = 2 * n; i < 3 * n; ++i)
        for (long c = 0; c < 2 * n; ++c) uncoupled(i, c) = 0.0;
    if (auto found = attempted([&] { return solve_tractions(uncoupled, depth, rigid, law, speed); })) return *found;
    return solve_pressures(block_of(matrix, {2 * n, 2 * n}, {n, n}, 1.0), depth);
}

// First strips and ends, from equal cells of a basis along every strip that penetrates, and along more strips. Throws
// Unsolved.
inline LatticeState cold_start(LatticeProblem& problem, const StripBasis& basis, const StripRanges& more = {}) {
    bool rolls = problem.all().rolls();
    auto at = merged(first_ranges(problem), more);
    long S = at.size(), N = basis.M();
    LatticeState state;
    for (int widening = 0; widening < WIDENINGS; ++widening) {
        auto places = problem.places(at.strips);
        auto grid = grid_of(at, basis, places);
        auto [inside, matrix] = cell_operator(problem.pairs(at.strips), grid, basis, rolls);
        if (!inside) throw OutsideSurface(PATCH_TOO_LONG);
        Array<double, 2> middles(S, N);
        for (long i = 0; i < S; ++i)
            for (long r = 0; r < N; ++r)
                middles(i, r) = at.low[i] + (at.high[i] - at.low[i]) * middle_of_cell(basis, r);
        auto depth = cell_depths(problem, places, middles);
        Array<double, 1> rigid;
        if (rolls) rigid = cell_creepages(problem, places, middles);
        auto found = start_tractions(problem, matrix, depth, rigid);
        Rows pressure{found.pressure.data, {S, N}};
        state = state_of_cells(problem, at, pressure, {found.tangential.data, {2, S, N}});
        bool cut = false;
        for (long i = 0; i < S; ++i) cut = cut || pressure(i, 0) > 0.0 || pressure(i, N - 1) > 0.0;
        if (!cut) break;
        for (long i = 0; i < S; ++i) at.widen(i, pressure(i, 0) > 0.0, pressure(i, N - 1) > 0.0, problem.lines.window);
    }
    if (state.strips.empty()) throw NotConverged("the cells of the first strips carry no pressure");
    return state;
}

}  // namespace wr
