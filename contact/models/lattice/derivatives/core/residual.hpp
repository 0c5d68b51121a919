// Derivative of the residual by pose and motion at fixed unknowns.
//
// The twelve changes of pose and motion are those of `wheelrail.contact.kinematics.sensitivity`. Places, velocities and
// penetrations vary with dual numbers of them.
#pragma once
#include "contact/models/lattice/derivatives/core/feet.hpp"
#include "contact/models/lattice/system/core/contact_lines.hpp"
#include "contact/models/lattice/system/core/state.hpp"

namespace wr {

using ByPose = Dual<POSE>;
using ByChanges = Dual<CHANGES>;

// Mean penetration m over the width of a strip at distance x m along the strip.
inline ByPose mean_depth(Walk& walk, const Pose<ByPose>& pose, double middle, double width, double x) {
    ByPose before = penetration_at(walk, pose, middle - GAUSS * width, x).depth;
    return 0.5 * (before + penetration_at(walk, pose, middle + GAUSS * width, x).depth);
}

// The residual's changes, in parts.
struct ResidualChanges {
    Rows values;  // (S, block), of the state
    const EquationData& data;
    const ContactLines& lines;  // of all strips
    const Lattice& lattice;
    Pose<double> pose = data.motion.pose();
    Pose<ByPose> moving = varied<ByPose>(pose);
    RigidMotion<ByChanges> motion = varied<ByChanges>(data.motion.velocities(), pose);
    long S = data.strips(), block = data.block(), M = data.basis.M();
    Array<double, 3> total{S, block, long(CHANGES)};

    // The moments of the penetration.
    void add_penetration() {
        Walk before(data.surface), after(data.surface);
        for (long i = 0; i < S; ++i) {
            double middle = data.places.middle(i), away = GAUSS * data.places.width(i);
            for (long g = 0; g < STATIONS; ++g) {
                double x = along_strip(values, i, data.basis.stations(g));
                ByPose depth = penetration_at(before, moving, middle - away, x).depth;
                depth = 0.5 * (depth + penetration_at(after, moving, middle + away, x).depth);
                for (int m = 0; m < MOMENTS; ++m)
                    for (int k = 0; k < POSE; ++k)
                        total(i, block - MOMENTS + m, k) += data.basis.penetration(m, g) * depth.d[k];
            }
        }
    }

    // The gaps of strips that touch on a part of their width.
    void add_openings() {
        for (long i = 0; i < S; ++i) {
            long own = data.places.strip(i);
            double load = half_length(values, i) * values(i, block - 2 - MODES);
            double onset = data.places.onset(i), whole = data.places.whole(i);
            if (!(load < whole) || own < 1 || own > lattice.middle.size() - 2) continue;
            ByPose depth[3];
            Walk walk(data.surface);
            for (int k = 0; k < 3; ++k) {
                long n = own - 1 + k;
                depth[k] = mean_depth(walk, moving, lattice.middle(n), lattice.width(n), lines.x(n));
                depth[k].v = lines.depth(n);
            }
            PartialWidth<ByPose> at(depth, lines.curvature(own), &lattice.middle(own - 1), lattice.width(own));
            OpeningChanges by(load, onset, whole);
            for (int k = 0; k < POSE; ++k)
                total(i, block - MOMENTS, k) +=
                    by.onset * (at.onset.d[k] / at.onset.v) + by.whole * (at.whole.d[k] / at.whole.v);
        }
    }

    // Rolling speed: the mean of the flow where strips touch, weighted by their squared penetration.
    ByChanges speed() const {
        ByChanges flow, weights;
        if (data.basis.slip_power == 1) return ByChanges(data.motion.speed);  // of a displacement it is 1 m/s
        auto all = varied<ByChanges>(pose);
        Walk walk(data.surface), sides(data.surface);
        for (long k = 0; k < lines.depth.size(); ++k) {
            if (!(lines.depth(k) > 0.0)) continue;
            ByPose depth = mean_depth(sides, moving, lattice.middle(k), lattice.width(k), lines.x(k));
            depth.v = lines.depth(k);
            auto weight = widened<CHANGES>(depth * depth * lattice.width(k), 0);
            auto at = place_at(walk, all, lattice.middle(k), lines.x(k));
            flow -= weight * shift_at(at.point, at.forward, at.lateral(), at.forward, motion).flow;
            weights += weight;
        }
        return flow / weights;
    }

    // The residual of friction with slopes (S, M, SLOPES): crest (S, 6), derivative of the strips' places of largest
    // penetration; slips (6, S, 2, M), derivative of the elastic slips at fixed loads.
    void add_friction(Blocks slopes, Rows crest, View<const double, 4> slips) {
        ByChanges speed = this->speed();
        auto all = varied<ByChanges>(pose);
        Walk walk(data.surface);
        for (long i = 0; i < S; ++i) {
            double middle = data.places.middle(i);
            ByChanges touching(lines.x(data.places.strip(i)));
            for (int k = 0; k < POSE; ++k) touching.d[k] = crest(i, k);
            auto level = place_at(walk, all, middle, touching).forward;
            for (long r = 0; r < M; ++r) {
                auto by = slopes[i][r];
                auto at = place_at(walk, all, middle, along_strip(values, i, middle_of_cell(data.basis, r)));
                auto shift = shift_at(at.point, at.forward, at.lateral(), level, motion);
                ByChanges x = shift.along / speed, y = shift.across / speed;
                for (int k = 0; k < POSE; ++k) x.d[k] += slips(k, i, 0, r), y.d[k] += slips(k, i, 1, r);
                for (int k = 0; k < CHANGES; ++k) {
                    total(i, r, k) = by(4) * x.d[k] + by(5) * y.d[k] + by(8) * speed.d[k];
                    total(i, M + r, k) = by(6) * x.d[k] + by(7) * y.d[k] + by(9) * speed.d[k];
                }
            }
        }
    }
};

// Derivative (S, block, CHANGES) of the residual.
//
// Parameters: arc (ns,) m, lines of the lower body, see `foot_derivatives`; slopes (S, M, SLOPES), of the friction
// residual, M = 0 without.
inline Array<double, 3> residual_changes(Rows values, const EquationData& data, const ContactLines& lines,
                                         const Lattice& lattice, Numbers arc, Blocks slopes) {
    long S = values.size();
    Array<double, 1> x(S), feet(S);
    for (long i = 0; i < S; ++i) x(i) = lines.x(data.places.strip(i)), feet(i) = lines.foot(data.places.strip(i));
    auto [crest, foot] = touching_changes(data.surface, data.motion, data.places.middle, x, feet);
    auto by_feet = foot_derivatives(values, data, arc, feet, foot);
    ResidualChanges changes{values, data, lines, lattice};
    for (long i = 0; i < S; ++i)
        for (int m = 0; m < MOMENTS; ++m)
            for (int k = 0; k < POSE; ++k) changes.total(i, changes.block - MOMENTS + m, k) = by_feet.moments(k, i, m);
    changes.add_penetration();
    changes.add_openings();
    if (data.rolls()) changes.add_friction(slopes, crest, by_feet.slips);
    return changes.total;
}

}  // namespace wr
