// The standard contact of a pair of profiles with Piotrowski and Kik's pressures and constant friction, as a model of
// wheelsets.
#pragma once
#include "contact/element/core/pair_contact.hpp"
#include "contact/models/standard/core/patches.hpp"
#include "contact/models/standard/core/wheel_tangents.hpp"
#include "support/core/text.hpp"

namespace wr {

// Data of the standard contact of a pair.
struct StandardData {
    Parameters parameters;
    std::array<double, 2> extent{};  // m, longest semi-axes, along and across, of a patch that lies on both bodies
    std::string wheel, rail;         // names of the profiles
    long tangential = FASTSIM;       // method where there is friction

    auto fields() { return std::tie(parameters, extent, wheel, rail, tangential); }
};

// Reason to reject a result by its values, see `WheelForces`; empty if valid.
//
// Parameters: largest extent m of patches along and across, E* Pa and method of the pair; values (8,).
inline std::string failure(const std::array<double, 2>& extent, double E_star, long method, const Numbers& values) {
    for (int a = 0; a < 2; ++a)
        if (!(values(4 + a) < extent[a]))
            return text("the surfaces conform: a semi-axis of %.3g mm is not on the bodies, whose extent is %.3g mm",
                        1e3 * values(4 + a), 1e3 * extent[a]);
    if (auto deep = overloaded(values(0), values(7), E_star); !deep.empty()) return deep;
    if (method != NO_FRICTION && !(values(6) > 0.0))
        return text("friction needs a positive rolling speed, got %g m/s; with mu = 0 any is allowed", values(6));
    return "";
}

class StandardContact : public PairContact {
  public:
    explicit StandardContact(StandardData data) : own_(std::move(data)) {}

    PairSolution solve(const LeftPair<double>& pair, const PairSolution*) const override {
        auto memory = std::make_shared<Found>();
        Array<double, 1> wrench(6), values(8);
        memory->regions = store_force(own_.parameters, pair, wrench, values);
        double approach = values(0);
        if (memory->regions.beyond)
            return PairSolution::failed(
                overlap(own_.parameters.pair(), pair.pose, own_.parameters.lines, own_.wheel, own_.rail),
                approach > 0.0 ? approach : std::nan(""));
        if (memory->regions.contacts.size() == 0) return PairSolution::separated(approach);
        const auto& p = own_.parameters;
        if (auto reason = failure(own_.extent, p.elastic.E_star, p.method, values); !reason.empty())
            return PairSolution::failed(reason, approach);
        PairSolution solution;
        solution.status = Status::CONVERGED, solution.approach = approach;
        solution.force = vec_of(wrench.part(0, 3)), solution.moment = vec_of(wrench.part(3, 6));
        solution.memory = std::move(memory);
        return solution;
    }

    Array<double, 2> tangent(const LeftPair<double>& pair, const PairSolution& solution) const override {
        if (own_.parameters.method == POLACH) throw std::runtime_error("the result has no tangent: converged");
        Array<double, 2> tangent(6, CHANGES);
        store_tangent(own_.parameters, pair, found(solution), tangent);
        return tangent;
    }

    Array<double, 2> patches(const LeftPair<double>& pair, const PairSolution& solution) const override {
        return wheel_patches(own_.parameters, pair, found(solution));
    }

    std::shared_ptr<const PairContact> with_friction(double mu) const override {
        StandardData other = own_;
        auto& p = other.parameters;
        p.mu = mu;
        p.method = mu > 0.0 ? own_.tangential : NO_FRICTION;
        return std::make_shared<StandardContact>(std::move(other));
    }

  private:
    struct Found : Memory {
        WheelRegions regions;
    };
    static const WheelRegions& found(const PairSolution& solution) {
        return static_cast<const Found&>(*solution.memory).regions;
    }
    StandardData own_;
};

}  // namespace wr
