// Python's face of the standard contact.
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>

#include "contact/models/standard/core/moved_wheels.hpp"
#include "contact/models/standard/core/patches.hpp"
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

namespace {

using Pair = std::pair<double, double>;
using Triple = std::tuple<double, double, double>;

void require_contacts(const StripPressures& strips, long contacts) {
    require(strips.load.size() == contacts, "strips: must have as many contacts as there are weights or frames");
}

PatchFrames<double> frames_of(const StripPressures& strips, const StripFrames& middles, const StripFrames& peaks) {
    require(middles.point.size() == strips.s.size() && peaks.point.size() == strips.load.size(),
            "middles, peaks: must be one for each strip, and for each contact");
    return {middles.frames(), peaks.frames()};
}

void require_wheels(const WheelPairs& pairs, const WheelForces& forces, const Indices& wheels) {
    require(pairs.size() == forces.wrench.size(), "forces: must be those of the pairs");
    for (long i : wheels) require(i < pairs.size(), "wheels: must be indices of the pairs, or -1");
}

void bind_ellipses(nb::module_& m) {
    structure<PairElasticity>(
        m, "PairElasticity", {"E_star", "G", "table"},
        "Combined elastic constants of two bodies: E* Pa, combined shear modulus G Pa, and table "
        "(2, 10, 3), C11, C22, C23 of `kalker` for a <= b, then for a >= b, at the ratios RATIO.");
    m.def(
        "complete",
        [](double k) {
            auto [K, D] = complete(k);
            return Pair{K, D};
        },
        "k"_a, "Complete elliptic integrals K and D = (K - E) / (1 - k^2) of the complementary modulus k, 0 < k <= 1.");
    m.def(
        "axis_ratio", [](double curvatures) { return axis_ratio(curvatures); }, "curvatures"_a,
        "Semi-axes short / long of the patch from the coefficients A / B <= 1 of the gap A x^2 + B y^2 (Johnson 1985, "
        "eq. 4.26).");
    m.def(
        "ellipse",
        [](double A, double B, double approach, double E_star) {
            auto [a, b, peak] = ellipse(A, B, approach, E_star);
            return Triple{a, b, peak};
        },
        "A"_a, "B"_a, "approach"_a, "E_star"_a,
        "Semi-axes a, b m along x and y and peak pressure Pa, from the coefficients A, B 1/m of the gap A x^2 + B y^2, "
        "the approach m and E* Pa.");
    m.def(
        "strip_potential", [](double half, double away) { return strip_potential(half, away); }, "half"_a, "away"_a,
        "Potential of a strip's pressure at a lateral distance away m: the integral m over x of sqrt(half^2 - x^2) / "
        "sqrt(x^2 + away^2).");
    m.def(
        "polach",
        [](const std::array<double, 3>& creepages, const std::array<double, 2>& semi_axes, double bound, double G,
           const std::array<double, 3>& kalker, const std::array<double, 2>& reduction) {
            auto [along, across] = polach(creepages, semi_axes, bound, G, kalker, reduction);
            return Pair{along, across};
        },
        "creepages"_a, "semi_axes"_a, "bound"_a, "G"_a, "kalker"_a, "reduction"_a,
        "Longitudinal and lateral force N on the faster body by Polach's formula: longitudinal and lateral creepage "
        "and spin 1/m; semi-axes along and across m; bound N, friction coefficient times load; shear modulus Pa; "
        "Kalker's coefficients C11, C22, C23; factors k_A and k_S, 1 on dry and clean rails.");
}

void bind_strips(nb::module_& m) {
    structure<PenetrationRegions>(
        m, "PenetrationRegions",
        {"peak", "peak_x", "depth", "weight", "contact", "s", "x", "width", "penetration", "radius"},
        "Contacts (k,) and strips (n,) across them, contact by contact: peak and peak_x m, position of the maximum on "
        "the upper body's profile and along x; depth m, penetration; weight of the contact, 0 to 1; contact of each "
        "strip; position s, x m on the upper body; width m; penetration m, of the virtual bodies; radius m along x.");
    structure<StripPressures>(
        m, "StripPressures", {"contact", "s", "x", "width", "half", "scale", "load", "along", "across"},
        "Pressures on n strips of k contacts: contact (n,); s, x (n,) m, middle of the strip, arc length on the upper "
        "body's profile and along the rolling direction; width and half length (n,) m; scale (n,) Pa/m, the pressure "
        "at "
        "x from the middle is scale sqrt(half^2 - x^2); load (k,) N, normal force; along and across (k,) m, semi-axes "
        "of the ellipse with the pressure's second moments.");
    structure<StripFriction>(m, "StripFriction", {"method", "of_cells", "of_contacts", "reduction"},
                             "Tangential method, NO_FRICTION, FASTSIM or POLACH; friction coefficients of_cells (n m,) "
                             "for FASTSIM and of_contacts (k,) for Polach's formula; its factors k_A and k_S.");
    structure<StripFrames>(
        m, "StripFrames", {"point", "axes"},
        "Points (n, 3) m on the wheel's surface and axes (n, 3, 3) there, rows longitudinal, lateral "
        "and outward.");
    structure<StripTractions>(
        m, "StripTractions",
        {"force", "moment", "speed", "point", "length", "area", "pressure", "traction", "slip", "sticks"},
        "Tractions of k contacts on n cells, strip by strip from the trailing end, and their resultants: force and "
        "moment (3,) N and N m about the origin; speed (k,) m/s, rolling speed of the contacts; point (n, 3) m; length "
        "(n,) m; area (n,) m2, times the weight of the contact; pressure (n,) Pa; traction (n, 2) Pa; slip (n, 2) over "
        "the rolling speed; sticks (n,), whether the slip is zero.");
    m.attr("NO_FRICTION") = NO_FRICTION;
    m.attr("FASTSIM") = FASTSIM;
    m.attr("POLACH") = POLACH;
    m.def("virtual_penetration", &virtual_penetration<double>, "zones"_a, "E_star"_a, Unlocked(),
          "Piotrowski and Kik's pressure on the interpenetration regions, with shape correction; E* Pa.");
    m.def("hertzian", &hertzian, "zones"_a, "E_star"_a, Unlocked(),
          "Hertz's pressure: the lateral curvature is that of the parabola whose interpenetration region has the same "
          "second moment; E* Pa.");
    m.def(
        "slip_velocities",
        [](const StripPressures& strips, const StripFrames& middles, const StripFrames& peaks, const RigidVelocities& v,
           long cells) { return slip_velocities(strips, frames_of(strips, middles, peaks), v.motion(), cells); },
        "strips"_a, "middles"_a, "peaks"_a, "v"_a, "cells"_a, Unlocked(),
        "Rigid slip velocities on the cells of strips (n cells,), and of the contacts as a whole (k,), m/s; frames in "
        "the middles of the strips and at the maxima of the penetration.");
    m.def(
        "strip_forces",
        [](const StripPressures& strips, const Numbers& share, const StripFrames& middles, const StripFrames& peaks,
           const RigidVelocities& v, const PairElasticity& elastic, const StripFriction& tangential, long cells) {
            long n = strips.s.size(), k = share.size();
            require_contacts(strips, k);
            require(cells > 0 && (tangential.method != FASTSIM || tangential.of_cells.size() == n * cells) &&
                        (tangential.method != POLACH || tangential.of_contacts.size() == k),
                    "tangential: must have a coefficient for each cell, or for each contact");
            return strip_forces(strips, share, frames_of(strips, middles, peaks), v.motion(), elastic, tangential,
                                cells);
        },
        "strips"_a, "share"_a, "middles"_a, "peaks"_a, "v"_a, "elastic"_a, "tangential"_a, "cells"_a, Unlocked(),
        "Tractions of k contacts on the cells of n strips: share (k,), weights of the contacts' areas; frames in the "
        "middles of the n strips, and at the k maxima of the penetration, where the contacts' rolling speeds are "
        "taken; "
        "rigid motion of wheel and rail; cells along each strip. Contacts with a rolling speed that is not positive "
        "have no tangential tractions.");
    m.def(
        "patch_numbers",
        [](const StripPressures& strips, const Numbers& weight) {
            require_contacts(strips, weight.size());
            return patch_numbers(strips, weight);
        },
        "strips"_a, "weight"_a,
        "Number (k,) of the patch of each contact, with weights (k,), by decreasing load: contacts whose pressures "
        "overlap share one.");
    m.def(
        "patch_rows",
        [](const Numbers& weight, const StripPressures& strips, const StripTractions& cells, const StripFrames& middles,
           const Rows& on_wheel, const Rows& on_rail, const RigidVelocities& v) {
            long n = strips.s.size(), size = cells.area.size();
            require_contacts(strips, weight.size());
            require(n > 0 && size % n == 0 && middles.point.size() == n && cells.speed.size() == weight.size(),
                    "cells, middles: must be those of the strips");
            std::array<long, 2> places{n, 2};
            require(on_wheel.shape == places && on_rail.shape == places, "on_wheel, on_rail: must be (n, 2)");
            return patch_rows(weight, strips, cells, middles.frames(), {on_wheel, on_rail}, v.motion());
        },
        "weight"_a, "strips"_a, "cells"_a, "middles"_a, "on_wheel"_a, "on_rail"_a, "v"_a, Unlocked(),
        "Sums over the cells of every patch, rows (p, 26) of `store_patch` by decreasing load: weights (k,) of the "
        "contacts; n strips and their cells and frames; arc lengths and lateral positions (n, 2) m of the strips on "
        "both profiles; rigid motion of wheel and rail.");
}

void bind_wheels(nb::module_& m) {
    structure<Parameters>(
        m, "Parameters", {"wheel", "rail", "radius", "lines", "merge", "elastic", "method", "mu", "reduction", "cells"},
        "Parameters common to all wheels of a pair of profiles: wheel, rail, radius m, lines and merge m as for "
        "`wheel_regions`; constants of both bodies; method of the tangential problem, see `StripFriction`; friction "
        "coefficient mu; factors of Polach's formula; cells along each strip.");
    structure<WheelForces>(
        m, "WheelForces", {"wrench", "values", "starts", "top", "low", "edges", "contacts", "contact", "strips"},
        "Forces of w wheels, and the regions of all: wrench (w, 6) force N and moment N m; values (w, 8), largest "
        "penetration m; 1 for a wheel inside the rail or over an end of a profile, otherwise 0; numbers of contacts "
        "and "
        "of cells; largest semi-axes m along and across; smallest rolling speed m/s; largest pressure Pa; starts (w + "
        "1, 6), first rows of each wheel in the arrays that follow; these are those of `WheelRegions`, wheel after "
        "wheel.");
    m.def("wheel_forces", &wheel_forces, "p"_a, "pairs"_a, "mirror"_a, Unlocked(),
          "Forces of all wheels and moments about the pairs' centres; mirror: whether forces and moments are those in "
          "the mirror y = 0, regions are those of the pairs.");
    m.def(
        "forces_in_states",
        [](const Parameters& p, const Rows& states, const Dimensions& dimensions, bool mirror) {
            require(states.shape[1] == STATE, "states: must be (w, 17)");
            auto pairs = left_pairs(states, dimensions, mirror);
            auto forces = wheel_forces(p, pairs, mirror);
            return std::pair{pairs, forces};
        },
        "p"_a, "states"_a, "dimensions"_a, "mirror"_a, Unlocked(),
        "Pairs and forces of one side of wheelsets: states (w, 17), values of `WheelsetState`; dimensions of wheelset "
        "and track; mirror: whether the side is the right one.");
    m.def(
        "wheel_tangents",
        [](const Parameters& p, const WheelPairs& pairs, const WheelForces& forces, const Indices& wheels) {
            require_wheels(pairs, forces, wheels);
            return wheel_tangents(p, pairs, forces, wheels);
        },
        "p"_a, "pairs"_a, "forces"_a, "wheels"_a, Unlocked(),
        "Derivatives (m, 6, 12) of forces and moments about the rail's origin, with FASTSIM or without friction; zero "
        "for wheels without contact: forces at these poses and motions; indices (m,) of the wheels, -1: none, without "
        "contact.");
    m.def(
        "tangents_in_states",
        [](const Parameters& p, const WheelPairs& pairs, const WheelForces& forces, const Indices& wheels,
           const Rows& states, const Dimensions& dimensions, bool mirror) {
            require_wheels(pairs, forces, wheels);
            require(states.shape == std::array<long, 2>{wheels.size(), STATE}, "states: must be (m, 17)");
            return tangents_in_states(p, pairs, forces, wheels, states, dimensions, mirror);
        },
        "p"_a, "pairs"_a, "forces"_a, "wheels"_a, "states"_a, "dimensions"_a, "mirror"_a, Unlocked(),
        "Derivatives (m, 6, 9) of forces and moments by the coordinates of wheelsets; parameters as for "
        "`wheel_tangents` and `forces_in_states`, whose results these are.");
    m.def(
        "moved_forces", &moved_forces, "p"_a, "states"_a, Unlocked(),
        "Pairs, axes (w, 3, 3) of their rails, and forces of one side of wheelsets with moved hubs and rails, moments "
        "about the wheelsets' centres, in the track's axes.");
    m.def(
        "moved_tangents",
        [](const Parameters& p, const WheelPairs& pairs, const WheelForces& forces, const Indices& wheels,
           const MovedStates& states) {
            require_wheels(pairs, forces, wheels);
            require(states.size() == wheels.size(), "states: must be those of the wheels");
            return moved_tangents(p, pairs, forces, wheels, states);
        },
        "p"_a, "pairs"_a, "forces"_a, "wheels"_a, "states"_a, Unlocked(),
        "Derivatives (m, 6, 18) of forces and moments of left-hand wheels by coordinates of the wheelset and motions "
        "of "
        "hub and rail; parameters as for `wheel_tangents`, forces from `moved_forces`.");
    m.def(
        "wheel_patches",
        [](const Parameters& p, const WheelPairs& pairs, const WheelForces& forces, long i) {
            require(pairs.size() == forces.wrench.size() && 0 <= i && i < pairs.size() && forces.touches(i),
                    "i: must be a wheel of the pairs that touches its rail");
            return wheel_patches(p, pairs[i], regions_of(forces, i));
        },
        "p"_a, "pairs"_a, "forces"_a, "i"_a, Unlocked(),
        "Rows of all patches of wheel i by decreasing load, as `patch_rows`; parameters as for `wheel_tangents`.");
}

}  // namespace

void bind_standard(nb::module_& m) {
    bind_ellipses(m);
    bind_strips(m);
    bind_wheels(m);
}
