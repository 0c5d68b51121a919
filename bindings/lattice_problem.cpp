// Python's face of contacts on a lattice: tables of bodies, and problems at a pose.
#include "contact/models/lattice/core/level_model.hpp"

#include <nanobind/stl/function.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include "lattice.hpp"

using namespace wr;

namespace {

// Translation of the core's errors into Python exceptions.
void translate(const std::exception_ptr& error, void*) {
    auto raise = [](const char* module, const char* name, const char* text) {
        PyErr_SetString(nb::module_::import_(module).attr(name).ptr(), text);
    };
    try {
        std::rethrow_exception(error);
    } catch (const OutsideSurface& e) {
        raise("wheelrail.contact.kinematics.contact_points", "OutsideSurface", e.what());
    } catch (const NotRolling& e) {
        raise("wheelrail.contact.kinematics.creepage", "NotRolling", e.what());
    } catch (const SingularMatrix& e) {
        raise("numpy.linalg", "LinAlgError", e.what());
    } catch (const Unsolved& e) {
        raise("wheelrail.contact.solvers.options", "NotConverged", e.what());
    }
}

LatticeState state_of(const LatticeProblem& problem, Indices strips, const Array<double, 2>& values) {
    require(values.shape == std::array{strips.size(), problem.all().block()}, "values: must be (S, block)");
    return {strips_of(strips, problem.all().strips()), values};
}

void bind_bodies(nb::module_& m) {
    structure<DeviationWeights>(m, "DeviationWeights", {"arc", "bounds", "even", "odd"},
                                "How coefficients of a finite body are sums over K numbers of the spectra of pairs of "
                                "lines: arc (ns,) m, of the lines; bounds (2,) m, their ends; weights even and odd "
                                "(cells (DEGREE + 1), K) of even and odd components.");
    nb::class_<FiniteBody>(m, "FiniteBody", "Deviation of a finite body from a half-space between its lines.")
        .def(
            "__init__",
            [](FiniteBody* self, const DeviationWeights& weights, bool moves, FiniteBody::Spectra spectra) {
                require(weights.arc.size() > 1, "weights: must be of lines");
                new (self) FiniteBody(weights, moves, std::move(spectra));
            },
            "weights"_a, "moves"_a, "spectra"_a,
            "moves: whether strips move on it; spectra(i, j) gives those (R, C, SPECTRA, K) of the displacement of the "
            "lines of a tile by loads on those of another one, i <= j.")
        .def(
            "coefficients",
            [](FiniteBody& body, double low, double high) {
                auto [first, stop] = body.between(low, high);
                const auto& [ns, other, cells, powers, components] = body.lines.shape;
                Array<double, 5> some(std::array{stop - first, stop - first, cells, powers, components});
                for (long i = first; i < stop; ++i) {
                    auto from = body.lines[i].part(first, stop);
                    std::copy(from.begin(), from.end(), some[i - first].begin());
                }
                return some;
            },
            "low"_a, "high"_a, Unlocked(),
            "Coefficients (n, n, cells, DEGREE + 1, COMPONENTS) between the lines that cover a part of the surface, "
            "m.");
    nb::class_<LatticeTables>(m, "LatticeTables", "Tables of half-spaces and bodies under the strips of a lattice.")
        .def(
            "__init__",
            [](LatticeTables* self, const LatticeStrips& strips, Numbers slenderness, const HalfSpaces& spaces,
               const CellRule& rule, std::shared_ptr<FiniteBody> upper, std::shared_ptr<FiniteBody> lower, bool moves) {
                require(slenderness.size() == strips.size() && strips.size() > 2, "slenderness: must be (K,)");
                new (self) LatticeTables(strips, slenderness, spaces, rule, {upper, lower}, moves);
            },
            "strips"_a, "slenderness"_a, "spaces"_a, "rule"_a, "upper"_a.none(), "lower"_a.none(), "moves"_a,
            "slenderness (K,) of the strips; rule: of the polynomials; upper, lower: finite bodies, None for "
            "half-spaces; moves: whether strips move on the lower one.")
        .def_prop_ro(
            "lattice", [](const LatticeTables& t) { return t.lattice; }, nb::keep_alive<0, 1>())
        .def_prop_ro("middle", [](const LatticeTables& t) { return t.lattice.middle; })
        .def_prop_ro("width", [](const LatticeTables& t) { return t.lattice.width; })
        .def_ro("slenderness", &LatticeTables::slenderness)
        .def_ro("modulus", &LatticeTables::modulus, "Contact modulus E* Pa of both bodies.")
        .def_prop_ro("lines", &LatticeTables::lines,
                     "Arc length (ns,) m of the lower body's lines; none where the compliance does not depend on "
                     "places there.")
        .def(
            "of",
            [](LatticeTables& t, Indices strips, View<const bool, 1> near, Numbers feet, double reach) {
                long K = t.lattice.middle.size();
                require(near.size() == K && feet.size() == K, "near, feet: must be (K,)");
                return t.of(strips_of(strips, K), t.at(near, feet, reach));
            },
            "strips"_a, "near"_a, "feet"_a, "reach"_a, Unlocked(),
            "`PairTables` of all pairs of some strips (C,), where strips near (K,) may touch, with their middles at "
            "feet (K,) m on the lower body; reach m: longest distance along x.");
}

void bind_problem(nb::module_& m) {
    nb::class_<LatticeSetting> setting(m, "LatticeSetting", "Constituents of a strip contact, at any pose.");
    setting.def(
        "__init__",
        [](LatticeSetting* self, const SurfaceData& surface, const std::optional<nb::object>& lines,
           const Array<double, 2>& outline, std::shared_ptr<LatticeTables> tables, const StripBasis& basis,
           const StripBasis& first, const StripBasis& second, const std::vector<nb::object>& starts,
           const ResidualCode& law, double margin, long apart, double tolerance) {
            std::vector<Owned<StripBasis>> bases;
            bases.reserve(starts.size());
            for (const auto& basis : starts) bases.push_back(owned(nb::cast<Kept<StripBasis>&>(basis).data));
            Owned<Lines> whole;
            if (lines) whole = owned(nb::cast<Kept<Lines>&>(*lines).data);
            LatticeSetting made{owned(surface), whole,        outline,       std::move(tables),
                                owned(basis),   owned(first), owned(second), bases,
                                owned(law),     margin,       apart,         tolerance};
            require(made.fits(), "LatticeSetting: lengths do not fit");
            new (self) LatticeSetting(std::move(made));
        },
        "surface"_a, "lines"_a.none(), "outline"_a, "tables"_a, "basis"_a, "first"_a, "second"_a, "starts"_a, "law"_a,
        "margin"_a, "apart"_a, "tolerance"_a,
        "lines of the wheel's whole profile, None for quadrics; outline (2, n) m of the rail, ascending; bases of "
        "the strips, of equal cells of unloaded ones and of starts; margin m, largest gap that displacements may "
        "close; apart: strips between those at which the penetration is estimated first; tolerance of the last "
        "step.");
    setting.def_rw("least_pressure", &LatticeSetting::least_pressure,
                   "Mean pressure Pa over a cell, below which a solution counts as one with tension.");
    nb::class_<LatticeProblem>(m, "LatticeProblem", "Equations of a contact on strips at a pose.")
        .def(
            "__init__",
            [](LatticeProblem* self, std::shared_ptr<LatticeSetting> setting, const Motion& motion) {
                new (self) LatticeProblem(std::move(setting), motion);
            },
            "setting"_a, "motion"_a)
        .def_ro("lines", &LatticeProblem::lines, "`ContactLines` of all strips.")
        .def_prop_ro(
            "candidates", [](const LatticeProblem& p) { return array_of(p.candidates); },
            "Strips with positive penetration.")
        .def_prop_ro(
            "lattice", [](const LatticeProblem& p) { return p.lattice(); }, nb::keep_alive<0, 1>())
        .def_prop_ro("tables", [](const LatticeProblem& p) { return p.setting->tables; })
        .def_prop_ro(
            "depth", [](const LatticeProblem& p) { return p.lines.depth; },
            "Largest penetration (K,) m of the strips, the mean over their widths.")
        .def_prop_ro("motion", [](const LatticeProblem& p) { return Owned<Motion>(owned(p.given())); })
        .def_prop_ro("basis", [](const LatticeProblem& p) { return p.all().basis; })
        .def_prop_ro("surface", [](const LatticeProblem& p) { return p.all().surface; })
        .def_prop_ro("rolls", [](const LatticeProblem& p) { return p.all().rolls(); })
        .def_prop_ro("approach", &LatticeProblem::approach,
                     "Largest penetration m of a strip; without any, minus the gap of the undeformed surfaces.")
        .def_prop_ro("rho", [](LatticeProblem& p) { return p.rho(); })
        .def(
            "check_loaded",
            [](const LatticeProblem& p, Indices strips) { p.check_loaded(strips_of(strips, p.all().strips())); },
            "strips"_a, "Raise OutsideSurface where loaded strips (S,) lie beyond the lower body's lines.")
        .def(
            "of", [](LatticeProblem& p, Indices strips) { return p.of(strips_of(strips, p.all().strips())); },
            "strips"_a, Unlocked(), nb::keep_alive<0, 1>(),
            "`EquationData` of some strips (S,). Raises OutsideSurface, NotRolling.")
        .def(
            "tensile",
            [](const LatticeProblem& p, Indices strips, const Array<double, 2>& values) {
                return p.tensile(state_of(p, strips, values));
            },
            "strips"_a, "values"_a, "Whether the mean pressure over a cell of a state is negative.")
        .def(
            "tension",
            [](const LatticeProblem& p, Indices strips, const Array<double, 2>& values) {
                return p.tension(state_of(p, strips, values));
            },
            "strips"_a, "values"_a, "Message on the largest tension of a state, and its place.")
        .def(
            "remaining_penetration",
            [](LatticeProblem& p, Indices strips, const Array<double, 2>& values, const std::vector<long>& free,
               const std::vector<double>& low, const std::vector<double>& high, const StripBasis& cells) {
                auto own = strips_of({free.data(), {long(free.size())}}, p.all().strips());
                require(low.size() == free.size() && high.size() == free.size(), "low, high: must be (n,)");
                return remaining_penetration(p, state_of(p, strips, values), {own, low, high}, cells);
            },
            "strips"_a, "values"_a, "free"_a, "low"_a, "high"_a, "cells"_a, Unlocked(),
            "Penetration (n, C) m of unloaded strips (n,) that a state leaves, means over cells from low to high (n,) "
            "m. Raises OutsideSurface.")
        .def(
            "cold_start",
            [](LatticeProblem& p, const StripBasis& cells) {
                auto state = cold_start(p, cells);
                return std::pair{array_of(state.strips), state.values};
            },
            "cells"_a, Unlocked(), "First strips (S,) and values (S, block), from equal cells.")
        .def(
            "newton",
            [](LatticeProblem& p, Indices strips, const Array<double, 2>& values, long iterations) {
                IterationCount count;
                std::function<void()> look;
                auto found = LatticeNewton(p, count, look).solve(state_of(p, strips, values), iterations);
                return std::pair{std::make_shared<LatticeSolution>(found), count.newton};
            },
            "strips"_a, "values"_a, "iterations"_a, Unlocked(),
            "Solution from a state, and the number of linearisations. Raises NotConverged, OutsideSurface.");
}

}  // namespace

void bind_lattice_problem(nb::module_& m) {
    m.attr("BEYOND") = BEYOND, m.attr("PATCH_TOO_LONG") = PATCH_TOO_LONG;
    nb::register_exception_translator(translate);
    bind_bodies(m);
    bind_problem(m);
}
