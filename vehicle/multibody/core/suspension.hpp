// Forces of suspension elements and rotational springs: docs/theory/multibody.md.
#pragma once
#include <cmath>

#include "vehicle/multibody/core/bodies.hpp"

namespace wr {

// Piecewise linear law, linear beyond its points, too; an odd one is given for positive values.
struct Law {
    bool odd;
    std::vector<double> values, forces;

    template <class T>
    T operator()(const T& x) const {
        bool mirrored = odd && value(x) < 0.0;
        T at = mirrored ? -x : x;
        std::size_t i = 0, last = values.size() - 2;
        while (i < last && value(at) >= values[i + 1]) ++i;
        double slope = (forces[i + 1] - forces[i]) / (values[i + 1] - values[i]);
        std::size_t point = values[i] >= 0.0 ? i : i + 1;  // the end nearer to zero: mirrored laws agree bit for bit
        T force = slope * (at - values[point]) + forces[point];
        return mirrored ? -force : force;
    }

    // Integral of the force from 0, J.
    double energy(double x) const {
        double at = odd ? std::abs(x) : x, sum = 0.0, from = 0.0;
        auto area = [&](double end) { return 0.5 * ((*this)(from) + (*this)(end)) * (end - from); };
        for (std::size_t i = 1; i + 1 < values.size(); ++i) {
            double kink = at > 0.0 ? values[i] : values[values.size() - 1 - i];
            if ((at > 0.0) == (kink > from) && kink != from && std::abs(kink) < std::abs(at))
                sum += area(kink), from = kink;
        }
        return sum + area(at);
    }
};

// Slider in series with a spring, which it bounds to a force. Sliders stay where they are within a step; see
// slider.hpp.
struct Friction {
    int slider;        // number of the internal variable, the deflection m at which the spring is unloaded; -1: none
    double stiffness;  // N/m
    double limit;      // N
    double share;      // of the vertical spring force of the element, in addition
};

// Mass that moves with the damper of a Maxwell element, as air in the surge pipe of an air spring.
struct Surge {
    int flow;         // number of the internal variable, the velocity m/s of the mass; -1: none
    double mass;      // kg
    double exponent;  // of the velocity in the force of the damper
};

// Spring and damper along an axis of an element; in series with a spring the damper is a Maxwell element.
struct Direction {
    double spring, damper;       // N/m and N s/m; 0 where there is a law
    int spring_law, damper_law;  // -1: none; of a Maxwell element the law of velocity over force
    int series;                  // number of the Maxwell element; -1: none
    double series_stiffness;     // N/m
    Friction friction;
    Surge surge;
};

struct Element {
    int upper, lower;                  // bodies
    Vec<double> upper_arm, lower_arm;  // m, of the points from the bodies' centres, in their axes
    double turn;                       // part of the rotation from the lower to the upper body that the axes make
    double static_load;                // N
    double length;                     // m, of a rod between two points, along which directions[0] acts; 0: none
    std::array<Direction, 3> directions;
};

struct RotationalSpring {
    int upper, lower;
    Vec<double> stiffness, damping;  // N m/rad and N m s/rad
};

// Internal variables of an element by direction: spring deflections m of Maxwell elements, places m of sliders, and
// velocities m/s of surging masses.
template <class T>
struct Internal {
    Vec<T> series;
    Vec<double> slider, flow;
};

// Force N of a damper that moves a mass, at its velocity m/s.
template <class T>
T surge_force(const Direction& d, const std::vector<Law>& laws, const T& velocity) {
    using std::pow;
    if (d.damper_law >= 0) return laws[d.damper_law](velocity);
    if (d.surge.exponent == 1.0 || value(velocity) == 0.0)
        return d.surge.exponent == 1.0 ? d.damper * velocity : T(0.0);
    return value(velocity) > 0.0 ? d.damper * pow(velocity, d.surge.exponent)
                                 : -(d.damper * pow(-velocity, d.surge.exponent));
}

// An element in motion: deflection m, its rate m/s and the force N on the upper body in its own axes, with the rates
// m/s of its Maxwell elements' springs and the largest friction N; force N on the upper body and moments N m about both
// bodies' centres in common axes.
template <class T>
struct ElementState {
    Vec<T> deflection, deflection_rate, own_force, series_rate, friction_limit, force, on_upper, on_lower;
};

// Largest friction N of a direction under a vertical spring force N.
template <class T>
T friction_limit(const Friction& f, const T& load) {
    return value(load) > 0.0 ? f.limit + f.share * load : T(f.limit);
}

// Whether a slider is drawn along by its spring: beyond the limit or, within its last digits, in motion away from it.
inline bool slides(double spring, double limit, double rate) {
    double excess = std::abs(spring) - limit, edge = 1e-8 * limit;
    return excess > edge || (excess > -edge && spring * rate > 0.0);
}

// Force N of a spring in series with a slider at a deflection m and its rate m/s.
template <class T>
T friction_force(const Friction& f, const T& x, const T& rate, double slider, const T& limit) {
    T spring = f.stiffness * (x - slider);
    if (!slides(value(spring), value(limit), value(rate))) return -spring;
    return value(spring) > 0.0 ? -limit : limit;
}

template <class T>
T direction_force(const Direction& d, const std::vector<Law>& laws, const T& x, const T& rate, const T& series,
                  double flow, T& series_rate) {
    T force = -d.spring * x;
    if (d.series < 0) force -= d.damper * rate;
    if (d.spring_law >= 0) force -= laws[d.spring_law](x);
    if (d.series < 0) return d.damper_law >= 0 ? force - laws[d.damper_law](rate) : force;
    T tension = d.series_stiffness * series;
    if (d.surge.flow >= 0)
        series_rate = rate - flow;
    else
        series_rate = rate - (d.damper_law >= 0 ? laws[d.damper_law](tension) : tension / d.damper);
    return force - tension;
}

// Adds the forces of sliders; those that depend on the vertical spring force, by its present value.
template <class T>
void add_friction(const Element& e, const std::vector<Law>& laws, const Vec<double>& slider, ElementState<T>& s) {
    const auto& d = e.directions;
    if (d[0].friction.slider < 0 && d[1].friction.slider < 0 && d[2].friction.slider < 0) return;
    T load = e.static_load - d[2].spring * s.deflection.z;
    if (d[2].spring_law >= 0) load -= laws[d[2].spring_law](s.deflection.z);
    auto add = [&](int j, const T& x, const T& rate, double place, T& limit, T& force) {
        if (d[j].friction.slider < 0) return;
        limit = friction_limit(d[j].friction, load);
        force += friction_force(d[j].friction, x, rate, place, limit);
    };
    const auto &x = s.deflection, &rate = s.deflection_rate;
    add(0, x.x, rate.x, slider.x, s.friction_limit.x, s.own_force.x);
    add(1, x.y, rate.y, slider.y, s.friction_limit.y, s.own_force.y);
    add(2, x.z, rate.z, slider.z, s.friction_limit.z, s.own_force.z);
}

// Bearings transmit no moment about the axle of a wheelset.
template <class T>
void without_bearing_moment(const Motion<T>& lower, bool wheelset, Vec<T>& on_lower) {
    if (wheelset) on_lower = on_lower - dot(on_lower, lower.axes.y) * lower.axes.y;
}

// A rod: its length between the points less the nominal one is the deflection.
template <class T>
void along_line(const Element& e, const std::vector<Law>& laws, const Vec<T>& gap, const Vec<T>& gap_rate,
                const Internal<T>& internal, ElementState<T>& s) {
    using std::sqrt;
    T size = sqrt(dot(gap, gap));
    auto along = (1.0 / size) * gap;
    s.deflection.x = size - e.length, s.deflection_rate.x = dot(along, gap_rate);
    s.own_force.x = direction_force(e.directions[0], laws, s.deflection.x, s.deflection_rate.x, internal.series.x,
                                    internal.flow.x, s.series_rate.x);
    add_friction(e, laws, internal.slider, s);
    s.force = s.own_force.x * along;
}

template <class T>
ElementState<T> element_state(const Element& e, const std::vector<Law>& laws, const Motion<T>& upper,
                              const Motion<T>& lower, bool wheelset, const Internal<T>& internal) {
    auto on_upper = upper.axes * e.upper_arm, on_lower = lower.axes * e.lower_arm;
    auto place = lower.position + on_lower, gap = upper.position + on_upper - place;
    auto gap_rate = upper.velocity + cross(upper.rate, on_upper) - (lower.velocity + cross(lower.rate, on_lower));
    if (e.length > 0.0) {
        ElementState<T> s{};
        along_line(e, laws, gap, gap_rate, internal, s);
        s.on_upper = cross(on_upper, s.force), s.on_lower = cross(on_lower, s.force);
        without_bearing_moment(lower, wheelset, s.on_lower);
        return s;
    }
    auto axes = e.turn == 0.0 ? lower.axes
                : e.turn == 1.0
                    ? upper.axes
                    : lower.axes * rotation_matrix(e.turn * rotation_vector(relative(lower.axes, upper.axes)));
    auto axes_rate = (1.0 - e.turn) * lower.rate + e.turn * upper.rate;
    auto x = back(axes, gap), rate = back(axes, gap_rate - cross(axes_rate, gap));
    const auto& [series, slider, flow] = internal;
    const auto& d = e.directions;
    ElementState<T> s{x, rate, {}, {}, {}, {}, {}, {}};
    s.own_force = {direction_force(d[0], laws, x.x, rate.x, series.x, flow.x, s.series_rate.x),
                   direction_force(d[1], laws, x.y, rate.y, series.y, flow.y, s.series_rate.y),
                   direction_force(d[2], laws, x.z, rate.z, series.z, flow.z, s.series_rate.z) + e.static_load};
    add_friction(e, laws, slider, s);
    s.force = axes * s.own_force;
    auto point = place + (1.0 - e.turn) * gap;
    s.on_upper = cross(point - upper.position, s.force), s.on_lower = cross(point - lower.position, s.force);
    without_bearing_moment(lower, wheelset, s.on_lower);
    return s;
}

// Moment N m on the upper body, in common axes, of the potential r.K r / 2 of rotation vectors r, and of dampers.
template <class T>
Vec<T> spring_moment(const RotationalSpring& spring, const Motion<T>& upper, const Motion<T>& lower) {
    auto turned = rotation_vector(relative(lower.axes, upper.axes));
    auto moment = lower.axes * (-1.0 * moment_of_gradient(turned, times(spring.stiffness, turned)));
    const auto& c = spring.damping;
    if (c.x == 0.0 && c.y == 0.0 && c.z == 0.0) return moment;
    return moment - lower.axes * times(c, back(lower.axes, upper.rate - lower.rate));
}

}  // namespace wr
