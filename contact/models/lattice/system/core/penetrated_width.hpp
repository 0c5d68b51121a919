// Width of the undeformed penetration by the exact profiles, in strips of a lattice, for its resolution.
//
// With the largest penetration d along x on every line, t the number of strips across, and m(t, t') the least d between
// two lines, 0 where it is negative, the width is
//
//     n = 1.2 int int max(d, d') m dt dt' / int d^2 dt
//
// over all d > 0. On one maximum the numerator is (int d dt)^2, and n the width of a parabola; of several regions n is
// the mean, weighted by int d^2 dt, and of two that merge it grows with the saddle between them: a continuous function
// of the pose. Of finite bodies d is the penetration less their bulk displacement, which is none of the contact: its
// lift, linear between some lines.
#pragma once
#include "contact/models/lattice/influence/core/bulk.hpp"
#include "contact/models/lattice/system/core/contact_lines.hpp"
#include "contact/models/lattice/system/core/penetration_pieces.hpp"
#include "contact/models/lattice/system/core/strips.hpp"

namespace wr {

constexpr double OF_PARABOLA = 1.2;  // width over (integral)^2 / (integral of the square)

// Gauss's rule of 16 nodes on -1 to 1, the positive half.
constexpr int NODES = 16;
constexpr double PLACES[] = {0.09501250983763745, 0.2816035507792589, 0.4580167776572274, 0.6178762444026438,
                             0.755404408355003,   0.8656312023878318, 0.9445750230732326, 0.9894009349916499};
constexpr double WEIGHTS[] = {0.1894506104550681,  0.18260341504492328, 0.16915651939500212, 0.14959598881657638,
                              0.12462897125553363, 0.09515851168249231, 0.06225352393864763, 0.027152459411756466};
inline double node(int i) { return i < NODES / 2 ? -PLACES[NODES / 2 - 1 - i] : PLACES[i - NODES / 2]; }
inline double weight(int i) { return WEIGHTS[i < NODES / 2 ? NODES / 2 - 1 - i : i - NODES / 2]; }

// Number of strips across, counted by their slenderness (K,), by their mean penetrations depth (K,) m, for contacts
// that are wide: that of a parabola of more than three strips is at most 3 % too large. Saddles are taken to lie lower
// than the means.
inline double strips_across(Numbers depth, Numbers slenderness) {
    long K = depth.size();
    double twice = 0.0, square = 0.0;
    for (long i = 0; i < K; ++i) {
        if (!(depth(i) > 0.0)) continue;
        double own = 1.0 / slenderness(i), least = depth(i);
        square += own * depth(i) * depth(i);
        twice += own * depth(i) * (own * depth(i));
        for (long j = i + 1; j < K && depth(j) > 0.0; ++j) {
            twice += 2.0 * own / slenderness(j) * std::max(depth(i), depth(j)) * std::min(least, depth(j));
            if (j < K - 1 && depth(j) <= depth(j - 1) && depth(j) <= depth(j + 1)) {
                double saddle = depth(j) - 0.25 * (depth(j - 1) - 2.0 * depth(j) + depth(j + 1));
                least = std::min(least, std::max(saddle, 0.0));
            }
        }
    }
    return square > 0.0 ? OF_PARABOLA * twice / square : 0.0;
}

// `strips_across` of the penetration less the displacement of finite bodies by the loads of a state.
// values: (S, block) of the state. With it, whether the compliance of the bodies is known there.
inline std::pair<bool, double> strips_beside_bulk(Rows values, const EquationData& data, const ContactLines& lines,
                                                  const Lattice& lattice, Numbers slenderness,
                                                  const std::vector<BulkCompliance>& bodies) {
    const auto& loaded = data.places;
    auto loads = strip_loads(values, loaded, data.basis, data.rolls());
    auto depth = Array<double, 1>::copy(lines.depth);
    std::vector<long> inside, under;
    for (long k = 0; k < depth.size(); ++k)
        if (depth(k) > 0.0) inside.push_back(k);
    for (long k : loaded.strip) under.push_back(k);
    auto wide = taken(lattice.width, inside), feet = taken<double>(lines.foot, inside);
    for (const auto& body : bodies) {
        auto places = bulk_places(body, taken(lattice.middle, inside), wide, feet);
        auto own = bulk_places(body, loaded.middle, loaded.width, taken<double>(lines.foot, under));
        if (!bulk_known(body, {places, wide}, {own, loaded.width})) return {false, 0.0};
        auto less = bulk_displacements(body.arc, body.values, places, own, loaded.width, loads);
        for (long k = 0; k < less.size(); ++k) depth(inside[k]) -= less(k);
    }
    return {true, strips_across(depth, slenderness)};
}

// Of a piece: depths m and shares of strips at the nodes, and depth m of the saddle at its lower bound, infinite where
// it continues no other piece; or derivatives of a number by these.
struct PieceSamples {
    double depth[NODES] = {}, share[NODES] = {}, saddle = 0.0;
};

// max(a, b) times the least of a, b and the saddle between.
template <class T>
T overlap(const T& a, const T& b, const T& saddle) {
    bool first = value(a) > value(b);
    const T &high = first ? a : b, &low = first ? b : a;
    return high * (value(saddle) < value(low) ? saddle : low);
}

// Numerator and denominator, and the derivatives of the former by the samples of all pieces.
struct WidthIntegrals {
    double twice = 0.0, square = 0.0;
    std::vector<PieceSamples> slopes;

