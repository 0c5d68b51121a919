// Depths at which wheels on a common axle carry their loads.
//
// Broyden's method takes few solves, but may not end on steep flanges, where a wheel that is lowered rolls the axle and
// climbs. The search by brackets always does: both wheels together carry their loads at one height for every roll, and
// the part of the left one passes its load between rolls that lift it and the other.
#pragma once
#include "contact/loading/core/load_search.hpp"

namespace wr {

constexpr int MAX_TRIALS = 24;  // of Broyden's method: 4 to 10 suffice but on steep flanges
// Step beyond a gap, over the approach: deeper wheels are not needed, and take long.
constexpr double FARTHEST_WHEEL = 3.0;
constexpr int LIFTS = 12;        // of a wheel that cannot be solved at the start, each twice as far as before
constexpr double WIDEST = 0.15;  // m, largest change of the difference of both depths: rolls of 0.1 rad
// Part of a load by which wheels that hardly carry, or carry nearly all, are told from others.
constexpr double LIFTED = 0.9;
constexpr int MAX_HALVINGS = 60;  // of a bracket

using OfWheels = std::array<double, 2>;
// Results at depths (2,) m, from earlier results as initial guess.
using BothLowered = std::function<Results(const OfWheels& depths, const Results& earlier)>;

// Depths (2,) m of two wheels on a common axle at which they carry loads, and number of trials.
struct LoadsSolution {
    OfWheels depths{};
    Results results;
    long trials = 0;
};

// Slopes: diagonal of the initial Jacobian, N^(2/3)/m; the force of a wheel depends mostly on its own depth.
struct LoadsTarget {
    OfWheels loads;  // N
    OfWheels start;  // m, initial depths
    OfWheels slopes;
    double rtol = RTOL;
    Results guess = {};  // results to start from
};

// Broyden's method on F^(2/3). A wheel in the air counts as minus its gap times the slope of F^(2/3) by depth, so that
// the equations stay regular. Throws LoadError when a solve fails, or when the loads are not reached.
inline LoadsSolution loads_by_broyden(const BothLowered& contact, const LoadsTarget& given, int max_trials) {
    const auto& [loads, start, slopes, rtol, first] = given;
    OfWheels depths = start, step{}, residual{}, expected{};
    double jacobian[2][2] = {{slopes[0], 0.0}, {0.0, slopes[1]}}, size = UNBOUNDED;
    for (int i : {0, 1}) expected[i] = compliant(loads[i]) / slopes[i];  // m, approach under the load
    Results guess = first;
    for (long trial = 1; trial <= max_trials; ++trial) {
        OfWheels at{depths[0] + step[0], depths[1] + step[1]}, now{};
        auto results = contact(at, guess);
        bool usable = all_ok(results);
        double error = 0.0, largest = 0.0;
        for (int i : {0, 1}) {
            double approach = results[i].approach, force = results[i].force.z;
            now[i] = (approach > 0.0 ? compliant(force) : slopes[i] * std::min(approach, 0.0)) - compliant(loads[i]);
            usable = usable && std::isfinite(now[i]);
            error = std::max(error, std::abs(force / loads[i] - 1.0)), largest = std::max(largest, std::abs(now[i]));
        }
        // Below the contact's own tolerance the force depends on the guess: shorter steps need not come back to `size`.
        if (usable && (error <= rtol || (error <= NOISE && largest > 0.5 * size))) return {at, results, trial};
        if (!usable && size == UNBOUNDED && trial < LIFTS) {  // too deep at the roll of both: from above
            for (int i : {0, 1})
                if (!results[i].ok()) depths[i] -= std::ldexp(expected[i], int(trial));
            continue;
        }
        if (!usable &&
            std::max(std::abs(step[0]), std::abs(step[1])) < std::min(1e-9, 1e-3 * std::ranges::min(expected)))
            require_solved(results);
        if (!usable || largest > 2.0 * size) {
            for (double& own : step) own *= 0.5;
            continue;
        }
        if (double square = step[0] * step[0] + step[1] * step[1]; square > 0.0)
            for (int i : {0, 1}) {
                double missed = now[i] - residual[i] - (jacobian[i][0] * step[0] + jacobian[i][1] * step[1]);
                for (int k : {0, 1}) jacobian[i][k] += missed * step[k] / square;
            }
        depths = at, guess = std::move(results), residual = now, size = largest;
        const auto& [top, bottom] = jacobian;
        double determinant = top[0] * bottom[1] - top[1] * bottom[0], part = 1.0;
        if (determinant != 0.0)
            step = {(top[1] * now[1] - bottom[1] * now[0]) / determinant,
                    (bottom[0] * now[0] - top[0] * now[1]) / determinant};
        else
            step = {-now[0] / slopes[0], -now[1] / slopes[1]};
        for (int i : {0, 1}) {
            double approach = guess[i].approach;
            double room = std::max(-approach, 0.0) + FARTHEST_WHEEL * std::max(approach, expected[i]);
            part = std::min(part, room / std::max(std::abs(step[i]), 1e-300));
        }
        for (double& own : step) own *= part;
    }
    throw LoadError(text("loads not reached in %d solves", max_trials));
}

// Search by brackets of the difference of both depths; expected: m, largest approach under the loads.
class BracketedLoads {
  public:
    BracketedLoads(const BothLowered& contact, const LoadsTarget& given, double expected)
        : contact(contact), given(given), expected(expected) {}

