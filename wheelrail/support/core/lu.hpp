// LU factors of square matrices with partial pivoting, P A = L U, and solutions by the factors; L has a unit diagonal.
//
// Sums have the same order on every processor, so that results have the same bits; LAPACK's have not, and its threads
// wait for each other. Up to 400 unknowns it takes 1.0 to 1.3 times the time of OpenBLAS on one core.
#pragma once
#include <cmath>
#include <utility>

#include "support/core/arrays.hpp"
#include "support/core/errors.hpp"

namespace wr {

constexpr long BLOCK = 32;      // columns that are eliminated together
constexpr int TILE_HEIGHT = 6;  // rows of a tile whose sums stay in registers
#if defined(__AVX2__)
constexpr int REGISTER = 32;  // bytes
#else
constexpr int REGISTER = 16;
#endif

// Two registers side by side: the width of a tile.
template <class T>
struct TileRow {
    static constexpr long LANES = REGISTER / sizeof(T), WIDE = 2 * LANES;
    typedef T vector __attribute__((vector_size(REGISTER)));
    typedef T anywhere __attribute__((vector_size(REGISTER), aligned(sizeof(T)), may_alias));

    vector left{}, right{};

    static TileRow load(const View<const T, 1>& from) {
        const auto* at = reinterpret_cast<const anywhere*>(from.data);
        return {at[0], at[1]};
    }
    void add(T factor, const TileRow& row) { left += factor * row.left, right += factor * row.right; }
    // Subtract from the first numbers of a row.
    void subtract_from(const View<T, 1>& to) const {
        if (to.size() == WIDE) {
            auto* at = reinterpret_cast<anywhere*>(to.data);
            at[0] -= left, at[1] -= right;
            return;
        }
        for (long c = 0; c < to.size(); ++c) to(c) -= c < LANES ? left[c] : right[c - LANES];
    }
};

// Subtract a multiple of a row from another one.
template <class T>
void subtract_multiple(T factor, View<const T, 1> from, View<T, 1> to) {
    T* result = to.data;
    for (long k = 0; k < from.size(); ++k) result[k] -= factor * from.data[k];
}

// Subtract the product of some columns, first to before last, and equal-numbered rows from the block below and right of
// both; packed: room for these rows in tiles.
template <class T>
void subtract_product(const View<T, 2>& m, long first, long last, const View<T, 3>& packed) {
    constexpr long WIDE = TileRow<T>::WIDE;
    long n = m.size(), count = last - first, tiles = (n - last + WIDE - 1) / WIDE;
    for (long tile = 0; tile < tiles; ++tile)
        for (long k = 0; k < count; ++k)
            for (long c = 0, j = last + tile * WIDE; c < WIDE; ++c, ++j)
                packed(tile, k, c) = j < n ? m(first + k, j) : T(0);
    auto subtract = [&]<int ROWS>(long i, std::integral_constant<int, ROWS>) {
        for (long tile = 0, j = last; tile < tiles; ++tile, j += WIDE) {
            TileRow<T> sums[ROWS];
            auto rows = packed[tile];
            const T* left = m[i].part(first, n).data;
            for (long k = 0; k < count; ++k) {
                auto row = TileRow<T>::load(rows[k]);
                for (int r = 0; r < ROWS; ++r) sums[r].add(left[r * n + k], row);
            }
            for (int r = 0; r < ROWS; ++r) sums[r].subtract_from(m[i + r].part(j, std::min(j + WIDE, n)));
        }
    };
    long i = last;
    for (; i + TILE_HEIGHT <= n; i += TILE_HEIGHT) subtract(i, std::integral_constant<int, TILE_HEIGHT>());
    for (; i < n; ++i) subtract(i, std::integral_constant<int, 1>());
}

// Replace a matrix (n, n) by its factors, L below the diagonal and U; pivots (n,): row that has changed places with
// each. Whether it is regular.
template <class T>
bool factorise(const View<T, 2>& m, const View<int, 1>& pivots) {
    long n = m.size(), wide = TileRow<T>::WIDE;
    auto packed = Array<T, 3>::unset({n / wide + 1, BLOCK, wide});
    for (long first = 0; first < n; first += BLOCK) {
        long last = std::min(first + BLOCK, n);
        for (long c = first; c < last; ++c) {
            long best = c;
            T largest = 0;
            for (long i = c; i < n; ++i)
                if (T size = std::abs(m(i, c)); size > largest) largest = size, best = i;
            pivots(c) = int(best);
            if (!(largest > 0)) return false;
            auto pivot = m[c];
            if (best != c) std::swap_ranges(pivot.begin(), pivot.end(), m[best].begin());
            for (long i = c + 1; i < n; ++i)
                if (T factor = m(i, c) /= pivot(c); factor != 0)
                    subtract_multiple<T>(factor, pivot.part(c + 1, last), m[i].part(c + 1, last));
        }
        for (long c = first; c < last; ++c)
            for (long i = c + 1; i < last; ++i) subtract_multiple<T>(m(i, c), m[c].part(last, n), m[i].part(last, n));
        subtract_product(m, first, last, packed);
    }
    return true;
}

// Replace right-hand sides (k, n) by the solutions with factors.
template <class T>
void solve(const View<const T, 2>& lu, const View<const int, 1>& pivots, const View<T, 2>& right) {
    long n = lu.size(), sides = right.size();
    for (long i = 0; i < n; ++i)
        for (long r = 0; r < sides; ++r) {
            auto x = right[r];
            if (pivots(i) != i) std::swap(x(i), x(pivots(i)));
        }
    for (long i = 1; i < n; ++i)
        for (long r = 0; r < sides; ++r) right(r, i) -= sum_of_products<T>(lu[i].part(0, i), right[r].part(0, i));
    for (long i = n - 1; i >= 0; --i)
        for (long r = 0; r < sides; ++r)
            right(r, i) = (right(r, i) - sum_of_products<T>(lu[i].part(i + 1, n), right[r].part(i + 1, n))) / lu(i, i);
}

// Replace right-hand sides (k, n) by the solutions of the transposed equations.
template <class T>
void solve_transposed(const View<const T, 2>& lu, const View<const int, 1>& pivots, const View<T, 2>& right) {
    long n = lu.size(), sides = right.size();
    for (long i = 0; i < n; ++i)
        for (long r = 0; r < sides; ++r) {
            auto x = right[r];
            x(i) /= lu(i, i);
            subtract_multiple<T>(x(i), lu[i].part(i + 1, n), x.part(i + 1, n));
        }
    for (long i = n - 1; i >= 0; --i)
        for (long r = 0; r < sides; ++r) {
            auto x = right[r];
            subtract_multiple<T>(x(i), lu[i].part(0, i), x.part(0, i));
        }
    for (long i = n - 1; i >= 0; --i)
        for (long r = 0; r < sides; ++r)
            if (pivots(i) != i) std::swap(right(r, i), right(r, pivots(i)));
}

// Replace right-hand sides (k, n) by the solutions with a matrix (n, n), which is overwritten. Throws SingularMatrix.
template <class T>
void solve_with(const View<T, 2>& matrix, const View<T, 2>& right, bool transposed) {
    Array<int, 1> pivots(matrix.size());
    if (!factorise(matrix, pivots)) throw SingularMatrix("the Jacobian of the contact is singular");
    transposed ? solve_transposed<T>(matrix, pivots, right) : solve<T>(matrix, pivots, right);
}

}  // namespace wr
