// Contact on a lattice as a model of wheelsets.
#pragma once
#include "contact/element/core/pair_contact.hpp"
#include "contact/models/lattice/core/lattice_contact.hpp"

namespace wr {

// Pose and velocities of a pair, at a speed of 1 m/s.
inline Owned<Motion> motion_of(const LeftPair<double>& pair) {
    Array<double, 2> rotation(3, 3);
    auto vector = [](const Vec<double>& a) {
        Array<double, 1> values(3);
        values(0) = a.x, values(1) = a.y, values(2) = a.z;
        return values;
    };
    const auto& [x, y, z] = pair.pose.rotation;
    long k = 0;
    for (const auto* axis : {&x, &y, &z}) {
        rotation(0, k) = axis->x, rotation(1, k) = axis->y, rotation(2, k) = axis->z;
        ++k;
    }
    auto origin = vector(pair.pose.origin);
    const auto& [wheel, rail] = pair.motion;
    auto v = vector(wheel.velocity), w = vector(wheel.rotation), at = vector(wheel.reference);
    auto u = vector(rail.velocity), r = vector(rail.rotation), from = vector(rail.reference);
    return {{origin, rotation, pair.pose.plan, {v, w, at}, {u, r, from}, 1.0},
            {origin.owner, rotation.owner, v.owner, w.owner, at.owner, u.owner, r.owner, from.owner}};
}

class LatticePair : public PairContact {
  public:
    // The model on the same strips with another coefficient of friction.
    using WithFriction = std::function<std::shared_ptr<const LatticeContact>(double mu)>;
    // rubs: whether the model has friction.
    LatticePair(std::shared_ptr<const LatticeContact> model, WithFriction other, bool rubs)
        : model(std::move(model)), other(std::move(other)), rubs(rubs) {}

    PairSolution solve(const LeftPair<double>& pair, const PairSolution* earlier) const override {
        const auto* known = earlier ? static_cast<const Start*>(earlier->warm_start.get()) : nullptr;
        auto memory = std::make_shared<Found>(model->solve(motion_of(pair), known ? &known->start : nullptr));
        const LatticeResult& done = *memory->result;
        if (!done.ok()) return PairSolution::failed(done.first().failure, done.approach());
        PairSolution solution = PairSolution::separated(done.approach());
        solution.memory = memory, solution.warm_start = std::make_shared<Start>(done.start);
        if (done.separated()) return solution;
        auto load = done.load();
        solution.status = Status::CONVERGED, solution.iterations = done.count().newton;
        solution.force = vec_of(load.part(0, 3));
        solution.moment = vec_of(load.part(3, 6)) - cross(pair.centre, solution.force);
        return solution;
    }
    Array<double, 2> tangent(const LeftPair<double>&, const PairSolution& solution) const override {
        return found(solution).tangent();
    }
    Array<double, 2> patches(const LeftPair<double>&, const PairSolution& solution) const override {
        return found(solution).patches();
    }
    std::shared_ptr<const PairContact> with_friction(double mu) const override {
        return std::make_shared<LatticePair>(other(mu), other, mu > 0.0);
    }
    double penetration(const LeftPair<double>& pair) const override { return model->approach(motion_of(pair)); }
    bool on_strips() const override { return true; }
    std::shared_ptr<const PairContact> frictionless() const override { return rubs ? with_friction(0.0) : nullptr; }

  private:
    struct Found : Memory {
        explicit Found(std::shared_ptr<LatticeResult> result) : result(std::move(result)) {}
        std::shared_ptr<LatticeResult> result;
    };
    struct Start : Memory {
        explicit Start(LatticeStart start) : start(std::move(start)) {}
        LatticeStart start;
    };
    static LatticeResult& found(const PairSolution& solution) {
        return *static_cast<const Found&>(*solution.memory).result;
    }

    std::shared_ptr<const LatticeContact> model;
    WithFriction other;
    bool rubs;
};

}  // namespace wr
