// Python's face of contacts on a lattice: their solution on one level or on several.
#include "contact/models/lattice/core/lattice_contact.hpp"

#include <nanobind/stl/function.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include "lattice.hpp"

using namespace wr;

namespace {

StripCells cells_of(const LatticeOutcome& at) {
    if (!at.solution) throw NotConverged("a result without load has no cells");
    auto cells = strip_cells(at.solution->state.values, at.problem->of(at.solution->state.strips));
    if (!cells.inside) throw OutsideSurface(PATCH_TOO_LONG);
    return cells;
}

std::vector<std::vector<long>> patch_numbers(const LatticeResult& result) {
    if (result.blended()) {
        auto [first, second] = result.blend().numbers;
        return {first, second};
    }
    std::vector<long> own(result.patches().size());
    std::iota(own.begin(), own.end(), 0L);
    return {own};
}

// Warm start of the next solve, if any.
std::optional<LatticeStart> next_start(const LatticeResult& result) {
    for (const auto& solution : result.start.solutions)
        if (solution) return result.start;
    if (result.start.ordinary) return result.start;
    return {};
}

void bind_starts(nb::module_& m) {
    nb::class_<LatticeSolution> solution(m, "LatticeSolution",
                                         "Converged state, and factors of a Jacobian near to it.");
    solution
        .def(
            "__init__",
            [](LatticeSolution* self, Indices strips, const Array<double, 2>& values, const Factors& factors) {
                require(values.size() == strips.size(), "values: must be (S, block)");
                new (self) LatticeSolution{{Strips(strips.begin(), strips.end()), values}, factors};
            },
            "strips"_a, "values"_a, "factors"_a)
        .def_prop_ro("strips", [](const LatticeSolution& s) { return array_of(s.state.strips); })
        .def_prop_ro("values", [](const LatticeSolution& s) { return s.state.values; })
        .def_prop_rw(
            "factors", [](const LatticeSolution& s) { return s.factors; },
            [](LatticeSolution& s, const Factors& factors) { s.factors = factors; });
    set_fields(solution, std::array{"strips", "values", "factors"});
    nb::class_<LatticeStart> start(m, "LatticeStart",
                                   "Solutions with which the next solve begins: of one or two levels, None without "
                                   "load, and of finite bodies that of the ordinary level.");
    start
        .def(
            "__init__",
            [](LatticeStart* self, const std::vector<int>& levels,
               const std::vector<std::shared_ptr<LatticeSolution>>& solutions,
               std::shared_ptr<LatticeSolution> ordinary) {
                require(levels.size() == solutions.size(), "solutions: must be as many as levels");
                new (self) LatticeStart{levels, solutions, std::move(ordinary)};
            },
            "levels"_a, "solutions"_a, "ordinary"_a.none())
        .def_ro("levels", &LatticeStart::levels)
        .def_ro("solutions", &LatticeStart::solutions)
        .def_ro("ordinary", &LatticeStart::ordinary);
    set_fields(start, std::array{"levels", "solutions", "ordinary"});
}

void bind_outcomes(nb::module_& m) {
    nb::class_<LatticeOutcome>(m, "LatticeOutcome", "Outcome of a solve on one level.")
        .def_ro("approach", &LatticeOutcome::approach)
        .def_ro("load", &LatticeOutcome::load)
        .def_ro("problem", &LatticeOutcome::problem)
        .def_ro("solution", &LatticeOutcome::solution, "None without load.")
        .def("cells", &cells_of, Unlocked(), "`StripCells` of the solution. Raises OutsideSurface.");
    nb::class_<LatticeResult>(m, "LatticeResult", "Force of one or two levels of a lattice.")
        .def_ro("levels", &LatticeResult::levels)
        .def_prop_ro(
            "share", [](const LatticeResult& r) { return r.shares.share; }, "Of the first level.")
        .def_prop_ro("failure", [](const LatticeResult& r) { return r.first().failure; })
        .def_prop_ro("ok", &LatticeResult::ok)
        .def_prop_ro("separated", &LatticeResult::separated)
        .def_prop_ro("approach", &LatticeResult::approach)
        .def_prop_ro("load", &LatticeResult::load, "Force N and moment N m (6,) about the rail's origin.")
        .def_prop_ro("newton", [](const LatticeResult& r) { return r.count().newton; })
        .def_prop_ro("evaluations", [](const LatticeResult& r) { return r.count().linear; })
        .def_prop_ro("residual", [](const LatticeResult& r) { return r.count().residual; })
        .def_prop_ro("points", &LatticeResult::points)
        .def_prop_ro("seconds", &LatticeResult::seconds)
        .def_prop_ro("start", &next_start)
        .def("patches", &LatticeResult::patches, Unlocked(),
             "Rows (k, 26) for `patches_of` of all patches, by decreasing load. Raises OutsideSurface.")
        .def("patch_numbers", &patch_numbers, Unlocked(), "Numbers of the patches of each level among these.")
        .def_prop_ro("matrix", &LatticeResult::tangent, Unlocked(),
                     "Derivative (6, 12) of the load by pose and motion. Raises OutsideSurface, NotConverged.");
}

void bind_models(nb::module_& m) {
    nb::class_<LevelModel>(m, "LevelModel", "Contact on the strips of one level of a lattice.")
        .def(
            "__init__",
            [](LevelModel* self, std::shared_ptr<LatticeSetting> setting, long strips, int level,
               std::function<LevelModel::Models()> finer, std::function<void(long)> check_size,
               std::function<void()> look) {
                new (self) LevelModel{std::move(setting),    strips,         level, std::move(finer),
                                      std::move(check_size), std::move(look)};
            },
            "setting"_a, "strips"_a, "level"_a, "finer"_a, "check_size"_a, "look"_a,
            "strips over a usual patch, on ordinary ones; level: halvings of their width; finer() gives models with "
            "more cells along the same strips, then two on narrower ones; check_size(strips) is called before a start, "
            "look() now and then.")
        .def(
            "problem", [](const LevelModel& model, const Motion& motion) { return model.problem(motion); }, "motion"_a,
            Unlocked(), "`LatticeProblem` of a motion.")
        .def(
            "solve",
            [](const LevelModel& model, const std::shared_ptr<LatticeProblem>& problem, const LatticeStart* earlier) {
                auto outcome = model.solve(problem, earlier ? earlier->on(model.level) : nullptr);
                LatticeStart start{{model.level}, {outcome.warm}, nullptr};
                return std::make_shared<LatticeResult>(std::vector{outcome}, LevelShares{}, start);
            },
            "problem"_a, "earlier"_a.none(), Unlocked(),
            "`LatticeResult` of the equations on the strips of this level, however few of them are loaded.");
    nb::class_<LatticeContact>(m, "LatticeContact", "Contact on a lattice, on ordinary strips or on finer levels.")
        .def(
            "__init__",
            [](LatticeContact* self, std::shared_ptr<LevelModel> ordinary,
               std::function<std::shared_ptr<LevelModel>(int)> on) {
                new (self) LatticeContact(std::move(ordinary), std::move(on));
            },
            "ordinary"_a, "on"_a, "The model on ordinary strips; on(level) gives that on finer ones.")
        .def(
            "solve",
            [](const LatticeContact& contact, const Motion& motion, const LatticeStart* earlier) {
                return contact.solve(motion, earlier);
            },
            "motion"_a, "earlier"_a.none(), Unlocked(), "`LatticeResult` of a pose and motion.");
    nb::class_<BulkDisplacement>(m, "BulkDisplacement", "Displacement of both bodies in a solution of their equations.")
        .def(
            "__init__",
            [](BulkDisplacement* self, std::shared_ptr<LatticeProblem> problem,
               std::shared_ptr<LatticeSolution> solution) {
                new (self) BulkDisplacement(std::move(problem), std::move(solution));
            },
            "problem"_a, "solution"_a)
        .def_prop_ro(
            "lift", [](BulkDisplacement& bulk) { return bulk.lift(); },
            "Middles (R,) m of strips on the lines of both bodies, and by how much the penetration is less "
            "there, m: (2, R).")
        .def(
            "changes", [](BulkDisplacement& bulk, Numbers weight) { return bulk.changes(weight); }, "weight"_a,
            "Derivative (12,) by pose and motion of the sum of the lift times weights (R,).");
    m.def(
        "level_shares",
        [](const std::shared_ptr<LatticeProblem>& problem, long strips, std::shared_ptr<BulkDisplacement> bulk) {
            auto shares = level_shares(problem, strips, bulk);
            return std::pair{shares.levels, shares.share};
        },
        "problem"_a, "strips"_a, "bulk"_a.none() = nb::none(), Unlocked(),
        "One or two levels that make up the force at a pose, and the share of the first.");
}

}  // namespace

void bind_lattice_contact(nb::module_& m) {
    bind_starts(m);
    bind_outcomes(m);
    bind_models(m);
}
