// Contact on a lattice: on ordinary strips or, where it is narrow, on finer levels.
#pragma once
#include "contact/models/lattice/core/blend.hpp"
#include "contact/models/lattice/core/levels.hpp"

namespace wr {

// Warm start of the next solve: solutions of one or two levels whose forces count, none without load, and of finite
// bodies that of the ordinary level, from which their displacement is.
struct LatticeStart {
    using Solution = std::shared_ptr<LatticeSolution>;

    std::vector<int> levels;
    std::vector<Solution> solutions;  // on these
    Solution ordinary;

    // The solution on a level; none without.
    const LatticeSolution* on(int level) const {
        for (std::size_t i = 0; i < levels.size(); ++i)
            if (levels[i] == level) return solutions[i].get();
        return level == 0 ? ordinary.get() : nullptr;
    }
};

// Outcomes of one or two levels, their weights, and the warm start of the next solve.
class LatticeResult {
  public:
    LatticeResult(std::vector<LatticeOutcome> outcomes, LevelShares own, LatticeStart start)
        : levels(std::move(outcomes)), shares(std::move(own)), start(std::move(start)) {}

    const std::vector<LatticeOutcome> levels;  // of `shares.levels`, or one that failed
    const LevelShares shares;
    const LatticeStart start;

    const LatticeOutcome& first() const { return levels.front(); }
    bool blended() const { return levels.size() > 1; }
    bool ok() const { return first().ok(); }
    bool separated() const { return !blended() && first().status == LatticeOutcome::SEPARATED; }
    double approach() const { return blended() ? mean(first().approach, levels[1].approach) : first().approach; }
    // Force N and moment N m (6,) about the rail's origin.
    Array<double, 1> load() const {
        auto load = Array<double, 1>::copy(first().load);
        if (blended())
            for (int i = 0; i < 6; ++i) load(i) = mean(load(i), levels[1].load(i));
        return load;
    }
    IterationCount count() const {
        IterationCount sum;
        for (const auto& at : levels) {
            sum.newton += at.count.newton, sum.linear += at.count.linear;
            sum.residual = std::max(sum.residual, at.count.residual);
        }
        return sum;
    }
    long points() const {
        long sum = 0;
        for (const auto& at : levels) sum += at.points;
        return sum;
    }
    double seconds() const {
        double sum = 0.0;
        for (const auto& at : levels) sum += at.seconds;
        return sum;
    }
    // Derivative (6, 12) of the load by pose and motion, computed at the first call. Throws Unsolved.
    const Array<double, 2>& tangent() {
        if (change.size()) return change;
        Array<double, 2> total = of_level(first());
        if (blended()) {
            auto other = of_level(levels[1]);
            auto by_share = shares.change();
            for (int i = 0; i < 6; ++i)
                for (int k = 0; k < CHANGES; ++k)
                    total(i, k) =
                        mean(total(i, k), other(i, k)) + (levels[0].load(i) - levels[1].load(i)) * by_share(k);
        }
        return change = total;
    }

    // Rows (k, 26) of `store_patch` of all patches, by decreasing load on the first level. Throws OutsideSurface.
    Array<double, 2> patches() const { return blended() ? blend().rows : patches_of(first()); }
    // Patches of two levels.
    BlendedPatches blend() const {
        auto one = patches_of(levels[0]), other = patches_of(levels[1]);
        return {{one, other}, shares.share};
    }

  private:
    static Array<double, 2> patches_of(const LatticeOutcome& at) {
        if (!at.solution) return Array<double, 2>(0, PATCH_NUMBERS);
        const auto& [strips, values] = at.solution->state;
        LatticeProblem& problem = *at.problem;
        auto found = patch_rows(values, problem.of(strips), problem.bodies(strips), problem.tables().modulus);
        if (!found.inside) throw OutsideSurface(PATCH_TOO_LONG);
        return found.rows;
    }
    double mean(double one, double other) const { return shares.share * one + (1.0 - shares.share) * other; }
    static Array<double, 2> of_level(const LatticeOutcome& at) {
        return at.solution ? tangent_of(*at.problem, *at.solution) : Array<double, 2>(6, CHANGES);
    }

    Array<double, 2> change;
};

class LatticeContact {
  public:
    using Level = std::shared_ptr<const LevelModel>;

    // ordinary: the model on ordinary strips. on: that on a finer level.
    LatticeContact(Level ordinary, std::function<Level(int)> on) : ordinary(std::move(ordinary)), on(std::move(on)) {}

    // Largest penetration m of the undeformed surfaces at a pose and motion. Throws Unsolved.
    double approach(const Motion& motion) const { return ordinary->problem(motion)->approach(); }

    // Result of a pose and motion; an earlier start changes the number of iterations only.
    std::shared_ptr<LatticeResult> solve(const Motion& motion, const LatticeStart* earlier) const {
        auto from = [&](int level) { return earlier ? earlier->on(level) : nullptr; };
        auto problem = ordinary->problem(motion);
        std::optional<LatticeOutcome> known;
        std::shared_ptr<BulkDisplacement> bulk;
        LevelShares shares;
        try {
            if (ordinary->setting->tables->finite()) {
                known = ordinary->solve(problem, from(0));
                if (!known->ok()) return result({*known}, {}, {});
                if (known->warm) bulk = std::make_shared<BulkDisplacement>(problem, known->warm);
            }
            shares = level_shares(problem, ordinary->strips, bulk);
        } catch (const Unsolved& error) {
            return result({LatticeOutcome::failed(error.what(), problem->approach())}, {}, {});
        }
        std::vector<LatticeOutcome> outcomes;
        outcomes.reserve(shares.levels.size());
        for (int level : shares.levels) {
            if (level == 0)
                outcomes.push_back(known ? *known : ordinary->solve(problem, from(0)));
            else
                outcomes.push_back(on(level)->solve(on(level)->problem(motion), from(level)));
        }
        // The end of a long strip on a steep flange may have no solution, where the other level's strips have one.
        for (std::size_t i = 0; i < outcomes.size(); ++i) {
            if (outcomes[i].ok()) continue;
            std::size_t k = outcomes.size() - 1 - i;
            if (!outcomes[i].stalled || !outcomes[k].ok() || !outcomes[k].warm)
                return result({outcomes[i]}, {}, start_of(shares.levels, outcomes, known));
            int level = shares.levels[k];
            return result({outcomes[k]}, {{level}, 1.0, {}}, start_of({level}, {outcomes[k]}, known));
        }
        return result(outcomes, shares, start_of(shares.levels, outcomes, known));
    }

  private:
    static LatticeStart start_of(const std::vector<int>& levels, const std::vector<LatticeOutcome>& outcomes,
                                 const std::optional<LatticeOutcome>& known) {
        LatticeStart start{levels, {}, known ? known->warm : nullptr};
        start.solutions.reserve(outcomes.size());
        for (const auto& at : outcomes) start.solutions.push_back(at.warm);
        if (!known && levels.front() == 0) start.ordinary = start.solutions.front();
        return start;
    }
    static std::shared_ptr<LatticeResult> result(std::vector<LatticeOutcome> outcomes, const LevelShares& shares,
                                                 const LatticeStart& start) {
        return std::make_shared<LatticeResult>(std::move(outcomes), shares, start);
    }

    Level ordinary;
    std::function<Level(int)> on;
};

}  // namespace wr
