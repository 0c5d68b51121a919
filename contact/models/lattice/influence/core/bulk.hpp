// Deviation of finite bodies from half-spaces in the displacement of strips by loads on other strips, see
// `wheelrail.contact.models.lattice.influence.bulk`.
#pragma once
#include <limits>

#include "contact/models/lattice/influence/core/body_correction.hpp"

namespace wr {

constexpr long TILE = 16;  // lines: granularity of the parts of the surface whose correction is assembled

// Compliance of a body between its lines.
struct BulkCompliance {
    Numbers arc;                 // (ns,) m, of the lines
    Blocks values;               // (ns, ns, 2) m/N of pairs of lines, see `bulk_compliance`
    View<const bool, 2> filled;  // (T, T) pairs of tiles of lines between which there are values
    bool moves = false;          // whether strips move on the body
    Numbers bounds;              // (2,) m, ends of its lines

    auto fields() { return std::tie(arc, values, filled, moves, bounds); }
    bool fits() const {
        long n = arc.size(), tiles = (n + TILE - 1) / TILE;
        return n > 1 && values.shape == std::array<long, 3>{n, n, 2} &&
               filled.shape == std::array<long, 2>{tiles, tiles} && bounds.size() == 2;
    }
};

// Displacement (R,) m of a body at some places, linear between its lines, by loads on strips.
//
// arc: (ns,) m, of the lines. compliance: (ns, ns, 2) m/N of pairs of lines. place: (R,) m.
// middle, width: (S,) m, of the strips. loads: (S, 2) N.
inline Array<double, 1> bulk_displacements(const Numbers& arc, const Blocks& compliance, const Numbers& place,
                                           const Numbers& middle, const Numbers& width, const Rows& loads) {
    long last = arc.size() - 1, first = last, end = 0;
    Array<double, 2> on_lines(arc.size(), 2);
    for (long j = 0; j < middle.size(); ++j) {
        double low = middle(j) - 0.5 * width(j), high = middle(j) + 0.5 * width(j);
        long m = std::max(line_from(arc, low) - 1, 0L);
        first = std::min(first, m);
        while (m <= last) {
            double share = (hat_integral(arc, m, high) - hat_integral(arc, m, low)) / width(j);
            for (int c = 0; c < 2; ++c) on_lines(m, c) += share * loads(j, c);
            if (arc(m++) >= high) break;
        }
        end = std::max(end, m);
    }
    Array<double, 1> total(place.size());
    for (long i = 0; i < place.size(); ++i) {
        auto [k, t] = between_lines(arc, place(i));
        for (long m = first; m < end; ++m)
            for (int c = 0; c < 2; ++c) {
                double at = (1.0 - t) * compliance(k - 1, m, c) + t * compliance(k, m, c);
                total(i) += on_lines(m, c) * at;
            }
    }
    return total;
}

// Arc length (n,) m on a body of the middles of strips with widths (n,) m, at most on its last lines.
//
// middle, foot: (n,) m, on the upper and on the lower body.
inline Array<double, 1> bulk_places(const BulkCompliance& body, const Numbers& middle, const Numbers& width,
                                    const Numbers& foot) {
    Array<double, 1> places(middle.size());
    for (long i = 0; i < middle.size(); ++i) {
        double half = 0.5 * width(i), place = body.moves ? foot(i) : middle(i);
        places(i) = std::min(std::max(place, body.bounds(0) + half), body.bounds(1) - half);
    }
    return places;
}

// Middles and widths (n,) m of strips on a body.
struct BulkStrips {
    Numbers places, width;
};

// Whether there are values between all lines around two sets of strips.
inline bool bulk_known(const BulkCompliance& body, const BulkStrips& first, const BulkStrips& second) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const auto* strips : {&first, &second})
        for (long i = 0; i < strips->places.size(); ++i) {
            double place = strips->places(i), half = 0.5 * strips->width(i);
            low = std::min(low, place - half), high = std::max(high, place + half);
        }
    long start = std::max(line_from(body.arc, low) - 1, 0L) / TILE;
    long end = std::min(line_from(body.arc, high), body.arc.size() - 1) / TILE;
    for (long i = start; i <= end; ++i)
        for (long j = start; j <= i; ++j)
            // another thread may be filling; what it has stored before the flag is then seen
            if (!__atomic_load_n(&body.filled(i, j), __ATOMIC_ACQUIRE)) return false;
    return true;
}

}  // namespace wr
