// Tables of the compliance between pairs of strips of a lattice, both bodies together, in the strips' own axes.
//
// With G'' = C the compliance along x, the mean displacement of cells by forces on cells is a second difference of G.
// Near its load a body is a half-space, whose part of G depends on the strips' widths and distances on the upper body
// alone and is tabulated once for all poses; the deviation of finite bodies from half-spaces is smooth.
//
// Cells of the tables: z = 1 + |x| / start, CELLS equal ones in every octave of z, polynomials of degree DEGREE in
// each; means over contact cells err by 1e-7. Axes are longitudinal x, lateral t and outward normal n of the upper body
// on either strip. Displacement by force is symmetric up to TN_TURN, ROLL and XN, which change their sign when the pair
// is taken in the other order: C_tn = TN + TN_TURN, C_nt = TN - TN_TURN, C_xt = C_tx = XT, and C_xn = -C_nx = XN. The
// coupling of normal with tangential directions, (1 + nu)(1 - 2 nu)/(2 pi E) times x/r^2 and y/r^2, has opposite signs
// in both bodies: half-spaces of equal material have none. Parts with the other symmetry are neglected: (C_xt -
// C_tx)/2, up to 1 % of XX at 5 mm and of the elastic slip, and (C_xn + C_nx)/2, about 0.1 %. The first five components
// are even functions of x, the others odd. ROLL is added to C_xn alone: the radial component of u_n by pressure over R,
// integrated along x. On a wheel the slip is -du_x/dx - u_r/R, for a compressed wheel rolls on a smaller radius. The
// rigid slip at s has the radius there, but the material at s comes from s - u_t (`body_displacement.hpp`), where the
// radius differs by as much as u_t adds to u_r: u_n alone remains.
#pragma once
#include <limits>
#include <stdexcept>

#include "contact/models/lattice/influence/core/basis.hpp"
#include "contact/models/lattice/influence/core/body_correction.hpp"

