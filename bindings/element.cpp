// Python's face of contact elements and of the files that libraries without Python open.
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "export/core/wheelset_file.hpp"
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

namespace {

std::vector<nb::tuple> rows(const Variables& all) {
    std::vector<nb::tuple> result;
    for (const auto& own : all) result.push_back(nb::make_tuple(own.name, own.unit, own.description));
    return result;
}

// The file of a wheelset, with the contact model of each side, or one for both.
nb::bytes sealed(const WheelsetHead& head, const nb::list& models) {
    Writer file;
    file.put(head);
    for (nb::handle model : models) {
        if (nb::isinstance<Kept<StandardData>>(model)) {
            file.put(long(STANDARD));
            file.put(nb::cast<Kept<StandardData>&>(model).data);
        } else {
            file.put(long(LATTICE));
            file.put(nb::cast<Kept<LatticeFile>&>(model).data);
        }
    }
    auto bytes = file.sealed(wheelset_look());
    return nb::bytes(bytes.data(), bytes.size());
}

}  // namespace

void bind_element(nb::module_& m) {
    m.attr("INTERFACE") = INTERFACE;
    m.attr("SPEED_INPUT") = SPEED, m.attr("RAIL_INPUTS") = RAILS, m.attr("CREEPAGE_STEP") = CREEPAGE_STEP;
    m.attr("DEFAULT_FILE") = DEFAULT_FILE;
    m.def(
        "input_variables", [] { return rows(input_variables()); },
        "Name, unit and description of an element's inputs.");
    m.def("output_variables", [] { return rows(output_variables()); }, "Likewise of its outputs.");
    m.def("patch_variables", [] { return rows(patch_variables()); }, "Likewise of values of a patch.");
    m.def("parameter_variables", [] { return rows(parameter_variables()); }, "Likewise of its parameters.");
    structure<StandardData>(
        m, "StandardData", {"parameters", "extent", "wheel", "rail", "tangential"},
        "Data of the standard contact of a pair: parameters; longest semi-axes m, along and across, of a patch that "
        "lies on both bodies; names of the profiles; tangential method where there is friction.");
    m.def(
        "standard_failure",
        [](const std::array<double, 2>& extent, double E_star, long method, const Numbers& values) {
            require(values.size() == 8, "values: must be (8,)");
            return failure(extent, E_star, method, values);
        },
        "extent"_a, "E_star"_a, "method"_a, "values"_a,
        "Why a standard contact with these values, see `WheelForces`, is none; empty if it is one: extent (2,) m, "
        "longest "
        "semi-axes of a patch that lies on both bodies; E* Pa; tangential method.");
    structure<LevelData>(m, "LevelData", {"strips", "slenderness"}, "Strips of a level, and their slenderness (K,).");
    structure<FamilyBases>(
        m, "FamilyBases", {"own", "finer", "starts"},
        "Bases of strips with or without friction: that of the model, those with twice and four times "
        "as many cells, and equal cells at starts.");
    structure<BodyData>(m, "BodyData", {"weights", "spectra"},
                        "Deviation of a body from a half-space: spectra of all pairs of tiles, first <= second.");
    structure<LatticeData>(
        m, "LatticeData",
        {"surface", "lines", "outline", "levels", "spaces", "rule", "moves", "bodies", "first", "second", "bases",
         "finer", "strips", "margin", "apart", "tolerance", "regularisation", "law"},
        "Contacts on the lattices of one pair of bodies, for libraries without Python.");
    structure<LatticeFile>(m, "LatticeFile", {"data", "law"},
                           "A lattice, and the sum of the library of its law of friction.");
    m.attr("LEVELS") = LEVELS;
    m.def(
        "law_file",
        [](const nb::bytes& library) {
            Array<long, 1> words((long(library.size()) + 7) / 8);
            std::memcpy(words.data, library.data(), library.size());
            long sum = sum_of(words);
            return std::pair{law_name(sum), sum};
        },
        "library"_a, "Name beside the file of a wheelset of the library of a law of friction, and its sum.");
    structure<AllowedRange>(m, "AllowedRange", {"low", "high", "allowed"}, "Allowed numbers, and a text of them.");
    m.def(
        "sealed_wheelset",
        [](const std::string& token, const Numbers& start, const nb::list& inputs,
           const std::array<double, 2>& friction, const AllowedRange& coefficients, const AllowedRange& loads,
           const std::array<double, 2>& sphere, const std::array<Dimensions, 2>& dimensions, const nb::list& models) {
            WheelsetHead head{token, start, {}, friction, coefficients, loads, sphere, dimensions, long(models.size())};
            require(inputs.size() == INPUTS && head.fits(), "must have all inputs, and one or two models");
            for (int k = 0; k < INPUTS; ++k) head.inputs[k] = nb::cast<Kept<AllowedRange>&>(inputs[k]).data;
            return sealed(head, models);
        },
        "token"_a, "start"_a, "inputs"_a, "friction"_a, "coefficients"_a, "loads"_a, "sphere"_a, "dimensions"_a,
        "models"_a,
        "File of a wheelset for the library without Python: token of a unit; start (17,), inputs of the scene's state; "
        "allowed inputs; friction coefficients of both sides, NaN of laws, and what is allowed; allowed loads N of a "
        "wheel; radius m and contact modulus Pa of a sphere whose approach is about that of a wheel; dimensions m of "
        "both sides; contact models of both sides, or one for both.");
}
