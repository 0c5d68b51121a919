// Contact of both wheels of a wheelset as an element of a time integration: trial states between accepted ones.
#pragma once
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "contact/element/core/pair_contact.hpp"
#include "contact/element/core/variables.hpp"
#include "contact/results/core/patch_sums.hpp"

namespace wr {

constexpr int SPEED = COORDINATES, RAILS = SPEED + 4;  // numbers of inputs: speed, and displacement of the first rail
constexpr double CREEPAGE_STEP = 1e-5;  // of differences by the speed and, at 1 m from the centre, by the rotation of
                                        // the track frame

// Contact models of both sides, each of a left-hand pair, and dimensions of wheelset and track of each.
struct WheelsetContact {
    std::array<std::shared_ptr<const PairContact>, 2> models;
    std::array<Dimensions, 2> dimensions;

    LeftPair<double> pair(const Numbers& values, int side) const {
        return left_pair(left_state<double>(values, side == 1), dimensions[side]);
    }
    // Solution of a side at values (17,) of a state, as a left-hand pair, from an earlier one or, null, from none.
    PairSolution solve(const Numbers& values, int side, const PairSolution* earlier) const {
        try {
            auto own = models[side]->solve(pair(values, side), earlier);
            for (double x : {own.force.x, own.force.y, own.force.z, own.moment.x, own.moment.y, own.moment.z})
                if (own.ok() && !std::isfinite(x))
                    return PairSolution::failed("force or moment is not finite", own.approach);
            return own;
        } catch (const std::exception& error) {  // of a solver, at a state it was not made for
            return PairSolution::failed(error.what(), std::nan(""));
        }
    }
};

// Values (17,) in the order of `input_variables`, and the solution there.
struct WheelsetSolution {
    std::array<double, STATE> values{};
    std::array<PairSolution, 2> sides;  // as left-hand pairs
    Array<double, 2> wrench{2, 6};      // N and N m on the wheels, about the wheelset's centre

    bool ok() const { return sides[0].ok() && sides[1].ok(); }
    Numbers state() const { return {values.data(), {STATE}}; }
    // "converged" (a side may be separated), "separated" (all sides), or "failed: ..." with side and reason.
    std::string status() const {
        std::string failures;
        for (int side = 0; side < 2; ++side)
            if (!sides[side].ok())
                failures +=
                    (failures.empty() ? "failed: " : "; ") + std::string(SIDES[side]) + ": " + sides[side].reason;
        if (!failures.empty()) return failures;
        bool touches = false;
        for (const auto& own : sides) touches |= own.status == Status::CONVERGED;
        return touches ? "converged" : "separated";
    }
    // Forces, moments and approaches (14,); NaN of a side that failed.
    void store(const View<double, 1>& outputs) const {
        for (int side = 0; side < 2; ++side) {
            for (int k = 0; k < 6; ++k) outputs(6 * side + k) = sides[side].ok() ? wrench(side, k) : std::nan("");
            outputs(FORCES + side) = sides[side].approach;
        }
    }
};

// Accepted solutions of both sides; none before the first. Trial states that are not accepted have no influence.
using Accepted = std::array<std::shared_ptr<const PairSolution>, 2>;
using Known = std::array<const PairSolution*, 2>;  // null: not there

class WheelsetElement {
  public:
    explicit WheelsetElement(WheelsetContact contact) : contact_(std::move(contact)) {}

    // Solve both contacts of a trial state, starting from the accepted one; known: solutions of sides that are there.
    const WheelsetSolution& solve(const Numbers& values, const Known& known = {}) {
        forget();
        latest_ = solved(values, known);
        return *latest_;
    }
    const WheelsetContact& contact() const { return contact_; }
    void forget() { latest_.reset(), by_coordinates_.reset(); }

    // Let the next solves start from the last solved state. Functions throw std::invalid_argument when it failed, or
    // there is none.
    void accept() {
        const auto& last = last_solved("accept");
        for (int side = 0; side < 2; ++side) {
            auto own = last.sides[side];
            own.memory.reset();  // which holds on to a whole problem
            accepted_[side] = std::make_shared<const PairSolution>(std::move(own));
        }
    }
    const Accepted& accepted() const { return accepted_; }
    void restore(const Accepted& accepted) { accepted_ = accepted, forget(); }

