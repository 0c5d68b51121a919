// Undeformed surfaces of a pair, their penetration and rigid slip at points of strips.
//
// Functions of one point are templates: with a pose, or an x, of dual numbers they give derivatives as well.
#pragma once
#include "contact/geometry/core/rigid_search.hpp"

namespace wr {

constexpr double GAUSS = 0.2886751345948129;  // 0.5 / sqrt(3) of a strip's width, from its middle
constexpr double OPPOSED = -0.5;  // cosine between normals of surfaces that may touch, 0.1 rad apart at most
constexpr int POSE = 6;           // motions of a rigid body

// Surfaces of a pair.
struct SurfaceData {
    bool revolves =
        true;  // whether the upper one is a wheel's profile revolved about y, on an extruded rail; else quadrics
    Shape wheel, rail;     // profiles; of one point each for quadrics
    double radius = 1.0;   // of the wheel, m
    Numbers upper, lower;  // (2,) 1/m, coefficients of quadrics along x and across

    auto fields() { return std::tie(revolves, wheel, rail, radius, upper, lower); }
    bool fits() const { return wheel.fits() && rail.fits() && upper.size() == 2 && lower.size() == 2; }
    WheelRail pair() const { return {wheel, rail, radius}; }
};

// Pose of the upper body, velocity fields of both, and the rolling speed.
struct Motion {
    Numbers origin;             // (3,) m
    Rows rotation;              // (3, 3)
    double plan = 0.0;          // 1/m, of a rail, see `Pose`
    VelocityField wheel, rail;  // v + w x (X - reference)
    double speed = 0.0;         // m/s; 0 without friction

    auto fields() { return std::tie(origin, rotation, plan, wheel, rail, speed); }
    bool fits() const {
        return origin.size() == 3 && rotation.shape == std::array<long, 2>{3, 3} && wheel.fits() && rail.fits();
    }
    Pose<double> pose() const { return pose_of(origin, rotation, plan); }
    RigidMotion<double> velocities() const { return {wheel.twist(), rail.twist()}; }
};

// Penetration at n points.
struct Penetration {
    Array<double, 1> depth;  // (n,) m; -inf beyond the ends of the rail
    Array<double, 1> slope;  // (n,) its derivative along x
    Array<double, 1> foot;   // (n,) m, arc length of the closest points on the lower body

    Penetration() = default;
    explicit Penetration(long n) : depth(n), slope(n), foot(n) {}
    auto fields() { return std::tie(depth, slope, foot); }
};

// Points (n, 3) m of the upper body and its axes (n, 3, 3) there: longitudinal, lateral and outward; forward (n, 3):
// change of the points along x; turn (3,) rad/m: rotation of the axes along x.
struct SurfaceFrames {
    Array<double, 2> point;
    Array<double, 3> axes;
    Array<double, 2> forward;
    Array<double, 1> turn;

    SurfaceFrames() = default;
    explicit SurfaceFrames(long n) : point(n, 3), axes(n, 3, 3), forward(n, 3), turn(3) {}
    auto fields() { return std::tie(point, axes, forward, turn); }
    bool fits() const {
        long n = point.size();
        return point.shape[1] == 3 && axes.shape == std::array<long, 3>{n, 3, 3} && forward.shape == point.shape &&
               turn.size() == 3;
    }
    long size() const { return point.size(); }
};

// Walk from point to point of strips, with reuse of data shared by neighbours; fastest where they share s.
struct Walk {
    const SurfaceData& surface;
    long sample = -1;  // nearest one of the rail
    double last = std::numeric_limits<double>::infinity();
    OnCurve<double> at{};  // on the wheel's profile