namespace wr {

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
    // Whether the sizes of the arrays fit; pair numbers, millions for thousands of strips, are checked on look-up.
    bool fits() const {
        long K = place.size(), P = first.size(), C = smooth.share.size();
        bool right = values.shape[1] == DEGREE + 1 && values.shape[2] == COMPONENTS && pair.shape[0] == K &&
                     pair.shape[1] == K && cells.size() == P && inverse.size() == P;
        for (long p = 0; right && p < P; ++p)
            right &= first(p) >= 0 && cells(p) >= 0 && first(p) + cells(p) <= values.size() && !(inverse(p) < 0.0);
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

// Chosen strips on the lines of the lower body.
struct StripsOnLines {
    Array<long, 1> place;            // (K,) numbers among the chosen ones
    Array<double, 1> middle, width;  // (C,) m, of these on the lower body
    double low, high;                // m, ends of the part that they cover
};

// Strips beyond the lines of the body are moved to the last ones. There a deviation from a half-space is a guess, which
// serves to find that a strip remains without load.
//
// chosen: (K,). feet: (K,) m, arc length of the strips' middles on the lower body.
inline StripsOnLines strips_on_lines(const Lattice& lattice, const View<const bool, 1>& chosen, const Numbers& feet) {
    long C = std::count(chosen.begin(), chosen.end(), true);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    StripsOnLines on{Array<long, 1>(chosen.size()), Array<double, 1>(C), Array<double, 1>(C), infinity, -infinity};
    for (long k = 0, i = 0; k < chosen.size(); ++k) {
        if (!chosen(k)) continue;
        double half = 0.5 * lattice.width(k);
        double middle = std::min(std::max(feet(k), lattice.bounds(0) + half), lattice.bounds(1) - half);
        on.place(k) = i, on.width(i) = lattice.width(k), on.middle(i++) = middle;
        on.low = std::min(on.low, std::max(middle - half, lattice.bounds(0)));  // despite round-off
        on.high = std::max(on.high, std::min(middle + half, lattice.bounds(1)));
    }
    return on;
}

// Largest distance of boundaries in order on two strips.
inline double farthest(const Numbers& rows, const Numbers& columns) {
    return std::max(std::abs(rows(0) - columns(columns.size() - 1)), std::abs(rows(rows.size() - 1) - columns(0)));
}

// Tables of a pair of strips i <= j up to a distance m, that of the half-spaces and that of the deviation.
class Pair {
  public:
    Pair(const PairTables& t, long i, long j, double reach) {
        if (i < 0 || i > j || j >= t.place.size()) throw std::out_of_range("strip without tables");
        long pair = t.pair(i, j);
        if (pair < 0 || pair >= t.first.size()) throw std::out_of_range("pair without tables");
        cells = t.cells(pair), inverse = t.inverse(pair);
        own = vectors(t.values.part(t.first(pair), t.first(pair) + cells));
        if (t.smooth.none()) return;
        long first = t.place(i), second = t.place(j);
        if (first > second) throw std::out_of_range("places of strips without order");
        auto means = pair_mean(t.smooth, first, second, table_cell(reach / START + 1.0).cell + 1);
        smooth_cells = means.size(), smooth = vectors(means);
    }
    // Write values and slopes of all components at x m; false beyond the tables.
    bool at(double x, Values& sum) const {
        double away = std::abs(x);
        TableCell place = table_cell(away * inverse + 1.0);
        if (!(place.cell < cells)) return false;
        sum = polynomial(own, place, inverse);
        if (smooth_cells) {
            constexpr double per_length = 1.0 / START;
            place = table_cell(away * per_length + 1.0);
            if (!(place.cell < smooth_cells)) return false;
            Values more = polynomial(smooth, place, per_length);
            sum = {sum.value + more.value, sum.slope + more.slope};
        }
        return true;
    }
    // Write value and slope by |x| of the component NN at x m; false beyond the tables.
    bool normal_at(double x, double& value, double& slope) const {
        double away = std::abs(x);
        TableCell place = table_cell(away * inverse + 1.0);
        if (!(place.cell < cells)) return false;
        normal_polynomial(own, place, value, slope);
        slope *= inverse;
        if (smooth_cells) {
            place = table_cell(away / START + 1.0);
            if (!(place.cell < smooth_cells)) return false;
            double deviation = 0.0, change = 0.0;
            normal_polynomial(smooth, place, deviation, change);
            value += deviation, slope += change / START;
        }
        return true;
    }

  private:
    static void normal_polynomial(const Vectors& table, const TableCell& at, double& value, double& slope) {
        long first = (DEGREE + 1) * at.cell;
        value = table(first + DEGREE, NN), slope = 0.0;
        for (int k = DEGREE - 1; k >= 0; --k) {
            slope = std::fma(slope, at.rest, value);
            value = std::fma(value, at.rest, table(first + k, NN));
        }
    }

    Vectors own, smooth;
    long cells = 0, smooth_cells = 0;
    double inverse = 0.0;
};

// Write G (R, C, 8), and its slopes H if wanted, at the distances between boundaries of two strips.
// rows (R,) on strip i, columns (C,) on j >= i; with turn = -1 at the opposite distances. False where they are farther
// apart than the table reaches.
template <bool slopes>
bool look_up(const PairTables& tables, long i, long j, const Numbers& rows, const Numbers& columns,
             const View<double, 3>& G, const View<double, 3>& H, double turn = 1.0) {
    Pair pair(tables, i, j, farthest(rows, columns));
    bool turned = turn < 0.0;
    for (long r = 0; r < rows.size(); ++r) {
        View<double, 2> values = G[r], changes;
        if constexpr (slopes) changes = H[r];
        Numbers places = columns;
        double row = rows(r);
        for (long c = 0; c < places.size(); ++c) {
            double x = row - places(c);
            Values at;
            if (!pair.at(x, at)) return false;
            at = with_sign(at, std::signbit(x) != turned);
            store8(at.value, &values(c, 0));
            if constexpr (slopes) store8(at.slope, &changes(c, 0));
        }
    }
    return true;
}

}  // namespace wr
