// Depth at which a contact carries a given load: a secant search with few solves, each warm-started by the previous.
//
// It is kept between a depth that carries less and one that carries more or where the contact fails. Separated surfaces
// do not touch before the upper one has moved by their gap, so that such a depth is known from the first solve on. A
// smooth contact force is about proportional to depth^1.5: the secant is taken of F^(2/3), which is nearly linear.
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <vector>

#include "contact/element/core/pair_contact.hpp"
#include "support/core/text.hpp"

namespace wr {

constexpr double RTOL = 1e-9;   // of the load
constexpr double NOISE = 1e-6;  // of the load: below it a trial without improvement is accepted, for the contact's own
                                // tolerance
constexpr double FORCE_JUMP = 2e-4;  // of the load: largest accepted jump of a discrete contact's force, where cells
                                     // become active
constexpr int MAX_SOLVES = 60;
constexpr double UNBOUNDED = std::numeric_limits<double>::infinity();

// A load is not found.
struct LoadError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

using Results = std::vector<PairSolution>;  // of one wheel, or of both of an axle
// Results at a depth m, from earlier ones as initial guess; none of these at the first solve.
using Lowered = std::function<Results(double depth, const Results& earlier)>;

// F^(2/3) with the sign of F, N^(2/3).
inline double compliant(double force) { return std::copysign(std::pow(std::abs(force), 2.0 / 3.0), force); }

// Hertzian approach m of a sphere on a plane, as initial guess: load N, radius m and contact modulus E* Pa.
inline double sphere_approach(double load, double radius, double modulus) {
    return std::pow(9.0 * (load * load) / (16.0 * (modulus * modulus) * radius), 1.0 / 3.0);
}

// Distance to the next larger number.
inline double spacing(double x) { return std::nextafter(x, UNBOUNDED) - x; }

inline bool all_ok(const Results& results) {
    return std::all_of(results.begin(), results.end(), [](const auto& own) { return own.ok(); });
}

// Vertical force N on all wheels, including friction.
inline double vertical(const Results& results) {
    double sum = 0.0;
    for (const auto& own : results) sum += own.force.z;
    return sum;
}

// Throws LoadError with the reason of the first result that failed, and with the load found before.
inline void require_solved(const Results& results, const std::string& nearest = "") {
    for (const auto& own : results)
        if (!own.ok()) throw LoadError("contact failed: " + own.reason + nearest);
}

// Depth m, downwards from the origin of the scale, at which the contact carries a load.
struct LoadSolution {
    double depth = 0.0;
    Results results;
    double error = UNBOUNDED;  // of the vertical force, over the load
    long trials = 0;           // number of solves
    double slope = 0.0;        // of F^(2/3) by depth, N^(2/3)/m

    std::string nearest() const { return results.empty() ? "none" : text("%g N", vertical(results)); }
};

// What is searched for, and from where.
struct LoadTarget {
    double load, expected;                   // N; m, estimate of the approach under the load
    double start = 0.0;                      // m, depth of the first solve
    double rtol = RTOL;                      // tolerance of the force over the load
    double deepest = 0.1;                    // m, largest depth below the start, or below the gap there
    Results guess = {};                      // initial guess of the first solve
    std::optional<double> known_slope = {};  // of F^(2/3) by depth at the start, if known from a similar contact
    double usual = UNBOUNDED;  // m, overlap from which on steps do not grow with it: where it makes solves long
};

class LoadSearch : LoadTarget {
  public:
    explicit LoadSearch(LoadTarget target) : LoadTarget(std::move(target)) {}

    // Throws LoadError when contact solves fail, or when the load is not reached.
    LoadSolution find(const Lowered& contact) {
        for (long trial = 1; trial <= MAX_SOLVES; ++trial) {
            auto results = contact(depth, guess);
            if (!all_ok(results))
                retreat(std::move(results));
            else if (done(std::move(results), trial)) {
                best.trials = trial;
                return best;
            }
        }
        throw LoadError(text("%g N not reached in %d solves, nearest ", load, MAX_SOLVES) + best.nearest());
    }

  private:
    // Lift a contact that fails.
    void retreat(Results results) {
        double penetration = 0.0;
        for (const auto& own : results)
            if (own.approach > 0.0) penetration = std::max(penetration, own.approach);
        above = std::min(above, depth), failed = std::move(results);
        if (above - below < 1e-3 * expected)
            require_solved(failed, best.results.empty() ? "" : "; nearest " + best.nearest());
        depth = std::isfinite(below) ? 0.5 * (below + above) : depth - std::max(penetration, stride);
        stride *= 2.0;
    }

    // Whether the best results carry the load; otherwise the next depth is set.
    bool done(Results results, long trial) {
        double penetration = results.front().approach, force = vertical(results), value = compliant(force);
        for (const auto& own : results) penetration = std::max(penetration, own.approach);
        double error = std::abs(force - load) / load, gap = std::max(-penetration, 0.0);
        guess = std::move(results);
        start += trial == 1 ? gap : 0.0;
        if (force < load)
            below = std::max(below, depth + gap);
        else
            above = depth, failed.clear();
        if (value > 0.0) {
            if (last || !known_slope) slope = secant(value, penetration);
            last = {depth, value};
        }
        bool stalled = best.error <= NOISE && error >= 0.5 * best.error;
        if (error < best.error) best = {depth, guess, error, trial, slope};
        if (error <= rtol || stalled) return true;
        if (above - below <= std::max(0.1 * rtol * expected, 8.0 * spacing(std::abs(depth)))) {
            if (best.error <= FORCE_JUMP) return true;
            require_solved(failed, "; nearest " + best.nearest());
            throw LoadError(text("the force jumps over %g N at a depth of %.9g m, nearest ", load, depth) +
                            best.nearest());
        }
        advance(value, penetration, gap, trial);
        return false;
    }

    void advance(double value, double penetration, double gap, long trial) {
        if (value > 0.0) {
            // within a step another contact may begin, stiffer than that of a flange which overlaps by millimetres
            double room = 3.0 * std::max(std::min(penetration, usual), expected);
            depth += slope > 0.0 ? std::clamp((target - value) / slope, -room, room) : expected;
        } else {
            if (gap > stride) stride = expected;
            depth = depth + gap + stride, stride *= 2.0;
        }
        bool slow = false;  // one-sided convergence of the secant: bisect instead
        if (trial % 4 == 0) slow = above - below > 0.25 * width, width = above - below;
        if (std::isfinite(below + above) && (slow || !(below < depth && depth < above))) depth = 0.5 * (below + above);
        if (depth - start > deepest)
            throw LoadError(text("%g N not reached within %g m, nearest ", load, deepest) + best.nearest());
    }

    // Slope of F^(2/3) by the last two solves in contact, or by one's penetration m.
    double secant(double value, double penetration) const {
        if (last && value != last->second && depth != last->first)
            return (value - last->second) / (depth - last->first);
        return penetration > 0.0 ? value / penetration : slope;
    }

    double target = compliant(load), depth = start, stride = expected;
    double slope = known_slope && *known_slope != 0.0 ? *known_slope : target / expected;
    double below = -UNBOUNDED, above = UNBOUNDED;   // depths that carry less; more, or where the contact fails
    Results failed;                                 // results at depth `above` where the contact fails
    std::optional<std::pair<double, double>> last;  // depth and F^(2/3) of the last solve in contact
    double width = UNBOUNDED;
    LoadSolution best{start, {}, UNBOUNDED, 0, slope};
};

}  // namespace wr
