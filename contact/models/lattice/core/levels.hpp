// Levels of a lattice: strips of half, a quarter, ... of their width for contacts that are narrow.
//
// The level follows the width of the undeformed penetration, the number n of ordinary strips across it, which is a
// continuous function of the pose. Strips count less where patches are longer than wide: less of the penetration is
// loaded there. On level L there are 2^L n. With x the number on a level, from LEAST to 2 LEAST, the force is
// S F_L + (1 - S) F_(L+1), S rising smoothly from 0 at LEAST to 1 at ENOUGH: one level alone from there on, and the
// same force from below and above where the level changes. LEAST is FEWEST strips or more: on fewer loaded ones forces
// err by per cents, and peak pressures by tens of them.
#pragma once
#include "contact/models/lattice/core/bulk_displacement.hpp"

namespace wr {

// of the strips asked for, across the penetration: an ellipse of half-spaces has 0.7 as many loaded ones
constexpr double LEAST_SHARE = 0.5;
constexpr double ENOUGH = 4.0 / 3.0;  // times LEAST
constexpr double FEWEST = 2.5;        // strips, of LEAST
constexpr double SURELY = 1.15;       // times that by the strips' means, which err by less: no exact width is needed
constexpr int FINEST = 5;             // level, with 14 strips for patches of 0.1 N on a tread; less has fewer strips

// LEAST across the penetration for a number of strips over a usual patch.
inline double least_strips(long strips) { return std::max(LEAST_SHARE * double(strips), FEWEST); }

// Levels that make up the force at a pose.
struct LevelShares {
    std::vector<int> levels{0};  // one or two successive ones
    double share = 1.0;          // of the first
    // Derivative (12,) of the share by pose and motion; none of a single level. Throws Unsolved.
    std::function<Array<double, 1>()> change;
};

// Levels for a pose. problem: equations on ordinary strips. strips: their number over a usual patch. bulk: displacement
// of finite bodies in their solution; none of half-spaces, and without a load.
inline LevelShares level_shares(const std::shared_ptr<LatticeProblem>& problem, long strips,
                                const std::shared_ptr<BulkDisplacement>& bulk) {
    const auto& tables = problem->tables();
    const auto& [middle, width] = std::tie(tables.lattice.middle, tables.lattice.width);
    double least = least_strips(strips);
    double across = bulk ? bulk->strips_across() : strips_across(problem->lines.depth, tables.slenderness);
    if (across > SURELY * ENOUGH * least) return {};
    auto depth = Array<double, 1>::copy(problem->lines.depth);
    auto lift = bulk ? bulk->lift() : Array<double, 2>(2, 1);
    if (bulk)
        for (long k = 0; k < depth.size(); ++k) depth(k) -= interpolated(middle(k), lift[0], lift[1]);
    Array<double, 1> counted(width.size());
    for (long k = 0; k < width.size(); ++k) counted(k) = width(k) * tables.slenderness(k);
    LiftedPenetration lifted{problem->all().surface, problem->pose(), lift[0], lift[1]};
    auto pieces = maxima(lifted, middle, width, depth);
    across = penetrated_width(lifted, middle, counted, pieces, false).first;
    if (!(across > 0.0)) return {};
    double part = across / least;
    int level = int(std::clamp(std::ceil(-std::log2(part)), 0.0, double(FINEST)));
    double at = (std::exp2(level) * part - 1.0) / (ENOUGH - 1.0);
    if (at >= 1.0) return {{level}, 1.0, {}};
    if (at <= 0.0 || level == FINEST) return {{std::min(level + 1, FINEST)}, 1.0, {}};
    auto change = [problem, bulk, lift, counted, pieces, level, least, at] {
        double by_number = std::exp2(level) / least / (ENOUGH - 1.0) * 30.0 * at * at * (1.0 - at) * (1.0 - at);
        LiftedPenetration lifted{problem->all().surface, problem->pose(), lift[0], lift[1]};
        auto slopes = penetrated_width(lifted, problem->lattice().middle, counted, pieces, true).second;
        Array<double, 1> total(CHANGES);
        if (bulk) total = bulk->changes(slopes.part(POSE, slopes.size()));
        for (int k = 0; k < POSE; ++k) total(k) += slopes(k);
        for (double& one : total) one *= by_number;
        return total;
    };
    return {{level, level + 1}, at * at * at * (10.0 - 15.0 * at + 6.0 * at * at), change};
}

}  // namespace wr
