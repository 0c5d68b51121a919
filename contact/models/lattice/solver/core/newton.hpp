// Newton's method on all unknowns of the contact on a lattice, and strips that enter and leave.
#pragma once
#include <functional>

#include "contact/models/lattice/solver/core/advance.hpp"
#include "contact/models/lattice/solver/core/entry.hpp"

namespace wr {

constexpr int EXCHANGES = 3;           // times that a strip may leave before it must stay out, for the time being
constexpr int RELEASES = 2;            // times that such strips may enter again
constexpr double UNINTERRUPTED = 1e9;  // multiplications of factorisations without a look at Ctrl-C: 0.1 s

// Converged state, and factors of a nearby Jacobian, for the start of the solution at the next pose.
struct LatticeSolution {
    LatticeState state;
    Factors factors;
};

struct IterationCount {
    long newton = 0, linear = 0;  // linearisations, and evaluations of the residual
    double residual = 0.0;        // last step
};

// Iteration from a state to the solution of a problem.
class LatticeNewton {
  public:
    // count: updated. look: called now and then, may throw.
    LatticeNewton(LatticeProblem& problem, IterationCount& count, const std::function<void()>& look)
        : problem(problem), count(count), look(look), probes(probes_of(problem)) {}

    // Solution from a state. iterations: linearisations at most. farthest: longest first step, relative. Throws
    // Unsolved, also if the first step exceeds farthest.
    LatticeSolution solve(const LatticeState& start, long iterations, double farthest = INFINITE) {
        return iterated(start, {}, false, iterations, farthest);
    }
    // Solution from that of another pose on the same strips.
    LatticeSolution from_earlier(const LatticeSolution& earlier, long iterations, double farthest) {
        return iterated(earlier.state, {false, earlier.factors, {}}, true, iterations, farthest);
    }

  private:
    LatticeSolution iterated(LatticeState state, KeptFactors kept, bool earlier, long iterations, double farthest) {
        bool searched = false;  // whether strips have entered since they last changed
        for (long done = 0;; earlier = false) {
            auto ahead = advanced(state, kept, earlier, searched, farthest, iterations - done);
            const auto& at = ahead.progress;
            check(at);
            if (at.iterations) farthest = INFINITE;
            done += at.iterations;
            state.values = at.values, kept = at.kept;
            if (at.event == LEAVES) {
                state = without(state, at.leaves, at.iterations > 0), kept = {}, searched = false;
            } else if (at.event != PAUSED) {
                auto more = entering(state, ahead);
                if (more.strips.empty() && at.event == CONVERGED) {
                    more = released(state);
                    if (more.strips.empty()) {
                        auto moves = placed ? Array<bool, 1>(0) : misplaced(problem, state);
                        if (any(moves)) {
                            state = replaced(state, moves), kept = {}, searched = false, done = 0;
                            continue;
                        }
                        count.residual = at.size;
                        return {state, kept.factors};
                    }
                }
                searched = more.strips.empty();
                if (!searched) state = state.joined(more), kept = {};
            }
        }
    }

    // Some iterations, as many as take no long time without a look at Ctrl-C.
    Advance advanced(const LatticeState& state, const KeptFactors& kept, bool earlier, bool searched, double farthest,
                     long iterations) {
        if (!iterations)
            throw NotConverged("Newton's method did not converge (" + std::to_string(state.strips.size()) + " strips)");
        double size = double(state.values.count()), cost = size * size * size;
        if (look && cost * double(iterations) > UNINTERRUPTED) look();
        long some = std::min(iterations, std::max(1L, long(UNINTERRUPTED / cost)));
        Limits limits{problem.all().tolerance, farthest, some};
        auto barred = strips_barred();
        return advance(state.values, problem.of(state.strips), kept, earlier, searched, limits, probes, problem.lines,
                       indices_of(barred));
    }

    // Count iterations. Throws Unsolved where they failed.
    void check(const Progress& at) {
        count.newton += at.linearisations, count.linear += at.evaluations;
        const char* failure = nullptr;
        if (at.event == OUTSIDE) throw OutsideSurface(PATCH_TOO_LONG);
        if (at.event == SINGULAR) failure = "the Jacobian of the contact is singular";
        if (at.event == TOO_LONG) failure = "the first step is too long";
        if (at.event == NOT_FINITE) failure = "the step of the contact is not finite";
        if (failure) throw NotConverged(text("%s (last step %.1e)", failure, at.size));
    }

    // The state without strips (S,) that leave, which may count.
    LatticeState without(const LatticeState& state, View<const bool, 1> leaves, bool counts) {
        auto rest = state.at(leaves, false);
        if (rest.strips.empty()) throw NotConverged("no strip remains loaded");
        for (long i = 0; counts && i < leaves.size(); ++i)
            if (leaves(i)) ++left[state.strips[i]];
        return rest;
    }
    // Strips that have left too often.
    Strips strips_barred() const {
        Strips barred;
        for (auto [strip, times] : left)
            if (times >= EXCHANGES) barred.push_back(strip);
        return barred;
    }
    LatticeState entering(const LatticeState& state, const Advance& at) {
        auto found = at.complete ? overlaps(problem, at.rest) : penetrating(problem, state, strips_barred());
        return entered(problem, state, found);
    }
    // The state without strips (S,) that may have several places. They enter again when the others are in equilibrium,
    // where most penetration remains, whatever the start.
    LatticeState replaced(const LatticeState& state, View<const bool, 1> moves) {
        for (long i = 0; i < moves.size(); ++i)
            if (moves(i)) left[state.strips[i]] = EXCHANGES;
        placed = true, least = LEAST_EXCESS, --releases;
        return state.at(moves, false);
    }
    // Release strips barred from entry after leaving too often. Throws NotConverged when that has happened before: a
    // solution must not depend on what was tried.
    LatticeState released(const LatticeState& state) {
        if (strips_barred().empty()) return {};
        auto more = entered(problem, state, penetrating(problem, state, {}, std::exchange(least, UNCERTAIN)));
        if (more.strips.empty()) return {};
        left.clear();
        if (++releases > RELEASES) throw NotConverged("strips of the contact come and go");
        return more;
    }

    LatticeProblem& problem;
    IterationCount& count;
    const std::function<void()>& look;
    Probes probes;
    std::map<long, int> left;
    int releases = 0;
    bool placed = false;       // whether strips have been sought a place
    Excess least = UNCERTAIN;  // of strips that are released
};

}  // namespace wr
