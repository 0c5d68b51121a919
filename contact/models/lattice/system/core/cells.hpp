// Contact points of the cells of a state, with their tractions, slips and displacements.
#pragma once
#include <algorithm>
#include <numeric>
#include <vector>

#include "contact/models/lattice/system/core/equations.hpp"
#include "contact/models/lattice/system/core/friction.hpp"
#include "contact/results/core/patch_points.hpp"

namespace wr {

// Cells n = S M of S strips of M cells, strip by strip from the trailing end.
struct StripCells {
    bool inside = false;            // whether all distances lie in the tables
    PatchPoints points;             // their middles
    Array<double, 1> penetration;   // (n,) m, undeformed penetration
    Array<double, 2> slip;          // (n, 2) over the rolling speed; zero without friction
    Array<double, 2> displacement;  // (n, 3) m, upper minus lower body, means over the cells
    Array<double, 1> margin;        // (n,) Pa, see `margins`; zero without friction
    Array<long, 1> patch;           // (S,) number of the strip's patch, by decreasing load

    auto fields() { return std::tie(inside, points, penetration, slip, displacement, margin, patch); }
    bool fits() const {
        long n = points.size();
        return penetration.size() == n && slip.shape == std::array{n, 2L} && displacement.shape == std::array{n, 3L} &&
               margin.size() == n && (patch.size() == 0 ? n == 0 : n % patch.size() == 0);
    }
};

// Patch (S,) of every strip, by decreasing load: neighbours that overlap along x share one. Values (S, block) of the
// strips, their numbers strip (S,) on the lattice, ascending, and load (S M,) N of their cells.
inline Array<long, 1> strip_patches(Rows values, Indices strip, Numbers load) {
    long S = values.size(), M = load.size() / std::max(S, 1L), low = values.shape[1] - 2, high = low + 1;
    Array<long, 1> patch(S);
    std::vector<double> total;
    for (long i = 0; i < S; ++i) {
        bool next = i > 0 && strip(i) == strip(i - 1) + 1 && values(i, low) < values(i - 1, high) &&
                    values(i - 1, low) < values(i, high);
        if (!next) total.push_back(0.0);
        patch(i) = long(total.size()) - 1;
        for (long r = 0; r < M; ++r) total.back() += load(i * M + r);
    }
    std::vector<long> order(total.size()), rank(total.size());
    std::iota(order.begin(), order.end(), 0L);
    std::stable_sort(order.begin(), order.end(), [&](long a, long b) { return total[a] > total[b]; });
    for (long k = 0; k < long(order.size()); ++k) rank[order[k]] = k;
    for (long& of : patch) of = rank[of];
    return patch;
}

// Store places on both profiles and the longitudinal axis of point n at s m on the wheel, closest point foot m on the
// rail. The axis is in the rail's surface, perpendicular to the axle.
inline void store_places(const SurfaceData& surface, const Vec<double>& axle, const OnCurve<double>& wheel, double s,
                         double foot, const PatchPoints& points, long n) {
    points.on_wheel(n, 0) = s, points.on_rail(n, 0) = foot;
    if (!surface.revolves) {
        points.on_wheel(n, 1) = s, points.on_rail(n, 1) = foot;
        for (int c = 0; c < 3; ++c) points.level(n, c) = points.axes(n, 0, c);
        return;
    }
    auto rail = local(surface.rail, foot);
    const auto& t = rail.tangent;
    points.on_wheel(n, 1) = wheel.point.y, points.on_rail(n, 1) = rail.point.y;
    double forward = axle.y * t.y + axle.z * t.z;  // axle times the rail's normal (0, -t_z, t_y)
    double size = std::sqrt(forward * forward + axle.x * axle.x);
    points.level(n, 0) = forward / size;
    points.level(n, 1) = -axle.x * t.y / size, points.level(n, 2) = -axle.x * t.z / size;
}

// Fill tractions, slips and margins of cells with pressures, from the elastic slip (S, 2, M).
inline void store_friction(Rows values, Blocks elastic, const EquationData& data, StripCells& cells) {
    long M = data.basis.M(), n = cells.margin.size();
    RigidSlip rigid(values, data);
    Array<double, 2> q(2, n), s(2, n);
    Array<double, 1> p(n), rho(n);
    for (long c = 0; c < n; ++c) {
        long i = c / M, r = c % M;
        p(c) = std::max(cells.points.pressure(c), 0.0), rho(c) = data.rho(r);
        for (int k = 0; k < 2; ++k) {
            cells.points.traction(c, k) = q(k, c) = values(i, k * M + r);
            cells.slip(c, k) = s(k, c) = elastic(i, k, r) + rigid.slip(i, k, r);
        }
    }
    cells.margin = margins(data.law, q, s, p, rho, data.motion.speed);
}

// Fill the elastic work of cells with tractions. That of the tractions on displacements by tractions vanishes, that of
// the pressure on them is that of the tractions on displacements by the pressure: jumps (S, M + 1, 3) N/m of all.
inline void store_elastic(const StripGrid& grid, Array<double, 3> jumps, const EquationData& data,
                          const PatchPoints& points) {
    for (long e = 0; e < jumps.count(); ++e)
        if (e % 3 < 2) jumps.data[e] = 0.0;
    auto slip = slips_and_moments(antiderivatives(data.tables, grid, jumps).second, grid, data.basis).first;
    for (long c = 0; c < points.size(); ++c) {
        long i = c / data.basis.M(), r = c % data.basis.M();
        for (int k = 0; k < 2; ++k) points.elastic(c) += points.traction(c, k) * slip(i, k, r);
    }
}

// `StripCells` of a state with values (S, block).
inline StripCells strip_cells(Rows values, const EquationData& data) {
    const auto& [places, basis, surface] = std::tie(data.places, data.basis, data.surface);
    long S = values.size(), M = basis.M(), n = S * M;
    auto pose = data.motion.pose();
    auto grid = strip_grid(values, places, basis);
    StripCells cells;
    Array<double, 3> V;
    auto jumps = force_jumps(values, places, basis, data.rolls());
    std::tie(cells.inside, V) = displacements(values, grid, jumps, data);
    cells.penetration = Array<double, 1>(n), cells.margin = Array<double, 1>(n);
    cells.slip = Array<double, 2>(n, 2), cells.displacement = Array<double, 2>(n, 3);
    auto pressure = cell_pressures(values, basis, data.rolls());
    PatchPoints& points = cells.points;
    points = {Array<double, 2>(n, 3), Array<double, 3>(n, 3, 3), Array<double, 2>(n, 3), Array<double, 1>(n),
              Array<double, 1>(n),    Array<double, 2>(n, 2),    Array<double, 2>(n, 2), Array<double, 1>(n),
              Array<double, 2>(n, 2), Array<double, 1>(n),       Array<bool, 1>(n)};
    Array<double, 1> load(n);
    CellMiddles middle(values, places, basis);
    Walk walk(surface);
    for (long c = 0; c < n; ++c) {
        long i = c / M, r = c % M;
        double s = middle.s(c), x = middle.x(c), length = grid.x(i, r + 1) - grid.x(i, r);
        auto under = penetration_at(walk, pose, s, x);
        write_frame(place_at(walk, pose, s, x), points.point, points.axes, c);
        store_places(surface, pose.rotation.y, walk.at, s, under.foot, points, c);
        cells.penetration(c) = under.depth;
        points.step(c) = length, points.area(c) = length * places.width(i), points.pressure(c) = pressure(i, r);
        load(c) = points.pressure(c) * points.area(c);
        for (int k = 0; k < 3; ++k) cells.displacement(c, k) = (V(i, r + 1, k) - V(i, r, k)) / length;
    }
    if (data.rolls()) {
        store_friction(values, slips_and_moments(V, grid, basis).first, data, cells);
        store_elastic(grid, jumps, data, points);
    }
    for (long c = 0; c < n; ++c) points.sticks(c) = cells.margin(c) > 0.0;
    cells.patch = strip_patches(values, places.strip, load);
    return cells;
}

}  // namespace wr
