// Displacement of strips by loads on others that finite bodies have beyond half-spaces, see
// `wheelrail.contact.models.lattice.influence.bulk`.
#pragma once
#include <tuple>

#include "support/core/arrays.hpp"

namespace wr {

constexpr long TILE = 16;  // lines: granularity of the parts of the surface whose correction is assembled

// Compliance of a body between its lines.
struct BulkCompliance {
    Numbers arc;                 // (ns,) m, of the lines
    Blocks values;               // (ns, ns, 2) m/N of pairs of lines, see `bulk_compliance`
    View<const bool, 2> filled;  // (T, T) pairs of tiles of lines between which there are values
    bool moves = false;          // whether strips move on the body
    Numbers bounds;              // (2,) m, ends of its lines

    auto fields() { return std::tie(arc, values, filled, moves, bounds); }
    bool fits() const {
        long n = arc.size(), tiles = (n + TILE - 1) / TILE;
        return n > 1 && values.shape == std::array<long, 3>{n, n, 2} &&
               filled.shape == std::array<long, 2>{tiles, tiles} && bounds.size() == 2;
    }
};

}  // namespace wr
