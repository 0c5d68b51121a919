// Equations of the contact on a lattice at one pose: residual and Jacobian of all unknowns together.
//
// Moments of the gap:  int (d + u_n) T_k / sqrt(1 - xi^2) = 0, d the undeformed penetration and u_n the relative normal
// displacement by all tractions. Friction: F(q, s, p) = 0 in every cell, s the rigid slip plus the elastic one over the
// rolling speed. Ends of strips are unknowns like the others.
#pragma once
#include <numeric>
#include <optional>
#include <string>

#include "contact/geometry/core/overlap.hpp"
#include "contact/models/lattice/system/core/equations.hpp"
#include "contact/models/lattice/system/core/setting.hpp"
#include "support/core/interpolation.hpp"

namespace wr {

inline const char* const PATCH_TOO_LONG = "the patch is longer than the tables of influence";
inline const char* const TENSION[] = {"the pressure is negative at an end of a strip",
                                      "the pressure is negative between two places of a strip, which has one"};
inline const char* const PROFILE_ENDS = "where a profile ends";
inline const char* const TOO_STEEP = "where the face of the rail is too steep for strips";
constexpr double MISSED = 1e-4;  // m, largest overlap that strips may miss: as means over their widths they have less

// Some loaded strips.
struct LatticeState {
    Strips strips;            // (S,) their numbers on the lattice, ascending
    Array<double, 2> values;  // (S, block), strip by strip: tractions, amplitudes of the pressure modes, and ends

    // State of the strips in a mask (S,), or in its complement.
    LatticeState at(View<const bool, 1> mask, bool value = true) const {
        LatticeState some;
        for (long i = 0; i < mask.size(); ++i)
            if (mask(i) == value) some.strips.push_back(strips[i]);
        some.values = Array<double, 2>(long(some.strips.size()), values.shape[1]);
        for (long i = 0, k = 0; i < mask.size(); ++i)
            if (mask(i) == value) some.set(k++, values[i]);
        return some;
    }
    // State with further strips, in order.
    LatticeState joined(const LatticeState& other) const {
        LatticeState all{{}, Array<double, 2>(values.size() + other.values.size(), values.shape[1])};
        std::size_t a = 0, b = 0;
        while (a < strips.size() || b < other.strips.size()) {
            bool own = b == other.strips.size() || (a < strips.size() && strips[a] < other.strips[b]);
            all.set(long(a + b), own ? values[long(a)] : other.values[long(b)]);
            all.strips.push_back(own ? strips[a++] : other.strips[b++]);
        }
        return all;
    }

  private:
    void set(long i, Numbers row) { std::copy(row.begin(), row.end(), values[i].begin()); }
};

class LatticeProblem {
  public:
    LatticeProblem(std::shared_ptr<const LatticeSetting> own, const Motion& given)
        : setting(std::move(own)),
          motion(owned(given)),
          at(*setting),
          lines(contact_lines(at.surface, motion, at.tables->lattice, at.margin, at.apart)) {
        for (long k = 0; k < lines.depth.size(); ++k)
            if (lines.depth(k) > 0.0) candidates.push_back(k);
    }

    const std::shared_ptr<const LatticeSetting> setting;

  private:
    Owned<Motion> motion;
    const LatticeSetting& at;

  public:
    const ContactLines lines;
    Strips candidates;  // with positive penetration

    const LatticeSetting& all() const { return at; }
    LatticeTables& tables() const { return *at.tables; }
    const Lattice& lattice() const { return at.tables->lattice; }
    Pose<double> pose() const { return motion.pose(); }
    const Motion& given() const { return motion; }

    // Largest penetration m of a strip; without any, minus the gap of the undeformed surfaces.
    double approach() { return lines.approach > 0.0 ? lines.approach : std::min(nearest().depth, 0.0); }

    // Text on an overlap although no strip penetrates; empty without.
    std::string overlap() {
        if (!at.surface.revolves) return "";
        const auto& [middle, width] = std::tie(lattice().middle, lattice().width);
        long last = middle.size() - 1;
        double low = nearest().s - (middle(0) - 0.5 * width(0));
        double high = middle(last) + 0.5 * width(last) - nearest().s;
        bool ended = low < width(0) || high < width(last);  // where no strip carries a load
        if (nearest().depth > (ended ? 0.0 : MISSED))
            return overlap_text(nearest().depth, on_wheel(nearest().s),
                                ended && std::min(low, high) > -1e-9 ? PROFILE_ENDS : UNSOLVED);
        auto over = at.outline[0], height = at.outline[1];
        Walk walk(at.surface);
        for (long k = 0; k < lines.x.size(); ++k) {
            auto point = place_at(walk, pose(), lattice().middle(k), lines.x(k)).point;
            if (point.y > over(0) && point.y < over(over.size() - 1) &&
                point.z < interpolated(point.y, over, height) - INSIDE)
                return TOO_DEEP;
        }
        return "";
    }

