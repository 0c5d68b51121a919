// Displacement, slip and their derivatives on strips of a lattice, from tables of pairs of strips.
//
// With V the antiderivative along x of the displacement of strip i, a sum of the table values G times the jumps of the
// traction at the cell boundaries of all strips, means over cells are differences of V, and moments of the gap and
// slips are weights of V at the cell boundaries. Linear in the loads: derivatives are the tables themselves and their
// slopes.
#pragma once
#include "contact/models/lattice/influence/core/pair_tables.hpp"

namespace wr {

// Table values of a pair of strips, seen from the displaced one in rows. turn: 1, or -1 for the pair in the other
// order, whose antisymmetric components change their sign by reciprocity.
struct Seen {
    Plane values;
    double turn;

    Seen(const View<double, 3>& G, double turn) : values(turn > 0.0 ? plane(G) : plane(G).transposed()), turn(turn) {}
};

// Length to the power of `StripBasis::slip_power`.
inline double slip_power(double length, const StripBasis& basis) {
    return basis.slip_power == 2 ? length * length : length;
}

// Add to V (R, 3) of a strip the effect of jumps (M + 1, 3) of the force per length on another one.
//
// sign: factor, -1 for slopes in the other order.
inline void add_antiderivative(const Seen& at, const Rows& jumps, double sign, const View<double, 2>& V) {
    for (long r = 0; r < V.size(); ++r) {
        auto [x, t, n] = products<3>(at.values.row(r), jumps);  // table values times loads along, across and normal
        V(r, 0) += sign * (x[XX] + t[XT] + at.turn * (n[XN] + n[ROLL]));
        V(r, 1) += sign * (x[XT] + t[TT] + n[TN] + at.turn * n[TN_TURN]);
        V(r, 2) += sign * (t[TN] + n[NN] - at.turn * (x[XN] + t[TN_TURN]));
    }
}

// Whether all distances lie in the tables, and V (S, M + 3, 3) by jumps (S, M + 1, 3) of traction times width.
inline std::pair<bool, Array<double, 3>> antiderivatives(const PairTables& tables, const StripGrid& grid,
                                                         const Blocks& jumps) {
    long S = grid.size(), R = grid.x.shape[1];
    Array<double, 3> V(S, R, 3), G(R, R, LANES);
    for (long i = 0; i < S; ++i)
        for (long j = i; j < S; ++j) {
            if (!look_up<false>(tables, grid.strip(i), grid.strip(j), grid.x[i], grid.x[j], G, {})) return {false, V};
            add_antiderivative({G, 1.0}, jumps[j], 1.0, V[i]);
            if (i != j) add_antiderivative({G, -1.0}, jumps[i], 1.0, V[j]);
        }
    return {true, V};
}

// Derivative A (S block, S block) of slips and moments by tractions, modes and ends, and V (S, M + 3, 3) with its
// slopes.
struct Operator {
    const PairTables& tables;
    const StripGrid& grid;
    const Blocks& jumps;
    const StripBasis& basis;
    bool rolls;
    long S = grid.size(), M = basis.M(), R = M + 3, block = basis.block(rolls), at = block - MOMENTS;
    Array<double, 2> A{S * block, S * block};
    Array<double, 3> V{S, R, 3L}, slopes{S, R, 3L};
    // Work space: table values and slopes, weighted values at the boundaries of the loaded strip, jumps times the
    // change of boundaries by one end, the antiderivative by that end.
    Array<double, 3> G{R, R, long(LANES)}, H{R, R, long(LANES)}, edges{long(MOMENTS), M + 1, long(LANES)};
    Array<double, 2> moved{M + 1, 3L}, by_end{R, 3L};

    // False where distances exceed the tables.
    bool fill() {
        for (long i = 0; i < S; ++i)
            for (long j = i; j < S; ++j) {
                if (!look_up<true>(tables, grid.strip(i), grid.strip(j), grid.x[i], grid.x[j], G, H)) return false;
                add(i, j, 1.0);
                if (i != j) add(j, i, -1.0);
            }
        for (long i = 0; i < S; ++i) add_own_ends(i);
        return true;
    }

  private:
    // Row of strip i from the columns of strip j on.
    double* entries(long i, long row, long j) { return &A(i * block + row, j * block); }

    // All that a strip has by loads on another one.
    void add(long i, long j, double turn) {
        Seen values(G, turn), changes(H, turn);
        add_moments(values, i, j);
        if (rolls) add_slips(values, i, j);
        add_ends(changes, i, j);
        add_antiderivative(values, jumps[j], 1.0, V[i]);
        add_antiderivative(changes, jumps[j], turn, slopes[i]);
    }

    // Moments of strip i by tractions and pressure modes on strip j.
    void add_moments(const Seen& seen, long i, long j) {
        double factor = grid.width(j) / grid.length(i), turn = seen.turn;
        for (long c = 0; c <= M; ++c) {
            auto sums = products<MOMENTS>(seen.values.column(c), basis.edge_moments);
            for (int k = 0; k < MOMENTS; ++k) store8(sums[k], &edges(k, c, 0));
        }
        for (int k = 0; k < MOMENTS; ++k) {
            Vectors e = vectors(edges[k]);
            auto s = products<MODES>(e, basis.load_edges);
            double* to = entries(i, at + k, j);
            for (int m = 0; m < MODES; ++m)
                to[at + m] -= factor * s[m][NN];  // pressure acts against the outward normal
            for (long c = 0; c < (rolls ? M : 0); ++c) {
                to[c] -= factor * turn * (e(c, XN) - e(c + 1, XN));
                to[M + c] += factor * (e(c, TN) - e(c + 1, TN) - turn * (e(c, TN_TURN) - e(c + 1, TN_TURN)));
            }
        }
    }

