// Python's face of displacements by loads on strips.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>

#include "contact/models/lattice/influence/core/body_displacement.hpp"
#include "contact/models/lattice/influence/core/bulk.hpp"
#include "contact/models/lattice/influence/core/pair_samples.hpp"
#include "contact/models/lattice/influence/core/short_strips.hpp"
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

namespace {

template <int N>
using Shape_ = std::array<long, N>;

void bind_structures(nb::module_& m) {
    structure<StripBasis>(m, "StripBasis",
                          {"marks", "row_marks", "mean", "ends", "loads", "load_edges", "moments", "moment_edges",
                           "edge_moments", "slip_edges", "slip_power", "own_slip", "stations", "penetration",
                           "cell_penetration", "longest", "split_marks", "split_edges"},
                          "Constants of strips of M cells.");
    structure<StripGrid>(m, "StripGrid", {"x", "length", "width", "stretch", "strip", "middle"}, "Cells of S strips.");
    structure<PairMeans>(m, "PairMeans", {"lines", "first", "share", "values", "known"},
                         "Coefficients of the pairs i <= j of C strips, computed as far as a pair is looked up.");
    structure<PairTables>(m, "PairTables", {"values", "pair", "first", "cells", "inverse", "place", "smooth"},
                          "Tables of the pairs i <= j of a lattice of K strips, as far as needed at a pose.");
    structure<Lattice>(m, "Lattice", {"middle", "width", "stretch", "carried", "bounds"}, "Strips of a lattice.");
    structure<PoseMeans>(m, "PoseMeans", {"place", "smooth"}, "Part of the tables that depends on the pose.");
    structure<BodyTables>(m, "BodyTables", {"upper", "lower", "share"},
                          "Tables of the deviation of each body from a half-space, and shares in their compliance.");
    structure<CellRule>(m, "CellRule", {"nodes", "to_powers", "integrals", "changes"},
                        "Constants of the polynomials of a cell of a table.");
    structure<LatticeStrips>(m, "LatticeStrips", {"sides", "angle", "stretch"},
                             "Strips of a lattice on the upper body.");
    structure<HalfSpaces>(m, "HalfSpaces", {"nu", "scale", "outward", "radius"}, "Half-spaces under both bodies.");
    structure<Deviation>(m, "Deviation", {"lines", "first", "share"},
                         "Deviation of a body from a half-space that does not depend on the pose.");
    structure<BodyDisplacements>(m, "BodyDisplacements", {"wheel", "rail", "wheel_normal"},
                                 "Displacements of n contact points, or of strips.");
}

// Displacements by loads.
void bind_operators(nb::module_& m) {
    m.def(
        "look_up",
        [](const PairTables& tables, long i, long j, const Numbers& rows, const Numbers& columns,
           const View<double, 3>& G, const std::optional<View<double, 3>>& H, double turn) {
            Shape_<3> shape{rows.size(), columns.size(), COMPONENTS};
            require(rows.size() > 0 && columns.size() > 0, "rows, columns: must not be empty");
            require(G.shape == shape && (!H || H->shape == shape), "G, H: must be (R, C, 8)");
            return H ? look_up<true>(tables, i, j, rows, columns, G, *H, turn)
                     : look_up<false>(tables, i, j, rows, columns, G, {}, turn);
        },
        "tables"_a, "i"_a, "j"_a, "rows"_a, "columns"_a, "G"_a, "H"_a.none(), "turn"_a = 1.0, Unlocked(),
        "Write G (R, C, 8), and its slope H unless None, at the distances of boundaries rows (R,) m on strip i and "
        "columns (C,) m on j >= i, with turn = -1 at the opposite distances. False where they are farther apart than "
        "the table reaches.");
    m.def(
        "normal_table",
        [](const PairTables& tables, long displaced, long loaded, const Numbers& rows, const Numbers& columns,
           const View<double, 2>& G, const std::optional<View<double, 2>>& H) {
            Shape_<2> shape{rows.size(), columns.size()};
            require(rows.size() > 0 && columns.size() > 0, "rows, columns: must not be empty");
            require(G.shape == shape && (!H || H->shape == shape), "G, H: must be (R, C)");
            return H ? normal_table<true>(tables, displaced, loaded, rows, columns, G, *H)
                     : normal_table<false>(tables, displaced, loaded, rows, columns, G, {});
        },
        "tables"_a, "displaced"_a, "loaded"_a, "rows"_a, "columns"_a, "G"_a, "H"_a.none(), Unlocked(),
        "Write the component NN of look_up, G (R, C), and its slope H unless None, for two strips in any order.");
    m.def(
        "split_shares",
        [](double length, double loaded, double distance, const StripBasis& basis) {
            SplitShares shares{};
            int count = split_shares(length, loaded, distance, basis, shares);
            Array<double, 2> to(3, SPLITS);
            for (int k = 0; k < 3; ++k) std::copy(shares[k].begin(), shares[k].end(), to[k].begin());
            return std::pair{count, to};
        },
        "length"_a, "loaded"_a, "distance"_a, "basis"_a,
        "Number of PARTS in which the cells of a loaded strip are split for the displacement of another one, and, up "
        "to "
        "that number, shares of these parts and their derivatives 1/m by both lengths (3, SPLITS); lengths and "
        "distance "
        "of their middles in m.");
}

}  // namespace

void bind_influence(nb::module_& m) {
    m.attr("MODES") = MODES, m.attr("MOMENTS") = MOMENTS, m.attr("STATIONS") = STATIONS;
    m.attr("PARTS") = nb::make_tuple(PARTS[0], PARTS[1]);
    m.attr("XX") = int(XX), m.attr("TT") = int(TT), m.attr("NN") = int(NN), m.attr("TN") = int(TN);
    m.attr("TN_TURN") = int(TN_TURN), m.attr("ROLL") = int(ROLL);
    m.attr("CELLS") = CELLS, m.attr("DEGREE") = DEGREE, m.attr("COMPONENTS") = COMPONENTS;
    m.attr("REACH") = REACH, m.attr("START") = START, m.attr("TILE") = TILE;
    bind_structures(m);
    bind_operators(m);
}