    // Throws LoadError.
    LoadsSolution find() {
        enclose();
        int side = 0;  // of the last trials: as often as one end stays, its excess counts half (Illinois)
        OfWheels weights{1.0, 1.0};
        const Balance* best = &low;
        for (int trial = 0; trial < MAX_HALVINGS; ++trial) {
            best = std::abs(high.excess) < std::abs(low.excess) ? &high : &low;
            double narrow = std::max(0.1 * given.rtol * expected, 8.0 * spacing(std::abs(low.tilt)));
            if (std::abs(best->excess) <= given.rtol || high.tilt - low.tilt <= narrow) break;
            double left = low.excess * weights[0], right = high.excess * weights[1];
            double part = std::max(left, -right) > LIFTED ? 0.5 : left / (left - right);
            double tilt = low.tilt + part * (high.tilt - low.tilt);
            auto own = balance(tilt, best->found.depth - 0.5 * std::abs(tilt - best->tilt), best->found.results);
            if (own.excess >= 0.0)
                low = std::move(own), weights = {1.0, side == 1 ? 0.5 * weights[1] : 1.0}, side = 1;
            else
                high = std::move(own), weights = {side == -1 ? 0.5 * weights[0] : 1.0, 1.0}, side = -1;
        }
        if (std::abs(best->excess) > std::max(FORCE_JUMP, given.rtol))
            throw LoadError(text("forces of the wheels jump over %g N at one roll, nearest ", given.loads[0]) +
                            best->forces());
        return {depths(best->found.depth, best->tilt), best->found.results, trials};
    }

  private:
    // Both wheels carry their loads together, at a difference of their depths.
    struct Balance {
        double tilt = 0.0;    // m, depth of the right wheel below the left one
        LoadSolution found;   // mean depth
        double excess = 0.0;  // of the left wheel's force over its load

        std::string forces() const { return text("%g N and %g N", found.results[0].force.z, found.results[1].force.z); }
    };

    static OfWheels depths(double mean, double tilt) { return {mean - 0.5 * tilt, mean + 0.5 * tilt}; }

    Balance balance(double tilt, double mean, const Results& guess) {
        auto lowered = [&](double depth, const Results& own) { return contact(depths(depth, tilt), own); };
        auto found = LoadSearch({.load = given.loads[0] + given.loads[1],
                                 .expected = expected,
                                 .start = mean,
                                 .rtol = 0.5 * given.rtol,
                                 .guess = guess})
                         .find(lowered);
        trials += found.trials;
        double excess = found.results[0].force.z / given.loads[0] - 1.0;
        return {tilt, std::move(found), excess};
    }

    // Find differences at which the left wheel carries more, and less, than its load.
    void enclose() {
        double first = given.start[1] - given.start[0], stride = 2.0 * expected;
        low = high = balance(first, std::ranges::min(given.start) - 0.5 * std::abs(first), {});
        Balance last = low;
        while (low.excess < 0.0 || high.excess > 0.0) {  // the left wheel carries more at low, less at high
            double way = double(last.excess > 0.0) - double(last.excess < 0.0);
            if (std::abs(last.tilt - first) > WIDEST)
                throw LoadError(text("no roll at which each wheel carries %g N, nearest ", given.loads[0]) +
                                last.forces());
            try {
                last = balance(last.tilt + way * stride, last.found.depth - 0.5 * stride, last.found.results);
            } catch (const LoadError&) {
                if (stride < 1e-3 * expected) throw;
                stride *= 0.25;
                continue;
            }
            stride *= 2.0;
            (last.excess >= 0.0 ? low : high) = last;
        }
    }

    const BothLowered& contact;
    const LoadsTarget& given;
    double expected;
    long trials = 0;
    Balance low, high;
};

// Throws LoadError when the loads are not reached. max_trials: of Broyden's method.
inline LoadsSolution depths_for_loads(const BothLowered& contact, const LoadsTarget& given,
                                      int max_trials = MAX_TRIALS) {
    try {
        return loads_by_broyden(contact, given, max_trials);
    } catch (const LoadError&) {
        double expected = 0.0;
        for (int i : {0, 1}) expected = std::max(expected, compliant(given.loads[i]) / given.slopes[i]);
        return BracketedLoads(contact, given, expected).find();
    }
}

}  // namespace wr