    // Slips of strip i by the same.
    void add_slips(const Seen& seen, long i, long j) {
        double factor = grid.width(j) / slip_power(grid.length(i), basis), turn = seen.turn;
        Vectors e = vectors(edges[0]);
        for (long r = 0; r < M; ++r) {
            for (long c = 0; c <= M; ++c)
                store8(product<4>(seen.values.column(c).part(r, 4), basis.slip_edges[r]), &edges(0, c, 0));
            auto s = products<MODES>(e, basis.load_edges);
            double *along = entries(i, r, j), *across = entries(i, M + r, j);
            for (int m = 0; m < MODES; ++m) {
                along[at + m] -= factor * turn * (s[m][XN] + s[m][ROLL]);
                across[at + m] -= factor * (s[m][TN] + turn * s[m][TN_TURN]);
            }
            for (long c = 0; c < M; ++c) {
                double both = factor * (e(c, XT) - e(c + 1, XT));
                along[c] += factor * (e(c, XX) - e(c + 1, XX));
                along[M + c] += both;
                across[c] += both;
                across[M + c] += factor * (e(c, TT) - e(c + 1, TT));
            }
        }
    }

    // Slips and moments of strip i by the ends of strip j, through its cell boundaries.
    void add_ends(const Seen& slope, long i, long j) {
        double over = 1.0 / grid.length(i), per_slip = 1.0 / slip_power(grid.length(i), basis);
        for (int end = 0; end < 2; ++end) {
            for (long c = 0; c <= M; ++c) {
                double change = -grid.stretch(j) * (end ? basis.marks(c) : 1.0 - basis.marks(c));
                for (int k = 0; k < 3; ++k) moved(c, k) = change * jumps(j, c, k);
            }
            std::fill(by_end.begin(), by_end.end(), 0.0);
            add_antiderivative(slope, moved, slope.turn, by_end);
            long column = at + MODES + end;
            for (int k = 0; k < MOMENTS; ++k) {
                double total = 0.0;
                for (long c = 0; c <= M; ++c) total += basis.moment_edges(k, c) * by_end(c, 2);
                entries(i, at + k, j)[column] += over * total;
            }
            for (long r = 0; r < (rolls ? M : 0); ++r) {
                double along = 0.0, across = 0.0;
                for (int k = 0; k < 4; ++k) {
                    along += basis.slip_edges(r, k) * by_end(r + k, 0);
                    across += basis.slip_edges(r, k) * by_end(r + k, 1);
                }
                entries(i, r, j)[column] += per_slip * along;
                entries(i, M + r, j)[column] += per_slip * across;
            }
        }
    }

    // The same by the ends of strip i itself: boundaries move and lengths change.
    void add_own_ends(long i) {
        double stretch = grid.stretch(i), over = 1.0 / grid.length(i), per_slip = slip_power(over, basis);
        for (int end = 0; end < 2; ++end) {
            long column = at + MODES + end;
            double longer = (end ? stretch : -stretch) * over;
            auto moves = [&](long e) { return stretch * (end ? basis.row_marks(e) : 1.0 - basis.row_marks(e)); };
            for (int k = 0; k < MOMENTS; ++k) {
                double total = 0.0;
                for (long e = 0; e <= M; ++e)
                    total += basis.moment_edges(k, e) * (slopes(i, e, 2) * moves(e) - V(i, e, 2) * longer);
                entries(i, at + k, i)[column] += over * total;
            }
            for (int a = 0; a < (rolls ? 2 : 0); ++a)
                for (long r = 0; r < M; ++r) {
                    double total = 0.0;
                    for (long e = r; e < r + 4; ++e) {
                        double change = slopes(i, e, a) * moves(e) - basis.slip_power * V(i, e, a) * longer;
                        total += basis.slip_edges(r, e - r) * change;
                    }
                    entries(i, a * M + r, i)[column] += per_slip * total;
                }
        }
    }
};

// Add elastic slips (S, 2, M) and moments (S, MOMENTS) m of the normal displacement, from V (S, M + 3, 3).
inline void add_slips(const Blocks& V, const StripGrid& grid, const StripBasis& basis, const View<double, 3>& slips,
                      const View<double, 2>& moments) {
    for (long i = 0; i < V.size(); ++i) {
        double over = 1.0 / grid.length(i), per_slip = slip_power(over, basis);
        for (int k = 0; k < MOMENTS; ++k)
            for (long e = 0; e <= basis.M(); ++e) moments(i, k) += over * basis.moment_edges(k, e) * V(i, e, 2);
        for (int a = 0; a < 2; ++a)
            for (long r = 0; r < basis.M(); ++r)
                for (int k = 0; k < 4; ++k) slips(i, a, r) += per_slip * basis.slip_edges(r, k) * V(i, r + k, a);
    }
}

// Elastic slips (S, 2, M) and moments (S, MOMENTS) m of the normal displacement, from V (S, M + 3, 3).
inline std::pair<Array<double, 3>, Array<double, 2>> slips_and_moments(const Blocks& V, const StripGrid& grid,
                                                                       const StripBasis& basis) {
    Array<double, 3> slips(V.size(), 2, basis.M());
    Array<double, 2> moments(V.size(), MOMENTS);
    add_slips(V, grid, basis, slips, moments);
    return {slips, moments};
}

}  // namespace wr
