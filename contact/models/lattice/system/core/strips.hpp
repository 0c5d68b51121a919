// Cells of loaded strips with values (S, block): boundaries and middles, forces, pressures and resultants.
#pragma once
#include <numbers>

#include "contact/models/lattice/system/core/equation_data.hpp"

namespace wr {

// Place m along x, from 0 at the trailing to 1 at the leading end of strip i.
inline double along_strip(Rows values, long i, double mark) {
    long last = values.shape[1] - 1;
    return values(i, last - 1) + (values(i, last) - values(i, last - 1)) * mark;
}

inline double middle_of_cell(const StripBasis& basis, long r) { return 0.5 * (basis.marks(r) + basis.marks(r + 1)); }

inline StripGrid strip_grid(Rows values, const StripPlaces& places, const StripBasis& basis) {
    long S = values.size(), R = basis.row_marks.size(), last = values.shape[1] - 1;
    StripGrid grid{Array<double, 2>(S, R), Array<double, 1>(S), places.width,
                   places.stretch,         places.strip,        places.middle};
    for (long i = 0; i < S; ++i) {
        grid.length(i) = places.stretch(i) * (values(i, last) - values(i, last - 1));
        for (long r = 0; r < R; ++r) grid.x(i, r) = places.stretch(i) * along_strip(values, i, basis.row_marks(r));
    }
    return grid;
}

// Jumps (S, M + 1, 3) N/m of the tractions times width at the cell boundaries.
inline Array<double, 3> force_jumps(Rows values, const StripPlaces& places, const StripBasis& basis, bool rolls) {
    long S = values.size(), M = basis.M(), at = rolls ? 2 * M : 0;
    Array<double, 3> jumps(S, M + 1, 3);
    for (long i = 0; i < S; ++i)
        for (long r = 0; r < M; ++r) {
            double load[3] = {rolls ? values(i, r) : 0.0, rolls ? values(i, M + r) : 0.0, 0.0};
            for (int m = 0; m < MODES; ++m) load[2] -= values(i, at + m) * basis.loads(r, m);
            for (int k = 0; k < 3; ++k) {
                jumps(i, r, k) += load[k] * places.width(i);
                jumps(i, r + 1, k) -= load[k] * places.width(i);
            }
        }
    return jumps;
}

// Pressure (S, M) Pa, means over the cells.
inline Array<double, 2> cell_pressures(Rows values, const StripBasis& basis, bool rolls) {
    long S = values.size(), M = basis.M(), at = rolls ? 2 * M : 0;
    Array<double, 2> pressure(S, M);
    for (long i = 0; i < S; ++i)
        for (long r = 0; r < M; ++r)
            for (int m = 0; m < MODES; ++m) pressure(i, r) += values(i, at + m) * basis.mean(r, m);
    return pressure;
}

// Places (S M,) m of all cells' middles across and along, strip by strip from the trailing end.
struct CellMiddles {
    Array<double, 1> s, x;

    CellMiddles(Rows values, const StripPlaces& places, const StripBasis& basis)
        : s(values.size() * basis.M()), x(s.shape) {
        long M = basis.M();
        for (long n = 0; n < s.size(); ++n) {
            s(n) = places.middle(n / M);
            x(n) = along_strip(values, n / M, middle_of_cell(basis, n % M));
        }
    }
};

// Points and axes of the upper body at the middles of all cells (S M,).
inline SurfaceFrames cell_frames(Rows values, const EquationData& data) {
    CellMiddles at(values, data.places, data.basis);
    return frames(data.surface, data.motion.pose(), at.s, at.x);
}

// Loads (S, 2) N of strips: lateral tractions, and pressure.
inline Array<double, 2> strip_loads(Rows values, const StripPlaces& places, const StripBasis& basis, bool rolls) {
    long S = values.size(), M = basis.M(), last = values.shape[1] - 1;
    Array<double, 2> loads(S, 2);
    for (long i = 0; i < S; ++i) {
        double area = places.width(i) * places.stretch(i) * (values(i, last) - values(i, last - 1));
        for (long r = 0; r < (rolls ? M : 0); ++r)
            loads(i, 0) += area * (basis.marks(r + 1) - basis.marks(r)) * values(i, M + r);
        loads(i, 1) = 0.25 * std::numbers::pi * area * values(i, last - 1 - MODES);
    }
    return loads;
}

// Force N and moment N m about the origin (6,) on the upper body.
inline Array<double, 1> resultants(Rows values, const EquationData& data) {
    const auto& [places, basis] = std::tie(data.places, data.basis);
    long S = values.size(), M = basis.M(), last = values.shape[1] - 1;
    bool rolls = data.rolls();
    auto pressure = cell_pressures(values, basis, rolls);
    auto at = cell_frames(values, data);
    Array<double, 1> total(6);
    for (long i = 0; i < S; ++i) {
        double length = places.stretch(i) * (values(i, last) - values(i, last - 1));
        for (long r = 0; r < M; ++r) {
            double area = length * (basis.marks(r + 1) - basis.marks(r)) * places.width(i);
            double along = rolls ? values(i, r) : 0.0, across = rolls ? values(i, M + r) : 0.0, force[3];
            auto axes = at.axes[i * M + r];
            auto point = at.point[i * M + r];
            for (int c = 0; c < 3; ++c) {
                force[c] = area * (along * axes(0, c) + across * axes(1, c) - pressure(i, r) * axes(2, c));
                total(c) += force[c];
            }
            for (int c = 0; c < 3; ++c) {
                int a = (c + 1) % 3, b = (c + 2) % 3;
                total(3 + c) += point(a) * force[b] - point(b) * force[a];
            }
        }
    }
    return total;
}

}  // namespace wr
