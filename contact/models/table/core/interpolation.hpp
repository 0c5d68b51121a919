// Interpolation on tensor products of unequally spaced nodes, with derivatives.
//
// Along each axis the interpolant is a cubic Hermite polynomial in every interval, with the slopes of parabolas through
// three nodes: continuous in value and slope, exact for quadratic functions. Two nodes are joined by a line; one node
// stands for a constant.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "support/core/arrays.hpp"

namespace wr {

using Four = std::array<double, 4>;

// Values on a tensor product of nodes.
struct Grid {
    Numbers nodes;             // of all axes, one after the other, each increasing
    std::vector<long> counts;  // number of nodes of each axis, the first one changing slowest
    Numbers values;            // (nodes * columns,)
    long columns = 0;          // numbers at a node

    auto fields() { return std::tie(nodes, counts, values, columns); }
    bool fits() const {
        long all = 0, size = columns;
        for (long n : counts) {
            if (n < 1) return false;
            all += n, size *= n;
        }
        return columns > 0 && !counts.empty() && nodes.size() == all && values.size() == size;
    }
    long axes() const { return long(counts.size()); }
    Numbers axis(long number) const {
        long start = 0;
        for (long k = 0; k < number; ++k) start += counts[k];
        return nodes.part(start, start + counts[number]);
    }
};

// Weights of the values at up to four nodes around an argument: number of the first node, number of nodes, weights
// (zero beyond these), and their derivatives.
struct Stencil {
    long first = 0, count = 1;
    Four weights{1.0, 0.0, 0.0, 0.0}, slopes{};

    // Of increasing nodes (n,) and an argument in their range; beyond it polynomials continue.
    Stencil(Numbers nodes, double x) {
        long n = nodes.size();
        if (n == 1) return;
        long i = interval(nodes, x);
        bool start = i == 0, end = i == n - 2;  // no interval before, none after
        double h = nodes(i + 1) - nodes(i), t = (x - nodes(i)) / h;
        Bend before, after;
        if (!start) before = {nodes(i) - nodes(i - 1), h};
        if (!end) after = {nodes(i + 2) - nodes(i + 1), h};
        auto weights_of = [&](double left, double right, double rise) -> Four {
            double fall = h * before.factor * ((end ? right : 0.0) - left);
            double turn = h * after.factor * ((start ? left : 0.0) - right);
            double here = rise + (left + right + fall * before.step + turn * after.step) / h;
            return {fall, -here - fall, here + turn, -turn};
        };
        double rest = 1.0 - t;
        Four value = weights_of(h * t * (rest * rest), h * t * t * (t - 1.0), t * t * (3.0 - 2.0 * t));
        Four slope = weights_of(rest * (1.0 - 3.0 * t), t * (3.0 * t - 2.0), 6.0 * t * rest / h);
        value[1] += 1.0;
        count = std::min(n, 4L), first = std::min(std::max(i - 1, 0L), n - count);
        // the four values begin at node i - 1
        weights = shifted(value, i - 1 - first), slopes = shifted(slope, i - 1 - first);
    }
    // Number of the interval of nodes (n,), n > 1, that an argument is in; the nearest one outside.
    static long interval(Numbers nodes, double x) {
        long i = 0;
        while (i < nodes.size() - 2 && x >= nodes(i + 1)) ++i;
        return i;
    }

  private:
    // How far a parabola bends: h (quotient here - quotient beside) / (h + step beside), of an interval h and the next.
    struct Bend {
        double step, factor;

        Bend() : step(0.0), factor(0.0) {}
        Bend(double beside, double h) : step(beside), factor(1.0 / (beside * (beside + h))) {}
    };
    static Four shifted(const Four& all, long by) {
        Four to{};
        for (long k = 0; k < 4; ++k)
            if (k + by >= 0 && k + by < 4) to[k + by] = all[k];
        return to;
    }
};

// Numbers (n,), counted from the first, of the nodes around a point on the inner axes, and their weights (1, n); with
// slopes (m, n), m coordinates, then their derivatives.
struct InnerTerms {
    Array<long, 1> numbers;
    Array<double, 2> weights;

