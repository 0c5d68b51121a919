// Contact on the strips of one level of a lattice: the force is a function of the pose alone.
#pragma once
#include <chrono>
#include <functional>

#include "contact/models/lattice/core/patches.hpp"
#include "contact/models/lattice/derivatives/core/tangent.hpp"
#include "contact/models/lattice/solver/core/newton.hpp"

namespace wr {

constexpr double FARTHEST_STEP = 0.5;  // first step from an earlier result beyond which a start without it is shorter
constexpr long WARM_ITERATIONS = 12;   // from an earlier result: from none, 8 to 12 suffice nearly always
constexpr long COLD_ITERATIONS = 25;   // from none: 99.9 % of random poses need at most 21
// m, approach of a wheel on half-spaces, and on bodies that bend: with 3 mm one on the tread carries 5 MN
constexpr double DEEPEST[] = {3e-3, 1e-2};
constexpr std::size_t NARROWER = 2;   // of the finer models: those on strips of half and a quarter of the width
constexpr long MOST_UNKNOWNS = 2500;  // in search of a pressure without tension on wide contacts: 2 s a Newton step

// Outcome of a solve on one level, with the data of its tangent and patches.
struct LatticeOutcome {
    enum Status { SOLVED, SEPARATED, FAILED };

    Status status = SEPARATED;
    std::string failure;
    double approach = std::numeric_limits<double>::quiet_NaN();  // m
    Array<double, 1> load{6};                                    // N and N m about the origin
    IterationCount count;
    long points = 0;
    double seconds = 0.0;
    std::shared_ptr<LatticeProblem> problem;
    std::shared_ptr<LatticeSolution> solution;  // none without load
    std::shared_ptr<LatticeSolution> warm;      // with which the next solve begins
    bool stalled = false;                       // whether it failed as Newton's method did not converge
    double tension = INFINITE;                  // Pa, largest mean over a cell, of a solution that failed by it

    bool ok() const { return status != FAILED; }
    static LatticeOutcome failed(std::string reason, double approach) {
        LatticeOutcome of;
        of.status = FAILED, of.failure = std::move(reason), of.approach = approach;
        return of;
    }
};

// Derivatives (k, 12) by pose and motion of sums of the unknowns of a solution with weights (k, n). Throws Unsolved.
inline TangentSums derivatives_of(LatticeProblem& problem, const LatticeSolution& solution, Rows weights) {
    TangentPlaces places{problem.lines, problem.lattice(), problem.tables().lines()};
    const auto& data = problem.of(solution.state.strips);
    TangentSums sums(solution.state.values, data, places, weights);
    if (!sums.inside) throw OutsideSurface(PATCH_TOO_LONG);
    if (!sums.regular) throw NotConverged("the Jacobian of the contact is singular");
    return sums;
}

// Derivative (6, 12) of force and moment about the rail's origin; the factors of the solution become those at hand.
// Throws Unsolved.
inline Array<double, 2> tangent_of(LatticeProblem& problem, LatticeSolution& solution) {
    ResultantSlopes by(solution.state.values, problem.of(solution.state.strips));
    auto sums = derivatives_of(problem, solution, by.slopes);
    solution.factors = sums.factors;
    if (!problem.all().surface.revolves) return sums.changes;
    // the strips move with the wheel: a force and its moment that move and rotate with its frame
    using D = Dual<POSE>;
    auto pose = problem.pose();
    auto moving = varied<D>(pose);
    Vec<double> force{by.total(0), by.total(1), by.total(2)}, moment{by.total(3), by.total(4), by.total(5)};
    Vec<D> turn{variable<D>(0.0, 3), variable<D>(0.0, 4), variable<D>(0.0, 5)};
    auto turned = [&](const Vec<double>& a) { return a + cross(turn, a); };
    auto carried = turned(force), twisted = turned(moment - cross(pose.origin, force)) + cross(moving.origin, carried);
    for (int k = 0; k < POSE; ++k) {
        const D* rows[] = {&carried.x, &carried.y, &carried.z, &twisted.x, &twisted.y, &twisted.z};
        for (int i = 0; i < 6; ++i) sums.changes(i, k) += rows[i]->d[k];
    }
    return sums.changes;
}

class LevelModel {
  public:
    using Models = std::vector<std::shared_ptr<const LevelModel>>;

