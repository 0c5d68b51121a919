// Penetration that remains on unloaded strips beside the loaded ones.
#pragma once
#include "contact/models/lattice/influence/core/cell_compliance.hpp"
#include "contact/models/lattice/system/core/contact_lines.hpp"
#include "contact/models/lattice/system/core/state.hpp"
#include "contact/models/lattice/system/core/strips.hpp"

namespace wr {

constexpr double RANGE = 1.2;  // half length of the probed range over that of the next loaded strip
constexpr int NARROWINGS = 6;  // of the range around a maximum, to a third of it each
constexpr long NEXT_TO = 2;    // strips: those nearer to a loaded one are probed around its middle, moved like crests
constexpr double FLATTEST = 1e-2;  // 1/m, least curvature

// Remaining penetration, possibly positive, of n unloaded strips.
struct Remaining {
    bool inside = false;         // whether all points lie on the surfaces and in the tables
    Array<long, 1> strips;       // (n,) their numbers
    Array<double, 1> depth;      // (n,) m, its maximum along x
    Array<double, 1> place;      // (n,) m, of the maximum
    Array<double, 1> curvature;  // (n,) 1/m there
    Array<double, 1> half;       // (n,) m, half length of the probed range
    Array<double, 1> highest;    // (m,) m, estimated maximum on all m unloaded strips

    auto fields() { return std::tie(inside, strips, depth, place, curvature, half, highest); }
};

// Where the remaining penetration is evaluated.
struct Probes {
    Lattice lattice;           // all strips
    StripBasis first, second;  // equal cells along the probed range, for an estimate, and around its maximum

    auto fields() { return std::tie(lattice, first, second); }
    bool fits() const { return first.M() > 2 && second.M() > 2; }
};

// Strips (n,) and the ends low and high (n,) m of a range along each.
struct Ranges {
    Array<long, 1> strips;
    Array<double, 1> low, high;

