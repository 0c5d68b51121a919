// Loads on the wheels of an element without Python.
#pragma once
#include "contact/element/core/wheelset_element.hpp"
#include "contact/loading/core/wheelset_loads.hpp"

namespace wr {

constexpr int Z_INPUT = 1, ROLL_INPUT = 2;  // numbers of inputs
// Wheels that carry a load: one, both together, or each, which takes a roll.
enum LoadedWheels { LEFT_WHEEL, RIGHT_WHEEL, BOTH_WHEELS, EACH_WHEEL };

// Wheels of a state (17,) but for its height and roll.
inline LoweredWheelset lowered(const WheelsetContact& contact, const Numbers& state) {
    std::array<double, STATE> values{};
    std::copy(state.begin(), state.end(), values.begin());
    auto without = contact;
    LoweredWheelset wheels{{values[Z_INPUT], values[ROLL_INPUT]}, contact.dimensions[0][0], {}, {}, {}, {}, {}};
    for (int side : {0, 1}) {
        wheels.on_strips[side] = contact.models[side]->on_strips();
        if (auto other = contact.models[side]->frictionless())
            without.models[side] = other, wheels.quicker[side] = true;
    }
    auto placed = [values](const Position& at) {
        auto own = values;
        own[Z_INPUT] = at.z, own[ROLL_INPUT] = at.roll;
        return own;
    };
    auto solved_by = [placed](const WheelsetContact& own) {
        return [own, placed](int side, const Position& at, const PairSolution* earlier) {
            return own.solve({placed(at).data(), {STATE}}, side, earlier);
        };
    };
    wheels.solve = solved_by(contact), wheels.frictionless = solved_by(without);
    wheels.penetration = [contact, placed](int side, const Position& at) {
        return contact.models[side]->penetration(contact.pair({placed(at).data(), {STATE}}, side));
    };
    return wheels;
}

// Solution of an element at the height, of each wheel also the roll, at which wheels carry a load N, from the state
// (17,) of its inputs, which are filled; expected: m, estimate of the approach. Throws LoadError.
inline const WheelsetSolution& solve_under_load(WheelsetElement& element, LoadedWheels loaded, double load,
                                                double expected, const View<double, 1>& inputs) {
    auto wheels = lowered(element.contact(), inputs);
    Sides sides;
    for (int side : {0, 1})
        if (loaded >= BOTH_WHEELS || loaded == side) sides.push_back(side);
    WheelTarget target{load, expected};
    auto found = loaded == EACH_WHEEL ? each_under_load(wheels, target) : wheels_under_load(wheels, sides, target);
    inputs(Z_INPUT) = found.position.z, inputs(ROLL_INPUT) = found.position.roll;
    Known known{};
    for (std::size_t i = 0; i < sides.size(); ++i) known[sides[i]] = &found.results[i];
    return element.solve(inputs, known);
}

}  // namespace wr
