// Data of the equations of loaded strips, and their evaluation.
#pragma once
#include <tuple>

#include "contact/geometry/core/surface.hpp"
#include "contact/laws/core/law.hpp"
#include "contact/models/lattice/influence/core/pair_tables.hpp"

namespace wr {

// Slopes of the friction residual of a cell: by traction (4), slip (4), speed (2), and pressure modes (2 each).
constexpr int SLOPES = 10 + 2 * MODES;

// S loaded strips.
struct StripPlaces {
    Numbers middle;   // (S,) m
    Numbers width;    // (S,) m
    Numbers stretch;  // (S,) length on the surface over that on the rolling circle
    Rows level;       // (S, 3), longitudinal axes where the surfaces touch
    Indices strip;    // (S,) numbers on the lattice, ascending
    Numbers onset;    // (S,) m, of contact
    Numbers whole;    // (S,) Pa m, amplitude times half length: load from which they touch on their whole width

    auto fields() { return std::tie(middle, width, stretch, level, strip, onset, whole); }
    bool fits() const {
        long S = middle.size();
        return width.size() == S && stretch.size() == S && level.shape == std::array{S, 3L} && strip.size() == S &&
               onset.size() == S && whole.size() == S;
    }
};

// Data of the equations of some strips at a pose.
struct EquationData {
    PairTables tables;
    SurfaceData surface;
    Motion motion;
    StripPlaces places;
    StripBasis basis;
    ResidualCode law;
    Numbers rho;  // (M,) 1/Pa, of the friction residual

    auto fields() { return std::tie(tables, surface, motion, places, basis, law, rho); }
    bool fits() const {
        bool right = rho.size() == basis.M() && (!rolls() || law.code);
        for (long k : places.strip) right &= k >= 0 && k < tables.place.size();
        return right;
    }
    bool rolls() const { return motion.speed > 0.0; }
    long strips() const { return places.middle.size(); }
    // Column of the first pressure mode of a strip, and number of its unknowns.
    long mode() const { return rolls() ? 2 * basis.M() : 0; }
    long block() const { return mode() + MOMENTS; }
    // Whether values match the strips.
    bool fits(Rows values) const { return values.shape == std::array{strips(), block()}; }
};

// Residual of a state, with intermediate results.
struct Evaluation {
    bool inside = false;           // whether all points lie on the surfaces and in the tables
    Array<double, 2> residual;     // (S, block): friction Pa along and across, moments of the gap m
    Array<double, 3> V;            // (S, M + 3, 3), antiderivatives of the displacements
    Array<double, 2> pressure;     // (S, M) Pa, means over the cells
    Array<double, 3> slip;         // (S, 2, M) over the speed
    Array<double, 3> rigid_slope;  // (S, 2, M) 1/m, change of its rigid part along x
    Array<double, 2> depth_slope;  // (S, STATIONS), change of the penetration along x

    auto fields() { return std::tie(inside, residual, V, pressure, slip, rigid_slope, depth_slope); }
    bool fits() const {
        long S = residual.size(), M = pressure.shape[1];
        return V.shape == std::array{S, V.shape[1], 3L} && (V.shape[1] == M + 3 || S == 0) && pressure.size() == S &&
               slip.shape == std::array{S, 2L, M} && rigid_slope.shape == slip.shape && depth_slope.size() == S;
    }
};

// Equations of a state, linearised.
struct Linearisation {
    Evaluation evaluation;
    Array<double, 2> jacobian;  // (n, n), n = S block
    Array<float, 3> slips;      // (S, 2 M, n), derivatives of the slips by the unknowns; M = 0 without friction
    Array<double, 3> slopes;    // (S, M, SLOPES), of the friction residual

    auto fields() { return std::tie(evaluation, jacobian, slips, slopes); }
    bool fits() const {
        long S = slips.size(), n = jacobian.size(), M = slopes.shape[1];
        return S > 0 && n % S == 0 && n / S >= MOMENTS && jacobian.shape == std::array{n, n} &&
               slips.shape == std::array{S, 2 * M, n} && slopes.shape == std::array{S, M, long(SLOPES)};
    }
};

}  // namespace wr
