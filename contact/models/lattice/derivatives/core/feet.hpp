// Derivatives of slips and moments of the gap where strips move on the lower body.
//
// Linear in the loads, by tables as the slips themselves. Each strip moves by itself: at every distance between
// boundaries of two strips this takes two polynomials, one for each that moves. Few principal motions of all strips
// take one each, two as a rule, and leave out the others; the multipliers of force and moment, applied first, six.
#pragma once
#include "contact/models/lattice/influence/core/operator.hpp"
#include "contact/models/lattice/system/core/strips.hpp"

namespace wr {

// Slips (6, S, 2, M) and moments (6, S, MOMENTS) m by the pose.
struct FootDerivatives {
    Array<double, 4> slips;
    Array<double, 3> moments;

    auto fields() { return std::tie(slips, moments); }
};

// Change of the displacements through means over lines, as strips move.
class MovedStrips {
  public:
    MovedStrips(const PairMeans& smooth, const StripGrid& grid, Blocks jumps, Rows share, Rows slope)
        : smooth_(smooth), grid_(grid), jumps_(jumps), share_(share), slope_(slope) {}

    // V (6, S, R, 3), derivative of `antiderivatives` by strips that move by change (S, 6) per motion.
    //
    // share, slope: (S, n) weights of the lines in the strips, and their derivatives by the strips' places.
    Array<double, 4> by_motions(Rows change) {
        for (long i = 0; i < S; ++i) {
            for (long j = i; j < S; ++j) {
                begin(i, j);
                add_means(slope_[i], share_[j]);
                if (i == j) add_means(share_[i], slope_[i]);
                tabulate(i, j);
                add_antiderivative({G_, 1.0}, jumps_[j], 1.0, own_[i]);
                if (i == j) continue;
                add_part(-1.0, jumps_[i], change[i], j);
                begin(i, j);
                add_means(share_[i], slope_[j]);
                tabulate(i, j);
                add_antiderivative({G_, -1.0}, jumps_[i], 1.0, own_[j]);
                add_part(1.0, jumps_[j], change[j], i);
            }
        }
        for (long i = 0; i < S; ++i) add_moved(own_[i], change[i], i);
        return V_;
    }

  private:
    // Clear the table of coefficients as far as strips i and j are apart.
    void begin(long i, long j) {
        long cells = table_cell(farthest(grid_.x[i], grid_.x[j]) * PER_LENGTH + 1.0).cell + 1;
        if (cells > table_.size()) throw std::out_of_range("strips longer than their tables");
        used_ = table_.part(0, cells);
        std::fill(used_.begin(), used_.end(), 0.0);
    }
    void add_means(const Numbers& row, const Numbers& column) {
        add_pair_mean(smooth_.lines, smooth_.first, row, column, used_);
    }
    // Values G (R, C, 8) at the distances of boundaries.
    void tabulate(long i, long j) {
        Vectors table = vectors(used_);
        for (long r = 0; r < R; ++r)
            for (long c = 0; c < R; ++c) {
                double x = grid_.x(i, r) - grid_.x(j, c);
                auto at = polynomial(table, table_cell(std::abs(x) * PER_LENGTH + 1.0), PER_LENGTH);
                store8(with_sign(at, std::signbit(x)).value, &G_(r, c, 0));
            }
    }
    // Add to V of strip j the effect of loads on another strip, times its motions (6,).
    void add_part(double turn, const Rows& jumps, const Numbers& motions, long j) {
        std::fill(part_.begin(), part_.end(), 0.0);
        add_antiderivative({G_, turn}, jumps, 1.0, part_);
        add_moved(part_, motions, j);
    }
    void add_moved(const Rows& part, const Numbers& motions, long j) {
        for (int k = 0; k < POSE; ++k)
            for (long r = 0; r < R; ++r)
                for (int c = 0; c < 3; ++c) V_(k, j, r, c) += motions(k) * part(r, c);
    }

    static constexpr double PER_LENGTH = 1.0 / START;
    const PairMeans& smooth_;
    const StripGrid& grid_;
    Blocks jumps_;
    Rows share_, slope_;
    long S = grid_.size(), R = grid_.x.shape[1];
    Array<double, 4> V_{long(POSE), S, R, 3L};
    Array<double, 3> table_{smooth_.lines.shape[2], DEGREE + 1L, long(COMPONENTS)}, G_{R, R, long(LANES)};
    Array<double, 2> part_{R, 3L};    // of one strip by another one
    Array<double, 3> own_{S, R, 3L};  // of a strip by all, where it moves itself
    View<double, 3> used_;
};

// Parameters: values (S, block), of the state; arc (ns,) m, lines of the lower body, none where the compliance does not
// depend on places there; feet (S,) m, arc length of the strips' middles on the lower body; change (S, 6), their
// derivative.
inline FootDerivatives foot_derivatives(Rows values, const EquationData& data, Numbers arc, Numbers feet, Rows change) {
    const auto& [places, basis, smooth] = std::tie(data.places, data.basis, data.tables.smooth);
    long S = values.size(), n = smooth.share.shape[1];
    FootDerivatives by{Array<double, 4>(POSE, S, 2, basis.M()), Array<double, 3>(POSE, S, MOMENTS)};
    if (!arc.size() || !S) return by;
    auto grid = strip_grid(values, places, basis);
    auto jumps = force_jumps(values, places, basis, data.rolls());
    auto slope = share_slopes(arc.part(smooth.first, smooth.first + n), feet, places.width);
    Array<double, 2> share(S, n);
    for (long i = 0; i < S; ++i) {
        auto own = smooth.share[data.tables.place(places.strip(i))];
        std::copy(own.begin(), own.end(), share[i].begin());
    }
    auto V = MovedStrips(smooth, grid, jumps, share, slope).by_motions(change);
    for (int k = 0; k < POSE; ++k) add_slips(V[k], grid, basis, by.slips[k], by.moments[k]);
    return by;
}

}  // namespace wr
