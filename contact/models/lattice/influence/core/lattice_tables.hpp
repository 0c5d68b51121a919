// Tables of half-spaces and bodies under the strips of a lattice, computed when a pair is first needed.
#pragma once
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "contact/models/lattice/influence/core/finite_body.hpp"
#include "contact/models/lattice/influence/core/pair_tables.hpp"
#include "support/core/owned.hpp"

namespace wr {

constexpr double GROWTH = 1.5;            // of the storage
constexpr std::size_t STORED_MEANS = 16;  // sets of strips whose deviations of each body are kept

using Strips = std::vector<long>;

inline Indices indices_of(const Strips& strips) { return {strips.data(), {long(strips.size())}}; }

// Means of a deviation over strips, from weights (C, n) of the lines from the first on, of the first cells.
inline Owned<PoseMeans> pose_means(const Array<long, 1>& place, const BetweenAllLines& lines, long first,
                                   const Array<double, 2>& share, long cells) {
    long pairs = share.size() * (share.size() + 1) / 2;
    auto values = Array<double, 4>::unset({pairs, cells, DEGREE + 1, COMPONENTS});
    Array<long, 1> known(pairs);
    return {{place, {lines, first, share, values, known}}, {place.owner, share.owner, values.owner, known.owner}};
}

// Solves in several threads may share the tables: what a solve has got does not change when others add pairs.
class LatticeTables {
  public:
    // strips: bounds, inclination and stretch. slenderness (K,): see `wheelrail.contact.geometry.strip_lattice`.
    // bodies: upper and lower one; none for half-spaces. moves: whether strips move on the lower one.
    LatticeTables(const LatticeStrips& strips, Numbers slenderness, const HalfSpaces& spaces, const CellRule& rule,
                  const std::array<std::shared_ptr<FiniteBody>, 2>& bodies, bool moves)
        : strips(owned(strips)),
          spaces(owned(spaces)),
          bodies(bodies),
          moves(moves && bodies[1]),
          slenderness(Array<double, 1>::copy(slenderness)),
          rule(owned(rule)),
          middle(strips.size()),
          width(strips.size()),
          carried(strips.size()),
          bounds(2),
          values(Array<double, 3>::unset({4096, 6, 8})),
          pair(Array<int, 2>::sparse({strips.size(), strips.size()})),
          first(1),
          cells(1),
          inverse(1),
          share(2),
          no_place(strips.size()) {
        const auto& sides = strips.sides;
        for (long k = 0; k < strips.size(); ++k) {
            middle(k) = 0.5 * (sides(k + 1) + sides(k)), width(k) = sides(k + 1) - sides(k);
            carried(k) = true;
        }
        double compliance = 0.0, total = 0.0;
        for (int b = 0; b < 2; ++b) {
            compliance += (1.0 - spaces.nu(b) * spaces.nu(b)) * spaces.scale(b);
            share(b) = (1.0 + spaces.nu(b)) * spaces.scale(b);
            total += share(b);
        }
        for (double& part : share) part /= total;
        modulus = 1.0 / compliance;
        constexpr double infinity = std::numeric_limits<double>::infinity();
        bounds(0) = -infinity, bounds(1) = infinity;
        for (int b = 0; b < 2; ++b) {
            if (!bodies[b]) continue;
            double low = bodies[b]->low(), high = bodies[b]->high();
            if (b == 1 && this->moves) {
                bounds(0) = low, bounds(1) = high;
                continue;
            }
            for (long k = 0; k < strips.size(); ++k) {
                double half = 0.5 * width(k);
                carried(k) = carried(k) && middle(k) - half >= low && middle(k) + half <= high;
            }
        }
        lattice = {middle, width, this->strips.stretch, carried, bounds};
    }

    const Owned<LatticeStrips> strips;
    const Owned<HalfSpaces> spaces;
    const std::array<std::shared_ptr<FiniteBody>, 2> bodies;
    const bool moves;
    const Array<double, 1> slenderness;
    Lattice lattice;
    double modulus = 0.0;  // Pa, contact modulus of both bodies

    bool finite() const { return bodies[0] || bodies[1]; }
    // Arc length (ns,) m of the lower body's lines; none where the compliance does not depend on places there.
    Numbers lines() const { return moves ? bodies[1]->bulk.arc : Numbers{}; }
    std::vector<BulkCompliance> bulk() const {
        std::vector<BulkCompliance> all;
        for (const auto& body : bodies)
            if (body) all.push_back(body->bulk);
        return all;
    }

    // Tables of all pairs of some strips (C,) at a pose; later ones are not in them.
    Owned<PairTables> of(const Strips& some, const Owned<PoseMeans>& at) {
        complete(some);
        std::lock_guard lock(growing);
        return {{values, pair, first, cells, inverse, at.place, at.smooth},
                owners_of(at.owners, values, pair, first, cells, inverse)};
    }
    // Add the tables that pairs of some strips (C,) lack.
    void complete(const Strips& some) {
        std::lock_guard lock(growing);
        if (completed.count(some)) return;
        add(some);
        completed.insert(some);
    }
    // Whether the tables contain all added pairs.
    bool holds(const PairTables& tables) {
        std::lock_guard lock(growing);
        return tables.first.data == first.data;
    }
    // Data of the tables of strips near (K,) at a pose. feet: (K,) m, arc length of their middles on the lower body.
    // reach: m, longest distance along x. Throws OutsideSurface.
    Owned<PoseMeans> at(View<const bool, 1> near, Numbers feet, double reach) {
        if (!moves) return none();
        auto& lower = *bodies[1];
        auto on = strips_on_lines(lattice, near, feet);
        auto range = lower.between(on.low, on.high);
        auto shares = strip_shares(lower.arc(range), on.middle, on.width);
        return pose_means(on.place, lower.lines, range.first, shares, cells_up_to(reach));
    }
    // Tables of each body of some loaded strips (S,); at, reach: as for `at`.
    Owned<BodyTables> body_tables(const Strips& some, const Owned<PoseMeans>& at, double reach) {
        auto upper = of_means(deviation_means(0, some, at, reach)),
             lower = of_means(deviation_means(1, some, at, reach));
        auto owners = upper.owners;
        owners.insert(owners.end(), lower.owners.begin(), lower.owners.end());
        return {{upper, lower, share}, owners_of(owners, share)};
    }

