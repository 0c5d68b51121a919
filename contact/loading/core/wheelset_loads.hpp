// Static equilibrium of a wheelset on its rails: height, and roll, at which it carries given loads.
#pragma once
#include "contact/loading/core/two_wheels.hpp"

namespace wr {

constexpr double DEEPEST_WHEEL = 0.05;  // m below the nominal height, limit of the search
constexpr double FRICTIONLESS = 1e-3;   // tolerance of the load without friction, for a first depth
constexpr double FIRST = 0.02;          // that of each wheel on its own, before both on one axle
constexpr double DEEP = 3.0;            // times the expected approach: too large a penetration to start from
// Times that: 0.8 nm of a cylinder on a plane, as long as wide, took 7 GB on the finest strips.
constexpr double SHALLOW = 1e-3;
// Times the expected approach, with which no wheel carries its load: steep flanges take 35 times at most.
constexpr double TOO_FAR = 50.0;
// m, as under usual loads: friction may hold a wheel down on a steep flange to this under any load.
constexpr double HELD = 2e-4;
constexpr int START_STEPS = 12;          // to a start without a solve
constexpr double FLATTEST_FLANGE = 0.1;  // smallest change of the penetration by the height that they use

// What is left open of a wheelset's state.
struct Position {
    double z = 0.0, roll = 0.0;  // m, rad
};

// Position with wheels at depths (2,) m below the nominal height at a roll, base m from the middle.
inline Position position_at(const OfWheels& depths, double roll, double base) {
    auto [left, right] = depths;  // z + base roll = -left, z - base roll = -right
    return {-0.5 * (left + right), roll + 0.5 * (right - left) / base};
}

// Wheels of a wheelset in a state but for its position; sides are 0, the left one, and 1.
struct LoweredWheelset {
    Position start;
    double base = 0.0;  // m, from the middle of the axle to the wheels
    // Solution from an earlier one or, null, from none.
    std::function<PairSolution(int side, const Position& at, const PairSolution* earlier)> solve;
    // Largest penetration m of the undeformed surfaces; NaN of models that tell it by a solve alone.
    std::function<double(int side, const Position& at)> penetration;
    std::array<bool, 2> on_strips{};  // whether a solve costs the more, the deeper the wheel
    // Solution without friction on the same points, for sides where this is another, quicker model.
    decltype(solve) frictionless;
    std::array<bool, 2> quicker{};

