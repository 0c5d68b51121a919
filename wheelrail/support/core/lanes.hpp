// Eight doubles at once. Multiplications and additions are fused explicitly, so that the rounding depends on no
// compiler.
#pragma once
#include <cmath>

#include "support/core/arrays.hpp"
#if defined(__AVX2__) && defined(__FMA__)
#include <immintrin.h>
#endif

namespace wr {

constexpr int LANES = 8;

// In parts as wide as registers: GCC 12 keeps larger vectors in memory, which takes seven times as long.
#if defined(__AVX2__) && defined(__FMA__)
constexpr int PART = 4;
#else
constexpr int PART = 2;
#endif
typedef double part8 __attribute__((vector_size(8 * PART)));
typedef double part8_anywhere __attribute__((vector_size(8 * PART), aligned(8), may_alias));

struct v8 {
    part8 p[LANES / PART];

    double operator[](int k) const { return p[k / PART][k % PART]; }
};

template <class F>
v8 each_part(const F& f) {
    v8 r;
    for (int k = 0; k < LANES / PART; ++k) r.p[k] = f(k);
    return r;
}
// GCC 12 does not always make one instruction of a loop of fused operations, which takes five times as long.
inline part8 fma(part8 a, part8 b, part8 c) {
#if defined(__AVX2__) && defined(__FMA__)
    return _mm256_fmadd_pd(a, b, c);
#else
    return part8{std::fma(a[0], b[0], c[0]), std::fma(a[1], b[1], c[1])};
#endif
}
inline v8 fma(const v8& a, const v8& b, const v8& c) {
    return each_part([&](int k) { return fma(a.p[k], b.p[k], c.p[k]); });
}
inline v8 operator+(const v8& a, const v8& b) {
    return each_part([&](int k) { return a.p[k] + b.p[k]; });
}
inline v8 operator*(const v8& a, const v8& b) {
    return each_part([&](int k) { return a.p[k] * b.p[k]; });
}
inline v8 splat(double x) {
#if defined(__AVX2__) && defined(__FMA__)
    return each_part([&](int) { return part8{x, x, x, x}; });
#else
    return each_part([&](int) { return part8{x, x}; });
#endif
}
inline v8 load8(const double* at) {
    return each_part([&](int k) -> part8 { return *reinterpret_cast<const part8_anywhere*>(at + PART * k); });
}
inline void store8(const v8& v, double* at) {
    for (int k = 0; k < LANES / PART; ++k) *reinterpret_cast<part8_anywhere*>(at + PART * k) = v.p[k];
}

inline long checked_vector(long n, [[maybe_unused]] long count) {
#if defined(_GLIBCXX_ASSERTIONS)
    if (n < 0 || n >= count) throw std::out_of_range("index of a vector");
#endif
    return n;
}

// Vectors one after the other: those of an array (.., 8).
struct Vectors {
    const double* data = nullptr;
    long count = 0;

    v8 operator[](long n) const { return load8(data + LANES * checked_vector(n, count)); }
    // Component k of vector n.
    double operator()(long n, int k) const { return data[LANES * checked_vector(n, count) + k]; }
    Vectors part(long first, long size) const { return {data + LANES * checked_vector(first, count - size + 1), size}; }
};
template <class T, int N>
Vectors vectors(const View<T, N>& from) {
    return {from.data, from.count() / LANES};
}

// Vectors that are a number of doubles apart.
struct Series {
    const double* data;
    long count, apart;

    v8 operator[](long n) const { return load8(data + apart * checked_vector(n, count)); }
    Series part(long first, long size) const {
        return {data + apart * checked_vector(first, count - size + 1), size, apart};
    }
};

// A plane of vectors; rows and columns change places without copies.
struct Plane {
    const double* data;
    long rows, columns, down, right;  // down and right: doubles from a vector to those below and beside it

    Series row(long r) const { return {data + down * checked_vector(r, rows), columns, right}; }
    Series column(long c) const { return {data + right * checked_vector(c, columns), rows, down}; }
    Plane transposed() const { return {data, columns, rows, right, down}; }
};

// Plane (rows, columns) of an array (rows, columns, 8).
template <class T>
Plane plane(const View<T, 3>& from) {
    return {from.data, from.shape[0], from.shape[1], LANES * from.shape[1], LANES};
}

// Sums over vectors times each of K weights (count, K): all stay in registers, and each vector is read once.
template <int K, class V>
std::array<v8, K> products(const V& of, const View<const double, 2>& weights) {
    v8 sums[K] = {};
    for (long n = 0; n < weights.shape[0]; ++n) {
        v8 value = of[n];
        for (int k = 0; k < K; ++k) sums[k] = fma(value, splat(weights.data[n * K + k]), sums[k]);
    }
    return std::to_array(sums);
}
// Sum over COUNT vectors times weights.
template <int COUNT>
v8 product(const Series& of, const View<const double, 1>& weights) {
    v8 sum{};
    for (int n = 0; n < COUNT; ++n) sum = fma(of[n], splat(weights(n)), sum);
    return sum;
}

}  // namespace wr