    long size() const { return strips.size(); }
};

// Remaining penetration (n, C) m, where unloaded strips begin to touch, as means over the cells from low to high (n,)
// m. The flag: whether all points lie in the tables. values (S, block) of the loaded strips, onset (K,) m of all.
// Beyond the lower body it is -inf.
inline std::pair<bool, Array<double, 2>> excess(Rows values, const EquationData& data, const Lattice& lattice,
                                                Numbers onset, const StripBasis& basis, Indices strips, Numbers low,
                                                Numbers high) {
    long n = strips.size(), C = basis.M();
    Array<double, 2> edges(n, C + 1);
    Array<double, 1> middle(n);
    for (long i = 0; i < n; ++i) {
        long k = strips(i);
        middle(i) = lattice.middle(k);
        for (long r = 0; r <= C; ++r) edges(i, r) = lattice.stretch(k) * (low(i) + (high(i) - low(i)) * basis.marks(r));
    }
    auto grid = strip_grid(values, data.places, data.basis);
    auto jumps = force_jumps(values, data.places, data.basis, data.rolls());
    auto [inside, total] =
        normal_displacements(data.tables, strips, middle, edges, grid, values, jumps, data.basis, data.rolls());
    auto pose = data.motion.pose();
    Walk walk(data.surface);
    for (long i = 0; i < n; ++i) {
        long k = strips(i);
        for (int g = 0; g < 2; ++g) {
            double s = middle(i) + (2 * g - 1) * GAUSS * lattice.width(k);
            for (int m = 0; m < STATIONS; ++m) {
                double x = low(i) + (high(i) - low(i)) * basis.stations(m);
                double depth = penetration_at(walk, pose, s, x).depth;
                for (long r = 0; r < C; ++r) total(i, r) += 0.5 * basis.cell_penetration(r, m) * depth;
            }
        }
        for (double& rest : total[i]) {
            rest += onset(k);
            if (!std::isfinite(rest)) rest = -INFINITE;
        }
    }
    return {inside, total};
}

struct Maximum {
    double height, place, curvature;  // m, m, 1/m
};

// Maximum of the parabola with the largest of means (C,) over cells from low to high m and the next ones: at the middle
// of a cell it is higher than its mean by a third of what it falls within half a cell.
inline Maximum maximum(Numbers means, double low, double high) {
    long C = means.size(), largest = std::max_element(means.begin(), means.end()) - means.begin();
    double step = (high - low) / double(C);
    long k = std::min(std::max(largest, 1L), C - 2);
    double left = means(k - 1), middle = means(k), right = means(k + 1), place = low + (double(k) + 0.5) * step;
    if (!std::isfinite(left + middle + right)) return {means(largest), place, FLATTEST};
    double curvature = std::max((2.0 * middle - left - right) / (step * step), FLATTEST);
    double slope = (right - left) / (2.0 * step);
    double offset = std::min(std::max(slope / curvature, -step), step), top = middle + curvature * step * step / 24.0;
    return {top + slope * offset - 0.5 * curvature * offset * offset, place + offset, curvature};
}

// Ranges of possible contact in free strips: around the loaded ones (S, block), or their own crests.
inline Ranges probed_ranges(Rows values, const StripPlaces& places, const ContactLines& lines,
                            const std::vector<long>& free) {
    long n = long(free.size()), S = values.size(), last = values.shape[1] - 1;
    double extent = longest_half(values);
    Ranges at{Array<long, 1>(n), Array<double, 1>(n), Array<double, 1>(n)};
    for (long k = 0; k < n; ++k) {
        long strip = free[k], near = 0;
        auto distance = [&](long i) { return std::abs(strip - places.strip(i)); };
        for (long i = 0; i < S; ++i)
            if (distance(i) < distance(near)) near = i;
        double middle = lines.x(strip);
        double half = std::max(std::sqrt(2.0 * std::max(lines.depth(strip), 0.0) / lines.curvature(strip)), extent);
        if (distance(near) <= NEXT_TO) {
            double along = lines.x(strip) - lines.x(places.strip(near));
            middle = 0.5 * (values(near, last) + values(near, last - 1)) + along;
            half = RANGE * std::max(half_length(values, near), 0.1 * extent) + std::abs(along);
        }
        at.strips(k) = strip, at.low(k) = middle - half, at.high(k) = middle + half;
    }
    return at;
}

// `Remaining` penetration of free strips; values (S, block) of the loaded ones.
inline Remaining remaining(Rows values, const EquationData& data, const Probes& probes, const ContactLines& lines,
                           const std::vector<long>& free) {
    auto all = probed_ranges(values, data.places, lines, free);
    auto [inside, first] =
        excess(values, data, probes.lattice, lines.onset, probes.first, all.strips, all.low, all.high);
    double C = double(probes.first.M());
    Array<double, 1> highest(all.size());
    std::vector<long> close;
    std::vector<double> places;
    for (long k = 0; k < all.size(); ++k) {
        auto top = maximum(first[k], all.low(k), all.high(k));
        double half = 0.5 * (all.high(k) - all.low(k)) / C;
        highest(k) = top.height;
        // as uncertain as its own fall within half a cell
        if (top.height + 0.5 * top.curvature * half * half > 0.0) close.push_back(k), places.push_back(top.place);
    }
    long n = long(close.size());
    Remaining rest{
        inside, Array<long, 1>(n), Array<double, 1>(n), Array<double, 1>(n), Array<double, 1>(n), Array<double, 1>(n),
        highest};
    Ranges at{rest.strips, Array<double, 1>(n), Array<double, 1>(n)};
    std::vector<long> unsure(close.size());
    for (long k = 0; k < n; ++k) {
        rest.strips(k) = all.strips(close[k]), rest.place(k) = places[k], unsure[k] = k;
        rest.half(k) = 0.5 * (all.high(close[k]) - all.low(close[k]));
        at.low(k) = places[k] - 2.0 * rest.half(k) / C, at.high(k) = places[k] + 2.0 * rest.half(k) / C;
    }
    // around the maximum, again while its sign is open: flatter than a parabola, or narrow at an end of the next strip
    for (int narrowing = 0; narrowing < NARROWINGS; ++narrowing) {
        auto [found, second] =
            excess(values, data, probes.lattice, lines.onset, probes.second, at.strips, at.low, at.high);
        rest.inside = rest.inside && found;
        std::vector<long> doubtful;
        for (long i = 0; i < at.size(); ++i) {
            long k = unsure[i];
            double half = 0.5 * (at.high(i) - at.low(i)) / double(probes.second.M());
            auto top = maximum(second[i], at.low(i), at.high(i));
            rest.depth(k) = top.height, rest.place(k) = top.place, rest.curvature(k) = top.curvature;
            at.low(i) = top.place - 4.0 * half, at.high(i) = top.place + 4.0 * half;
            if (std::abs(top.height) < 0.5 * top.curvature * half * half) doubtful.push_back(i);
        }
        if (doubtful.empty()) break;
        at = {taken<long>(at.strips, doubtful), taken<double>(at.low, doubtful), taken<double>(at.high, doubtful)};
        for (std::size_t i = 0; i < doubtful.size(); ++i) unsure[i] = unsure[doubtful[i]];
    }
    return rest;
}

// Whether there are tables for all pairs of a loaded strip and a free one.
inline bool paired(const PairTables& tables, Indices loaded, const std::vector<long>& free) {
    for (long i : loaded)
        for (long k : free) {
            long pair = tables.pair(std::min(i, k), std::max(i, k));  // others may have been added since
            if (pair == 0 || pair >= tables.first.size()) return false;
        }
    return true;
}

// Strips (K,) near to contact (K,), next to loaded ones (S,), that are not known (K,).
inline Array<bool, 1> next_to_loaded(Indices loaded, View<const bool, 1> known, View<const bool, 1> near) {
    long K = known.size();
    Array<bool, 1> next(K);
    for (long strip : loaded)
        for (long k : {std::max(strip - 1, 0L), std::min(strip + 1, K - 1)}) next(k) = near(k) && !known(k);
    return next;
}

// Strips (K,) near to contact (K,) next to positive remaining penetration, or in the direction of its growth; highest
// (n,) m, of unloaded strips free (n,); known (K,): strips where it is known, or that are loaded.
inline Array<bool, 1> next_to_deeper(const std::vector<long>& free, Numbers highest, View<const bool, 1> known,
                                     View<const bool, 1> near) {
    long K = known.size();
    Array<double, 1> depth(K);
    Array<bool, 1> next(K);
    for (std::size_t i = 0; i < free.size(); ++i) depth(free[i]) = highest(long(i));
    for (std::size_t i = 0; i < free.size(); ++i)
        for (long side : {-1L, 1L}) {
            long behind = free[i] - side, ahead = free[i] + side;
            if (ahead < 0 || ahead >= K || !near(ahead) || known(ahead)) continue;
            double least = behind >= 0 && behind < K ? std::min(depth(behind), 0.0) : 0.0;
            next(ahead) = next(ahead) || highest(long(i)) > least;
        }
    return next;
}

// Result of `search`: whether there are tables of all pairs, what remains, and strips between which tables are missing,
// or that are free.
struct Search {
    bool complete = false;
    Remaining rest;
    std::vector<long> strips;
};

// Remaining penetration of the strips that may enter: of those that are probed at first or next to loaded ones, and of
// further ones as long as it grows from strip to strip. Values (S, block) of the loaded strips; barred (n,): strips
// that must not enter.
inline Search search(Rows values, const EquationData& data, const Probes& probes, const ContactLines& lines,
                     Indices barred) {
    Indices loaded = data.places.strip;
    long K = lines.near.size();
    auto known = Array<bool, 1>::copy(lines.probed);
    Array<bool, 1> kept_out(K);
    for (long strip : loaded) known(strip) = kept_out(strip) = true;
    auto add = [&](View<const bool, 1> more) {
        for (long k = 0; k < K; ++k) known(k) = known(k) || more(k);
    };
    add(next_to_loaded(loaded, known, lines.near));
    for (long strip : barred) kept_out(strip) = true;
    while (true) {
        std::vector<long> free;
        for (long k : numbers_of(known))
            if (!kept_out(k)) free.push_back(k);
        if (!paired(data.tables, loaded, free)) return {false, {}, numbers_of(known)};
        auto rest = remaining(values, data, probes, lines, free);
        auto further = next_to_deeper(free, rest.highest, known, lines.near);
        if (!any(further)) return {true, rest, free};
        add(further);
    }
}

}  // namespace wr
