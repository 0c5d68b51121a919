// Deviation of a finite body from a half-space between its lines, computed tile by tile on demand.
#pragma once
#include <cmath>
#include <functional>
#include <mutex>

#include "contact/models/lattice/influence/core/bulk.hpp"
#include "contact/models/lattice/influence/core/pair_samples.hpp"
#include "support/core/errors.hpp"
#include "support/core/owned.hpp"

namespace wr {

inline const char* const BEYOND = "the bodies touch beyond the part of their surface that carries contact points";

// Lines of a body: the first one, and one past the last.
struct LineRange {
    long first, stop;

    long size() const { return stop - first; }
};

// Number of cells from START up to a distance m.
inline long cells_up_to(double x) {
    double z = x / START + 1.0;
    long cell = table_cell(z).cell;
    return std::min(cell + (z > lower_bound(cell) ? 2 : 1), count_of(START));
}

constexpr int SPECTRA = 7;  // components with a spectrum: the even ones, XT and XN

// How coefficients are sums over K numbers of the spectra of pairs of lines.
struct DeviationWeights {
    Numbers arc;     // (ns,) m, of the lines
    Numbers bounds;  // (2,) m, ends of the lines
    Rows even, odd;  // (cells (DEGREE + 1), K) weights, of even and of odd components

    auto fields() { return std::tie(arc, bounds, even, odd); }
    bool fits() const {
        return arc.size() == 0 || (arc.size() > 1 && bounds.size() == 2 &&
                                   even.size() == count_of(START) * (DEGREE + 1) && odd.shape == even.shape);
    }
};

class FiniteBody {
  public:
    // Spectra (R, C, SPECTRA, K) of the displacement of the lines of a tile by loads on another tile.
    using Spectra = std::function<Array<double, 4>(long first, long second)>;

    // moves: whether strips move on the body.
    FiniteBody(const DeviationWeights& weights, bool moves, Spectra spectra)
        : weights(owned(weights)),
          spectra(std::move(spectra)),
          bounds(lines_of() + 1),
          filled(tiles(), tiles()),
          coefficients(std::array{lines_of(), lines_of(), count_of(START), long(DEGREE + 1), long(COMPONENTS)}),
          apart(lines_of(), lines_of(), 2),
          bulk{this->weights.arc, apart, filled, moves, this->weights.bounds},
          lines(coefficients) {
        const auto& arc = bulk.arc;
        long n = arc.size();
        for (long k = 1; k < n; ++k) bounds(k) = 0.5 * (arc(k) + arc(k - 1));
        bounds(0) = 2.0 * arc(0) - bounds(1), bounds(n) = 2.0 * arc(n - 1) - bounds(n - 1);
    }

  private:
    const Owned<DeviationWeights> weights;
    const Spectra spectra;
    Array<double, 1> bounds;        // (ns + 1,) m, of the cells around the lines
    Array<bool, 2> filled;          // pairs of tiles
    Array<double, 5> coefficients;  // (ns, ns, cells, DEGREE + 1, COMPONENTS)
    Array<double, 3> apart;         // `BulkCompliance::values`
    std::mutex filling;

    long lines_of() const { return weights.arc.size(); }
    long tiles() const { return (lines_of() + TILE - 1) / TILE; }

  public:
    const BulkCompliance bulk;
    const BetweenAllLines lines;

    double low() const { return bounds(0); }
    double high() const { return bounds(bounds.size() - 1); }

    // Lines that cover an interval of arc length m, with mutual coefficients. Throws OutsideSurface beyond.
    LineRange between(double from, double to) {
        if (from < low() || to > high()) throw OutsideSurface(BEYOND);
        long n = bulk.arc.size();
        auto after = [&](double s) { return std::upper_bound(bounds.begin(), bounds.end(), s) - bounds.begin(); };
        LineRange range{std::max(after(from) - 3, 0L), std::min(std::min(after(to), n) + 2, n)};
        std::lock_guard lock(filling);
        for (long i = range.first / TILE; i < (range.stop + TILE - 1) / TILE; ++i)
            for (long j = i; j < (range.stop + TILE - 1) / TILE; ++j)
                if (!filled(i, j)) fill(i, j);
        return range;
    }
    Numbers arc(LineRange range) const { return bulk.arc.part(range.first, range.stop); }

  private:
    // Compute the coefficients between two tiles, in both orders.
    void fill(long i, long j) {
        auto of = spectra(i, j);
        long n = lines_of(), K = weights.even.shape[1];
        if (of.shape != std::array{std::min(TILE, n - TILE * i), std::min(TILE, n - TILE * j), long(SPECTRA), K})
            throw std::invalid_argument("spectra: must be (R, C, SPECTRA, K)");
        Array<double, 2> even(K, LANES), odd(K, LANES);
        for (long r = 0; r < of.shape[0]; ++r)
            for (long c = 0; c < of.shape[1]; ++c) {
                long row = TILE * i + r, column = TILE * j + c;
                if (row > column) continue;
                auto spectrum = of[r][c];
                for (long k = 0; k < K; ++k) {
                    for (int m = 0; m < EVEN; ++m) even(k, m) = spectrum(m, k);
                    odd(k, XT) = spectrum(EVEN, k), odd(k, XN) = spectrum(EVEN + 1, k);
                }
                store(even, odd, row, column);
            }
        for (bool* flag : {&filled(i, j), &filled(j, i)}) __atomic_store_n(flag, true, __ATOMIC_RELEASE);
    }
    // Store coefficients and bulk compliance of a pair of lines, in both orders.
    void store(const Array<double, 2>& even, const Array<double, 2>& odd, long row, long column) {
        constexpr double RECIPROCAL[LANES] = {1, 1, 1, 1, -1, -1, 1, 1};  // signs in the other order
        auto of = vectors(even), beside = vectors(odd);
        auto forward = coefficients[row][column], backward = coefficients[column][row];
        for (long n = 0; n < weights.even.size(); ++n) {
            v8 sum{};
            for (long k = 0; k < of.count; ++k) {
                sum = fma(of[k], splat(weights.even(n, k)), sum);
                sum = fma(beside[k], splat(weights.odd(n, k)), sum);
            }
            store8(sum, forward.data + LANES * n);
            if (row < column) store8(sum * load8(RECIPROCAL), backward.data + LANES * n);
        }
        store_bulk(row, column), store_bulk(column, row);
    }
    // Normal displacement m/N of separate lines by lateral loads and by pressure on other lines. It varies little along
    // a contact, and is the mean over the first cell with weights that fall linearly with the distance, 2 (G(l) - G(0))
    // / l^2 of G'' = C.
    void store_bulk(long row, long column) {
        auto first = lines[row][column][0];
        constexpr double width = 1.0 / CELLS, length = START / CELLS;
        auto mean = [&](int component) {
            double rise = 0.0;
            for (int k = DEGREE; k > 0; --k) rise = (rise + first(k, component)) * width;
            return 2.0 * rise / (length * length);
        };
        apart(row, column, 0) = mean(TN_TURN) - mean(TN), apart(row, column, 1) = mean(NN);
    }
};

// Strips with middles and widths (C,) m, and the ends m of the covered part of a body.
struct CoveredPart {
    double low = std::numeric_limits<double>::infinity(), high = -low;

    CoveredPart(Numbers middle, Numbers width) {
        for (long i = 0; i < middle.size(); ++i) {
            low = std::min(low, middle(i) - 0.5 * width(i));
            high = std::max(high, middle(i) + 0.5 * width(i));
        }
    }
};

}  // namespace wr
