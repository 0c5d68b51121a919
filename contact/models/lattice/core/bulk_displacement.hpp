// Displacement of finite bodies beyond that of half-spaces: the part of the penetration that is no contact.
//
// Wheel and rail bend and twist as wholes. On a flange this is most of the penetration, 225 of 260 um at 14 kN, and
// wide strips would seem to be many across it.
#pragma once
#include "contact/models/lattice/core/level_model.hpp"
#include "contact/models/lattice/system/core/penetrated_width.hpp"

namespace wr {

// Displacement of both bodies in a solution of their equations.
class BulkDisplacement {
  public:
    BulkDisplacement(std::shared_ptr<LatticeProblem> of, std::shared_ptr<const LatticeSolution> found)
        : problem(std::move(of)),
          solution(std::move(found)),
          rows(numbers_of(problem->lines.covered)),
          loaded(solution->state.strips),
          loads(strip_loads(solution->state.values, problem->of(loaded).places, problem->all().basis,
                            problem->all().rolls())) {}

    // Number of strips across the penetration less this displacement.
    double strips_across() {
        auto& tables = problem->tables();
        for (int attempt = 0;; ++attempt) {
            auto [known, across] = strips_beside_bulk(solution->state.values, problem->of(loaded), problem->lines,
                                                      tables.lattice, tables.slenderness, tables.bulk());
            if (known || attempt) return across;
            at(problem->candidates);  // which computes what is missing
        }
    }

    // Middles (R,) m of the strips that lie on the lines of both bodies, and by how much the penetration is less there,
    // m: (2, R); one zero without any.
    const Array<double, 2>& lift() {
        if (lifted.size()) return lifted;
        long R = long(rows.size());
        lifted = Array<double, 2>(2, std::max(R, 1L));
        if (!R) return lifted;
        auto less = at(rows);
        for (long k = 0; k < R; ++k) lifted(0, k) = problem->lattice().middle(rows[k]), lifted(1, k) = less(k);
        return lifted;
    }

    // Displacement (R,) m of the middles of some strips; beyond the lines of a body, of the last one.
    Array<double, 1> at(const Strips& strips) {
        Array<double, 1> total(long(strips.size()));
        for (const auto& body : problem->tables().bodies) {
            if (!body) continue;
            OnLines on(*this, *body, strips);
            auto more = bulk_displacements(body->bulk.arc, body->bulk.values, on.places, on.middle, on.width, loads);
            for (long k = 0; k < total.size(); ++k) total(k) += more(k);
        }
        return total;
    }

    // Derivative (12,) by pose and motion of the sum of the lift times weights (R,). Throws Unsolved.
    Array<double, 1> changes(Numbers weight) {
        Array<double, 1> total(CHANGES);
        long R = long(rows.size()), S = long(loaded.size());
        if (!R) return total;
        Array<double, 2> by_loads(S, 2);
        Array<double, 1> by_place(problem->lattice().middle.size());
        for (const auto& body : problem->tables().bodies)
            if (body) add_changes(*body, weight, by_loads, by_place);
        auto sums = derivatives_of(*problem, *solution, by_unknowns(by_loads));
        std::copy(sums.changes.begin(), sums.changes.end(), total.begin());
        Strips moved;
        for (long k = 0; k < by_place.size(); ++k)
            if (by_place(k) != 0.0) moved.push_back(k);
        if (moved.empty()) return total;
        const auto& lines = problem->lines;
        auto feet = std::get<1>(touching_changes(problem->all().surface, problem->given(),
                                                 taken(problem->lattice().middle, moved), taken(lines.x, moved),
                                                 taken(lines.foot, moved)));
        for (long i = 0; i < feet.size(); ++i)
            for (int k = 0; k < POSE; ++k) total(k) += by_place(moved[i]) * feet(i, k);
        return total;
    }

  private:
    // Some strips and the loaded ones on a body: arc lengths m of their middles, at most on its last lines, widths m of
    // the loaded ones, and lines around all.
    struct OnLines {
        Array<double, 1> places, middle, width;
        LineRange range;

