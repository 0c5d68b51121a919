// Semi-axes, area and stick area of a patch from the means of its cells, to second order.
#pragma once
#include <cmath>
#include <numbers>

#include "contact/results/core/patch_area.hpp"
#include "contact/results/core/patch_sums.hpp"

namespace wr {

// length times integral of the square over square of the integral
constexpr double HALF_ELLIPSE = 32.0 / (3.0 * std::numbers::pi * std::numbers::pi);

// S adjacent strips of M cells.
struct StripMeans {
    Numbers middle, width;      // (S,) m, across
    Array<double, 2> edges;     // (S, M + 1) m, cell boundaries along the rolling circle
    Array<double, 1> length;    // (S,) m, on the surface
    Array<double, 1> touching;  // (S,) squared length, continued beyond the end of the contact, over that of the strip
    Rows pressure;              // (S, M) Pa, means over the cells
    Rows margin;                // (S, M) Pa, from the traction to the largest possible one, zero under slip

    long size() const { return middle.size(); }
    long cells() const { return pressure.shape[1]; }
    double cell(long i, long r) const { return edges(i, r + 1) - edges(i, r); }
    // Strips from the first to before the last.
    StripMeans part(long first, long last) const {
        StripMeans own = *this;
        own.middle = middle.part(first, last), own.width = width.part(first, last);
        cut(own.edges, first, last), cut(own.length, first, last), cut(own.touching, first, last);
        own.pressure = pressure.part(first, last), own.margin = margin.part(first, last);
        return own;
    }

  private:
    template <class T, int N>
    static void cut(Array<T, N>& array, long first, long last) {
        static_cast<View<T, N>&>(array) = array.part(first, last);
    }
};

// Lengths (S,) m of the stick zones of strips. From the margins (S, M) Pa of the tractions to their bounds, zero under
// slip, and the lengths (S, M) m of the cells.
//
// Over the stick zone the margin is half an ellipse (Carter, Cattaneo), whose length follows from the integrals of the
// margin and of its square: cells that barely stick count little, so that the length does not jump with their number.
inline Array<double, 1> stick_lengths(Rows margin, Rows length) {
    Array<double, 1> lengths(margin.size());
    for (long i = 0; i < margin.size(); ++i) {
        double first = 0.0, second = 0.0, whole = 0.0;
        for (long r = 0; r < margin.shape[1]; ++r) {
            first += margin(i, r) * length(i, r);
            second += margin(i, r) * margin(i, r) * length(i, r);
            whole += length(i, r);
        }
        if (second > 0.0) lengths(i) = std::min(HALF_ELLIPSE * first * first / second, whole);
    }
    return lengths;
}

// Derivative at the middle of a cell r of means (M,) between marks (M + 1,), of second order within the strip.
inline double slope_of_means(Numbers values, Numbers marks, long r) {
    long last = values.size() - 1;
    double before = r > 0 ? (values(r) - values(r - 1)) / (0.5 * (marks(r + 1) - marks(r - 1))) : 0.0;
    double after = r < last ? (values(r + 1) - values(r)) / (0.5 * (marks(r + 2) - marks(r))) : before;
    if (r == 0) return after;
    if (r == last) return before;
    double low = marks(r + 1) - marks(r - 1), high = marks(r + 2) - marks(r);
    return (low * after + high * before) / (low + high);
}

// Semi-axis m of the ellipse whose Hertz pressure has the same second moment along x; marks (M + 1,): boundaries of the
// cells from 0 to 1. With a pressure gradient p' the second moment of a cell is p (x^2 + l^2/12) + 2 x p' l^2/12.
inline double spread(const StripMeans& strips, Numbers marks) {
    double total = 0.0, centre = 0.0, moment = 0.0;
    const auto& [p, edges] = std::tie(strips.pressure, strips.edges);
    for (long i = 0; i < strips.size(); ++i)
        for (long r = 0; r < strips.cells(); ++r) {
            double load = p(i, r) * strips.cell(i, r);
            total += load;
            centre += 0.5 * load * (edges(i, r) + edges(i, r + 1));
        }
    centre /= total;
    for (long i = 0; i < strips.size(); ++i) {
        double per_mark = (marks(1) - marks(0)) / strips.cell(i, 0);
        for (long r = 0; r < strips.cells(); ++r) {
            double length = strips.cell(i, r), x = 0.5 * (edges(i, r) + edges(i, r + 1)) - centre;
            double part = length * length / 12.0;
            moment += p(i, r) * length * (x * x + part);
            if (p(i, r) > 0.0) moment += length * 2.0 * x * part * per_mark * slope_of_means(p[i], marks, r);
        }
    }
    return std::sqrt(5.0 * std::max(moment / total, 0.0));
}

// Lateral semi-axis m of the Hertz ellipse with the second moment of strips with loads (S,) N, middles and widths (S,)
// m: the load of outer strips, reduced where they are wider than the contact, makes up for their variation across.
inline double lateral_spread(Numbers load, Numbers middle, Numbers width) {
    double total = 0.0, centre = 0.0, moment = 0.0;
    for (long i = 0; i < load.size(); ++i) {
        total += load(i);
        centre += load(i) * middle(i);
    }
    centre /= total;
    for (long i = 0; i < load.size(); ++i) {
        double away = middle(i) - centre;
        moment += load(i) * (away * away + width(i) * width(i) / 12.0);
    }
    return std::sqrt(5.0 * moment / total);
}

// Interpolate lateral ends, semi-axes, area and stick area of the sums over the cells of a patch within cells; marks
// (M + 1,): boundaries of the cells from 0 to 1.
inline void sharpen(PatchSums& sums, const StripMeans& strips, Numbers marks) {
    long S = strips.size(), M = strips.cells();
    Array<double, 2> lengths(S, M);
    Array<double, 1> load(S), square(S), bounds(S + 1);
    for (long i = 0; i < S; ++i)
        for (long r = 0; r < M; ++r) lengths(i, r) = strips.cell(i, r);
    auto sticks = stick_lengths(strips.margin, lengths);
    for (long i = 0; i < S; ++i) {
        for (long r = 0; r < M; ++r) load(i) += strips.pressure(i, r) * lengths(i, r) * strips.width(i);
        square(i) = strips.length(i) * strips.length(i) * (S >= LEAST_STRIPS ? strips.touching(i) : 1.0);
        double part = sticks(i) / (strips.edges(i, M) - strips.edges(i, 0));
        sticks(i) = square(i) * (part * part);
        bounds(i) = strips.middle(i) - 0.5 * strips.width(i);
        bounds(i + 1) = strips.middle(i) + 0.5 * strips.width(i);
    }
    auto [low, high] = lateral_ends(square, bounds);
    double level = std::abs(sums.axes(2, 2));
    for (int c = 0; c < 4; c += 2) {  // from the sides of the outer strips, on the wheel and on the rail
        sums.bands(c) += (low - bounds(0)) * level;
        sums.bands(c + 1) += (high - bounds(S)) * level;
    }
    sums.area = patch_area(square, bounds);
    sums.stick_area = std::min(stick_area(sticks, bounds), sums.area);
    sums.semi_axes(0) = spread(strips, marks);
    sums.semi_axes(1) = lateral_spread(load, strips.middle, strips.width);
    sums.strips = S;
}

}  // namespace wr
