// Part of the prescribed functions of a run that a step overlooks.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "support/core/arrays.hpp"

namespace wr {

// Functions of pieces of polynomials.
struct LocalFunctions {
    Numbers starts;       // (m,) of the pieces, the first and the last of which are unbounded
    Blocks coefficients;  // (m, degree + 1, k), see `LocalPolynomials`

    // Index of the piece at an abscissa.
    long piece(double s) const {
        long low = 0, high = starts.size() - 1;
        while (low < high) {
            long middle = (low + high + 1) / 2;
            if (s >= starts(middle))
                low = middle;
            else
                high = middle - 1;
        }
        return low;
    }
    // Value, slope and second derivative of a function on a piece.
    std::array<double, 3> at(long piece, long function, double s) const {
        double x = s - starts(piece), value = 0.0, slope = 0.0, half = 0.0;
        for (long power = coefficients.shape[1] - 1; power >= 0; --power) {
            half = half * x + slope;
            slope = slope * x + value;
            value = value * x + coefficients(piece, power, function);
        }
        return {value, slope, 2.0 * half};
    }
};

// Whether a function differs, between two abscissae, from the cubic through its values and slopes at both: in value or
// slope by more than the first two of some limits (5,), or in value, slope and second derivative by the others.
inline bool differs(const LocalFunctions& of, long function, double first, double last, Numbers limits) {
    constexpr int PARTS = 4;  // of each smooth piece, at whose ends the function and its derivatives are compared
    double span = last - first;
    long begin = of.piece(first);
    auto [at_start, left, bend_before] = of.at(begin, function, first);
    auto [at_end, right, bend_after] = of.at(of.piece(last), function, last);
    double rise = at_end - at_start;
    left = left * span, right = right * span;
    double bend = left + right - 2.0 * rise, low = first, value = 0.0, slope = 0.0, second = 0.0;
    for (long piece = begin; low < last; ++piece) {
        double high = piece + 1 < of.starts.size() ? std::min(last, of.starts(piece + 1)) : last;
        for (int part = 0; part <= PARTS; ++part) {
            double s = low + (high - low) * part / PARTS, u = (s - first) / span;
            auto [there, tilt, curve] = of.at(piece, function, s);
            double cubic = u * (rise + (1.0 - u) * (left - rise - u * bend));
            double cubic_slope = (left + u * (2.0 * (rise - left - bend) + 3.0 * u * bend)) / span;
            double cubic_second = (2.0 * (rise - left - bend) + 6.0 * u * bend) / (span * span);
            value = std::max(value, std::abs(there - at_start - cubic));
            slope = std::max(slope, std::abs(tilt - cubic_slope));
            second = std::max(second, std::abs(curve - cubic_second));
        }
        if (value > limits(0) || slope > limits(1) || (value > limits(2) && slope > limits(3) && second > limits(4)))
            return true;
        low = high;
    }
    return false;
}

// Whether one of the functions, somewhere between two abscissae, differs by more than some limits (5,); places (p,):
// added to both abscissae, one after the other.
inline bool differ(const LocalFunctions& of, Numbers places, double start, double end, Numbers limits) {
    for (double place : places)
        for (long k = 0; k < of.coefficients.shape[2]; ++k)
            if (differs(of, k, start + place, end + place, limits)) return true;
    return false;
}

}  // namespace wr