        OnLines(const BulkDisplacement& of, FiniteBody& body, const Strips& strips) {
            const auto& lattice = of.problem->lattice();
            double low = std::numeric_limits<double>::infinity(), high = -low;
            auto put = [&](const Strips& some, Array<double, 1>& at) {
                auto wide = taken(lattice.width, some);
                at = bulk_places(body.bulk, taken(lattice.middle, some), wide, taken(of.problem->lines.foot, some));
                CoveredPart part(at, wide);
                low = std::min(low, part.low), high = std::max(high, part.high);
            };
            put(strips, places), put(of.loaded, middle);
            width = taken(lattice.width, of.loaded);
            range = body.between(std::max(low, body.low()), std::min(high, body.high()));
        }
    };

    // Add the derivatives by the loads (S, 2) and by the places (K,) of strips on a body.
    void add_changes(FiniteBody& body, Numbers weight, View<double, 2> by_loads, View<double, 1> by_place) {
        OnLines on(*this, body, rows);
        auto arc = body.arc(on.range);
        long first = on.range.first, n = on.range.size(), S = by_loads.size();
        auto at = hats(arc, on.places);
        Array<double, 1> spread_weight(n);
        for (long r = 0; r < at.size(); ++r)
            for (long k = 0; k < n; ++k) spread_weight(k) += weight(r) * at(r, k);
        Array<double, 2> spread(n, 2);
        for (long k = 0; k < n; ++k)
            for (long m = 0; m < n; ++m)
                for (int c = 0; c < 2; ++c)
                    spread(m, c) += spread_weight(k) * body.bulk.values(first + k, first + m, c);
        auto shares = strip_shares(arc, on.middle, on.width);
        for (long i = 0; i < S; ++i)
            for (long m = 0; m < n; ++m)
                for (int c = 0; c < 2; ++c) by_loads(i, c) += shares(i, m) * spread(m, c);
        if (!body.bulk.moves) return;
        auto displaced = bulk_displacements(body.bulk.arc, body.bulk.values, arc, on.middle, on.width, loads);
        for (std::size_t r = 0; r < rows.size(); ++r) {
            long right = between_lines(arc, on.places(long(r))).right;
            double slope = (displaced(right) - displaced(right - 1)) / (arc(right) - arc(right - 1));
            by_place(rows[r]) += weight(long(r)) * slope;
        }
        auto slopes = share_slopes(arc, on.middle, on.width);
        for (long i = 0; i < S; ++i)
            for (int c = 0; c < 2; ++c) {
                double total = 0.0;
                for (long m = 0; m < n; ++m) total += slopes(i, m) * spread(m, c);
                by_place(loaded[i]) += total * loads(i, c);
            }
    }

    // Derivative (1, n) by the unknowns of the sum of the loads times weights (S, 2): see `strip_loads`.
    Array<double, 2> by_unknowns(Rows by_loads) const {
        const auto& values = solution->state.values;
        const auto& basis = problem->all().basis;
        long S = values.size(), block = values.shape[1], M = problem->all().rolls() ? basis.M() : 0;
        Array<double, 2> total(1, S * block);
        for (long i = 0; i < S; ++i) {
            auto to = total[0].part(i * block, (i + 1) * block);
            double area = problem->lattice().width(loaded[i]) * problem->lattice().stretch(loaded[i]);
            double length = values(i, block - 1) - values(i, block - 2), quarter = 0.25 * std::numbers::pi * area;
            double by_length = quarter * by_loads(i, 1) * values(i, 2 * M);
            for (long r = 0; r < M; ++r) {
                double share = area * by_loads(i, 0) * (basis.marks(r + 1) - basis.marks(r));
                to(M + r) = share * length;
                by_length += share * values(i, M + r);
            }
            to(2 * M) = quarter * by_loads(i, 1) * length;
            to(block - 1) = by_length, to(block - 2) = -by_length;
        }
        return total;
    }

    std::shared_ptr<LatticeProblem> problem;
    std::shared_ptr<const LatticeSolution> solution;
    Strips rows, loaded;
    Array<double, 2> loads;  // (S, 2) N, of the strips
    Array<double, 2> lifted;
};

}  // namespace wr
