// Python's face of the searches for loads, which call any contact model of Python.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "contact/loading/core/wheelset_loads.hpp"
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

namespace {

// A `ContactResult` of Python.
struct PythonResult : Memory {
    explicit PythonResult(nb::object result) : result(std::move(result)) {}
    nb::object result;
};

PairSolution solution_of(const nb::object& result) {
    PairSolution own = PairSolution::separated(nb::cast<double>(result.attr("approach")));
    own.memory = std::make_shared<PythonResult>(result);
    if (nb::cast<bool>(result.attr("ok"))) {
        own.status = Status::CONVERGED, own.force.z = nb::cast<double>(result.attr("force")[2]);
        return own;
    }
    auto reason = nb::cast<std::string>(result.attr("status")), prefix = std::string("failed: ");
    own.status = Status::FAILED, own.reason = reason.starts_with(prefix) ? reason.substr(prefix.size()) : reason;
    return own;
}

nb::object object_of(const PairSolution& own) { return static_cast<const PythonResult&>(*own.memory).result; }

// None without results.
nb::object objects_of(const Results& results) {
    if (results.empty()) return nb::none();
    nb::list all;
    for (const auto& own : results) all.append(object_of(own));
    return nb::tuple(all);
}

Results solutions_of(const nb::object& results) {
    Results all;
    if (!results.is_none())
        for (nb::handle own : results) all.push_back(solution_of(nb::borrow(own)));
    return all;
}

Lowered lowered(const nb::callable& contact, std::size_t wheels) {
    return [contact, wheels](double depth, const Results& earlier) {
        auto results = solutions_of(contact(depth, objects_of(earlier)));
        require(wheels ? results.size() == wheels : !results.empty(), "contact: must give results of all wheels");
        return results;
    };
}

nb::tuple tuple_of(const LoadSolution& own) {
    return nb::make_tuple(own.depth, objects_of(own.results), own.error, own.trials, own.slope);
}

nb::tuple tuple_of(const Equilibrium& own) {
    return nb::make_tuple(own.position.z, own.position.roll, objects_of(own.results), own.solves);
}

auto solved(const nb::callable& solve) {
    return [solve](int side, const Position& at, const PairSolution* earlier) {
        return solution_of(solve(side, at.z, at.roll, earlier ? object_of(*earlier) : nb::none()));
    };
}

void translate(const std::exception_ptr& error, void*) {
    try {
        std::rethrow_exception(error);
    } catch (const LoadError& e) {
        PyErr_SetString(nb::module_::import_("wheelrail.contact.loading.load_search").attr("LoadError").ptr(),
                        e.what());
    }
}

}  // namespace

