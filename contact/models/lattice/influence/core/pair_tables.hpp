// Tables of the compliance between pairs of strips of a lattice, see
// `wheelrail.contact.models.lattice.influence.pair_tables`.
#pragma once
#include "contact/models/lattice/influence/core/basis.hpp"
#include "contact/models/lattice/influence/core/pair_grid.hpp"

namespace wr {

// Coefficients of the pairs i <= j of C strips, the means over them, computed as far as a pair is looked up.
struct PairMeans {
    View<const double, 5> lines;  // (ns, ns, cells, DEGREE + 1, COMPONENTS) of pairs of lines
    long first = 0;               // line from which on the weights count
    Rows share;                   // (C, n) weights of the lines in the strips
    View<double, 4> values;       // (C (C + 1) / 2, cells, DEGREE + 1, COMPONENTS), a pair in row j (j + 1) / 2 + i
    View<long, 1> known;          // (C (C + 1) / 2,) number of cells that are computed

    auto fields() { return std::tie(lines, first, share, values, known); }
    bool fits() const {
        long C = share.size(), pairs = C * (C + 1) / 2;
        bool right = lines.shape[0] == lines.shape[1] && lines.shape[3] == DEGREE + 1 && lines.shape[4] == COMPONENTS &&
                     values.shape[2] == DEGREE + 1 && values.shape[3] == COMPONENTS && values.size() == pairs &&
                     known.size() == pairs && values.shape[1] <= lines.shape[2] && first >= 0 &&
                     first + share.shape[1] <= lines.shape[0];
        for (long cells : known) right &= cells >= 0 && cells <= values.shape[1];
        return right;
    }
};

// Tables of the pairs i <= j of a lattice of K strips, as far as needed at a pose.
struct PairTables {
    Blocks values;  // (cells, DEGREE + 1, COMPONENTS) m/N times m2, of powers of z less the cell's lower bound
    View<const int, 2> pair;  // (K, K) number of a pair i <= j, 0 of those without tables
    Indices first;            // (P,) first cell of a pair
    Indices cells;            // (P,) its number of cells
    Numbers inverse;          // (P,) 1/m, 1 / start
    Indices place;            // (K,) place of the strips in smooth
    PairMeans smooth;         // deviation of the lower body from a half-space, in cells from START; none: in values

    auto fields() { return std::tie(values, pair, first, cells, inverse, place, smooth); }
    // Numbers of pairs, thousands of strips have millions, are checked when they are looked up.
    bool fits() const {
        long K = place.size(), P = first.size(), C = smooth.share.size();
        bool right = values.shape[1] == DEGREE + 1 && values.shape[2] == COMPONENTS && pair.shape[0] == K &&
                     pair.shape[1] == K && cells.size() == P && inverse.size() == P;
        for (long p = 0; right && p < P; ++p)
            right &= first(p) >= 0 && cells(p) >= 0 && first(p) + cells(p) <= values.size();
        for (long at : place) right &= at >= 0 && (at < C || C == 0);
        return right;
    }
};

// Strips of a lattice.
struct Lattice {
    Numbers middle;               // (K,) m
    Numbers width;                // (K,) m
    Numbers stretch;              // (K,) length on the surface over length on the rolling circle
    View<const bool, 1> carried;  // (K,) whether they lie on the lines of the bodies on which their place is fixed
    Numbers bounds;               // (2,) m, ends of the lines of the lower body, where their place moves; or infinite

    auto fields() { return std::tie(middle, width, stretch, carried, bounds); }
    bool fits() const {
        long K = middle.size();
        return width.size() == K && stretch.size() == K && carried.size() == K && bounds.size() == 2;
    }
};

// Part of the tables that depends on the pose.
struct PoseMeans {
    Indices place;
    PairMeans smooth;

    auto fields() { return std::tie(place, smooth); }
};

// Tables of the deviation from a half-space of each body alone, without pair means for a half-space.
struct BodyTables {
    PairTables upper, lower;
    Numbers share;  // (2,) of the bodies in the compliance of both half-spaces

    auto fields() { return std::tie(upper, lower, share); }
    bool fits() const { return share.size() == 2; }
};

}  // namespace wr
