// Laws of friction and of pressure at points: functions in C, printed from their expressions in UFL
// (`contact/laws/code_generation.py`), and their use in cells of strips.
#pragma once
#include <tuple>

#include "support/core/arrays.hpp"

namespace wr {

// Functions of all friction laws of a class, at n points: tractions q (2, n) Pa, slips s (2, n) over the rolling speed
// V m/s, pressures p (n,) Pa, rho (n,) 1/Pa, the regularising creepage eps, given bounds b (n,) Pa, and the constants
// `own` of a law. The residual is F = q - b y / max(|y|, b rho + eps), y = rho q - s, b = mu(|s| V, p) p.
struct FrictionCode {
    using Coefficient = void(long n, const double* w, const double* p, const double* own, double* mu);
    using Residual = void(long n, const double* q, const double* s, const double* p, const double* rho, double speed,
                          double eps, const double* own, double* bound, double* F);
    using BoundedResidual = void(long n, const double* q, const double* s, const double* bound, const double* rho,
                                 double eps, double* F);
    using Slopes = void(long k, const long* index, long n, const double* q, const double* s, const double* p,
                        const double* rho, double speed, double eps, const double* own, double* rows);
    using BoundedSlopes = void(long k, const long* index, long n, const double* q, const double* s, const double* bound,
                               const double* rho, double eps, double* rows);
    // of cells, whose pressure varies linearly between two values (2, n)
    using Mean = void(long n, const double* q, const double* s, const double* p, const double* rho, double speed,
                      double eps, const double* own, double* out);
    using Bounds = void(long n, const double* s, const double* p, double speed, const double* own, double* bound);

    Coefficient* coefficient = nullptr;           // (n,), of slip velocities w (n,) m/s
    Residual* residual = nullptr;                 // bounds (n,) and F (2, n)
    BoundedResidual* bounded_residual = nullptr;  // F (2, n)
    Slopes* slopes = nullptr;                     // (k, 12) at points: dF/dq, dF/ds (2, 2 each), dF/dp, dF/dV (2 each)
    BoundedSlopes* bounded_slopes = nullptr;      // (k, 12), of them dF/dp = dF/dV = 0
    Mean* mean_residual = nullptr;                // F (2, n), see `wheelrail.forms.traction.mean_projected`
    Mean* mean_slopes = nullptr;                  // (n, 14), by q, s (2, 2 each), both pressures and the speed (2 each)
    Bounds* bounds = nullptr;                     // (n,)
    long parameters = 0;                          // number of constants of a law
    bool depends_on_speed = false, depends_on_pressure = false;
};

// Functions of all normal laws of a class: pressures Pa and their slopes Pa/m at penetrations m.
struct PressureCode {
    using Pressure = void(long n, const double* d, const double* own, double* p, double* slope);

    Pressure* pressure = nullptr;
    long parameters = 0;
};

// A friction law of cells of strips.
struct ResidualCode {
    const FrictionCode* code = nullptr;  // none without friction
    Numbers parameters;                  // constants of the law
    double regularisation = 0.0;         // creepage eps

    auto fields() { return std::tie(code, parameters, regularisation); }
    bool fits() const { return (code ? code->parameters : 0) == parameters.size(); }
};

// Means F (2, n) Pa of the friction residual over n cells: tractions q (2, n) Pa, slips s (2, n) over the rolling
// speed m/s, pressures p (2, n) Pa between which the cells have a linear one, and rho (n,) 1/Pa.
inline void friction_residual(const ResidualCode& law, Rows q, Rows s, Rows p, Numbers rho, double speed,
                              View<double, 2> F) {
    law.code->mean_residual(rho.size(), q.data, s.data, p.data, rho.data, speed, law.regularisation,
                            law.parameters.data, F.data);
}

// Slopes (n, 14) of `friction_residual` by q, s (2, 2 each), both pressures and the speed (2 each).
inline void friction_slopes(const ResidualCode& law, Rows q, Rows s, Rows p, Numbers rho, double speed,
                            View<double, 2> slopes) {
    law.code->mean_slopes(rho.size(), q.data, s.data, p.data, rho.data, speed, law.regularisation, law.parameters.data,
                          slopes.data);
}

// Bounds mu(|s| V, p) p (n,) Pa of the tractions at n points: slips s (2, n) over the rolling speed V m/s, pressures
// p (n,) Pa.
inline void friction_bounds(const ResidualCode& law, Rows s, Numbers p, double speed, View<double, 1> bounds) {
    law.code->bounds(p.size(), s.data, p.data, speed, law.parameters.data, bounds.data);
}

// dF/dq (2 k, 2 k) of k points, transposed: slopes (k, 12) of the residual, ds/dq (2 k, 2 k)
// 1/Pa, and dp/dq (k, 2 k), without rows where the pressure does not depend on the tractions.
inline void assembled(Rows slopes, Rows slip, Rows pressure, View<double, 2> columns) {
    long k = slopes.size();
    for (long i = 0; i < k; ++i) {
        View<const double, 1> own = slopes[i];
        for (long c = 0; c < 2 * k; ++c) {
            double x = own[4] * slip(i, c) + own[5] * slip(k + i, c);
            double y = own[6] * slip(i, c) + own[7] * slip(k + i, c);
            if (pressure.size()) {
                x += own[8] * pressure(i, c);
                y += own[9] * pressure(i, c);
            }
            columns(c, i) = x;
            columns(c, k + i) = y;
        }
        columns(i, i) += own[0];
        columns(k + i, i) += own[1];
        columns(i, k + i) += own[2];
        columns(k + i, k + i) += own[3];
    }
}

}  // namespace wr
