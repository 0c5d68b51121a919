// Interface of a pair's contact model to a wheelset, the same for all models.
#pragma once
#include <cmath>
#include <memory>
#include <string>

#include "contact/kinematics/core/left_pair.hpp"

namespace wr {

enum class Status { CONVERGED, SEPARATED, FAILED };

// Data of a solve stored by a model.
struct Memory {
    Memory() = default;
    Memory(const Memory&) = delete;
    Memory& operator=(const Memory&) = delete;
    virtual ~Memory() = default;
};

// Contact of a left-hand pair.
struct PairSolution {
    Status status = Status::SEPARATED;
    std::string reason;                    // of a failure
    Vec<double> force, moment;             // N and N m on the wheel, about the pair's centre; zero of a failure
    double approach = 0.0;                 // m, largest undeformed penetration, negative is a distance; NaN: unknown
    long iterations = 0;                   // of Newton's method
    std::shared_ptr<const Memory> memory;  // for tangent and patches
    std::shared_ptr<const Memory> warm_start;  // for the next solve

    bool ok() const { return status != Status::FAILED; }
    static PairSolution separated(double approach) {
        PairSolution own;
        own.approach = approach;
        return own;
    }
    static PairSolution failed(std::string reason, double approach) {
        PairSolution own = separated(approach);
        own.status = Status::FAILED, own.reason = std::move(reason);
        return own;
    }
};

// A contact model of a left-hand pair; several elements and threads use it at once. Functions throw std::exception for
// what cannot be solved.
class PairContact {
  public:
    PairContact() = default;
    PairContact(const PairContact&) = delete;
    PairContact& operator=(const PairContact&) = delete;
    virtual ~PairContact() = default;
    // Solution at a pose and motion, from an earlier one of this model or, null, from none.
    virtual PairSolution solve(const LeftPair<double>& pair, const PairSolution* earlier) const = 0;
    // Derivatives (6, 12) of force and moment about the rail's origin at a solution that touches: by translation and
    // rotation of the wheel, its velocity and angular velocity, whose reference point moves with the wheel's frame.
    virtual Array<double, 2> tangent(const LeftPair<double>& pair, const PairSolution& solution) const = 0;
    // Largest penetration m of the undeformed surfaces; NaN of models that tell it by a solve alone.
    virtual double penetration(const LeftPair<double>&) const { return std::nan(""); }
    // Whether a solve takes the longer, the deeper the wheel is.
    virtual bool on_strips() const { return false; }
    // A quicker model without friction on the same points; null without one.
    virtual std::shared_ptr<const PairContact> frictionless() const { return nullptr; }
    // Rows (k, 26) of `store_patch` of the patches at a solution that touches, by decreasing load.
    virtual Array<double, 2> patches(const LeftPair<double>& pair, const PairSolution& solution) const = 0;
    // The same model with another friction coefficient.
    virtual std::shared_ptr<const PairContact> with_friction(double mu) const = 0;
};

}  // namespace wr
