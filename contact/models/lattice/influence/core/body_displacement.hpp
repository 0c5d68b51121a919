// Displacement of each body in a contact on a lattice, for the material that touches.
//
// The relative displacement of the solution is the sum of that of half-spaces, which divides by their compliance, and
// of the deviations of finite bodies, which are evaluated body by body. The contraction of half-spaces by pressure is
// left out: it is opposite on both sides of a patch, and 2 um by another patch of 40 kN at 10 mm. So is their
// displacement along the normal: by reciprocity a half-space under pressure is not inclined in the mean.
#pragma once
#include "contact/models/lattice/influence/core/operator.hpp"

namespace wr {

constexpr int THIRDS = 3;  // parts of a strip, over which deviations from half-spaces vary little

// Displacements of n contact points, or of strips: means over their lengths weighted by pressure.
struct BodyDisplacements {
    Array<double, 1> wheel, rail;   // (n,) m, lateral displacement of the upper and lower body along the upper one's t
    Array<double, 1> wheel_normal;  // (n,) m, displacement of the upper body along its outward normal

    auto fields() { return std::tie(wheel, rail, wheel_normal); }
    bool fits() const { return wheel.size() == rail.size() && wheel.size() == wheel_normal.size(); }
};

// Cell boundary at which a part of a strip of M cells begins.
inline long part_begin(long part, long M) { return (2 * part * M + THIRDS) / (2 * THIRDS); }

// Fill zero jumps (THIRDS + 1, 3) N/m of the mean forces per length on the parts of a strip. From jumps (M + 1, 3) N/m
// at boundaries x m of its cells.
inline void store_mean_jumps(const Rows& forces, const Numbers& x, const View<double, 2>& jumps) {
    long M = forces.size() - 1;
    for (int k = 0; k < 3; ++k) {
        double at = 0.0;
        for (int part = 0; part < THIRDS; ++part) {
            long first = part_begin(part, M), last = part_begin(part + 1, M);
            double force = 0.0;
            for (long r = first; r < last; ++r) {
                at += forces(r, k);
                force += at * (x(r + 1) - x(r));
            }
            double mean = force / (x(last) - x(first));
            jumps(part, k) += mean;
            jumps(part + 1, k) -= mean;
        }
    }
}

// Means (S, 3) m, by weights (S, THIRDS), of the displacement by a body's tables; zero for a half-space.
inline Array<double, 2> mean_displacements(const PairTables& tables, const StripGrid& grid, const Blocks& jumps,
                                           const Rows& weight) {
    Array<double, 2> means(grid.size(), 3);
    if (tables.smooth.none()) return means;
    auto V = antiderivatives(tables, grid, jumps).second;
    for (long i = 0; i < grid.size(); ++i) {
        double total = 0.0;
        for (double one : weight[i]) total += one;
        for (int part = 0; part < THIRDS && total > 0.0; ++part) {
            double share = weight(i, part) / (total * (grid.x(i, part + 1) - grid.x(i, part)));
            for (int k = 0; k < 3; ++k) means(i, k) += share * (V(i, part + 1, k) - V(i, part, k));
        }
    }
    return means;
}

// Displacements of both bodies on strips.
//
// forces: (S, M + 1, 3) N/m, jumps at the boundaries of the cells. load: (S, M) N. displacement: (S, M, 3) m, relative.
// bodies: tables of each body.
inline BodyDisplacements body_displacements(const StripGrid& grid, const Blocks& forces, const Rows& load,
                                            const Blocks& displacement, const BodyTables& bodies) {
    long S = grid.size(), M = forces.shape[1] - 1;
    Array<double, 2> weight(S, THIRDS), ends(S, THIRDS + 1), relative(S, 3);
    Array<double, 3> jumps(S, THIRDS + 1, 3);
    for (long i = 0; i < S; ++i) {
        ends(i, 0) = grid.x(i, 0);
        for (int part = 0; part < THIRDS; ++part) {
            long last = part_begin(part + 1, M);
            ends(i, part + 1) = grid.x(i, last);
            for (long r = part_begin(part, M); r < last; ++r) {
                weight(i, part) += load(i, r);
                for (int k = 0; k < 3; ++k) relative(i, k) += load(i, r) * displacement(i, r, k);
            }
        }
        store_mean_jumps(forces[i], grid.x[i], jumps[i]);
    }
    StripGrid coarse{ends, grid.length, grid.width, grid.stretch, grid.strip, grid.middle};
    auto upper = mean_displacements(bodies.upper, coarse, jumps, weight);
    auto lower = mean_displacements(bodies.lower, coarse, jumps, weight);
    BodyDisplacements of{Array<double, 1>(S), Array<double, 1>(S), Array<double, 1>(S)};
    for (long i = 0; i < S; ++i) {
        double total = 0.0;
        for (double one : weight[i]) total += one;
        double across = total > 0.0 ? relative(i, 1) / total : 0.0, half_spaces = across - upper(i, 1) - lower(i, 1);
        of.wheel(i) = upper(i, 1) + bodies.share(0) * half_spaces;
        of.rail(i) = -lower(i, 1) - bodies.share(1) * half_spaces;
        of.wheel_normal(i) = upper(i, 2);
    }
    return of;
}

}  // namespace wr
