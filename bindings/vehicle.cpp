// Python's face of the equations of motion of a vehicle.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/vector.h>

#include "vehicle/multibody/core/derivatives.hpp"
#include "vehicle/multibody/core/energy.hpp"
#include "vehicle/multibody/core/slider.hpp"
#include "vehicle/simulation/core/excitation.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace wr;

// Vectors are three numbers in Python.
template <>
struct nb::detail::type_caster<Vec<double>> {
    using Numbers = make_caster<std::array<double, 3>>;
    NB_TYPE_CASTER(Vec<double>, Numbers::Name)

    bool from_python(handle source, uint8_t flags, cleanup_list* cleanup) noexcept {
        Numbers numbers;
        if (!numbers.from_python(source, flags, cleanup)) return false;
        const auto& [x, y, z] = numbers.value;
        value = {x, y, z};
        return true;
    }
};

namespace {

using Values = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using Result = nb::ndarray<nb::numpy, double>;
using Journey = std::array<double, 4>;  // distance m, speed m/s, acceleration m/s2, time s

Travel<double> travel_of(const Journey& j) { return {j[0], j[1], j[2], j[3]}; }

void require(const Values& values, std::size_t size, const char* name) {
    if (values.size() != size)
        throw nb::value_error((std::string(name) + ": must have " + std::to_string(size) + " values").c_str());
}

// Array of a shape that owns its values.
Result array(std::vector<double> values, std::initializer_list<std::size_t> shape) {
    auto* kept = new std::vector<double>(std::move(values));
    nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
    return Result(kept->data(), shape, owner);
}

template <int N>
using Results =
    std::conditional_t<N == 3, nb::typed<nb::tuple, Result, Result, Result>, nb::typed<nb::tuple, Result, Result>>;

template <class... R>
Results<sizeof...(R)> results(R... arrays) {
    return Results<sizeof...(R)>(nb::make_tuple(arrays...));
}

void store(double*& to, const Vec<double>& a) { *to++ = a.x, *to++ = a.y, *to++ = a.z; }

bool fits(const Track& t) {
    bool right = !t.pieces.empty() && t.pieces.size() == t.starts.size() && t.nodes.size() == t.weights.size();
    for (const auto& powers : t.pieces) right &= !powers.empty();
    return right;
}

// Raises ValueError: no function of a vehicle reads beyond its arrays.
void check_indices(const Vehicle& v) {
    auto within = [](int i, std::size_t size) { return i >= 0 && i < int(size); };
    auto body = [&](int i) { return within(i, v.bodies.size()); };
    auto law = [&](int i) { return i == -1 || within(i, v.laws.size()); };
    auto internal = [&](int i) { return i >= -1 && i < v.internal; };
    auto table = [](const Table& t) { return !t.places.empty() && t.places.size() == t.values.size(); };
    bool right = !v.bodies.empty() && (v.kept == -1 || body(v.kept)) && v.internal >= 0;
    for (const auto& e : v.elements) {
        right &= body(e.upper) && body(e.lower);
        for (const auto& d : e.directions)
            right &= law(d.spring_law) && law(d.damper_law) && internal(d.series) && internal(d.friction.slider) &&
                     internal(d.surge.flow) && (d.surge.flow < 0 || d.series >= 0);
    }
    for (const auto& [first, second] : v.pairs)
        right &= within(first, v.elements.size()) && (second == -1 || within(second, v.elements.size()));
    for (const auto& s : v.springs) right &= body(s.upper) && body(s.lower);
    for (const auto& t : v.torques) right &= body(t.wheelset) && body(t.reaction) && table(t.size);
    for (const auto& f : v.forces) {
        right &= body(f.body);
        for (const auto& t : f.components) right &= table(t);
    }
    for (const auto& l : v.laws) right &= l.values.size() > 1 && l.values.size() == l.forces.size();
    right &= fits(v.track);
    if (!right) throw nb::value_error("vehicle: an index or a length does not fit");
}

// Rows (n, 6, 3): position, axes, rotation per length and its derivative.
template <class SectionOf>
Result section_rows(std::size_t count, const SectionOf& section_of) {
    std::vector<double> rows(18 * count);
    double* to = rows.data();
    for (std::size_t i = 0; i < count; ++i) {
        Section<double> s = section_of(i);
        store(to, s.position), store(to, s.axes.x), store(to, s.axes.y), store(to, s.axes.z);
        store(to, s.rate), store(to, s.rate_slope);
    }
    return array(std::move(rows), {count, 6, 3});
}

Result sections(const Vehicle& v, double distance, Values state) {
    require(state, v.states(), "state");
    return section_rows(v.bodies.size(), [&](int i) { return v.section(i, distance, state.data()); });
}

Result accelerations(const Vehicle& v, const Journey& travel, Values state, Values sections, Values contacts) {
    require(state, v.states(), "state"), require(sections, 18 * v.bodies.size(), "sections");
    require(contacts, 6 * v.bodies.size(), "contacts");
    std::vector<double> results(v.accelerated());
    v.accelerations(travel_of(travel), state.data(), sections.data(), contacts.data(), results.data());
    return array(std::move(results), {std::size_t(v.accelerated())});
}

Results<3> derivatives(const Vehicle& v, const Journey& travel, const Journey& rates, Values state, Values contacts) {
    require(state, v.states(), "state"), require(contacts, 6 * v.bodies.size(), "contacts");
    VehicleDerivatives d(v, travel_of(travel), travel_of(rates), state.data(), contacts.data());
    std::size_t rows = v.accelerated(), columns = v.states();
    return results(array(std::move(d.by_state), {rows, columns}), array(std::move(d.by_time), {rows}),
                   array(std::move(d.by_wrench), {v.bodies.size(), 6, 6}));
}

// Position, velocity, axes and angular velocity (n, 6, 3), and force and moment (n, 2, 3) of suspension, loads and
// hold.
Results<2> motions(const Vehicle& v, const Journey& travel, Values state, Values sections) {
    require(state, v.states(), "state"), require(sections, 18 * v.bodies.size(), "sections");
    auto all = v.body_states(travel_of(travel), state.data(), sections.data());
    std::vector<double> rows(18 * all.size()), loads(6 * all.size()), rates(v.internal);
    double *to = rows.data(), *load = loads.data();
    for (const auto& at : all) {
        const auto& m = at.motion;
        store(to, m.position), store(to, m.velocity), store(to, m.axes.x), store(to, m.axes.y), store(to, m.axes.z);
        store(to, m.rate);
    }
    auto wrenches = v.wrenches(all, state.data(), rates.data());
    if (v.kept >= 0) wrenches[v.kept].force = wrenches[v.kept].force + v.hold(all[v.kept]) * all[v.kept].section.axes.x;
    for (const auto& w : wrenches) store(load, w.force), store(load, w.moment);
    return results(array(std::move(rows), {all.size(), 6, 3}), array(std::move(loads), {all.size(), 2, 3}));
}

ElementState<double> state_of(const Vehicle& v, const Element& e, const std::vector<BodyState<double>>& all,
                              const double* state) {
    return element_state(e, v.laws, all[e.upper].motion, all[e.lower].motion, v.bodies[e.lower].wheelset,
                         v.internal_of<double>(e, state));
}

// Deflections m, their rates m/s, forces N, rates m/s of the springs of Maxwell elements, and largest friction N (5, e,
// 3) in the elements' axes.
Result element_states(const Vehicle& v, const Journey& travel, Values state, Values sections) {
    require(state, v.states(), "state"), require(sections, 18 * v.bodies.size(), "sections");
    auto all = v.body_states(travel_of(travel), state.data(), sections.data());
    std::size_t size = 3 * v.elements.size();
    std::vector<double> rows(5 * size);
    for (std::size_t e = 0; e < v.elements.size(); ++e) {
        auto s = state_of(v, v.elements[e], all, state.data());
        const Vec<double>* parts[] = {&s.deflection, &s.deflection_rate, &s.own_force, &s.series_rate,
                                      &s.friction_limit};
        for (int k = 0; k < 5; ++k) {
            double* to = rows.data() + k * size + 3 * e;
            store(to, *parts[k]);
        }
    }
    return array(std::move(rows), {5, v.elements.size(), 3});
}

// Internal variables (m,) at the end of a step, of which sliders count from its start, and distances (m,) m by which
// they would be wrong had no deflection turned back within the step.
Results<2> settled_internal(const Vehicle& v, const std::array<Journey, 2>& travels,
                            const std::array<Values, 2>& states, const std::array<Values, 2>& sections) {
    for (int i : {0, 1})
        require(states[i], v.states(), "state"), require(sections[i], 18 * v.bodies.size(), "sections");
    auto of = [&](int i) { return v.body_states(travel_of(travels[i]), states[i].data(), sections[i].data()); };
    auto start = of(0), end = of(1);
    const double *first = states[0].data() + 12 * v.count(), *last = states[1].data() + 12 * v.count();
    std::vector<double> internal(last, last + v.internal), turned(v.internal);
    for (const auto& e : v.elements)
        for (const auto& d : e.directions)
            if (int m = d.friction.slider; m >= 0) internal[m] = first[m];
    double duration = travels[1][3] - travels[0][3];
    for (const auto& e : v.elements)
        settle(e, state_of(v, e, start, states[0].data()), state_of(v, e, end, states[1].data()), duration,
               internal.data(), turned.data());
    std::size_t size = v.internal;
    return results(array(std::move(internal), {size}), array(std::move(turned), {size}));
}

// Torques (p,) N m about the axles, and components (f, 3) N of forces along the axes of the sections.
Results<2> load_values(const Vehicle& v, const Journey& travel, Values state, Values sections) {
    require(state, v.states(), "state"), require(sections, 18 * v.bodies.size(), "sections");
    auto all = v.body_states(travel_of(travel), state.data(), sections.data());
    std::vector<double> torques, forces(3 * v.forces.size());
    double* to = forces.data();
    for (const auto& t : v.torques)
        torques.push_back(axle_torque(t, all[t.wheelset], all[t.reaction].motion, v.radius, v.release));
    for (const auto& f : v.forces) store(to, components(f, all[f.body]));
    return results(array(std::move(torques), {v.torques.size()}), array(std::move(forces), {v.forces.size(), 3}));
}

// Whether one of the functions, pieces of polynomials, is no cubic between two abscissae, see excitation.hpp.
bool differ(Values starts, nb::ndarray<const double, nb::ndim<3>, nb::c_contig, nb::device::cpu> coefficients,
            Values places, double start, double end, Values limits) {
    require(limits, 5, "limits"), require(starts, coefficients.shape(0), "starts");
    auto numbers = [](const Values& of) { return Numbers{of.data(), {long(of.size())}}; };
    std::array<long, 3> shape{long(coefficients.shape(0)), long(coefficients.shape(1)), long(coefficients.shape(2))};
    if (!shape[0]) throw nb::value_error("starts: must be one at least");
    return differ({numbers(starts), {coefficients.data(), shape}}, numbers(places), start, end, numbers(limits));
}

}  // namespace

