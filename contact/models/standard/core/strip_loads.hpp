// Force of strips with pressure and FASTSIM's or Polach's tractions, without storage of their cells.
#pragma once
#include <limits>

#include "contact/models/standard/core/forces.hpp"
#include "contact/models/standard/core/strip_resultant.hpp"

namespace wr {

// Constants of both bodies, method of the tangential problem, friction coefficient, factors of Polach's formula, and
// cells along each strip.
struct PairFriction {
    const PairElasticity& elastic;
    long method;
    double mu;
    std::array<double, 2> reduction;
    long cells;
};

// Force N and moment N m about the rail's origin, and the smallest rolling speed m/s of a contact.
template <class T>
struct StripLoads {
    Vec<T> force, moment;
    double slowest = std::numeric_limits<double>::infinity();
};

// Load of a strip: longitudinal, lateral and pressing force N, and moment N m about the inward normal.
template <class T>
struct StripLoad {
    T along{}, across{}, normal{}, turn{};
};

template <class T, class G>
void add_load(const Frame<G>& frame, const StripLoad<T>& load, StripLoads<T>& sum) {
    Vec<T> forward = as<T>(frame.axes[0]), lateral = as<T>(frame.axes[1]), outward = as<T>(frame.axes[2]);
    auto force = load.along * forward + load.across * lateral - load.normal * outward;
    sum.force = sum.force + force;
    sum.moment = sum.moment + (cross(as<T>(frame.point), force) - load.turn * outward);
}

// Sums over all cells of `strip_forces`, weights (k,) of the contacts' areas.
//
// Pressures, weights and frames are numbers G, of doubles or varying with the pose; T varies with the motion, too: with
// FASTSIM or without friction.
template <class T, class G, class Motion>
StripLoads<T> strip_loads(const Pressures<G>& strips, const Array<G, 1>& weight, const PatchFrames<G>& frames,
                          const Motion& v, const PairFriction& own) {
    using std::numbers::pi;
    long n = strips.s.size(), start = 0, stop = 0;
    auto bounds = parabola_means(own.cells);
    double top = *std::max_element(bounds.begin(), bounds.end());
    for (double& bound : bounds) bound /= top;
    std::vector<Creepages<T>> creepage(n);
    std::vector<Increments<T>> increments(n);
    std::vector<Resultants<T>> resultants(n);
    StripLoads<T> sum;
    for (long c = 0; c < weight.size(); ++c, start = stop) {
        stop = end_of(strips.contact, start, c);
        auto patch = rolling_patch<T>(strips, c, start, stop, frames, v, own.elastic, creepage);
        sum.slowest = std::min(sum.slowest, value(patch.speed));
        bool rolls = own.method != NO_FRICTION && value(patch.speed) > 0.0;
        std::array<double, 2> creep_force{};
        if constexpr (std::is_same_v<T, double>)
            if (rolls && own.method == POLACH) creep_force = polach_force(patch, own.elastic.G, own.mu, own.reduction);
        if (rolls && own.method == FASTSIM) {
            for (long i = start; i < stop; ++i) {
                G bound = own.mu * PARABOLA * strips.scale(i) * strips.half(i) * top;
                increments[i] = strip_increments(patch.flexibility, patch.creepages, creepage[i], as<T>(strips.half(i)),
                                                 as<T>(bound));
            }
            strip_resultants<T>(std::span(increments).subspan(start, stop - start), bounds,
                                std::span(resultants).subspan(start, stop - start));
        }
        for (long i = start; i < stop; ++i) {
            const G& half = strips.half(i);
            StripLoad<T> load;
            load.normal = as<T>(G(0.5 * pi * strips.scale(i) * half * half * (strips.width(i) * weight(c))));
            if (rolls && own.method == FASTSIM) {
                T size = 1.5 * own.mu * top * load.normal;
                load.along = size * resultants[i].along, load.across = size * resultants[i].across;
                load.turn = size * as<T>(half) * resultants[i].turning;
            } else if (rolls) {
                load.along = creep_force[0] * load.normal / patch.load;
                load.across = creep_force[1] * load.normal / patch.load;
            }
            add_load(frames.middles[i], load, sum);
        }
    }
    return sum;
}

}  // namespace wr