    WidthIntegrals(const std::vector<PieceSamples>& pieces, const std::vector<bool>& continues, bool with_slopes)
        : slopes(pieces.size()) {
        for (std::size_t p = 0; p < pieces.size(); ++p) {
            double least = std::numeric_limits<double>::infinity();
            std::size_t place = p;
            for (std::size_t q = p; q < pieces.size() && (q == p || continues[q]); ++q) {
                if (q > p && pieces[q].saddle < least) least = pieces[q].saddle, place = q;
                for (int i = 0; i < NODES; ++i)
                    for (int k = 0; k < NODES; ++k) {
                        double a = pieces[p].depth[i], b = pieces[q].depth[k], count = q == p ? 1.0 : 2.0;
                        double own = count * pieces[p].share[i] * pieces[q].share[k];
                        twice += own * overlap(a, b, least);
                        if (!with_slopes) continue;
                        using T = Dual<3>;
                        auto at = overlap(variable<T>(a, 0), variable<T>(b, 1), variable<T>(least, 2));
                        slopes[p].depth[i] += own * at.d[0], slopes[q].depth[k] += own * at.d[1];
                        slopes[place].saddle += own * at.d[2];
                        slopes[p].share[i] += count * pieces[q].share[k] * at.v;
                        slopes[q].share[k] += count * pieces[p].share[i] * at.v;
                    }
            }
            for (int i = 0; i < NODES; ++i) square += pieces[p].share[i] * pieces[p].depth[i] * pieces[p].depth[i];
        }
    }
};

// Derivative of the penetration on a line by six motions of the wheel's frame, by s, and by the lift.
struct LineChange {
    Dual<POSE + 1> depth;
    BetweenLines lift;