    // Throw OutsideSurface where the penetration reaches an end of a profile, or of the upper body's lines, or lines
    // whose largest penetration is far ahead: along the profile it changes by no more than the way.
    void check_inside() const {
        const auto& [depth, middle] = std::tie(lines.depth, lattice().middle);
        long last = depth.size() - 1, worst = -1;
        bool worst_ended = false;
        for (long k : candidates) {
            long before = std::max(k - 1, 0L), after = std::min(k + 1, last);
            auto lost = [&](long m) { return depth(m) < depth(k) - std::abs(middle(m) - middle(k)); };
            bool ended = k == 0 || k == last || (lost(before) && 2.0 * depth(k) > depth(after)) ||
                         (lost(after) && 2.0 * depth(k) > depth(before));
            if ((ended || !lattice().carried(k)) && (worst < 0 || depth(k) > depth(worst)))
                worst = k, worst_ended = ended;
        }
        if (worst < 0) return;
        throw OutsideSurface(overlap_at(worst, !worst_ended ? UNSOLVED : at_end(worst) ? PROFILE_ENDS : TOO_STEEP));
    }
    // Throw OutsideSurface where loaded strips lie beyond the lower body's lines, as unloaded ones may.
    void check_loaded(const Strips& strips) const {
        long worst = -1;
        for (long k : strips)
            if (!lines.covered(k) && (worst < 0 || lines.depth(k) > lines.depth(worst))) worst = k;
        if (at.tables->moves && worst >= 0) throw OutsideSurface(overlap_at(worst, UNSOLVED));
    }

    // Rolling speed m/s: mean over all strips, weighted by the squared penetration. Throws NotRolling.
    double speed() const {
        if (!at.rolls()) return 0.0;
        if (at.shifts()) return 1.0;
        if (lines.speed > 0.0) return lines.speed;
        throw NotRolling(
            text("friction needs a wheel that rolls forward, but the material flows at %g m/s; mu = 0 needs none",
                 lines.speed));
    }
    // Pose and velocities with this speed. Throws NotRolling.
    Motion data() const {
        Motion moving = motion;
        moving.speed = speed();
        return moving;
    }

    // Places of some strips (S,).
    Owned<StripPlaces> places(const Strips& strips) const {
        auto middle = taken(lattice().middle, strips), width = taken(lattice().width, strips);
        auto stretch = taken(lattice().stretch, strips), onset = taken(lines.onset, strips);
        auto whole = taken(lines.whole, strips);
        Array<double, 2> level(long(strips.size()), 3);
        auto numbers = Array<long, 1>::copy(indices_of(strips));
        for (long i = 0; i < level.size(); ++i) {
            whole(i) = whole(i) * at.tables->modulus / stretch(i);
            for (int c = 0; c < 3; ++c) level(i, c) = lines.level(strips[i], c);
        }
        return {{middle, width, stretch, level, numbers, onset, whole},
                {middle.owner, width.owner, stretch.owner, level.owner, numbers.owner, onset.owner, whole.owner}};
    }
    // Tables of the pairs of some strips (S,). Throws OutsideSurface.
    Owned<PairTables> pairs(const Strips& strips) { return at.tables->of(strips, means()); }
    // Tables of each body of some loaded strips (S,).
    Owned<BodyTables> bodies(const Strips& strips) { return at.tables->body_tables(strips, means(), reach()); }

    // Data of the equations of some strips (S,), with the tables of all pairs that have been added. Throws
    // OutsideSurface, NotRolling.
    const Owned<EquationData>& of(const Strips& strips) {
        auto found = stored.find(strips);
        if (found != stored.end() && at.tables->holds(found->second.tables)) return found->second;
        auto tables = pairs(strips);
        auto own = places(strips);
        auto owners = tables.owners;
        owners.insert(owners.end(), own.owners.begin(), own.owners.end());
        Owned<EquationData> made({tables, at.surface, data(), own, at.basis, at.law, rho()}, owners_of(owners, rho()));
        return stored[strips] = made;
    }

