// Python's face of curves, surfaces and rigid motions.
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>

#include "contact/geometry/core/surface.hpp"
#include "contact/kinematics/core/left_pair.hpp"
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

namespace {

using Unlocked = nb::call_guard<nb::gil_scoped_release>;
using Complex = View<const std::complex<double>, 1>;

void require(bool fits, const char* text) {
    if (!fits) throw nb::value_error(text);
}

Pose<double> pose(const Numbers& origin, const Rows& rotation) {
    require(origin.size() == 3 && rotation.shape == std::array<long, 2>{3, 3}, "pose: must be (3,) and (3, 3)");
    return pose_of(origin, rotation);
}

// Places s, x (n,) m across and along.
void require_places(const Numbers& s, const Numbers& x) { require(s.size() == x.size(), "x: must be as long as s"); }

void bind_curves(nb::module_& m) {
    structure<Shape>(m, "Shape", {"breaks", "middles", "table", "samples", "sampled", "hollow"},
                     "A curve of m pieces: breaks (m + 1,) and middles (m,) m in arc length, table (m, 3, 8) of "
                     "coefficients of y + iz and its first two derivatives, samples (n,) m and points y + iz sampled "
                     "(n,) m there, and whether it is hollow: has several closest points nearby.");
    m.def(
        "closest",
        [](const Shape& shape, const Complex& q, const Numbers& guess) {
            require(guess.size() == 0 || guess.size() == q.size(), "guess: must have a number for every point");
            return closest(shape, q, guess);
        },
        "shape"_a, "q"_a, "guess"_a, Unlocked(),
        "Arc lengths m, distances m (positive outwards) and whether inside (n,) of the closest points to points q (n,) "
        "m as y + iz, from arc lengths guess (n,) m, or (0,) for the nearest samples.");
}

void bind_kinematics(nb::module_& m) {
    structure<VelocityField>(m, "VelocityField", {"velocity", "rotation", "reference"},
                             "Velocity field v + w x (X - reference) of a body: (3,) m/s, rad/s and m.");
    structure<RigidVelocities>(m, "RigidVelocities",
                               {"wheel", "wheel_turn", "wheel_at", "rail", "rail_turn", "rail_at"},
                               "Rigid motion of wheel and rail: velocity m/s, angular velocity rad/s and reference "
                               "point m, (3,) each.");
    structure<WheelPairs>(
        m, "WheelPairs", {"origin", "rotation", "motion", "centre"},
        "Poses and motions of w wheels, each as that of a left-hand pair in the frame of its rail: "
        "origin (w, 3) m and rotation (w, 3, 3) of the wheels' frames; motion (w, 6, 3), in the order "
        "of `RigidVelocities`; centre (w, 3) m, reference points of moments.");
    m.def(
        "left_pairs",
        [](const Rows& states, const Dimensions& dimensions, bool mirror) {
            require(states.shape[1] == STATE, "states: must be (w, 17)");
            return left_pairs(states, dimensions, mirror);
        },
        "states"_a, "dimensions"_a, "mirror"_a, Unlocked(),
        "Pairs of one side of w wheelsets as left-hand ones, with moments about the wheelsets' centres: states (w, "
        "17), "
        "values of `WheelsetState`; dimensions m of a `Mounting`; mirror: whether the side is the right one.");
    m.def(
        "by_states",
        [](const Blocks& tangents, const Rows& wrenches, const Rows& states, double wheel_y, bool mirror) {
            long w = states.size();
            require(states.shape[1] == STATE && tangents.shape == std::array<long, 3>{w, 6, 12} &&
                        wrenches.shape == std::array<long, 2>{w, 6},
                    "tangents, wrenches, states: must be (w, 6, 12), (w, 6), (w, 17)");
            return by_states(tangents, wrenches, states, wheel_y, mirror);
        },
        "tangents"_a, "wrenches"_a, "states"_a, "wheel_y"_a, "mirror"_a, Unlocked(),
        "Derivatives (w, 6, 9) of forces and moments by coordinates of the wheelsets: tangents (w, 6, 12) about the "
        "wheelsets' centres, of the left-hand pairs; wrenches (w, 6) N and N m of the wheels themselves; states (w, "
        "17); wheel_y m; mirror: whether the wheels are the right ones.");
}

void bind_surfaces(nb::module_& m) {
    structure<SurfaceData>(m, "SurfaceData", {"revolves", "wheel", "rail", "radius", "upper", "lower"},
                           "Surfaces of a pair: whether the upper one is a wheel's profile revolved about y, on an "
                           "extruded rail, else quadrics; profiles wheel and rail; radius m of the wheel; coefficients "
                           "upper and lower (2,) 1/m of quadrics along x and across.");
    structure<Motion>(m, "Motion", {"origin", "rotation", "wheel", "rail", "speed"},
                      "Pose of the upper body, origin (3,) m and rotation (3, 3), velocity fields of both bodies, and "
                      "the rolling speed m/s; 0 without friction.");
    structure<Penetration>(m, "Penetration", {"depth", "slope", "foot"},
                           "Penetration at n points: depth (n,) m, -inf beyond the ends of the rail; its derivative "
                           "slope (n,) along x; foot (n,) m, arc length of the closest points on the lower body.");
    structure<PenetrationChanges>(m, "PenetrationChanges", {"depth", "foot"},
                                  "Derivatives (n, 6) of the penetration and of the closest points at n points by the "
                                  "pose of the wheel's frame.");
    structure<SurfaceFrames>(m, "SurfaceFrames", {"point", "axes", "forward", "turn"},
                             "Points (n, 3) m of the upper body and its axes (n, 3, 3) there: longitudinal, lateral "
                             "and outward; forward (n, 3): change of the points along x; turn (3,) rad/m: rotation of "
                             "the axes along x.");
    m.def(
        "penetration",
        [](const SurfaceData& surface, const Numbers& origin, const Rows& rotation, const Numbers& s,
           const Numbers& x) {
            require_places(s, x);
            return penetration(surface, pose(origin, rotation), s, x);
        },
        "surface"_a, "origin"_a, "rotation"_a, "s"_a, "x"_a, Unlocked(),
        "`Penetration` of points s, x (n,) m across and along, at a pose (3,) m and (3, 3).");
    m.def(
        "penetration_changes",
        [](const SurfaceData& surface, const Numbers& origin, const Rows& rotation, const Numbers& s,
           const Numbers& x) {
            require_places(s, x);
            return penetration_changes(surface, pose(origin, rotation), s, x);
        },
        "surface"_a, "origin"_a, "rotation"_a, "s"_a, "x"_a, Unlocked(),
        "`PenetrationChanges` at points s, x (n,) m across and along, at a pose (3,) m and (3, 3).");
    m.def(
        "crests",
        [](const SurfaceData& surface, const Numbers& origin, const Rows& rotation, const Numbers& s) {
            return crests(surface, pose(origin, rotation), s);
        },
        "surface"_a, "origin"_a, "rotation"_a, "s"_a, Unlocked(),
        "Largest penetration on the lines s (n,) m at a pose (3,) m and (3, 3), its place (n,) m along x and the "
        "relative curvature (n,) 1/m there.");
    m.def(
        "frames",
        [](const SurfaceData& surface, const Numbers& origin, const Rows& rotation, const Numbers& s,
           const Numbers& x) {
            require_places(s, x);
            return frames(surface, pose(origin, rotation), s, x);
        },
        "surface"_a, "origin"_a, "rotation"_a, "s"_a, "x"_a, Unlocked(),
        "Points and axes at s, x (n,) m across and along, at a pose (3,) m and (3, 3).");
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
        "rigid_shift",
        [](const SurfaceFrames& places, const Rows& level, const Motion& motion) {
            require(level.shape == places.point.shape, "level: must be (n, 3)");
            return rigid_shift(places, level, motion);
        },
        "places"_a, "level"_a, "motion"_a, Unlocked(),
        "Rigid tangential velocity (n, 2) m/s of the upper relative to the lower body, its derivative (n, 2) along x, "
        "and the mean velocity (n,) m/s of both in the longitudinal axes; level (n, 3): longitudinal axes where the "
        "strips touch.");
    m.def(
        "wheel_points",
        [](const Shape& wheel, double radius, const Numbers& origin, const Rows& rotation, const Numbers& s,
           const Numbers& x) {
            require_places(s, x);
            return wheel_points(wheel, radius, pose(origin, rotation), s, x);
        },
        "wheel"_a, "radius"_a, "origin"_a, "rotation"_a, "s"_a, "x"_a, Unlocked(),
        "Points (n, 3) m and axes (n, 3, 3) at s, x (n,) m on a wheel of a radius m at a pose (3,) m and (3, 3), s "
        "limited to the profile's ends.");
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

}  // namespace

void bind_geometry(nb::module_& m) {
    bind_curves(m);
    bind_kinematics(m);
    bind_surfaces(m);
}
