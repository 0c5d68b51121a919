// Cells of the tables of pairs of strips along x, and the components that are tabulated.
#pragma once
#include <bit>
#include <cstdint>
#include <tuple>

#include "support/core/lanes.hpp"

namespace wr {

constexpr int CELLS = 8;  // an octave
constexpr int DEGREE = 5;
constexpr int COMPONENTS = LANES;
enum Component { XX, TT, NN, TN, TN_TURN, XT, ROLL, XN };
constexpr int EVEN = 5;         // components that are even functions of x, the first ones; the others are odd
constexpr double REACH = 0.25;  // m, longest distance along x
constexpr double START = 0.04;  // m: cells of 5 mm up to this distance; of 2.5 mm, forces change by 1e-6

using Coefficients = View<double, 3>;  // (cells, DEGREE + 1, COMPONENTS)

// Place in a table: its cell, and z less the cell's lower bound.
struct TableCell {
    long cell;
    double rest;
};

// Place at z = 1 + |x| / start: the exponent and the three leading bits of the fraction are the cell.
inline TableCell table_cell(double z) {
    constexpr int below = 49;  // bits of a double below them
    auto top = std::bit_cast<std::uint64_t>(z) >> below;
    return {long(top) - (1023L << 3), z - std::bit_cast<double>(top << below)};
}

// Lower bound of a cell.
inline double lower_bound(long cell) { return std::ldexp(1.0 + double(cell % CELLS) / CELLS, int(cell / CELLS)); }

// Values and slopes by length of the components.
struct Values {
    v8 value, slope;
};

// Polynomial of a cell of a table (cells (DEGREE + 1),) at z less its lower bound.
inline Values polynomial(const Vectors& table, const TableCell& at, double per_length) {
    static_assert(DEGREE == 5);
    long first = (DEGREE + 1) * at.cell;
    v8 u = splat(at.rest), value = table[first + DEGREE], slope = value;
    for (int k = DEGREE - 1; k >= 0; --k) {
        if (k < DEGREE - 1) slope = fma(slope, u, value);
        value = fma(value, u, table[first + k]);
    }
    return {value, slope * splat(per_length)};
}

// With signs of x; odd components, and slopes of even ones, change with it.
constexpr double SIGNS[3][LANES] = {
    {1, 1, 1, 1, 1, 1, 1, 1}, {1, 1, 1, 1, 1, -1, -1, -1}, {-1, -1, -1, -1, -1, 1, 1, 1}};
inline Values with_sign(const Values& at, bool behind) {
    return {at.value * load8(SIGNS[behind ? 1 : 0]), at.slope * load8(SIGNS[behind ? 2 : 0])};
}

// Constants of the polynomials of a cell, by linear algebra in Python.
struct CellRule {
    Numbers nodes;   // (DEGREE + 1,) places of samples from 0 to 1
    Rows to_powers;  // (DEGREE + 1, DEGREE + 1) from samples to coefficients of powers
    Rows integrals;  // (DEGREE + 1, DEGREE + 1) from samples to integrals from 0 to the nodes
    Rows changes;    // (2, DEGREE + 1) powers of polynomials that are zero at both ends and at the middle nodes, with
                     // slopes 1 and 0 at the ends, and 0 and 1

    auto fields() { return std::tie(nodes, to_powers, integrals, changes); }
    bool fits() const {
        constexpr long n = DEGREE + 1;
        using Two = std::array<long, 2>;
        return nodes.size() == n && to_powers.shape == Two{n, n} && integrals.shape == Two{n, n} &&
               changes.shape == Two{2, n};
    }
};

// Make polynomials (n, DEGREE + 1, m) of powers of z less the cell's lower bound continuously differentiable, in place:
// at bounds their slopes become the mean of both cells'. The errors of both slopes have opposite signs; a jump, 1e-6 of
// the slope, would be a step of the displacement, on which ends of short strips have no place.
//
// width: (n,) of the cells. even: number of functions, the first ones, whose slope at the first bound is 0.
inline void join_cells(const Coefficients& values, const Numbers& width, long even, const CellRule& rule) {
    long n = values.size(), m = values.shape[2];
    Array<double, 3> slopes(2, n, m);  // at the lower and at the upper bound
    for (long cell = 0; cell < n; ++cell)
        for (long c = 0; c < m; ++c) {
            double power = 1.0, upper = 0.0;
            for (int k = 1; k <= DEGREE; ++k) {
                upper += k * power * values(cell, k, c);
                power *= width(cell);
            }
            slopes(0, cell, c) = values(cell, 1, c), slopes(1, cell, c) = upper;
        }
    for (long cell = 0; cell < n; ++cell)
        for (long c = 0; c < m; ++c) {
            double low = slopes(0, cell, c), high = slopes(1, cell, c), lower = c < even ? -low : 0.0, upper = 0.0;
            if (cell > 0) lower = 0.5 * (slopes(1, cell - 1, c) - low);
            if (cell < n - 1) upper = 0.5 * (slopes(0, cell + 1, c) - high);
            double power = width(cell);
            for (int k = 0; k <= DEGREE; ++k) {
                values(cell, k, c) += power * (lower * rule.changes(0, k) + upper * rule.changes(1, k));
                power /= width(cell);
            }
        }
}

}  // namespace wr
