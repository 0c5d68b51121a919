// Deviation of a finite body from a half-space between its lines, computed tile by tile when it is first needed.
#pragma once
#include <functional>
#include <mutex>

#include "contact/models/lattice/influence/core/bulk.hpp"
#include "contact/models/lattice/influence/core/pair_samples.hpp"
#include "support/core/errors.hpp"

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

class FiniteBody {
  public:
    // Computes the values between two tiles of lines, first <= second, in both orders.
    using Fill = std::function<void(long first, long second)>;

    // bulk: compliance between the lines. lines: coefficients between them. Both are filled where `bulk.filled`.
    FiniteBody(const BulkCompliance& bulk, const BetweenAllLines& lines, Fill fill)
        : bulk(bulk), lines(lines), fill(std::move(fill)), bounds(bulk.arc.size() + 1) {
        const auto& arc = bulk.arc;
        long n = arc.size();
        for (long k = 1; k < n; ++k) bounds(k) = 0.5 * (arc(k) + arc(k - 1));
        bounds(0) = 2.0 * arc(0) - bounds(1), bounds(n) = 2.0 * arc(n - 1) - bounds(n - 1);
    }

    const BulkCompliance bulk;
    const BetweenAllLines lines;

    double low() const { return bounds(0); }
    double high() const { return bounds(bounds.size() - 1); }

    // Lines that cover an interval of arc length m, with coefficients between them. Throws OutsideSurface beyond.
    LineRange between(double from, double to) {
        if (from < low() || to > high()) throw OutsideSurface(BEYOND);
        long n = bulk.arc.size();
        auto after = [&](double s) { return std::upper_bound(bounds.begin(), bounds.end(), s) - bounds.begin(); };
        LineRange range{std::max(after(from) - 3, 0L), std::min(std::min(after(to), n) + 2, n)};
        std::lock_guard lock(filling);
        for (long i = range.first / TILE; i < (range.stop + TILE - 1) / TILE; ++i)
            for (long j = i; j < (range.stop + TILE - 1) / TILE; ++j)
                if (!bulk.filled(i, j)) fill(i, j);
        return range;
    }
    Numbers arc(LineRange range) const { return bulk.arc.part(range.first, range.stop); }

  private:
    Fill fill;
    Array<double, 1> bounds;  // (ns + 1,) m, of the cells around the lines
    std::mutex filling;
};

// Strips with middles and widths (C,) m, and the ends m of the part of a body that they cover.
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