    std::shared_ptr<const LatticeSetting> setting;
    long strips = 0;  // over a usual patch, on ordinary ones
    int level = 0;    // halvings of the strips' width
    // Models with more cells along the same strips, then two on narrower ones.
    std::function<Models()> finer;
    // Called before a start with a number of strips; may throw.
    std::function<void(long strips)> check_size;
    // Called now and then; may throw.
    std::function<void()> look;

    std::shared_ptr<LatticeProblem> problem(const Motion& motion) const {
        return std::make_shared<LatticeProblem>(setting, motion);
    }

    // Outcome of the equations on the strips of this level, for any number of loaded strips. earlier: solution of
    // another pose, or none. wider: state of this pose on wider strips, or none; without tension, it is the only start.
    LatticeOutcome solve(const std::shared_ptr<LatticeProblem>& of, const LatticeSolution* earlier,
                         const LatticeState* wider = nullptr) const {
        auto start = std::chrono::steady_clock::now();
        LatticeProblem& problem = *of;
        double approach = problem.approach();
        if (approach <= 0.0) {
            auto overlap = problem.overlap();
            if (!overlap.empty()) return LatticeOutcome::failed(overlap, std::numeric_limits<double>::quiet_NaN());
            LatticeOutcome apart;
            apart.approach = approach;
            return apart;
        }
        if (setting->surface.revolves && approach > DEEPEST[setting->tables->finite()]) {
            return LatticeOutcome::failed(TOO_DEEP + text(": both overlap by %.3g mm", 1e3 * approach), approach);
        }
        try {
            problem.check_inside();
            LatticeOutcome done;
            auto found = wider     ? from_wider(problem, *wider, done.count)
                         : earlier ? from_earlier(problem, *earlier, done.count)
                                   : std::nullopt;
            if (!found || (!wider && problem.tensile(found->state))) found = from_none(problem, done.count);
            const auto& state = found->state;
            problem.check_loaded(state.strips);
            done.solution = done.warm = std::make_shared<LatticeSolution>(*found);
            // first, as solves with finer cells take twenty times as long
            auto failure = overloaded(approach, peak(state.values), problem.tables().modulus);
            if (!failure.empty()) return LatticeOutcome::failed(failure, approach);
            if (problem.tensile(state)) return without_tension(problem, done.solution, approach);
            done.status = LatticeOutcome::SOLVED, done.approach = approach;
            done.points = long(state.strips.size()) * setting->cells();
            done.load = resultants(state.values, problem.of(state.strips));
            done.problem = of;
            done.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            return done;
        } catch (const Unsolved& error) {
            auto failed = LatticeOutcome::failed(error.what(), approach);
            failed.stalled = dynamic_cast<const NotConverged*>(&error);
            return failed;
        }
    }

    // Solution from the strips of an earlier one, which may lack friction; none where that is too far away.
    std::optional<LatticeSolution> from_earlier(LatticeProblem& problem, const LatticeSolution& earlier,
                                                IterationCount& count) const {
        const auto& near = problem.lines.near;
        long S = long(earlier.state.strips.size()), before = -1;
        bool same = earlier.state.values.shape == std::array{S, setting->block()};
        if (!same && earlier.state.values.shape != std::array{S, long(MOMENTS)}) return {};
        Array<bool, 1> remain(S);
        for (long i = 0; i < S; ++i) {
            long k = earlier.state.strips[i];
            if (k <= before || k >= near.size()) return {};
            remain(i) = near(k), before = k;
        }
        if (!any(remain)) return {};
        LatticeNewton newton(problem, count, look);
        try {
            if (same && std::all_of(remain.begin(), remain.end(), [](bool one) { return one; }))
                return newton.from_earlier(earlier, WARM_ITERATIONS, FARTHEST_STEP);
            auto state = earlier.state.at(remain);
            if (!same) state.values = without_tractions(state.values);
            return newton.solve(state, WARM_ITERATIONS, FARTHEST_STEP);
        } catch (const NotConverged&) {
            return {};
        } catch (const OutsideSurface&) {
            return {};
        }
    }

