// Derivatives of the resultants by the unknowns.
#pragma once
#include "contact/models/lattice/system/core/strips.hpp"

namespace wr {

// Force N and moment N m about the origin (6,) on the upper body, and their derivative (6, S block) by the unknowns.
struct ResultantSlopes {
    Array<double, 1> total;
    Array<double, 2> slopes;

    auto fields() { return std::tie(total, slopes); }

    ResultantSlopes() = default;
    ResultantSlopes(Rows values, const EquationData& data) : total(6), slopes(6, values.count()) {
        // of a cell, by its tractions along and across and its pressure, and by the ends of the strip
        using D = Dual<5>;
        const auto& [places, basis] = std::tie(data.places, data.basis);
        long M = basis.M(), block = data.block(), mode = data.mode();
        auto pose = data.motion.pose();
        auto pressure = cell_pressures(values, basis, data.rolls());
        Walk walk(data.surface);
        for (long i = 0; i < values.size(); ++i) {
            long first = i * block;
            D low = variable<D>(values(i, block - 2), 3), high = variable<D>(values(i, block - 1), 4);
            for (long r = 0; r < M; ++r) {
                double scale = places.stretch(i) * (basis.marks(r + 1) - basis.marks(r)) * places.width(i);
                D area = scale * (high - low), p = variable<D>(-pressure(i, r), 2), x, y;
                if (mode) x = variable<D>(values(i, r), 0), y = variable<D>(values(i, M + r), 1);
                auto at = place_at(walk, pose, places.middle(i), low + (high - low) * middle_of_cell(basis, r));
                Vec<D> force = area * (x * at.forward + y * at.lateral() + p * at.normal);
                Vec<D> moment = cross(at.point, force);
                const D* all[6] = {&force.x, &force.y, &force.z, &moment.x, &moment.y, &moment.z};
                for (int c = 0; c < 6; ++c) {
                    const D& of = *all[c];
                    auto row = slopes[c];
                    total(c) += of.v;
                    if (mode) row(first + r) = of.d[0], row(first + M + r) = of.d[1];
                    for (int m = 0; m < MODES; ++m) row(first + mode + m) -= basis.mean(r, m) * of.d[2];
                    row(first + block - 2) += of.d[3], row(first + block - 1) += of.d[4];
                }
            }
        }
    }
};

}  // namespace wr
