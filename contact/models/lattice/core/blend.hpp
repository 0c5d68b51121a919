// Patches between two levels of a lattice, in proportion to their shares: those that overlap are one, with means of
// both; one without a counterpart has its share of area and force.
#pragma once
#include <cmath>
#include <vector>

#include "contact/results/core/patch_sums.hpp"

namespace wr {

// Patches of both levels as rows of `store_patch`, and the row number of each patch of either level.
struct BlendedPatches {
    Array<double, 2> rows;
    std::array<std::vector<long>, 2> numbers;

    // levels: rows of both. share: of the first.
    BlendedPatches(const std::array<Rows, 2>& levels, double share) {
        struct Pair {
            long first, second;  // -1 without a counterpart
        };
        std::vector<Pair> pairs;
        std::vector<bool> taken(levels[1].size(), false);
        numbers = {std::vector<long>(levels[0].size()), std::vector<long>(levels[1].size())};
        for (long i = 0; i < levels[0].size(); ++i) {
            long partner = -1;
            for (long j = 0; j < levels[1].size() && partner < 0; ++j)
                if (!taken[j] && overlap(levels[0][i], levels[1][j])) partner = j;
            if (partner >= 0) taken[partner] = true;
            pairs.push_back({i, partner});
        }
        for (long j = 0; j < levels[1].size(); ++j)
            if (!taken[j]) pairs.push_back({-1, j});
        rows = Array<double, 2>(long(pairs.size()), PATCH_NUMBERS);
        for (long p = 0; p < rows.size(); ++p) {
            double total = 0.0;
            const long of[] = {pairs[p].first, pairs[p].second};
            const double shares[] = {share, 1.0 - share};
            for (int k = 0; k < 2; ++k)
                if (of[k] >= 0) total += shares[k], numbers[k][of[k]] = p;
            for (int k = 0; k < 2; ++k)
                for (int c = 0; of[k] >= 0 && c < PATCH_NUMBERS; ++c)
                    rows(p, c) += (is_sum(c) ? shares[k] : shares[k] / total) * levels[k](of[k], c);
            rows(p, STRIPS) = std::nearbyint(rows(p, STRIPS));
        }
    }

  private:
    static constexpr int STRIPS = 25, BAND = 15;  // columns: number of strips, lateral extent on the wheel

    // Areas, forces and power.
    static bool is_sum(int column) {
        return column == 0 || (2 <= column && column <= 7) || column == 20 || column == 24;
    }
    static bool overlap(Numbers one, Numbers other) {
        return one(BAND) < other(BAND + 1) && other(BAND) < one(BAND + 1);
    }
};

}  // namespace wr
