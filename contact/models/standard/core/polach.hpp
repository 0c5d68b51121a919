// Polach's creep forces of an elliptic patch in closed form.
//
// O. Polach, Vehicle System Dynamics 33 Suppl. (1999) 728-739, with the reduction factors of
// Wear 258 (2005) 992-1000, doi:10.1016/j.wear.2004.03.046.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace wr {

// Effective lateral creepage from the lateral creepage eta and the spin phi 1/m on a patch of semi-axis a m.
inline double effective(double eta, double phi, double a) { return std::max(std::abs(eta), std::abs(eta + phi * a)); }

// Longitudinal and lateral force N on the faster body.
//
// Parameters: longitudinal and lateral creepage and spin 1/m; semi-axes along and across, m; friction coefficient times
// load, N; shear modulus, Pa; Kalker's C11, C22, C23; factors k_A and k_S, 1 on dry and clean rails.
inline std::array<double, 2> polach(const std::array<double, 3>& creepages, const std::array<double, 2>& semi_axes,
                                    double bound, double G, const std::array<double, 3>& kalker,
                                    const std::array<double, 2>& reduction) {
    using std::numbers::pi;
    auto [xi, eta, phi] = creepages;
    auto [a, b] = semi_axes;
    auto [adhesion, slip] = reduction;
    double lateral = effective(eta, phi, a), total = std::hypot(xi, lateral), plain = std::hypot(xi, eta);
    if (total == 0.0 || bound == 0.0) return {0.0, 0.0};
    double c = plain > 0.0 ? std::hypot(kalker[0] * xi, kalker[1] * eta) / plain : 0.0;
    double gradient = 0.25 * pi * G * a * b * c * total / bound, adhering = adhesion * gradient;
    double size = 2.0 / pi * bound * (adhering / (1.0 + adhering * adhering) + std::atan(slip * gradient));
    double slender = 1.0 + 6.3 * (1.0 - std::exp(-a / b));
    double e = 8.0 / 3.0 * G * b * std::sqrt(a * b) * kalker[2] * lateral / (bound * slender);
    double d = (e * e - 1.0) / (e * e + 1.0);
    double k = e * (d * d * d / 3.0 - d * d / 2.0 + 1.0 / 6.0) - std::pow(1.0 - d * d, 1.5) / 3.0;
    double by_spin = 9.0 / 16.0 * a * bound * k * slender;
    return {-size * xi / total, (by_spin * phi - size * eta) / total};
}

}  // namespace wr
