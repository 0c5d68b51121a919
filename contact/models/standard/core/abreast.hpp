// Numbers of several strips side by side, in K vector registers.
#pragma once
#include <cmath>

#include "support/core/dual.hpp"
#include "support/core/lanes.hpp"

namespace wr {

template <int K>
struct Abreast {
    static constexpr int COUNT = K * PART;
    // Where something holds.
    struct Mask {
        decltype(part8{} < part8{}) p[K];

        friend bool all(const Mask& mask) {
            auto both = mask.p[0];
            for (int k = 1; k < K; ++k) both &= mask.p[k];
            bool whole = true;
            for (int i = 0; i < PART; ++i) whole &= both[i] != 0;
            return whole;
        }
    };

    part8 p[K]{};

    Abreast() = default;
    Abreast(double x) {
        for (auto& part : p) part = part8{} + x;
    }
    double operator[](int k) const { return p[k / PART][k % PART]; }
    void set(int k, double x) { p[k / PART][k % PART] = x; }

    template <class F>
    static Abreast each(const F& f) {
        Abreast r;
        for (int k = 0; k < K; ++k) r.p[k] = f(k);
        return r;
    }
    template <class F>
    static Mask mask(const F& f) {
        Mask r;
        for (int k = 0; k < K; ++k) r.p[k] = f(k);
        return r;
    }
    Abreast operator-() const {
        return each([&](int k) { return -p[k]; });
    }
    Abreast& operator+=(const Abreast& b) { return *this = *this + b; }
    Abreast& operator-=(const Abreast& b) { return *this = *this - b; }
    friend Abreast operator+(const Abreast& a, const Abreast& b) {
        return each([&](int k) { return a.p[k] + b.p[k]; });
    }
    friend Abreast operator-(const Abreast& a, const Abreast& b) {
        return each([&](int k) { return a.p[k] - b.p[k]; });
    }
    friend Abreast operator*(const Abreast& a, const Abreast& b) {
        return each([&](int k) { return a.p[k] * b.p[k]; });
    }
    friend Abreast operator/(const Abreast& a, const Abreast& b) {
        return each([&](int k) { return a.p[k] / b.p[k]; });
    }
    friend Mask operator<(const Abreast& a, const Abreast& b) {
        return mask([&](int k) { return a.p[k] < b.p[k]; });
    }
    friend Mask operator<=(const Abreast& a, const Abreast& b) {
        return mask([&](int k) { return a.p[k] <= b.p[k]; });
    }
    friend Abreast select(const Mask& mask, const Abreast& a, const Abreast& b) {
        return each([&](int k) { return mask.p[k] ? a.p[k] : b.p[k]; });
    }
    friend Abreast sqrt(const Abreast& a) {
        return each([&](int k) { return root(a.p[k]); });
    }

  private:
    static part8 root(part8 a) {
#if defined(__AVX2__) && defined(__FMA__)
        return _mm256_sqrt_pd(a);
#else
        return part8{std::sqrt(a[0]), std::sqrt(a[1])};
#endif
    }
};

template <int K>
Abreast<K> value(const Abreast<K>& a) {
    return a;
}

inline bool all(bool mask) { return mask; }
inline double select(bool mask, double a, double b) { return mask ? a : b; }

template <class Mask, int N, class V>
Dual<N, V> select(const Mask& mask, const Dual<N, V>& a, const Dual<N, V>& b) {
    Dual<N, V> r(select(mask, a.v, b.v));
    for (int i = 0; i < N; ++i) r.d[i] = select(mask, a.d[i], b.d[i]);
    return r;
}

}  // namespace wr
