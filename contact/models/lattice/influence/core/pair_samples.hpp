// Coefficients of the tables of pairs of strips, from half-spaces and the deviations of finite bodies.
#pragma once
#include "contact/elasticity/core/half_space.hpp"
#include "contact/models/lattice/influence/core/body_correction.hpp"

namespace wr {

// Start over the width, for the same strip and adjacent ones; over the distance, beyond.
constexpr double STARTS[] = {0.004, 0.03, 0.5};

// Strips of a lattice on the upper body.
struct LatticeStrips {
    Numbers sides;    // (K + 1,) m, lateral bounds
    Numbers angle;    // (K,) rad, inclination to the axle
    Numbers stretch;  // (K,) length over that on the rolling circle

    auto fields() { return std::tie(sides, angle, stretch); }
    bool fits() const { return sides.size() == angle.size() + 1 && stretch.size() == angle.size(); }
    long size() const { return angle.size(); }
    Bounds bounds(long i) const { return {sides(i), sides(i + 1)}; }
};

// Half-spaces under both bodies, upper and lower.
struct HalfSpaces {
    Numbers nu;           // (2,) Poisson's ratios
    Numbers scale;        // (2,) 1/Pa
    Numbers outward;      // (2,) 1 where the normal of the tables is the body's outward one, else -1
    double radius = 0.0;  // m, of a wheel that compresses; 0 without

    auto fields() { return std::tie(nu, scale, outward, radius); }
    bool fits() const { return nu.size() == 2 && scale.size() == 2 && outward.size() == 2; }
};

// Length m of the first octave of cells of a pair.
inline double start_of(const LatticeStrips& strips, long i, long j) {
    const auto& sides = strips.sides;
    double width = std::min(sides(i + 1) - sides(i), sides(j + 1) - sides(j));
    if (i == j) return STARTS[0] * width;
    double distance = 0.5 * (sides(j) + sides(j + 1) - sides(i) - sides(i + 1));
    return std::max(STARTS[1] * width, STARTS[2] * (distance - width));
}

// Number of cells up to REACH.
inline long count_of(double start) { return long(std::ceil(std::log2(1.0 + REACH / start))) * CELLS; }

// Deviation of a body from a half-space that does not depend on the pose.
struct Deviation {
    BetweenAllLines lines;  // (ns, ns, cells, DEGREE + 1, COMPONENTS) between all lines
    long first = 0;         // number of the first line
    Rows share;             // (K, n) weights of lines in the means over the strips; (0, 0) without deviation

    auto fields() { return std::tie(lines, first, share); }
    bool fits() const {
        return lines.shape[0] == lines.shape[1] && lines.shape[3] == DEGREE + 1 && lines.shape[4] == COMPONENTS &&
               first >= 0 && first + share.shape[1] <= lines.shape[0] && (none() || lines.shape[2] >= count_of(START));
    }
    bool none() const { return share.size() == 0; }
};

// Components of a half-space in the axes of two strips.
//
// near: in the strips' mean axes, from which the axes of the displaced strip are turned by -tilt, those of the loaded
// one
//     by tilt, positive from the lateral towards the upper body's outward normal. cosine, sine: of the tilt.
inline v8 in_axes_of_strips(const std::array<double, 6>& near, double cosine, double sine) {
    auto [along, across, normal, x_by_t, x_by_n, t_by_n] = near;
    double twice_cosine = cosine * cosine - sine * sine, twice_sine = 2.0 * cosine * sine;
    double to[COMPONENTS] = {};
    to[XX] = along;
    to[TT] = cosine * cosine * across - sine * sine * normal + twice_sine * t_by_n;
    to[NN] = cosine * cosine * normal - sine * sine * across + twice_sine * t_by_n;
    to[TN_TURN] = twice_cosine * t_by_n - cosine * sine * (across + normal);
    to[XT] = x_by_t * cosine + x_by_n * sine;
    to[XN] = x_by_n * cosine - x_by_t * sine;
    return load8(to);
}

// Values of a deviation at x >= 0 m.
inline v8 deviation_at(const Vectors& table, double x) {
    double z = x / START + 1.0;
    long cell = std::min(table_cell(z).cell, table.count / (DEGREE + 1) - 1), first = (DEGREE + 1) * cell;
    v8 u = splat(z - lower_bound(cell)), value = table[first + DEGREE];
    for (int k = DEGREE - 1; k >= 0; --k) value = value * u + table[first + k];
    return value;
}

// Write the coefficients (cells, DEGREE + 1, COMPONENTS) of a pair i <= j; deviations of the upper and lower body.
inline void pair_coefficients(const LatticeStrips& strips, long i, long j, const HalfSpaces& bodies,
                              const std::array<const Deviation*, 2>& deviations, const CellRule& rule,
                              const Coefficients& values) {
    constexpr int NODES = DEGREE + 1;
    double start = start_of(strips, i, j), stretch = 0.5 * (strips.stretch(i) + strips.stretch(j));
    double tilt = 0.5 * (strips.angle(j) - strips.angle(i)), angle = 0.5 * (strips.angle(i) + strips.angle(j));
    double cosine = std::cos(tilt), sine = std::sin(tilt), normal = std::cos(angle);
    bool rolls = bodies.radius > 0.0 && !deviations[0]->none();
    Array<double, 3> means[2];
    for (int b = 0; b < 2; ++b) {
        const auto& body = *deviations[b];
        if (body.none()) continue;
        means[b] = Array<double, 3>(count_of(START), NODES, COMPONENTS);
        add_pair_mean(body.lines, body.first, body.share[i], body.share[j], means[b]);
    }
    Array<double, 1> widths(values.size());
    double integral = 0.0;
    for (long cell = 0; cell < values.size(); ++cell) {
        double lower = lower_bound(cell), width = lower_bound(cell - cell % CELLS) / CELLS;
        widths(cell) = width;
        double samples[NODES][COMPONENTS], radial[NODES];
        for (int node = 0; node < NODES; ++node) {
            double x = (lower + width * rule.nodes(node) - 1.0) * start;
            auto geometry = pair_geometry(x, strips.bounds(i), strips.bounds(j));
            v8 both[2];
            for (int b = 0; b < 2; ++b) {
                auto near = pair_antiderivative(geometry, bodies.nu(b));
                for (int c = 0; c < 6; ++c) near[c] *= bodies.scale(b) * (c >= 4 ? bodies.outward(b) : 1.0);
                both[b] = in_axes_of_strips(near, cosine, sine);
                if (!deviations[b]->none())
                    both[b] = both[b] + splat(stretch * stretch) * deviation_at(vectors(means[b]), x / stretch);
            }
            store8(both[0] + both[1], samples[node]);
            radial[node] = normal * both[0][NN];
        }
        if (rolls) {
            for (int node = 0; node < NODES; ++node) {
                double total = integral;
                for (int k = 0; k < NODES; ++k) total += width * start * rule.integrals(node, k) * radial[k];
                samples[node][ROLL] = total / (bodies.radius * stretch);
            }
            integral = samples[DEGREE][ROLL] * bodies.radius * stretch;
        }
        double power = 1.0;
        for (int k = 0; k < NODES; ++k, power *= width) {  // exact: widths are powers of two
            v8 value{};
            for (int node = 0; node < NODES; ++node)
                value = value + splat(rule.to_powers(k, node)) * load8(samples[node]);
            store8(value * splat(1.0 / power), &values(cell, k, 0));
        }
    }
    join_cells(values, widths, EVEN, rule);
}

}  // namespace wr
