// Python's face of surfaces and searches for contacts.
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include "contact/geometry/core/interpenetration.hpp"
#include "contact/geometry/core/overlap.hpp"
#include "contact/geometry/core/surface.hpp"
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

namespace {

using Complex = View<const std::complex<double>, 1>;

Pose<double> pose(const Numbers& origin, const Rows& rotation, double plan) {
    require(origin.size() == 3 && rotation.shape == std::array<long, 2>{3, 3}, "pose: must be (3,) and (3, 3)");
    return pose_of(origin, rotation, plan);
}

Array<double, 1> copied(const std::array<double, HALF>& values) {
    Array<double, 1> a(HALF);
    std::copy(values.begin(), values.end(), a.begin());
    return a;
}

// Places s, x (n,) m across and along.
void require_places(const Numbers& s, const Numbers& x) { require(s.size() == x.size(), "x: must be as long as s"); }

void bind_surfaces(nb::module_& m) {
    structure<SurfaceData>(m, "SurfaceData", {"revolves", "wheel", "rail", "radius", "upper", "lower"},
                           "Surfaces of a pair: whether the upper one is a wheel's profile revolved about y, on an "
                           "extruded rail, else quadrics; profiles wheel and rail; radius m of the wheel; coefficients "
                           "upper and lower (2,) 1/m of quadrics along x and across.");
    structure<Motion>(
        m, "Motion", {"origin", "rotation", "plan", "wheel", "rail", "speed"},
        "Pose of the upper body, origin (3,) m and rotation (3, 3), on a rail with the curvature plan 1/m in "
        "plan, velocity fields of both bodies, and "
        "the rolling speed m/s; 0 without friction.");
    structure<Penetration>(m, "Penetration", {"depth", "slope", "foot"},
                           "Penetration at n points: depth (n,) m, -inf beyond the ends of the rail; its derivative "
                           "slope (n,) along x; foot (n,) m, arc length of the closest points on the lower body.");
    m.def(
        "penetration",
        [](const SurfaceData& surface, const Numbers& origin, const Rows& rotation, double plan, const Numbers& s,
           const Numbers& x) {
            require_places(s, x);
            return penetration(surface, pose(origin, rotation, plan), s, x);
        },
        "surface"_a, "origin"_a, "rotation"_a, "plan"_a, "s"_a, "x"_a, Unlocked(),
        "`Penetration` of points s, x (n,) m across and along, at a pose (3,) m and (3, 3).");
    m.def(
        "crests",
        [](const SurfaceData& surface, const Numbers& origin, const Rows& rotation, double plan, const Numbers& s) {
            return crests(surface, pose(origin, rotation, plan), s);
        },
        "surface"_a, "origin"_a, "rotation"_a, "plan"_a, "s"_a, Unlocked(),
        "Largest penetration on the lines s (n,) m at a pose (3,) m and (3, 3), its place (n,) m along x and the "
        "relative curvature (n,) 1/m there.");
    m.def(
        "touching_changes",
        [](const SurfaceData& surface, const Motion& motion, const Numbers& s, const Numbers& x, const Numbers& feet) {
            require_places(s, x);
            require(feet.size() == s.size(), "feet: must be as long as s");
            return touching_changes(surface, motion, s, x, feet);
        },
        "surface"_a, "motion"_a, "s"_a, "x"_a, "feet"_a, Unlocked(),
        "Derivatives (n, 6) by the pose of the places of `crests` along x, and of the closest points on the lower "
        "body: lines s and places x (n,) m of the largest penetration on them, feet (n,) m of the closest points.");
    m.def(
        "wheel_points",
        [](const Shape& wheel, double radius, const Numbers& origin, const Rows& rotation, double plan,
           const Numbers& s, const Numbers& x) {
            require_places(s, x);
            return wheel_points(wheel, radius, pose(origin, rotation, plan), s, x);
        },
        "wheel"_a, "radius"_a, "origin"_a, "rotation"_a, "plan"_a, "s"_a, "x"_a, Unlocked(),
        "Points (n, 3) m and axes (n, 3, 3) at s, x (n,) m on a wheel of a radius m at a pose (3,) m and (3, 3), s "
        "limited to the profile's ends.");
    m.def(
        "stretched", [](const Shape& wheel, double radius, const Numbers& s) { return stretched(wheel, radius, s); },
        "wheel"_a, "radius"_a, "s"_a, Unlocked(),
        "Length on the surface of a wheel of a radius m at s (n,) m over length on the rolling circle.");
    m.def(
        "profile_places",
        [](const Shape& wheel, const Shape& rail, const Numbers& s, const Rows& points) {
            require(points.shape == std::array<long, 2>{s.size(), 3}, "points: must be (n, 3)");
            return profile_places(wheel, rail, s, points);
        },
        "wheel"_a, "rail"_a, "s"_a, "points"_a, Unlocked(),
        "Arc lengths and lateral positions (n, 2) m of points (n, 3) m on the profiles of wheel and rail, whose "
        "closest "
        "points are taken; s (n,) m, arc lengths on the wheel, limited to its ends.");
}

std::tuple<double, double, double> numbers(const Extremum<>& at) { return {at.s, at.depth, at.x}; }

// Lines of a pair, and a range of lines.
void require_lines(const Shape& rail, const Lines& lines, const Part& part) {
    require(lines.of(rail), "lines: must be those of the rail");
    require(0 <= part.first && part.first < part.second && part.second <= lines.s.size(), "part: must be of the lines");
}
void require_scan(const Shape& rail, const Lines& lines, const Part& part, const Scan& samples) {
    require_lines(rail, lines, part);
    require(samples.depth.size() == lines.s.size() && samples.of(rail), "samples: must be those of lines and rail");
}

// Weights of maxima, and their derivatives by every parameter.
auto weights(const Rows& top, const Rows& low, double merge, const Blocks& by_top, const Blocks& by_low) {
    long k = top.size(), between = std::max(k - 1, 0L), q = by_top.shape[2];
    require(top.shape[1] == 3 && low.shape == std::array<long, 2>{between, 3} &&
                by_top.shape == std::array<long, 3>{k, 3, q} && by_low.shape == std::array<long, 3>{between, 3, q},
            "top, low, by_top, by_low: must be (k, 3), (k - 1, 3), (k, 3, q), (k - 1, 3, q)");
    auto values_of = [&](const Rows& rows, const Blocks& by, auto made, long along) {
        using T = decltype(made);
        std::vector<Extremum<T>> all(rows.size());
        auto number = [&](long i, int c) { return variable<T>(rows(i, c), 0, along < 0 ? 0.0 : by(i, c, along)); };
        for (long i = 0; i < rows.size(); ++i) all[i] = {number(i, 0), number(i, 1), number(i, 2)};
        return all;
    };
    auto of = [&](auto made, long along) {
        using T = decltype(made);
        auto tops = values_of(top, by_top, made, along), lows = values_of(low, by_low, made, along);
        return merging_weights<T>(tops, lows, merge);
    };
    Array<double, 1> weight(k);
    Array<double, 2> by_weight(k, q);
    auto plain = of(0.0, -1);
    std::copy(plain.begin(), plain.begin() + k, weight.begin());
    for (long c = 0; c < q; ++c) {
        auto all = of(Dual<1>(), c);
        for (long i = 0; i < k; ++i) by_weight(i, c) = all[i].d[0];
    }
    return std::tuple{weight, by_weight};
}

void bind_searches(nb::module_& m) {
    structure<Box>(m, "Box", {"side", "low", "high"},
                   "Bounds of some lines: lateral position nearest to the ordinary lines, smallest and largest z, m.");
    structure<Lines>(
        m, "Lines",
        {"s", "point", "tangent", "rail_tangent", "rail_curvature", "first", "stop", "flange", "field", "widest",
         "outline"},
        "Lines of the wheel's whole profile on which the penetration is sampled, complex numbers y + iz: s "
        "(n,) m, arc lengths on the wheel's profile; point and tangent (n,) m and 1 there; rail_tangent and "
        "rail_curvature (m,) 1 and 1/m at the rail's samples, positive where it is convex; first and stop "
        "of the ordinary lines, which are always looked at; flange and field, bounds of the lines before "
        "first, and from stop on; widest m, largest distance of a line from y = 0; outline (4, m) m, "
        "lateral positions of the rail's samples, increasing, heights, largest heights up to there and "
        "from there on.");
    structure<Scan>(m, "Scan", {"depth", "slope", "x", "sample"},
                    "Penetration (n,) m, its slope, x m, and the rail's nearest sample, -1 beside the rail, at every "
                    "line.");
    structure<WheelRegions>(m, "WheelRegions",
                            {"approach", "beyond", "top", "low", "edges", "contacts", "contact", "strips"},
                            "Regions of a wheel on a rail, with what they consist of: approach m, largest penetration, "
                            "without, minus the gap; beyond, whether the penetration reaches an end of a profile, is "
                            "larger than that of all maxima, or the wheel lies inside the rail; maxima top (k, 3) m: "
                            "position, penetration and x; minima low (k - 1, 3) m between them; edges (h,) m, outer "
                            "ends of the halves of regions; contacts (c, 4) m: position, x, penetration, and weight; "
                            "contact (n,) of each strip; strips (n, 5) m: position, x, width, penetration of the "
                            "virtual bodies, and radius along x.");
    m.def(
        "lines_to_scan",
        [](const Lines& lines, double radius, const Numbers& origin, const Rows& rotation, double plan, double margin) {
            return lines_to_scan(lines, radius, pose(origin, rotation, plan), margin);
        },
        "lines"_a, "radius"_a, "origin"_a, "rotation"_a, "plan"_a, "margin"_a = 0.0, Unlocked(),
        "First of the lines that may come closer to the rail at a pose (3,) m and (3, 3) than a margin m, 0 if they "
        "overlap it, and one past the last: the ordinary ones, and all before or after them unless bounds of their "
        "places show that they do not; radius m.");
    m.def(
        "scan",
        [](const Shape& rail, const Lines& lines, double radius, const Numbers& origin, const Rows& rotation,
           double plan, const Part& part) {
            require_lines(rail, lines, part);
            return scan(rail, lines, radius, pose(origin, rotation, plan), part);
        },
        "rail"_a, "lines"_a, "radius"_a, "origin"_a, "rotation"_a, "plan"_a, "part"_a, Unlocked(),
        "Penetration at some lines of a wheel of a radius m at a pose (3,) m and (3, 3), to about 1e-9 m; beside the "
        "rail minus the distance from its end. part: the first of the lines, and one past the last; others are left "
        "out.");
    m.def(
        "local_maxima",
        [](const Shape& wheel, const Shape& rail, double radius, const Numbers& origin, const Rows& rotation,
           double plan, const Numbers& lines, const Scan& samples) {
            require(samples.depth.size() == lines.size() && samples.of(rail),
                    "samples: must be those of lines and rail");
            auto found = local_maxima({wheel, rail, radius}, pose(origin, rotation, plan), lines, samples);
            Array<long, 1> before(long(found.before.size()));
            std::copy(found.before.begin(), found.before.end(), before.begin());
            return std::tuple{rows_of(found.top), rows_of(found.low), before, found.approach};
        },
        "wheel"_a, "rail"_a, "radius"_a, "origin"_a, "rotation"_a, "plan"_a, "lines"_a, "samples"_a, Unlocked(),
        "Maxima (n, 3) of the penetration, minima (n - 1, 3) between them, line (n,) before each maximum, and largest "
        "penetration m, of a wheel at a pose (3,) m and (3, 3), from a scan on lines (m,) m. Columns: position, "
        "penetration and x, m. A gap between two maxima has the penetration 0.");
    m.def(
        "nearest_place",
        [](const Shape& wheel, const Shape& rail, double radius, const Numbers& origin, const Rows& rotation,
           double plan, const Lines& lines, const Part& part, const Scan& samples) {
            require_scan(rail, lines, part, samples);
            return numbers(nearest_place({wheel, rail, radius}, pose(origin, rotation, plan), lines, part, samples));
        },
        "wheel"_a, "rail"_a, "radius"_a, "origin"_a, "rotation"_a, "plan"_a, "lines"_a, "part"_a, "samples"_a,
        Unlocked(),
        "Position s m on the wheel's profile, penetration and x m where the penetration is largest, at a pose (3,) m "
        "and (3, 3); separated surfaces have minus their gap. part: first of the lines that may overlap the rail, and "
        "one past the last; samples: their scan.");
    m.def(
        "overlap",
        [](const Shape& wheel, const Shape& rail, double radius, const Numbers& origin, const Rows& rotation,
           double plan, const Lines& lines, const std::string& wheel_name, const std::string& rail_name) {
            require(lines.of(rail), "lines: must be those of the rail");
            return overlap({wheel, rail, radius}, pose(origin, rotation, plan), lines, wheel_name, rail_name);
        },
        "wheel"_a, "rail"_a, "radius"_a, "origin"_a, "rotation"_a, "plan"_a, "lines"_a, "wheel_name"_a, "rail_name"_a,
        Unlocked(), "Message on interpenetration beyond the solved regions; others as for `wheel_regions`.");
    m.def(
        "wheel_regions",
        [](const Shape& wheel, const Shape& rail, double radius, const Numbers& origin, const Rows& rotation,
           double plan, const Lines& lines, double merge) {
            require(lines.of(rail), "lines: must be those of the rail");
            return wheel_regions({wheel, rail, radius}, pose(origin, rotation, plan), lines, merge);
        },
        "wheel"_a, "rail"_a, "radius"_a, "origin"_a, "rotation"_a, "plan"_a, "lines"_a, "merge"_a, Unlocked(),
        "Regions of a wheel at a pose (3,) m and (3, 3); maxima of the penetration, which is sampled on the lines, "
        "closer than merge m are one contact.");
    m.def("merging_weights", &weights, "top"_a, "low"_a, "merge"_a, "by_top"_a, "by_low"_a, Unlocked(),
          "Weight (k,) of each maximum as a contact, and its derivatives (k, q) by q parameters: maxima top (k, 3) and "
          "minima low (k - 1, 3) between them, position, penetration, x, m; by_top (k, 3, q) and by_low (k - 1, 3, q), "
          "their derivatives; maxima closer than merge m are one contact.");
    m.def(
        "covered",
        [](double depth, double valley, double away, double merge) {
            using T = Dual<3>;
            auto at = covered(variable<T>(depth, 0), variable<T>(valley, 1), variable<T>(away, 2), merge);
            return std::tuple{at.v, at.d[0], at.d[1], at.d[2]};
        },
        "virtual"_a, "valley"_a, "away"_a, "merge"_a,
        "Virtual penetration m that a place behind a minimum has in the region of another maximum, and its "
        "derivatives: penetration m of the virtual bodies there, and at the lowest minimum on the way; distance m from "
        "the maximum of the region; places closer than merge m belong to the region.");
    m.attr("TOO_DEEP") = TOO_DEEP, m.attr("UNSOLVED") = UNSOLVED;
    m.def(
        "overlap_text",
        [](double depth, Numbers place, const std::string& reason) {
            require(place.size() == 2, "place: must be (2,)");
            return overlap_text(depth, {place(0), place(1)}, reason);
        },
        "depth"_a, "place"_a, "reason"_a,
        "Text on an overlap that is not solved: its depth m, place (2,) m on the wheel's profile, and the reason.");
    m.def("overloaded", &overloaded, "approach"_a, "pressure"_a, "modulus"_a,
          "Text on bodies with a contact modulus Pa that are pressed together by an approach m and a largest pressure "
          "Pa; "
          "empty where these are no reason not to solve.");
    m.attr("VIRTUAL") = VIRTUAL;
    m.def(
        "half_strips", [] { return std::tuple{copied(POSITIONS), copied(WIDTHS)}; },
        "Positions and widths (8,) from 0 to 1 of the strips of half a region, denser at the maximum.");
}

}  // namespace

void bind_geometry(nb::module_& m) {
    bind_surfaces(m);
    bind_searches(m);
}