    // Derivatives (12,) of forces and moments by an input at the last solved state: those by coordinates and rails are
    // exact, for the rails without the velocity that the frame's rotation gives to the displaced rail, a part of 1e-5;
    // those by the motion of the track frame are central differences, two solves each.
    void tangent(int input, const View<double, 1>& derivatives) {
        const auto& last = last_solved("tangent");
        if (!by_coordinates_) by_coordinates_ = derivatives_by_coordinates(last);
        if (SPEED <= input && input < RAILS) return store_difference(last, input, derivatives);
        for (int side = 0; side < 2; ++side)
            for (int k = 0; k < 6; ++k) {
                double& value = derivatives(6 * side + k);
                if (input < COORDINATES)
                    value = (*by_coordinates_)(side, k, input);
                else
                    value = (input - RAILS) / 2 == side ? -(*by_coordinates_)(side, k, (input - RAILS) % 2) : 0.0;
            }
    }

    // Values (2, 13) of the most loaded patch of each side at the last solved state, zeros where there is none.
    Array<double, 2> patches() const {
        const auto& last = last_solved("patches");
        Array<double, 2> values(2, PATCH_VALUES);
        for (int side = 0; side < 2; ++side)
            if (const auto& own = last.sides[side]; own.status == Status::CONVERGED)
                store_most_loaded(contact_.models[side]->patches(contact_.pair(last.state(), side), own), side == 1,
                                  values[side]);
        return values;
    }

  private:
    WheelsetSolution solved(const Numbers& values, const Known& known = {}) const {
        WheelsetSolution solution;
        std::copy(values.begin(), values.end(), solution.values.begin());
        for (int side = 0; side < 2; ++side) {
            auto& own = solution.sides[side];
            own = known[side] ? *known[side] : contact_.solve(values, side, accepted_[side].get());
            if (own.status != Status::CONVERGED) continue;
            auto wrench = solution.wrench[side];
            store_vector(own.force, wrench.part(0, 3)), store_vector(own.moment, wrench.part(3, 6));
            if (side == 1) wrench(1) = -wrench(1), wrench(3) = -wrench(3), wrench(5) = -wrench(5);
        }
        return solution;
    }

    // Derivatives (2, 6, 9) of forces and moments by the coordinates.
    Array<double, 3> derivatives_by_coordinates(const WheelsetSolution& last) const {
        Array<double, 3> result(2, 6, COORDINATES);
        for (int side = 0; side < 2; ++side) {
            const auto& own = last.sides[side];
            if (own.status != Status::CONVERGED) continue;
            auto at = contact_.pair(last.state(), side);
            auto tangent = contact_.models[side]->tangent(at, own);
            for (long q = 0; q < tangent.shape[1]; ++q) {  // about the wheelset's centre
                auto moment = cross(at.centre, Vec<double>{tangent(0, q), tangent(1, q), tangent(2, q)});
                tangent(3, q) -= moment.x, tangent(4, q) -= moment.y, tangent(5, q) -= moment.z;
            }
            store_by_state(tangent, last.wrench[side], last.state(), contact_.dimensions[side][0], side == 1,
                           result[side]);
        }
        return result;
    }

    void store_difference(const WheelsetSolution& last, int input, const View<double, 1>& derivatives) const {
        double size = CREEPAGE_STEP * (last.values[SPEED] != 0.0 ? last.values[SPEED] : 1.0);
        std::array<double, OUTPUTS> ahead{}, behind{};
        for (auto [way, outputs] : {std::pair{size, &ahead}, std::pair{-size, &behind}}) {
            auto values = last.values;
            values[input] += way;
            solved({values.data(), {STATE}}).store({outputs->data(), {OUTPUTS}});
        }
        for (int k = 0; k < FORCES; ++k) derivatives(k) = (ahead[k] - behind[k]) / (2.0 * size);
    }

    // Values (13,) of the patch with the largest normal force, of rows (k, 26) of `store_patch`; mirrored: in y = 0.
    static void store_most_loaded(const Rows& rows, bool mirrored, const View<double, 1>& values) {
        long best = 0;
        for (long k = 1; k < rows.size(); ++k)
            if (rows(k, 2) > rows(best, 2)) best = k;
        if (rows.size() == 0) return;
        auto row = rows[best];
        double sign = mirrored ? -1.0 : 1.0;
        double own[] = {double(rows.size()), row(0),  row(1),  row(2),  row(6), sign * row(7), row(8), row(9),
                        sign * row(10),      row(13), row(14), row(20), row(24)};
        static_assert(std::size(own) == PATCH_VALUES);
        std::copy(std::begin(own), std::end(own), values.begin());
    }

    const WheelsetSolution& last_solved(const std::string& purpose) const {
        if (!latest_)
            throw std::invalid_argument(purpose + ": no state has been solved since the element was made or restored");
        if (!latest_->ok()) throw std::invalid_argument(purpose + ": the last solve " + latest_->status());
        return *latest_;
    }

    WheelsetContact contact_;
    Accepted accepted_;
    std::optional<WheelsetSolution> latest_;
    std::optional<Array<double, 3>> by_coordinates_;
};

}  // namespace wr
