// Resultants of FASTSIM on strips, without units, with derivatives.
//
// With the traction over the largest bound B of the strip, places over its half length l, and displacements over B, the
// resultants are functions of five increments only: those of the rigid slip over the flexibility of spin L3 in the
// middle of the strip, l wx / (L3 B), l wy / (L3 B), and its slope l^2 spin / (L3 B); and those by which elastic
// displacements over their own flexibilities are less, l xi (1 / L3 - 1 / L1) / B and l eta (1 / L3 - 1 / L2) / B.
// Bounds over B are the same for all strips. Several strips are computed side by side, in vector instructions: a strip
// alone waits in every cell for roots and divisions of the cell before.
#pragma once
#include <span>

#include "contact/models/standard/core/fastsim.hpp"

namespace wr {

// Of a strip: rigid slip along and across and its slope, and what rates of displacement are less.
template <class T>
struct Increments {
    T along{}, across{}, turning{}, apart_x{}, apart_y{};

    static constexpr int COUNT = 5;
    std::array<T*, COUNT> all() { return {&along, &across, &turning, &apart_x, &apart_y}; }
    std::array<const T*, COUNT> all() const { return {&along, &across, &turning, &apart_x, &apart_y}; }
};

// Means over the cells of both tractions and of place times lateral traction.
template <class T>
struct Resultants {
    T along{}, across{}, turning{};

    std::array<T*, 3> all() { return {&along, &across, &turning}; }
    std::array<const T*, 3> all() const { return {&along, &across, &turning}; }
};

// Increments of a strip. From flexibilities m/Pa, creepages, mean of the patch and in the middle of the strip, its half
// length m, and the largest bound of its traction Pa.
template <class T>
Increments<T> strip_increments(const ElasticFoundation<T>& flexible, const Creepages<T>& creep, const Creepages<T>& own,
                               const T& half, const T& bound) {
    T size = half / bound;
    return {size * own.longitudinal / flexible.spin, size * own.lateral / flexible.spin,
            size * half * own.spin / flexible.spin,
            size * creep.longitudinal * (1.0 / flexible.spin - 1.0 / flexible.along),
            size * creep.lateral * (1.0 / flexible.spin - 1.0 / flexible.across)};
}

// Resultants with bounds (m,) on cells from the trailing end, over the largest one: the recursion of `strip_tractions`.
template <class T>
Resultants<T> roll(const Increments<T>& by, std::span<const double> bounds) {
    double m = double(bounds.size()), h = 2.0 / m, step = 0.5 * h, place = 1.0 - 0.25 * h;
    Traction<T> q;
    Resultants<T> sum;
    for (long i = long(bounds.size()) - 1; i >= 0; --i) {
        q = next_traction(q, {by.along, by.across + by.turning * place}, {by.apart_x, by.apart_y}, step, bounds[i]);
        sum.along += q.x, sum.across += q.y, sum.turning += ((2.0 * double(i) + 1.0) / m - 1.0) * q.y;
        place -= step < h ? 0.75 * h : h;
        step = h;
    }
    return {sum.along / m, sum.across / m, sum.turning / m};
}

// Resultants of n strips, with derivatives from local derivatives by the increments.
template <class T>
void strip_resultants(std::span<const Increments<T>> by, std::span<const double> bounds,
                      std::span<Resultants<T>> results) {
    long n = long(by.size());
    constexpr int FIVE = Increments<T>::COUNT;
    constexpr bool derives = !std::is_same_v<T, double>;
    using Numbers = Abreast<derives ? 1 : 2>;
    using Own = std::conditional_t<derives, Dual<FIVE, Numbers>, Numbers>;
    for (long first = 0; first < n; first += Numbers::COUNT) {
        long count = std::min<long>(Numbers::COUNT, n - first);
        Increments<Own> own;
        for (int j = 0; j < FIVE; ++j) {
            Numbers numbers;
            for (long k = 0; k < count; ++k) numbers.set(int(k), value(*by[first + k].all()[j]));
            *own.all()[j] = Own(numbers);
            if constexpr (derives) own.all()[j]->d[j] = 1.0;
        }
        auto found = roll(own, bounds);
        for (long k = 0; k < count; ++k)
            for (int r = 0; r < 3; ++r) {
                const Own& from = *found.all()[r];
                T& to = *results[first + k].all()[r];
                if constexpr (derives) {
                    to = T(from.v[int(k)]);
                    for (int j = 0; j < FIVE; ++j) {
                        double slope = from.d[j][int(k)];
                        const T& increment = *by[first + k].all()[j];
                        for (int i = 0; i < T::COUNT; ++i) to.d[i] += slope * increment.d[i];
                    }
                } else {
                    to = from[int(k)];
                }
            }
    }
}

}  // namespace wr
