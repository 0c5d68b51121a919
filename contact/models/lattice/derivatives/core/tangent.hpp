// Derivatives of sums of the unknowns by pose and motion, from the Jacobian of the converged equations.
//
// With R(u, g) = 0 the equations and g the twelve changes, the unknowns change by u' = -J^-1 dR/dg (implicit function
// theorem); the multipliers of the sums are solved first.
#pragma once
#include "contact/models/lattice/derivatives/core/residual.hpp"
#include "contact/models/lattice/derivatives/core/resultants.hpp"
#include "contact/models/lattice/solver/core/factors.hpp"
#include "contact/models/lattice/system/core/equations.hpp"

namespace wr {

// Where all strips touch, the lattice, and lines (ns,) m of the lower body, see `foot_derivatives`.
struct TangentPlaces {
    ContactLines lines;
    Lattice lattice;
    Numbers arc;

    auto fields() { return std::tie(lines, lattice, arc); }
    bool fits() const { return lines.depth.size() == lattice.middle.size(); }
};

// Whether indices of both are the same.
inline bool fit(const EquationData& data, const TangentPlaces& places) {
    const auto& smooth = data.tables.smooth;
    return places.lines.depth.size() == data.tables.place.size() &&
           (!places.arc.size() || (!smooth.none() && smooth.first + smooth.share.shape[1] <= places.arc.size()));
}

// Derivatives (k, CHANGES) of sums, and the factors of a regular Jacobian, if all distances lie in the tables.
struct TangentSums {
    bool inside = false, regular = false;
    Array<double, 2> changes;
    Factors factors;

    auto fields() { return std::tie(inside, regular, changes, factors); }

    TangentSums() = default;
    // Of the unknowns (S, block) with weights (k, S block).
    TangentSums(Rows values, const EquationData& data, const TangentPlaces& places, Rows weights)
        : changes(weights.size(), CHANGES) {
        auto at = linearised(values, data);
        inside = at.evaluation.inside;
        std::tie(regular, factors) = factorised(at);
        if (!inside || !regular) return;
        auto multipliers = solve_transposed(factors, at.jacobian, weights);
        auto by = residual_changes(values, data, places.lines, places.lattice, places.arc, at.slopes);
        for (long i = 0; i < weights.size(); ++i)
            for (long n = 0; n < values.count(); ++n)
                for (int k = 0; k < CHANGES; ++k) changes(i, k) -= multipliers(i, n) * by.data[CHANGES * n + k];
    }
};

}  // namespace wr
