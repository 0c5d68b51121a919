// Kalker's coefficients of a pair of materials.
#pragma once
#include <algorithm>
#include <array>
#include <tuple>

#include "support/core/arrays.hpp"
#include "support/core/dual.hpp"

namespace wr {

// Combined elastic constants of two bodies.
struct PairElasticity {
    double E_star = 0.0;  // Pa
    double G = 0.0;       // combined shear modulus, Pa
    Blocks table;         // (2, 10, 3), C11, C22, C23 for a <= b, then for a >= b, at ten ratios

    auto fields() { return std::tie(E_star, G, table); }
    bool fits() const { return table.shape == std::array<long, 3>{2, 10, 3}; }
};

// C11, C22, C23 at a / b, linear in the shorter over the longer semi-axis; constant below a ratio of 1/10.
template <class T>
std::array<T, 3> coefficients(const Blocks& table, const T& ratio) {
    long side = value(ratio) > 1.0 ? 1 : 0;
    T shorter = side ? 1.0 / ratio : ratio;
    if (!(value(shorter) > 0.1)) shorter = T(0.1);
    T t = 10.0 * shorter - 1.0;
    long i = std::clamp(long(value(t)), 0L, 8L);
    t -= double(i);
    std::array<T, 3> found;
    for (int k = 0; k < 3; ++k) {
        double low = table(side, i, k), high = table(side, i + 1, k);
        found[k] = low + t * (high - low);
    }
    return found;
}

}  // namespace wr
