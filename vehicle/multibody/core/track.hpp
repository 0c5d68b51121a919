// Sections of a track: orientation Rz(heading) Ry(-gradient) Rx(roll), see wheelrail.vehicle.track.section_poses.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "support/core/vector.hpp"

namespace wr {

// Section of the track: position m, axes as columns, rotation per length rad/m and its derivative rad/m2.
template <class T>
struct Section {
    Vec<T> position;
    Matrix<T> axes;
    Vec<T> rate, rate_slope;
};

// Local polynomials of the alignment.
struct Track {
    static constexpr int FUNCTIONS = 10;  // heading; curvature, superelevation, gradient; their first two derivatives
    enum Function { HEADING, CURVATURE, SUPERELEVATION, GRADIENT };
    using Powers = std::vector<std::array<double, FUNCTIONS>>;  // coefficients, ascending

    std::vector<double> starts;  // m, of the pieces; the first and the last one are unbounded
    std::vector<Powers> pieces;
    double base;                         // m, on which the superelevation is measured
    std::vector<double> nodes, weights;  // of Gauss' quadrature from -1 to 1

    std::size_t piece_at(double s) const {
        std::size_t piece = 0;
        while (piece + 1 < starts.size() && s >= starts[piece + 1]) ++piece;
        return piece;
    }

    template <class T>
    T function(std::size_t piece, int which, const T& s) const {
        const Powers& powers = pieces[piece];
        T x = s - starts[piece], result = powers.back()[which] + 0.0 * x;
        for (std::size_t k = powers.size() - 1; k-- > 0;) result = result * x + powers[k][which];
        return result;
    }

    double heading(double s) const { return function(piece_at(s), HEADING, s); }

    // Displacement m along the centre line within a piece, x along a heading, rad.
    Vec<double> advance(std::size_t piece, double start, double end, double heading) const {
        double half = 0.5 * (end - start), middle = 0.5 * (start + end);
        Vec<double> sum;
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            double s = middle + half * nodes[i], step = half * weights[i];
            double turned = function(piece, HEADING, s) - heading, a = function(piece, GRADIENT, s);
            double along = step * std::cos(a);
            sum = sum + Vec<double>{along * std::cos(turned), along * std::sin(turned), step * std::sin(a)};
        }
        return sum;
    }

    // Position m of the centre line from that at a reference, x along its heading, rad.
    Vec<double> position(double s, double reference, double heading) const {
        std::size_t piece = piece_at(reference), last = piece_at(s);
        Vec<double> sum;
        while (piece != last) {
            double end = piece < last ? starts[piece + 1] : starts[piece];
            sum = sum + advance(piece, reference, end, heading);
            piece = piece < last ? piece + 1 : piece - 1, reference = end;
        }
        return sum + advance(piece, reference, s, heading);
    }

    // Section at a distance m, its position apart, in axes of a heading, rad.
    template <class T>
    Section<T> orientation(const T& s, double heading) const {
        using std::sin, std::cos, std::sqrt, std::atan;
        std::size_t piece = piece_at(value(s));
        auto f = [&](int which, int derivative = 0) { return function(piece, which + 3 * derivative, s); };
        T angle = f(HEADING) - heading, curvature = f(CURVATURE), dcurvature = f(CURVATURE, 1);
        T a = f(GRADIENT), da = f(GRADIENT, 1), dda = f(GRADIENT, 2);
        T h = f(SUPERELEVATION) / -base, dh = f(SUPERELEVATION, 1) / -base, ddh = f(SUPERELEVATION, 2) / -base;
        T root = sqrt(1.0 - h * h);
        T p = atan(h / root), dp = dh / root, ddp = ddh / root + h * dh * dh / (root * root * root);
        T ca = cos(a), sa = sin(a), cp = cos(p), sp = sin(p), ch = cos(angle), sh = sin(angle);
        T turn = curvature * ca, dturn = dcurvature * ca - curvature * da * sa;
        T across = turn * ca, dacross = dturn * ca - turn * da * sa, zero(0.0), one(1.0);
        return {{},
                Matrix<T>{{ch * ca, sh * ca, sa}, {-sh, ch, zero}, {-ch * sa, -sh * sa, ca}} *
                    Matrix<T>{{one, zero, zero}, {zero, cp, sp}, {zero, -sp, cp}},
                {dp + turn * sa, across * sp - da * cp, across * cp + da * sp},
                {ddp + dturn * sa + turn * da * ca, dacross * sp + across * dp * cp - dda * cp + da * dp * sp,
                 dacross * cp - across * dp * sp + dda * sp + da * dp * cp}};
    }

    // Section at a distance m, in the axes at the distance of the reference, m.
    template <class T>
    Section<T> section(const T& s, double reference) const {
        double at_reference = heading(reference);
        Section<T> result = orientation(s, at_reference);
        auto place = position(value(s), reference, at_reference);
        T ahead = s - value(s);
        result.position = place + ahead * result.axes.x;
        return result;
    }
};

}  // namespace wr