    explicit Walk(const SurfaceData& own) : surface(own) {}
    void to(double s) {
        if (!surface.revolves || s == last) return;
        at = local(surface.wheel, s);
        if (!(std::abs(s - last) < NEXT)) sample = -1;
        last = s;
    }
};

// Place of the upper body at s, x m across and along.
template <class P, class X>
auto place_at(Walk& walk, const Pose<P>& pose, double s, const X& x) {
    using T = decltype(P{} * X{});
    walk.to(s);
    if (walk.surface.revolves) return Place<T>(on_circle(walk.at, walk.surface.radius, pose, x));
    return Place<T>{{T(x), T(s), T(0.0)}, {T(1.0), T(0.0), T(0.0)}, {T(0.0), T(0.0), T(-1.0)}};
}

// A point of the upper body, projected on the lower one.
template <class T>
struct Projection {
    T depth{};  // m, penetration; -inf beyond the ends of the rail, and where the surfaces do not face each other
    T foot{};   // m, arc length of the closest point
    long sample = -1;  // nearest one of the rail
};

// Projection of a place of a wheel; sample: that nearest to a neighbour, -1 without one. With the closest point r of
// the rail, (q - r) r' = 0, and the wheel's normal w the penetration is (q - r) w.
template <class T>
Projection<T> project(const Shape& rail, const Place<T>& place, long sample) {
    Point<T> q{place.point.y, place.point.z}, w{place.normal.y, place.normal.z};
    sample = sample_from(rail, value(q), sample);
    auto found = foot(rail, value(q), rail.samples(sample));
    auto on = local(rail, found.s, found.piece);
    T change = foot_change(on, q);
    Point<T> away = q - on.point;
    if constexpr (!std::is_same_v<T, double>) away = away - change * on.tangent;
    Projection<T> at{dot(away, w), found.s + change, sample};
    // beside the rail, and for surfaces that face the same way, as a flange's back and a gauge face: no contact
    if (!(found.inside && cross(on.tangent, value(w)) < OPPOSED)) {
        T none(-std::numeric_limits<double>::infinity());
        if constexpr (!std::is_same_v<T, double>) std::copy(std::begin(at.depth.d), std::end(at.depth.d), none.d);
        at.depth = none;
    }
    return at;
}

// Penetration at s, x m across and along.
template <class P, class X>
auto penetration_at(Walk& walk, const Pose<P>& pose, double s, const X& x) {
    using T = decltype(P{} * X{});
    const SurfaceData& own = walk.surface;
    if (!own.revolves) {
        T dx = x - pose.origin.x;
        P ds = s - pose.origin.y;
        return Projection<T>{-pose.origin.z - own.upper(0) * dx * dx - own.upper(1) * ds * ds - own.lower(0) * x * x -
                                 own.lower(1) * s * s,
                             T(s), -1};
    }
    walk.to(s);
    Projection<T> at = project<T>(own.rail, seen_on_circle(walk.at, own.radius, pose, x), walk.sample);
    walk.sample = at.sample;
    return at;
}

// `Penetration` of points s, x (n,) m across and along.
inline Penetration penetration(const SurfaceData& surface, const Pose<double>& pose, const Numbers& s,
                               const Numbers& x) {
    Penetration result(s.size());
    Walk walk(surface);
    for (long i = 0; i < s.size(); ++i) {
        auto at = penetration_at(walk, pose, s(i), variable<Dual<1>>(x(i), 0));
        result.depth(i) = at.depth.v, result.slope(i) = at.depth.d[0], result.foot(i) = at.foot.v;
    }
    return result;
}

// Largest penetration on the lines s (n,) m, its place (n,) m along x and the relative curvature (n,) 1/m there.
//
// Penetration is largest where the wheel's circle is parallel to the rail: where its tangent has no component along the
// rail's normal. Fastest where neighbours follow each other.
inline std::tuple<Penetration, Array<double, 1>, Array<double, 1>> crests(const SurfaceData& surface,
                                                                          const Pose<double>& pose, const Numbers& s) {
    long n = s.size(), sample = -1;
    Array<double, 1> x(n), bend(n);
    std::vector<long> again;
    double radius = surface.radius, a = surface.upper(0), b = surface.lower(0);
    for (long i = 0; i < n; ++i) {
        if (!surface.revolves) {
            x(i) = pose.origin.x * a / (a + b), bend(i) = 2 * (a + b);
            continue;
        }
        auto line = local(surface.wheel, s(i));
        double r = line.point.z + radius;
        if (pose.rotation.x.y != 0.0 || pose.plan != 0.0) {
            bool next = i > 0 && std::abs(s(i) - s(i - 1)) < NEXT;
            auto at = lowest(surface.rail, radius, pose, line, next ? x(i - 1) : 0.0, next ? sample : -1);
            x(i) = at.x, sample = at.sample;
            if (!at.ended) again.push_back(i);
        }
        bend(i) = std::max(r * level_share(line.tangent, r, pose.plan), 0.05 * r) / (radius * radius);
    }
    // from the other side: on a steep flange a search from a line whose own one has not ended may not end, either
    for (; !again.empty(); again.pop_back()) {
        long i = again.back(), next = std::min(i + 1, n - 1);
        auto at = lowest(surface.rail, radius, pose, local(surface.wheel, s(i)), x(next), -1);
        if (at.ended) x(i) = at.x;
    }
    return {penetration(surface, pose, s, x), x, bend};
}

// Points and axes at s, x (n,) m across and along.
inline SurfaceFrames frames(const SurfaceData& surface, const Pose<double>& pose, const Numbers& s, const Numbers& x) {
    SurfaceFrames places(s.size());
    Walk walk(surface);
    Vec<double> turn{};
    if (surface.revolves)
        turn = {-pose.rotation.y.x / surface.radius, -pose.rotation.y.y / surface.radius,
                -pose.rotation.y.z / surface.radius};
    auto store = [](const View<double, 1>& to, const Vec<double>& a) { to(0) = a.x, to(1) = a.y, to(2) = a.z; };
    store(places.turn, turn);
    for (long i = 0; i < s.size(); ++i) {
        auto at = place_at(walk, pose, s(i), x(i));
        write_frame(at, places.point, places.axes, i);
        store(places.forward[i], surface.revolves ? cross(turn, at.point - pose.origin) : Vec<double>{1.0, 0.0, 0.0});
    }
    return places;
}

// Derivatives (n, 6) by the pose of the places of `crests` along x, and of the closest points on the lower body: these
// move along x with the former, which depend on the normals at the latter. One more step of Newton's method for both.
//
// Parameters: s, x (n,) m, lines and places of the largest penetration on them; feet (n,) m, arc length of the closest
// points.
inline std::tuple<Array<double, 2>, Array<double, 2>> touching_changes(const SurfaceData& surface, const Motion& motion,
                                                                       const Numbers& s, const Numbers& x,
                                                                       const Numbers& feet) {
    Array<double, 2> crest(s.size(), POSE), foot(s.size(), POSE);
    auto moving = varied<Dual<POSE>>(motion.pose());
    for (long i = 0; i < s.size(); ++i) {
        if (!surface.revolves) {
            crest(i, 0) = surface.upper(0) / (surface.upper(0) + surface.lower(0));
            continue;
        }
        double angle = x(i) / surface.radius;
        auto line = local(surface.wheel, s(i));
        auto at = lowest_step(line, surface.radius, seen_line(line.point, surface.radius, moving), std::sin(angle),
                              std::cos(angle), local(surface.rail, feet(i)));
        for (int k = 0; k < POSE; ++k) crest(i, k) = surface.radius * at.turn.d[k], foot(i, k) = at.step.d[k];
    }
    return {crest, foot};
}

// Rigid tangential velocity m/s of the upper relative to the lower body, and the mean velocity of both in the
// longitudinal axes.
template <class T>
struct Shift {
    T along{}, across{}, flow{};
};

// Shift at a point with the axes along and across; level: longitudinal axis where the strip touches.
//
// Material flows along its own surface, and both surfaces end up in the common one: the velocity of the wheel counts
// along its circle, that of the rail, which is straight, along the level axis. Along the wheel's circle it would be
// smaller by x^2 / (2 R^2), as much as the creepage of a few per mille of saturation. The lateral axes turn along x,
// which is the spin of a conical wheel.
template <class T, class L, class M>
auto shift_at(const Vec<T>& point, const Vec<T>& along, const Vec<T>& across, const Vec<L>& level,
              const RigidMotion<M>& motion) {
    auto velocity = [&](const Twist<M>& of) { return of.velocity + cross(of.rotation, point - of.reference); };
    auto sum = [](const auto& a) { return a.x + a.y + a.z; };
    auto own = velocity(motion.wheel), other = velocity(motion.rail);
    using S = decltype(T{} * L{} * M{});
    return Shift<S>{sum(times(along, own) - times(level, other)), sum(times(across, own - other)),
                    sum(times(0.5 * along, own + other))};
}

}  // namespace wr
