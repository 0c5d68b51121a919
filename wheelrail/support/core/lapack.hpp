// LU factors by LAPACK.
#pragma once
#include <tuple>

#include "support/core/arrays.hpp"
#include "support/core/errors.hpp"

namespace wr {

// Addresses of functions of LAPACK: LU factors in single precision, solution with them, solution in double precision,
// and factors and solution with them in double precision.
struct Lapack {
    long sgetrf = 0, sgetrs = 0, dgesv = 0, dgetrf = 0, dgetrs = 0;

    auto fields() { return std::tie(sgetrf, sgetrs, dgesv, dgetrf, dgetrs); }
    bool fits() const { return sgetrf && sgetrs && dgesv && dgetrf && dgetrs; }

    // Factors of a matrix (n, n) column by column, in place; pivots (n,). Whether it is regular.
    bool factorise(View<float, 2> matrix, View<int, 1> pivots) const { return factorise(sgetrf, matrix, pivots); }
    bool factorise(View<double, 2> matrix, View<int, 1> pivots) const { return factorise(dgetrf, matrix, pivots); }
    // Replace right-hand sides (k, n) by the solutions, or by those of the transposed equations.
    void solve(View<const float, 2> factors, View<const int, 1> pivots, View<float, 2> right, bool transposed) const {
        solve(sgetrs, factors, pivots, right, transposed);
    }
    void solve(View<const double, 2> factors, View<const int, 1> pivots, View<double, 2> right) const {
        solve(dgetrs, factors, pivots, right, false);
    }
    // Replace right-hand sides (k, n) by the solutions with a matrix (n, n) column by column, which is overwritten.
    void solve(View<double, 2> matrix, View<double, 2> right) const {
        using Function = void(int* n, int* sides, double* matrix, int* apart, int* pivots, double* right,
                              int* right_apart, int* flag);
        int n = int(matrix.size()), sides = int(right.size()), flag = 0;
        Array<int, 1> pivots(n);
        // NOLINTNEXTLINE(performance-no-int-to-ptr): of LAPACK there are addresses
        reinterpret_cast<Function*>(dgesv)(&n, &sides, matrix.data, &n, pivots.data, right.data, &n, &flag);
        if (flag) throw SingularMatrix("the Jacobian of the contact is singular");
    }

  private:
    template <class T>
    static bool factorise(long address, View<T, 2> matrix, View<int, 1> pivots) {
        using Function = void(int* rows, int* columns, T* matrix, int* apart, int* pivots, int* flag);
        int n = int(matrix.size()), flag = 0;
        // NOLINTNEXTLINE(performance-no-int-to-ptr): of LAPACK there are addresses
        reinterpret_cast<Function*>(address)(&n, &n, matrix.data, &n, pivots.data, &flag);
        return flag == 0;
    }
    template <class T>
    static void solve(long address, View<const T, 2> factors, View<const int, 1> pivots, View<T, 2> right,
                      bool transposed) {
        using Function = void(const char* kind, int* n, int* sides, const T* factors, int* apart, const int* pivots,
                              T* right, int* right_apart, int* flag);
        int n = int(factors.size()), sides = int(right.size()), flag = 0;
        // NOLINTNEXTLINE(performance-no-int-to-ptr): of LAPACK there are addresses
        reinterpret_cast<Function*>(address)(transposed ? "T" : "N", &n, &sides, factors.data, &n, pivots.data,
                                             right.data, &n, &flag);
    }
};

}  // namespace wr