  private:
    Owned<PoseMeans> none() const { return {{no_place, {}}, {no_place.owner}}; }

    // Deviation of the upper (0) or lower (1) body; stored where it does not depend on the pose.
    Owned<PoseMeans> deviation_means(int which, const Strips& some, const Owned<PoseMeans>& at, double reach) {
        if (!bodies[which]) return none();
        if (which == 1 && moves) return at;
        std::lock_guard lock(growing);
        auto& body = *bodies[which];
        long count = cells_up_to(reach);
        auto& known = means[which];
        auto found = known.find(some);
        if (found != known.end() && found->second.smooth.values.shape[1] >= count) return found->second;
        if (known.size() >= STORED_MEANS) known.clear();
        auto own = taken(middle, some), wide = taken(width, some);
        CoveredPart part(own, wide);
        auto range = body.between(part.low, part.high);
        Array<long, 1> place(middle.size());
        for (std::size_t i = 0; i < some.size(); ++i) place(some[i]) = long(i);
        auto made = pose_means(place, body.lines, range.first, strip_shares(body.arc(range), own, wide), count);
        complete_means(made.smooth);
        return known[some] = made;
    }
    // Tables that contain nothing but the coefficients of a deviation.
    Owned<PairTables> of_means(const Owned<PoseMeans>& at) const {
        long K = middle.size(), count = count_of(START);
        Array<double, 3> zeros(count, DEGREE + 1, COMPONENTS);
        auto alike = Array<int, 2>::sparse({K, K});
        Array<long, 1> begin(1), number(1);
        Array<double, 1> over(1);
        number(0) = count, over(0) = 1.0 / START;
        return {{zeros, alike, begin, number, over, at.place, at.smooth},
                owners_of(at.owners, zeros, alike, begin, number, over)};
    }

    void add(const Strips& some) {
        std::vector<std::pair<long, long>> missing;
        for (std::size_t i = 0; i < some.size(); ++i)
            for (std::size_t j = i; j < some.size(); ++j)
                if (pair(some[i], some[j]) == 0) missing.emplace_back(some[i], some[j]);
        if (missing.empty()) return;
        long P = first.size(), added = long(missing.size()), end = used;
        Array<long, 1> more_first(P + added), more_cells(P + added);
        Array<double, 1> more_inverse(P + added);
        std::copy(first.begin(), first.end(), more_first.begin());
        std::copy(cells.begin(), cells.end(), more_cells.begin());
        std::copy(inverse.begin(), inverse.end(), more_inverse.begin());
        for (long p = 0; p < added; ++p) {
            double start = start_of(strips, missing[p].first, missing[p].second);
            long count = count_of(start);
            more_first(P + p) = end, more_cells(P + p) = count, more_inverse(P + p) = 1.0 / start;
            end += count;
        }
        if (end > values.size()) {
            auto larger = Array<double, 3>::unset({long(GROWTH * double(end)), DEGREE + 1, COMPONENTS});
            auto kept = values.part(0, used);
            std::copy(kept.begin(), kept.end(), larger.begin());
            values = larger;
        }
        Deviations both{deviation(0, some), deviation(1, some)};
        for (long p = 0; p < added; ++p) {
            auto [i, j] = missing[p];
            pair_coefficients(strips, i, j, spaces, {&both[0], &both[1]}, rule,
                              values.part(more_first(P + p), more_first(P + p) + more_cells(P + p)));
        }
        for (long p = 0; p < added; ++p) pair(missing[p].first, missing[p].second) = int(P + p);
        first = more_first, cells = more_cells, inverse = more_inverse, used = end;
    }
    using Deviations = std::array<Owned<Deviation>, 2>;

    // Deviation of a body that does not depend on the pose, for some strips (C,).
    Owned<Deviation> deviation(int which, const Strips& some) const {
        if (!bodies[which] || (which == 1 && moves)) return {};
        auto& body = *bodies[which];
        auto own = taken(middle, some), wide = taken(width, some);
        CoveredPart part(own, wide);
        auto range = body.between(part.low, part.high);
        auto shares = strip_shares(body.arc(range), own, wide);
        auto all = Array<double, 2>::sparse({middle.size(), range.size()});
        for (std::size_t i = 0; i < some.size(); ++i) {
            auto from = shares[long(i)];
            std::copy(from.begin(), from.end(), all[some[i]].begin());
        }
        return {{body.lines, range.first, all}, {all.owner}};
    }

    Owned<CellRule> rule;
    Array<double, 1> middle, width;
    Array<bool, 1> carried;
    Array<double, 1> bounds;
    std::mutex growing;
    // Parts that were given out do not change: pairs are added behind, or in new arrays.
    Array<double, 3> values;
    Array<int, 2> pair;
    Array<long, 1> first, cells;
    Array<double, 1> inverse;
    long used = 0;
    std::set<Strips> completed;  // strips all of whose pairs have tables
    std::array<std::map<Strips, Owned<PoseMeans>>, 2> means;
    Array<double, 1> share;
    Array<long, 1> no_place;
};

}  // namespace wr
