// Patches of a contact on a lattice.
#pragma once
#include <cmath>
#include <numbers>

#include "contact/models/lattice/influence/core/body_displacement.hpp"
#include "contact/models/lattice/system/core/cells.hpp"
#include "contact/results/core/patch_moments.hpp"

namespace wr {

constexpr int PRESSURE_SAMPLES = 65;  // of the pressure along a strip, with its ends
constexpr double FEW_ACROSS = 4.0;    // strips, up to which the largest one has the peak pressure; one more, and the
                                      // curve through all has it

// Largest pressure Pa along a strip with amplitudes (MODES,) Pa of sin(m angle), sqrt(1 - xi^2) U_m.
inline double highest_pressure(Numbers modes) {
    static const auto shapes = [] {
        std::array<std::array<double, MODES>, PRESSURE_SAMPLES - 2> at;
        for (int k = 0; k < PRESSURE_SAMPLES - 2; ++k)
            for (int m = 0; m < MODES; ++m)
                at[k][m] = std::sin((k + 1) * (std::numbers::pi / (PRESSURE_SAMPLES - 1)) * (m + 1));
        return at;
    }();
    double highest = -INFINITE;
    for (const auto& shape : shapes) {
        double pressure = 0.0;
        for (int m = 0; m < MODES; ++m) pressure += modes(m) * shape[m];
        highest = std::max(highest, pressure);
    }
    return highest;
}

// Strips across a patch of parabolic loads per width; from loads (n,) N and widths (n,) m.
inline double strips_across_parabola(Numbers load, Numbers width) {
    double total = 0.0, square = 0.0, mean = 0.0;
    for (long i = 0; i < load.size(); ++i) {
        total += load(i), mean += load(i) * width(i);
        square += load(i) * load(i) / width(i);
    }
    return 1.2 * total * total * total / (square * mean);
}

// Largest pressure Pa over adjacent strips: of cubics between the squares of the largest values (n,) Pa of the strips
// with middles and widths (n,) m whose slopes are those of parabolas through three of them: an ellipse is one parabola.
// The largest value of a continuous curve changes continuously, that of the parabola at the largest strip jumps to
// another parabola. The strips beyond have no pressure, as those that begin to touch.
//
// An outer strip carries too little, and the next one too much: a constant pressure cannot follow a root. On few strips
// the next one is the largest, and its value instead of the curve's is that of an ellipse within 1.4 % on four strips,
// 2.3 % on 3.5.
inline double peak_across(Numbers highest, Numbers middle, Numbers width, Numbers load) {
    std::vector<double> at{middle(0) - width(0)}, square{0.0};
    for (long i = 0; i < highest.size(); ++i) at.push_back(middle(i)), square.push_back(highest(i) * highest(i));
    at.push_back(at.back() + width(width.size() - 1)), square.push_back(0.0);
    auto slope = [&](std::size_t i) {  // of the parabola through those next to it
        if (square[i] == 0.0) return 0.0;
        double before = at[i] - at[i - 1], after = at[i + 1] - at[i];
        double fall = (square[i] - square[i - 1]) / before, rise = (square[i + 1] - square[i]) / after;
        return (fall * after + rise * before) / (before + after);
    };
    double strip = *std::max_element(square.begin(), square.end()), largest = strip;
    for (std::size_t i = 0; i + 1 < at.size(); ++i) {
        double h = at[i + 1] - at[i], rise = square[i + 1] - square[i], a = h * slope(i), b = h * slope(i + 1);
        double cubic = a + b - 2.0 * rise, bow = rise - a - cubic;  // value + a u + bow u^2 + cubic u^3, 0 < u < 1
        double root = std::sqrt(std::max(bow * bow - 3.0 * cubic * a, 0.0));
        double u = a / (root - bow);  // where it is largest
        if (0.0 < u && u < 1.0) largest = std::max(largest, square[i] + u * (a + u * (bow + u * cubic)));
    }
    double more = std::clamp(strips_across_parabola(load, width) - FEW_ACROSS, 0.0, 1.0);
    return std::lerp(std::sqrt(strip), std::sqrt(largest), more * more * (3.0 - 2.0 * more));
}

// Means over the cells of all strips; contact modulus Pa of both bodies.
inline StripMeans strip_means(Rows values, const EquationData& data, const StripCells& cells, double modulus) {
    const auto& [places, marks] = std::tie(data.places, data.basis.marks);
    long S = values.size(), M = data.basis.M(), last = values.shape[1] - 1;
    StripMeans means{places.middle,
                     places.width,
                     Array<double, 2>(S, M + 1),
                     Array<double, 1>(S),
                     Array<double, 1>(S),
                     {cells.points.pressure.data, {S, M}},
                     {cells.margin.data, {S, M}}};
    for (long i = 0; i < S; ++i) {
        double along = values(i, last) - values(i, last - 1), load = 0.5 * along * values(i, last - 1 - MODES);
        for (long r = 0; r <= M; ++r) means.edges(i, r) = values(i, last - 1) + along * marks(r);
        means.length(i) = places.stretch(i) * along;
        double gap = opening(load, places.onset(i), places.whole(i)).gap;
        means.touching(i) = 1.0 - gap * modulus / (places.stretch(i) * load);
    }
    return means;
}

// Displacements of both bodies on the strips of a state.
inline BodyDisplacements body_displacements(Rows values, const EquationData& data, const StripCells& cells,
                                            const BodyTables& bodies) {
    long S = values.size(), M = data.basis.M();
    auto grid = strip_grid(values, data.places, data.basis);
    auto forces = force_jumps(values, data.places, data.basis, data.rolls());
    Array<double, 2> load(S, M);
    for (long n = 0; n < S * M; ++n) load.data[n] = cells.points.pressure(n) * cells.points.area(n);
    return body_displacements(grid, forces, load, {cells.displacement.data, {S, M, 3}}, bodies);
}

struct PatchRows {
    bool inside = false;    // whether all distances lie in the tables
    Array<double, 2> rows;  // (k, 26) of `store_patch` of all patches, by decreasing load

