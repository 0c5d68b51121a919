// Deviation of finite bodies from half-spaces: means over strips of tables between lines of the surface.
#pragma once
#include "contact/models/lattice/influence/core/pair_grid.hpp"

namespace wr {

// Index of the first line at or beyond s m.
inline long line_from(const Numbers& arc, double s) {
    return std::lower_bound(arc.begin(), arc.end(), s) - arc.begin();
}

// Place between two lines: the second one, and its weight from 0 to 1 in what is linear between them.
struct BetweenLines {
    long right;
    double share;
};
inline BetweenLines between_lines(const Numbers& arc, double s) {
    long right = std::clamp(line_from(arc, s), 1L, arc.size() - 1);
    double share = (s - arc(right - 1)) / (arc(right) - arc(right - 1));
    return {right, std::min(std::max(share, 0.0), 1.0)};
}

// Integral up to s m of the hat function of line k, 1 there, 0 at all other lines and linear in between.
inline double hat_integral(const Numbers& arc, long k, double s) {
    double total = 0.0;
    if (k > 0 && s > arc(k - 1)) {
        double t = std::min(s, arc(k)) - arc(k - 1);
        total += 0.5 * t * t / (arc(k) - arc(k - 1));
    }
    if (k < arc.size() - 1 && s > arc(k)) {
        double wide = arc(k + 1) - arc(k), t = std::min(s - arc(k), wide);
        total += t - 0.5 * t * t / wide;
    }
    return total;
}

// Values (S, n) at s (S,) m of hat functions on lines (n,) m, each 1 at one line and 0 at all other lines.
inline Array<double, 2> hats(const Numbers& arc, const Numbers& s) {
    Array<double, 2> values(s.size(), arc.size());
    for (long i = 0; i < s.size(); ++i) {
        auto [right, share] = between_lines(arc, s(i));
        values(i, right - 1) = 1.0 - share, values(i, right) = share;
    }
    return values;
}

// Weights (S, n) of lines (n,) m, with linear interpolation, in means over strips, middles and widths (S,) m.
inline Array<double, 2> strip_shares(const Numbers& arc, const Numbers& middle, const Numbers& width) {
    Array<double, 2> share(middle.size(), arc.size());
    for (long i = 0; i < middle.size(); ++i) {
        double low = middle(i) - 0.5 * width(i), high = middle(i) + 0.5 * width(i);
        long end = std::min(line_from(arc, high) + 1, arc.size());
        for (long k = std::max(line_from(arc, low) - 1, 0L); k < end; ++k)
            share(i, k) = (hat_integral(arc, k, high) - hat_integral(arc, k, low)) / width(i);
    }
    return share;
}

// Derivatives (S, n) 1/m of `strip_shares` by the middles.
inline Array<double, 2> share_slopes(const Numbers& arc, const Numbers& middle, const Numbers& width) {
    Array<double, 2> slopes(middle.size(), arc.size());
    for (long i = 0; i < middle.size(); ++i) {
        auto low = between_lines(arc, middle(i) - 0.5 * width(i)),
             high = between_lines(arc, middle(i) + 0.5 * width(i));
        for (long k = low.right - 1; k <= high.right; ++k) {
            auto at = [&](const BetweenLines& b) {
                return k == b.right ? b.share : k == b.right - 1 ? 1.0 - b.share : 0.0;
            };
            slopes(i, k) = (at(high) - at(low)) / width(i);
        }
    }
    return slopes;
}

using BetweenAllLines = View<const double, 5>;  // (ns, ns, cells, DEGREE + 1, COMPONENTS) coefficients between lines

// Add the coefficients (cells, DEGREE + 1, COMPONENTS) of a pair of strips, from coefficients of lines.
//
// row, column: (n,) weights of the lines from the first in both strips. start: the first cell.
inline void add_pair_mean(const BetweenAllLines& lines, long first, const Numbers& row, const Numbers& column,
                          const Coefficients& to, long start = 0) {
    long count = to.size() * (DEGREE + 1), wide = lines.shape[1], cells = lines.shape[2];
    Vectors all = vectors(lines), sums = vectors(to);
    for (long k = 0; k < row.size(); ++k) {
        if (row(k) == 0.0) continue;
        for (long m = 0; m < column.size(); ++m) {
            double weight = row(k) * column(m);
            if (weight == 0.0) continue;
            v8 factor = splat(weight);
            Vectors from = all.part((DEGREE + 1) * (((first + k) * wide + first + m) * cells + start), count);
            for (long n = 0; n < count; ++n) store8(fma(from[n], factor, sums[n]), to.data + LANES * n);
        }
    }
}

// Coefficients of the pairs i <= j of C strips, means over both strips, computed on demand.
struct PairMeans {
    BetweenAllLines lines;
    long first = 0;          // line from which on the weights count
    Rows share;              // (C, n) weights of the lines in the strips
    View<double, 4> values;  // (C (C + 1) / 2, cells, DEGREE + 1, COMPONENTS), a pair in row j (j + 1) / 2 + i
    View<long, 1> known;     // (C (C + 1) / 2,) number of cells that are computed

    auto fields() { return std::tie(lines, first, share, values, known); }
    bool fits() const {
        long C = share.size(), pairs = C * (C + 1) / 2;
        bool right = lines.shape[0] == lines.shape[1] && lines.shape[3] == DEGREE + 1 && lines.shape[4] == COMPONENTS &&
                     values.shape[2] == DEGREE + 1 && values.shape[3] == COMPONENTS && values.size() == pairs &&
                     known.size() == pairs && first >= 0 && first + share.shape[1] <= lines.shape[0] &&
                     (pairs == 0 || values.shape[1] <= lines.shape[2]);
        for (long cells : known) right &= cells >= 0 && cells <= values.shape[1];
        return right;
    }
    bool none() const { return values.size() == 0; }
};

// Coefficients of a pair i <= j, valid in some first cells.
inline Coefficients pair_mean(const PairMeans& means, long i, long j, long cells) {
    long row = j * (j + 1) / 2 + i, known = means.known(row);
    auto values = means.values[row];
    cells = std::min(cells, values.size());
    if (known < cells) {
        auto added = values.part(known, cells);
        std::fill(added.begin(), added.end(), 0.0);
        add_pair_mean(means.lines, means.first, means.share[i], means.share[j], added, known);
        means.known(row) = cells;
    }
    return values;
}

// Compute the coefficients of all pairs in all cells.
inline void complete_means(const PairMeans& means) {
    for (long j = 0; j < means.share.size(); ++j)
        for (long i = 0; i <= j; ++i) pair_mean(means, i, j, means.values.shape[1]);
}

}  // namespace wr