    Position at(const OfWheels& depths) const { return position_at(depths, start.roll, base); }
};

using Sides = std::vector<int>;

// Position at which wheels carry loads, their results, and number of contact solves.
struct Equilibrium {
    Position position;
    Results results;
    long solves = 0;
};

struct WheelTarget {
    double load, expected;  // N, on all wheels of the search; m, estimate of the approach
    double rtol = RTOL;     // of the load
};

// Initial depth m: beyond a gap; on strips of the expected approach, on a grid where there are not many more candidate
// points than under the load.
//
// 0.7 mm on the flange root at a grid of 1 mm are 1600 points, whose compliance takes a gigabyte; under the load they
// are 770. On strips a solve at six times the load takes ten times as long as one under the load.
inline double initial_depth(const LoweredWheelset& wheels, int side, double expected) {
    double depth = -wheels.start.z, last_depth = 0.0, last = 0.0;
    double largest = wheels.on_strips[side] ? expected : DEEP * expected;
    for (int step = 0; step < START_STEPS; ++step) {
        double penetration = wheels.penetration(side, {-depth, wheels.start.roll});
        if (!(penetration < SHALLOW * expected || penetration > largest)) break;
        // on a flange face the distance of both surfaces changes by a part of the height
        double change = 1.0, least = penetration > 0.0 ? FLATTEST_FLANGE : 1.0;
        if (step > 0 && depth != last_depth) change = (penetration - last) / (depth - last_depth);
        last_depth = depth, last = penetration;
        depth -= (penetration - expected) / std::min(std::max(change, least), 1.0);
    }
    return depth;
}

// Depths m from which wheels are solved: those far deeper than under their loads, as on a flange by millimetres, are
// lifted to their approach.
//
// Parameters: depths m, of each wheel or of both together; approach m, under the loads; expected: m, by which the
// penetration may exceed it; penetration: of the undeformed surfaces at depths; NaN where only a solve tells it.
inline Array<double, 1> lifted(Array<double, 1> depths, const Numbers& approach, double expected,
                               const std::function<Array<double, 1>(const Numbers&)>& penetration) {
    long n = depths.size();
    Array<double, 1> last_depths(n), last(n);
    for (int step = 0; step < START_STEPS; ++step) {
        auto known = penetration(depths);
        bool any = false;
        for (long i = 0; i < n; ++i) {
            double way = depths(i) - last_depths(i), change = 1.0;
            if (step) change = (known(i) - last(i)) / (way != 0.0 ? way : UNBOUNDED);
            last_depths(i) = depths(i), last(i) = known(i);
            if (!(known(i) > approach(i) + expected)) continue;
            any = true;
            depths(i) -= (known(i) - approach(i)) / std::clamp(change, FLATTEST_FLANGE, 1.0);
        }
        if (!any) break;
    }
    return depths;
}

// Depth, below the nominal height at the roll of the state, at which some wheels together carry a load; first: a depth,
// results and a slope to begin with, to `NOISE` of the load. Throws LoadError.
inline LoadSolution depth_of_wheels(const LoweredWheelset& wheels, const Sides& sides, WheelTarget target,
                                    std::optional<LoadSolution> first = {}) {
    auto [load, expected, rtol] = target;
    if (first) {
        rtol = std::max(rtol, NOISE);
    } else if (std::any_of(sides.begin(), sides.end(), [&](int side) { return wheels.quicker[side]; })) {
        auto without = wheels;
        without.solve = wheels.frictionless, without.quicker = {};
        try {
            first = depth_of_wheels(without, sides, {load, expected, FRICTIONLESS});
        } catch (const LoadError&) {
            first.reset();  // friction may find the load from another start
        }
    }
    double start = first ? first->depth : UNBOUNDED;
    if (!first)
        for (int side : sides) start = std::min(start, initial_depth(wheels, side, expected));
    LoadTarget to{load, expected, start, rtol, DEEPEST_WHEEL};
    if (first) to.guess = first->results, to.known_slope = first->slope;
    if (std::any_of(sides.begin(), sides.end(), [&](int side) { return wheels.on_strips[side]; })) to.usual = HELD;
    auto lowered = [&](double depth, const Results& earlier) {
        Results results;
        for (std::size_t i = 0; i < sides.size(); ++i)
            results.push_back(
                wheels.solve(sides[i], {-depth, wheels.start.roll}, earlier.empty() ? nullptr : &earlier[i]));
        return results;
    };
    try {
        auto found = LoadSearch(std::move(to)).find(lowered);
        if (first) found.trials += first->trials;
        return found;
    } catch (const LoadError& error) {
        std::string names = sides.size() > 1 ? "left and right" : sides[0] ? "right" : "left";
        throw LoadError(names + " wheel: " + error.what());
    }
}

// Height at which some wheels together carry a load, at the roll of the state. Throws LoadError.
inline Equilibrium wheels_under_load(const LoweredWheelset& wheels, const Sides& sides, const WheelTarget& target,
                                     const std::optional<LoadSolution>& first = {}) {
    auto found = depth_of_wheels(wheels, sides, target, first);
    return {{-found.depth, wheels.start.roll}, std::move(found.results), found.trials * long(sides.size())};
}

// Height and roll at which each wheel carries a load, starting from the state's roll. Throws LoadError.
inline Equilibrium each_under_load(const LoweredWheelset& wheels, const WheelTarget& target) {
    const auto& [load, expected, rtol] = target;
    LoadsTarget to{{load, load}, {}, {}, rtol};
    Array<double, 1> depths(2), approach(2);
    long solves = 0;
    for (int side : {0, 1}) {
        auto own = depth_of_wheels(wheels, {side}, {load, expected, FIRST});
        depths(side) = own.depth, approach(side) = own.results[0].approach, to.slopes[side] = own.slope;
        to.guess.push_back(own.results[0]), solves += own.trials;
    }
    auto penetrations = [&](const Numbers& at) {
        Array<double, 1> known(2);
        for (int side : {0, 1}) known(side) = wheels.penetration(side, wheels.at({at(0), at(1)}));
        return known;
    };
    depths = lifted(depths, approach, expected, penetrations), to.start = {depths(0), depths(1)};
    double limit = std::max(TOO_FAR * expected, HELD);
    auto lowered = [&](const OfWheels& own, const Results& earlier) {
        auto at = wheels.at(own);
        Results results;
        for (int side : {0, 1}) {
            double deep = wheels.on_strips[side] ? wheels.penetration(side, at) : 0.0;
            results.push_back(deep > limit
                                  ? PairSolution::failed(text("%.3g mm deep, far beyond its load", 1e3 * deep), deep)
                                  : wheels.solve(side, at, earlier.empty() ? nullptr : &earlier[side]));
        }
        return results;
    };
    auto found = depths_for_loads(lowered, to);
    return {wheels.at(found.depths), std::move(found.results), solves + 2 * found.trials};
}

}  // namespace wr