    // Slips (M,) 1/Pa of cells by their own traction in plane strain, from a displacement for the deepest strip. In a
    // cell where the law of friction divides stick from slip, the traction varies with the slip by these.
    const Array<double, 1>& rho() {
        if (!slips) {
            double size = 1.0;
            if (at.shifts()) {
                long deepest = std::max_element(lines.depth.begin(), lines.depth.end()) - lines.depth.begin();
                size = std::sqrt(8.0 * lines.depth(deepest) / lines.curvature(deepest));
            }
            slips = Array<double, 1>::copy(at.basis.own_slip);
            for (double& slip : *slips) slip *= 2.0 * size / (std::numbers::pi * at.tables->modulus);
        }
        return *slips;
    }

    // Least mean pressure Pa over a cell.
    double least_pressure(const LatticeState& state) const {
        auto pressures = cell_pressures(state.values, at.basis, at.rolls());
        return *std::min_element(pressures.begin(), pressures.end());
    }
    // Whether the mean pressure over a cell is negative, as may happen at a strip's end with few cells.
    bool tensile(const LatticeState& state) const { return least_pressure(state) < at.least_pressure; }
    // Message on the largest tension of a tensile solution, and its place.
    std::string tension(const LatticeState& state) const {
        auto pressures = cell_pressures(state.values, at.basis, at.rolls());
        auto least = std::min_element(pressures.begin(), pressures.end());
        long strip = (least - pressures.begin()) / at.cells();
        auto first = pressures.begin() + strip * at.cells(), last = first + at.cells();
        auto more = [&](auto from, auto to) { return std::accumulate(from, to, *least) > 0.0; };  // than the tension
        auto what = TENSION[*least < 0.0 && more(first, least) && more(least + 1, last)];
        return at.surface.revolves ? overlap_at(state.strips[strip], std::string("where ") + what) : what;
    }

  private:
    double reach() const { return lines.window[1] - lines.window[0]; }
    const Owned<PoseMeans>& means() {
        if (!of_pose) of_pose = at.tables->at(lines.near, lines.foot, reach());
        return *of_pose;
    }
    const Extremum<>& nearest() {
        if (!gap) {
            const auto& surface = at.surface;
            if (surface.revolves) {
                Part part = lines_to_scan(at.lines, surface.radius, pose());
                Scan samples = scan(surface.rail, at.lines, surface.radius, pose(), part);
                gap = nearest_place(surface.pair(), pose(), at.lines, part, samples);
            } else {
                auto share = [&](int k) {
                    double own = surface.upper(k), other = surface.lower(k), away = motion.origin(k);
                    return away * away * own * other / (own + other);
                };
                gap = Extremum<>{0.0, -motion.origin(2) - (share(0) + share(1)), 0.0};
            }
        }
        return *gap;
    }
    Point<double> on_wheel(double s) const { return local(at.surface.wheel, s).point; }
    // Whether a strip lies at an end of its profile or of the rail's.
    bool at_end(long strip) const {
        double foot = lines.foot(strip), width = lattice().width(strip);
        bool outer = strip == 0 || strip == lines.depth.size() - 1;
        return outer || foot - width < at.surface.rail.first() || foot + width > at.surface.rail.last();
    }
    // Message on a strip that penetrates outside the solved region.
    std::string overlap_at(long strip, const std::string& reason) const {
        if (!at.surface.revolves) return BEYOND;
        return overlap_text(lines.depth(strip), on_wheel(lattice().middle(strip)), reason);
    }

    std::optional<Owned<PoseMeans>> of_pose;
    std::optional<Extremum<>> gap;
    std::optional<Array<double, 1>> slips;
    std::map<Strips, Owned<EquationData>> stored;
};

// State of a pose on wider strips as one on narrower ones: with the values of those in which their middles lie.
inline LatticeState divided_strips(const LatticeState& state, const Lattice& wider, const LatticeProblem& narrower) {
    LatticeState divided;
    std::vector<long> from;
    const auto& middle = narrower.lattice().middle;
    for (long i = 0; i < long(state.strips.size()); ++i) {
        long own = state.strips[i];
        for (long k = 0; k < middle.size(); ++k)
            if (narrower.lines.near(k) && 2.0 * std::abs(middle(k) - wider.middle(own)) < wider.width(own))
                divided.strips.push_back(k), from.push_back(i);
    }
    divided.values = Array<double, 2>(long(from.size()), state.values.shape[1]);
    for (std::size_t i = 0; i < from.size(); ++i)
        std::copy(state.values[from[i]].begin(), state.values[from[i]].end(), divided.values[long(i)].begin());
    return divided;
}

}  // namespace wr