    // Solution from a state of the same pose on wider strips; none where that does not converge. From none a solve
    // takes up to 100 times as long: it begins with all strips that overlap, of which few are loaded.
    std::optional<LatticeSolution> from_wider(LatticeProblem& problem, const LatticeState& wider,
                                              IterationCount& count) const {
        try {
            return LatticeNewton(problem, count, look).solve(wider, COLD_ITERATIONS);
        } catch (const NotConverged&) {
            return {};
        }
    }

    // Solution without an earlier result, from cells that are refined until Newton's method converges: strips with
    // little load need more of them. Throws Unsolved.
    LatticeSolution from_none(LatticeProblem& problem, IterationCount& count) const {
        if (check_size) check_size(long(problem.candidates.size()));
        for (std::size_t k = 0; k + 1 < setting->starts.size(); ++k) {
            try {
                return from_cells(problem, setting->starts[k], count);
            } catch (const NotRolling&) {
                throw;
            } catch (const Unsolved&) {
                continue;
            }
        }
        return from_cells(problem, setting->starts.back(), count);
    }

  private:
    // Values (S, block) with zero tractions before those (S, MOMENTS) of strips without friction.
    Array<double, 2> without_tractions(Rows values) const {
        Array<double, 2> all(values.size(), setting->block());
        for (long i = 0; i < values.size(); ++i)
            std::copy(values[i].begin(), values[i].end(), all[i].end() - values.shape[1]);
        return all;
    }
    // Largest pressure Pa of loaded strips with values (S, block).
    static double peak(Rows values) {
        double highest = 0.0;
        long last = values.shape[1] - 2;
        for (long i = 0; i < values.size(); ++i)
            highest = std::max(highest, highest_pressure(values[i].part(last - MODES, last)));
        return highest;
    }
    // Solution from complementarity on equal cells along each strip.
    LatticeSolution from_cells(LatticeProblem& problem, const StripBasis& cells, IterationCount& count) const {
        auto state = cold_start(problem, cells);
        auto apart = penetrating(problem, state, problem.candidates);
        if (apart.size()) state = cold_start(problem, cells, apart);
        return LatticeNewton(problem, count, look).solve(state, COLD_ITERATIONS);
    }

    // Outcome with more cells along the strips of a solution with tension, or on narrower strips: on a quarter of their
    // width, ten times as long a solve, only where tension that is linear in the width would vanish there. Failed where
    // tension remains.
    LatticeOutcome without_tension(const LatticeProblem& problem, const std::shared_ptr<LatticeSolution>& solution,
                                   double approach) const {
        long S = long(solution->state.strips.size());
        double tension = -problem.least_pressure(solution->state), halved = INFINITE;
        std::string tried;
        bool narrow = false;
        for (const auto& model : finer ? finer() : Models{}) {
            long narrower = model->level - level, unknowns = (S << narrower) * model->setting->block();
            if (S > strips && (narrower > 1 || unknowns > MOST_UNKNOWNS)) continue;
            if (narrower > 1 && halved - 0.5 * (tension - halved) > 0.0) continue;
            auto own = model->problem(problem.given());
            LatticeState divided;
            if (narrower) divided = divided_strips(solution->state, problem.lattice(), *own);
            auto done = model->solve(own, nullptr, narrower ? &divided : nullptr);
            if (narrower == 1) halved = done.tension;
            narrow = narrow || narrower;
            tried += tried.empty() ? ", also " : ", ";
            tried += narrower ? text("on 1/%d of the width", 1 << narrower)
                              : text("with %ld cells", model->setting->cells());
            if (!done.ok()) continue;
            done.warm = solution;
            return done;
        }
        bool grids = problem.tables().finite();
        auto help = !narrow ? "more strips" : grids ? "points = \"grid\"" : "model = \"standard\"";
        auto failed =
            LatticeOutcome::failed(problem.tension(solution->state) + tried + "; " + help + " may serve", approach);
        failed.tension = tension;
        return failed;
    }
};

}  // namespace wr