    auto fields() { return std::tie(inside, rows); }
};

// Patches of a solution with values (S, block); bodies: tables of each body; contact modulus Pa of both.
inline PatchRows patch_rows(Rows values, const EquationData& data, const BodyTables& bodies, double modulus) {
    auto cells = strip_cells(values, data);
    const auto& points = cells.points;
    long S = values.size(), M = data.basis.M(), block = values.shape[1];
    auto means = strip_means(values, data, cells, modulus);
    auto displaced = body_displacements(values, data, cells, bodies);
    auto velocities = data.motion.velocities();
    double speed = data.basis.slip_power == 1 ? 0.0 : data.motion.speed;  // a displacement has none
    long patches = S ? *std::max_element(cells.patch.begin(), cells.patch.end()) + 1 : 0;
    PatchRows result{cells.inside, Array<double, 2>(patches, PATCH_NUMBERS)};
    for (long last = 0, first = 0; last < S; ++last) {
        long k = cells.patch(last), end = last + 1;
        if (end < S && cells.patch(end) == k) continue;
        Array<bool, 1> inside(S * M);
        Array<double, 1> load(end - first), highest(end - first);
        for (long i = first; i < end; ++i) {
            highest(i - first) = highest_pressure(values[i].part(block - 2 - MODES, block - 2));
            for (long n = i * M; n < (i + 1) * M; ++n) {
                inside(n) = true;
                load(i - first) += points.pressure(n) * points.area(n);
            }
        }
        auto middle = data.places.middle.part(first, end);
        auto sums = patch_sums(inside, points, velocities, speed);
        sharpen(sums, means.part(first, end), data.basis.marks);
        put_on_material(sums,
                        {displaced.wheel.part(first, end), displaced.rail.part(first, end),
                         displaced.wheel_normal.part(first, end)},
                        middle, load);
        store_patch(sums, peak_across(highest, middle, data.places.width.part(first, end), load), result.rows[k]);
        first = end;
    }
    return result;
}

}  // namespace wr