NB_MODULE(_vehicle, m) {
    nb::set_leak_warnings(false);  // vehicles that Python keeps until its end are no leaks
    using List = std::vector<double>;
    using Vector = Vec<double>;
    nb::class_<Body>(m, "Body").def(nb::init<double, double, double, Vector, bool, std::array<bool, 6>>(), "place"_a,
                                    "height"_a, "mass"_a, "inertia"_a, "wheelset"_a, "held"_a);
    nb::class_<Law>(m, "Law").def(nb::init<bool, List, List>(), "odd"_a, "values"_a, "forces"_a);
    nb::class_<Friction>(m, "Friction")
        .def(nb::init<int, double, double, double>(), "slider"_a, "stiffness"_a, "limit"_a, "share"_a);
    nb::class_<Surge>(m, "Surge").def(nb::init<int, double, double>(), "flow"_a, "mass"_a, "exponent"_a);
    nb::class_<Direction>(m, "Direction")
        .def(nb::init<double, double, int, int, int, double, Friction, Surge>(), "spring"_a, "damper"_a, "spring_law"_a,
             "damper_law"_a, "series"_a, "series_stiffness"_a, "friction"_a, "surge"_a);
    nb::class_<Element>(m, "Element")
        .def(nb::init<int, int, Vector, Vector, double, double, double, std::array<Direction, 3>>(), "upper"_a,
             "lower"_a, "upper_arm"_a, "lower_arm"_a, "turn"_a, "static_load"_a, "length"_a, "directions"_a);
    nb::class_<RotationalSpring>(m, "RotationalSpring")
        .def(nb::init<int, int, Vector, Vector>(), "upper"_a, "lower"_a, "stiffness"_a, "damping"_a);
    nb::class_<Table>(m, "Table").def(nb::init<bool, List, List>(), "by_distance"_a, "places"_a, "values"_a);
    nb::class_<Torque>(m, "Torque")
        .def(nb::init<int, int, bool, Table>(), "wheelset"_a, "reaction"_a, "brake"_a, "size"_a);
    nb::class_<Force>(m, "Force").def(nb::init<int, Vector, std::array<Table, 3>>(), "body"_a, "arm"_a, "components"_a);
    nb::class_<Track>(m, "Track")
        .def(nb::init<List, std::vector<Track::Powers>, double, List, List>(), "starts"_a, "pieces"_a, "base"_a,
             "nodes"_a, "weights"_a)
        .def(
            "sections",
            [](const Track& t, Values stations, double reference) {
                if (!fits(t)) throw nb::value_error("track: a length does not fit");
                return section_rows(stations.size(),
                                    [&](std::size_t i) { return t.section(stations.data()[i], reference); });
            },
            "stations"_a, "reference"_a);
    nb::class_<Vehicle>(m, "Vehicle")
        .def(
            "__init__",
            [](Vehicle* self, Track track, std::vector<Body> bodies, std::vector<Law> laws,
               std::vector<Element> elements, std::vector<std::array<int, 2>> pairs,
               std::vector<RotationalSpring> springs, std::vector<Torque> torques, std::vector<Force> forces,
               double radius, double gravity, double release, int kept, std::array<double, 2> hold, int internal) {
                Vehicle v{track,  bodies,  laws,    elements, pairs,   springs, torques, forces,
                          radius, gravity, release, kept,     hold[0], hold[1], internal};
                check_indices(v);
                new (self) Vehicle(std::move(v));
            },
            "track"_a, "bodies"_a, "laws"_a, "elements"_a, "pairs"_a, "springs"_a, "torques"_a, "forces"_a, "radius"_a,
            "gravity"_a, "release"_a, "kept"_a, "hold"_a, "internal"_a)
        .def("sections", &sections, "distance"_a, "state"_a)
        .def("accelerations", &accelerations, "travel"_a, "state"_a, "sections"_a, "contacts"_a)
        .def("derivatives", &derivatives, "travel"_a, "rates"_a, "state"_a, "contacts"_a)
        .def("motions", &motions, "travel"_a, "state"_a, "sections"_a)
        .def("settled", &settled_internal, "travels"_a, "states"_a, "sections"_a)
        .def("element_states", &element_states, "travel"_a, "state"_a, "sections"_a)
        .def("load_values", &load_values, "travel"_a, "state"_a, "sections"_a)
        .def(
            "energy_rates",
            [](const Vehicle& v, const Journey& travel, Values state, Values sections, Values contacts) {
                require(state, v.states(), "state"), require(sections, 18 * v.bodies.size(), "sections");
                require(contacts, 6 * v.bodies.size(), "contacts");
                auto e = energy_rates(v, travel_of(travel), state.data(), sections.data(), contacts.data());
                return std::array<double, 8>{e.kinetic, e.elastic,  e.contacts, e.dampers,
                                             e.weight,  e.inertial, e.applied,  e.friction};
            },
            "travel"_a, "state"_a, "sections"_a, "contacts"_a);
    m.def("differ",
          nb::overload_cast<Values, nb::ndarray<const double, nb::ndim<3>, nb::c_contig, nb::device::cpu>, Values,
                            double, double, Values>(&differ),
          "starts"_a, "coefficients"_a, "places"_a, "start"_a, "end"_a, "limits"_a,
          "Whether one of k functions, somewhere between two abscissae, differs by more than some limits (5,) from the "
          "cubic through its values and slopes at both: starts (m,) of the pieces, coefficients (m, degree + 1, k), "
          "places (p,) that are added to both abscissae, one after the other.");
}