    // At the crest of a line at s m and x m, with the closest point foot m of the rail. It moves along x by one more
    // step of Newton's method: as the wheel's circle is parallel to the rail there, but not to the wheel's own axes,
    // the penetration is not quite the largest one.
    LineChange(const LiftedPenetration& at, double s, double x, double foot) : lift{0, 0.0} {
        using T = Dual<POSE + 1>;
        auto moving = varied<T>(at.pose);
        T line = variable<T>(s, POSE), along(x);
        const auto& surface = at.surface;
        if (surface.revolves) {
            auto wheel = local(surface.wheel, line);
            double angle = x / surface.radius;
            T turn = lowest_step(wheel, surface.radius, seen_line(wheel.point, surface.radius, moving), std::sin(angle),
                                 std::cos(angle), local(surface.rail, foot))
                         .turn;
            if (std::abs(turn.v) < LOWEST) along += surface.radius * (turn - turn.v);
            depth = project<T>(surface.rail, seen_on_circle(wheel, surface.radius, moving, along), -1).depth;
        } else {
            T dx = along - moving.origin.x, ds = line - moving.origin.y;
            depth = -moving.origin.z - surface.upper(0) * dx * dx - surface.upper(1) * ds * ds -
                    surface.lower(0) * along * along - surface.lower(1) * line * line;
        }
        depth -= interpolated(line, at.lines, at.lift);
        if (at.lines.size() > 1) lift = between_lines(at.lines, s);
    }
    double slope() const { return depth.d[POSE]; }
    // Add a multiple to the derivative (6 + R,) of a number.
    void add(double factor, View<double, 1> to) const {
        for (int j = 0; j < POSE; ++j) to(j) += factor * depth.d[j];
        to(POSE + lift.right) -= factor * (lift.right ? lift.share : 1.0);
        if (lift.right) to(POSE + lift.right - 1) -= factor * (1.0 - lift.share);
    }
};

// Number of strips across the penetration, and its derivative (6 + R,) by pose and lift if slopes, else zeros; middle
// and width (K,) m of the strips.
inline std::pair<double, Array<double, 1>> penetrated_width(const LiftedPenetration& depth, Numbers middle,
                                                            Numbers width, const std::vector<Piece>& pieces,
                                                            bool slopes) {
    std::size_t P = pieces.size();
    Array<double, 1> change(POSE + depth.lift.size());
    std::vector<PieceSamples> samples(P);
    std::vector<bool> continues(P);
    std::vector<Array<double, 1>> lines(P);
    std::vector<LiftedPenetration::Crests> crests(P);
    for (std::size_t p = 0; p < P; ++p) {
        const auto& [low, high, goes_on] = pieces[p];
        double half = 0.5 * (high - low);
        lines[p] = Array<double, 1>(NODES + 2);
        for (int i = 0; i < NODES; ++i) lines[p](i) = 0.5 * (low + high) + half * node(i);
        lines[p](NODES) = low, lines[p](NODES + 1) = high, continues[p] = goes_on;
        const auto& at = crests[p] = depth.on(lines[p]);
        for (int i = 0; i < NODES; ++i) {
            samples[p].depth[i] = std::max(at.depth(i), 0.0);
            samples[p].share[i] = half * weight(i) / interpolated(lines[p](i), middle, width);
        }
        samples[p].saddle = std::max(at.depth(NODES), 0.0);
    }
    WidthIntegrals sums(samples, continues, slopes);
    if (!(sums.square > 0.0)) return {0.0, change};
    double number = OF_PARABOLA * sums.twice / sums.square;
    auto change_of = [&](std::size_t p, int i) {
        return LineChange(depth, lines[p](i), crests[p].x(i), crests[p].foot(i));
    };
    for (std::size_t p = 0; slopes && p < P; ++p) {
        using T = Dual<2>;  // by the bounds of the piece
        T low = variable<T>(pieces[p].low, 0), high = variable<T>(pieces[p].high, 1), half = 0.5 * (high - low), moved;
        for (int i = 0; i < NODES; ++i) {
            double a = samples[p].depth[i], share = samples[p].share[i];
            double by_depth = (OF_PARABOLA * sums.slopes[p].depth[i] - number * 2.0 * share * a) / sums.square;
            double by_share = (OF_PARABOLA * sums.slopes[p].share[i] - number * a * a) / sums.square;
            LineChange at = change_of(p, i);
            T line = 0.5 * (low + high) + half * node(i);
            moved += by_depth * at.slope() * line + by_share * (half * weight(i) / interpolated(line, middle, width));
            at.add(by_depth, change);
        }
        // bounds at the edge of a region move with the edge, saddles count as fixed
        LineChange lower = change_of(p, NODES), upper = change_of(p, NODES + 1);
        lower.add(continues[p] ? OF_PARABOLA * sums.slopes[p].saddle / sums.square : -moved.d[0] / lower.slope(),
                  change);
        if (!(p + 1 < P && continues[p + 1])) upper.add(-moved.d[1] / upper.slope(), change);
    }
    return {number, change};
}

}  // namespace wr
