// Numbers with their derivatives by N variables: forward-mode automatic differentiation.
#pragma once
#include <cmath>
#include <type_traits>

namespace wr {

// V: double, or a type of several numbers side by side.
template <int N, class V = double>
struct Dual {
    V v{};
    V d[N]{};

    static constexpr int COUNT = N;
    constexpr Dual() = default;
    constexpr Dual(V x) : v(x) {}

    // f(v) with the slope s
    Dual chain(V value, V s) const {
        Dual r(value);
        for (int i = 0; i < N; ++i) r.d[i] = s * d[i];
        return r;
    }
    Dual operator-() const { return chain(-v, -1.0); }
    Dual& operator+=(const Dual& b) { return *this = *this + b; }
    Dual& operator-=(const Dual& b) { return *this = *this - b; }
    Dual& operator*=(const Dual& b) { return *this = *this * b; }
    friend Dual operator+(const Dual& a, const Dual& b) {
        Dual r(a.v + b.v);
        for (int i = 0; i < N; ++i) r.d[i] = a.d[i] + b.d[i];
        return r;
    }
    friend Dual operator-(const Dual& a, const Dual& b) {
        Dual r(a.v - b.v);
        for (int i = 0; i < N; ++i) r.d[i] = a.d[i] - b.d[i];
        return r;
    }
    friend Dual operator*(const Dual& a, const Dual& b) {
        Dual r(a.v * b.v);
        for (int i = 0; i < N; ++i) r.d[i] = a.d[i] * b.v + a.v * b.d[i];
        return r;
    }
    friend Dual operator/(const Dual& a, const Dual& b) {
        Dual r(a.v / b.v);
        V over = 1.0 / b.v;
        for (int i = 0; i < N; ++i) r.d[i] = (a.d[i] - r.v * b.d[i]) * over;
        return r;
    }
    // With a number: constants have no derivatives to carry along.
    friend Dual operator+(Dual a, const V& b) { return a.v += b, a; }
    friend Dual operator+(const V& b, Dual a) { return a.v += b, a; }
    friend Dual operator-(Dual a, const V& b) { return a.v -= b, a; }
    friend Dual operator-(const V& b, const Dual& a) { return a.chain(b - a.v, -1.0); }
    friend Dual operator*(const Dual& a, const V& b) { return a.chain(a.v * b, b); }
    friend Dual operator*(const V& b, const Dual& a) { return a.chain(a.v * b, b); }
    friend Dual operator/(const Dual& a, const V& b) { return a.chain(a.v / b, 1.0 / b); }
    friend Dual operator/(const V& b, const Dual& a) {
        V value = b / a.v;
        return a.chain(value, -value / a.v);
    }
};

template <int N>
Dual<N> sin(const Dual<N>& a) {
    return a.chain(std::sin(a.v), std::cos(a.v));
}
template <int N>
Dual<N> cos(const Dual<N>& a) {
    return a.chain(std::cos(a.v), -std::sin(a.v));
}
template <int N, class V>
Dual<N, V> sqrt(const Dual<N, V>& a) {
    using std::sqrt;
    V r = sqrt(a.v);
    return a.chain(r, 0.5 / r);
}
template <int N>
Dual<N> pow(const Dual<N>& a, double b) {
    double r = std::pow(a.v, b);
    return a.chain(r, b * r / a.v);
}
template <int N>
Dual<N> atan(const Dual<N>& a) {
    return a.chain(std::atan(a.v), 1.0 / (1.0 + a.v * a.v));
}
template <int N>
Dual<N> asinh(const Dual<N>& a) {
    return a.chain(std::asinh(a.v), 1.0 / std::sqrt(1.0 + a.v * a.v));
}
template <int N>
Dual<N> exp(const Dual<N>& a) {
    double r = std::exp(a.v);
    return a.chain(r, r);
}
template <int N>
Dual<N> log(const Dual<N>& a) {
    return a.chain(std::log(a.v), 1.0 / a.v);
}

// a * b + c with one rounding of the value.
template <int N>
Dual<N> fma(const Dual<N>& a, const Dual<N>& b, double c) {
    Dual<N> r(std::fma(a.v, b.v, c));
    for (int i = 0; i < N; ++i) r.d[i] = a.d[i] * b.v + a.v * b.d[i];
    return r;
}

// Branches look at the value.
inline double value(double x) { return x; }
template <int N, class V>
V value(const Dual<N, V>& x) {
    return x.v;
}

// A number x that changes by a slope along one variable; a plain number has no derivatives.
template <class T>
T variable(double x, int i, double slope = 1.0) {
    T r(x);
    if constexpr (!std::is_same_v<T, double>) r.d[i] = slope;
    return r;
}

// The same number as one of more variables, of which its own begin at `first`.
template <int M, int N>
Dual<M> widened(const Dual<N>& x, int first) {
    Dual<M> r(x.v);
    for (int i = 0; i < N; ++i) r.d[first + i] = x.d[i];
    return r;
}

}  // namespace wr