    InnerTerms(const Grid& grid, const double* at, long axes, bool slopes) {
        long size = 1, done = 1;
        for (long axis = 1; axis < axes; ++axis) size *= std::min(grid.counts[axis], 4L);
        numbers = Array<long, 1>(size), weights = Array<double, 2>(slopes ? axes : 1, size);
        weights(0, 0) = 1.0;
        for (long axis = 1; axis < axes; ++axis) {
            Numbers nodes = grid.axis(axis);
            Stencil of(nodes, at[axis]);
            for (long n = done - 1; n >= 0; --n) {
                long number = numbers(n) * nodes.size() + of.first;
                double weight = weights(0, n);
                for (long k = of.count - 1; k >= 0; --k) {
                    long term = n * of.count + k;
                    numbers(term) = number + k;
                    if (slopes) {
                        for (long row = 1; row < axis; ++row) weights(row, term) = weights(row, n) * of.weights[k];
                        weights(axis, term) = weight * of.slopes[k];
                    }
                    weights(0, term) = weight * of.weights[k];
                }
            }
            done *= of.count;
        }
    }
};

// Add to total (width,) up to four parts of values from every start, times weights.
//
// starts, factors: (n,) of the first part, and of its weights. step: from one part to the next. count: of parts;
// further weights are zero.
inline void add_parts(const View<double, 1>& total, Numbers values, Indices starts, Numbers factors, long step,
                      long count, const Four& w) {
    long last = (count - 1) * step, second = std::min(step, last), third = std::min(2 * step, last);
    for (long n = 0; n < starts.size(); ++n) {
        auto part = [&](long from) { return values.part(starts(n) + from, starts(n) + from + total.size()); };
        Numbers a = part(0), b = part(second), c = part(third), d = part(last);
        double p = factors(n) * w[0], q = factors(n) * w[1], r = factors(n) * w[2], s = factors(n) * w[3];
        for (long k = 0; k < total.size(); ++k)
            total(k) = std::fma(p, a(k), std::fma(q, b(k), std::fma(r, c(k), std::fma(s, d(k), total(k)))));
    }
}

// Values (1, count * columns) at nodes of the last axis, from the first on, interpolated along all other axes; with
// slopes (axes, count * columns), then their derivatives by the coordinates of all axes but the last.
inline Array<double, 2> between(const Grid& grid, const double* at, long first, long count, bool slopes) {
    long axes = grid.axes() - 1;
    InnerTerms inner(grid, at, axes, slopes);
    Stencil own(grid.axis(0), at[0]);
    long size = grid.counts[axes] * grid.columns, step = grid.values.size() / grid.counts[0];
    for (long& number : inner.numbers) number = own.first * step + number * size + first * grid.columns;
    Array<double, 2> out(slopes ? 1 + axes : 1, count * grid.columns);
    auto add = [&](long row, long factors, const Four& weights) {
        add_parts(out[row], grid.values, inner.numbers, inner.weights[factors], step, own.count, weights);
    };
    add(0, 0, own.weights);
    if (slopes) {
        add(1, 0, own.slopes);
        for (long row = 1; row < axes; ++row) add(row + 1, row, own.weights);
    }
    return out;
}

// Values (1, columns) between nodes in blocks (1, size); from m > 1 rows (m + 1, columns), the last their slope.
//
// first: of the nodes in the blocks. columns: numbers at a node.
inline Array<double, 2> along(Rows blocks, long first, const Stencil& of, long columns) {
    long rows = blocks.size();
    Array<double, 2> out(rows == 1 ? rows : rows + 1, columns);
    for (long k = 0; k < of.count; ++k) {
        long start = (first + k) * columns;
        for (long row = 0; row < rows; ++row)
            for (long column = 0; column < columns; ++column)
                out(row, column) += of.weights[k] * blocks(row, start + column);
        if (rows > 1)
            for (long column = 0; column < columns; ++column)
                out(rows, column) += of.slopes[k] * blocks(0, start + column);
    }
    return out;
}

}  // namespace wr