void bind_loading(nb::module_& m) {
    nb::register_exception_translator(&translate);
    m.attr("RTOL") = RTOL;
    m.attr("JUMP") = FORCE_JUMP;
    m.attr("MAX_TRIALS") = MAX_TRIALS;
    m.def("compliant", &compliant, "force"_a, "F^(2/3) with the sign of F, N^(2/3).");
    m.def("sphere_approach", &sphere_approach, "load"_a, "radius"_a, "modulus"_a,
          "Hertzian approach m of a sphere on a plane: load N, radius m, contact modulus E* Pa.");
    m.def(
        "depth_for_load",
        [](const nb::callable& contact, double load, double expected, double start, double rtol, double deepest,
           const nb::object& guess, std::optional<double> slope) {
            LoadTarget target{load, expected, start, rtol, deepest, solutions_of(guess), slope};
            return tuple_of(LoadSearch(std::move(target)).find(lowered(contact, 0)));
        },
        "contact"_a, "load"_a, "expected"_a, "start"_a, "rtol"_a, "deepest"_a, "guess"_a.none(), "slope"_a.none(),
        "Depth m, results, error, trials and slope of F^(2/3), see `find_depth_for_load`. Raises LoadError.");
    m.def(
        "depths_for_loads",
        [](const nb::callable& contact, const OfWheels& loads, const OfWheels& start, const OfWheels& slopes,
           double rtol, const nb::object& guess, int max_trials) {
            auto both = [&](const OfWheels& depths, const Results& earlier) {
                Array<double, 1> at(2);
                std::copy(depths.begin(), depths.end(), at.begin());
                auto results = solutions_of(contact(at, objects_of(earlier)));
                require(results.size() == 2, "contact: must give results of both wheels");
                return results;
            };
            auto found = depths_for_loads(both, {loads, start, slopes, rtol, solutions_of(guess)}, max_trials);
            return nb::make_tuple(found.depths, objects_of(found.results), found.trials);
        },
        "contact"_a, "loads"_a, "start"_a, "slopes"_a, "rtol"_a, "guess"_a.none(), "max_trials"_a,
        "Depths (2,) m, results and trials, see `find_depths_for_loads`. Raises LoadError.");
    m.def(
        "lifted",
        [](const Numbers& depths, const Numbers& approach, double expected, const nb::callable& penetration) {
            require(approach.size() == depths.size(), "approach: must be as depths");
            return lifted(Array<double, 1>::copy(depths), approach, expected, [&](const Numbers& at) {
                auto known = nb::cast<Array<double, 1>>(penetration(Array<double, 1>::copy(at)));
                require(known.size() == at.size(), "penetration: must be as depths");
                return known;
            });
        },
        "depths"_a, "approach"_a, "expected"_a, "penetration"_a,
        "Depths (n,) m from which wheels are solved: those that exceed their approach (n,) m under the loads by more "
        "than expected m are lifted to it; penetration(depths) m of the undeformed surfaces, NaN where only a solve "
        "tells it.");
    m.def(
        "position_at",
        [](const OfWheels& depths, double roll, double base) {
            auto at = position_at(depths, roll, base);
            return std::pair{at.z, at.roll};
        },
        "depths"_a, "roll"_a, "base"_a,
        "Height z m and roll rad of a wheelset with wheels at depths (2,) m below the nominal height at a roll, base m "
        "from the middle.");
    nb::class_<LoweredWheelset>(m, "LoweredWheelset", "Wheels of a wheelset in a state but for its height and roll.")
        .def(
            "__init__",
            [](LoweredWheelset* self, double z, double roll, double base, const nb::callable& solve,
               const nb::callable& penetration, std::array<bool, 2> on_strips, const nb::callable& frictionless,
               std::array<bool, 2> quicker) {
                auto deep = [penetration](int side, const Position& at) {
                    return nb::cast<double>(penetration(side, at.z, at.roll));
                };
                new (self)
                    LoweredWheelset{{z, roll}, base, solved(solve), deep, on_strips, solved(frictionless), quicker};
            },
            "z"_a, "roll"_a, "base"_a, "solve"_a, "penetration"_a, "on_strips"_a, "frictionless"_a, "quicker"_a,
            "Start z m and roll rad; base m, from the middle to the wheels; solve(side, z, roll, earlier) of side 0 or "
            "1; penetration(side, z, roll) m, NaN where only a solve tells it; whether sides are on strips; solves "
            "without friction, and for which sides these are others.")
        .def(
            "under_load",
            [](const LoweredWheelset& own, const Sides& sides, double load, double expected, double rtol,
               const std::optional<std::tuple<double, nb::object, double>>& near) {
                for (int side : sides) require(side == 0 || side == 1, "sides: must be 0 and 1");
                require(!sides.empty(), "sides: must be one or two");
                std::optional<LoadSolution> first;
                if (near) {
                    first = {std::get<0>(*near), solutions_of(std::get<1>(*near)), UNBOUNDED, 0, std::get<2>(*near)};
                    require(first->results.size() == sides.size(), "near: must have a result for each side");
                }
                return tuple_of(wheels_under_load(own, sides, {load, expected, rtol}, first));
            },
            "sides"_a, "load"_a, "expected"_a, "rtol"_a, "near"_a.none() = nb::none(),
            "Height z m at which wheels together carry a load N, roll rad, results and number of solves; expected "
            "approach m; near: depth m, results and slope of F^(2/3) to begin with. Raises LoadError.")
        .def(
            "each_under_load",
            [](const LoweredWheelset& own, double load, double expected, double rtol) {
                return tuple_of(each_under_load(own, {load, expected, rtol}));
            },
            "load"_a, "expected"_a, "rtol"_a, "The same with the roll at which each wheel carries the load.");
}
