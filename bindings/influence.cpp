// Python's face of displacements by loads on strips.
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>

#include "contact/models/lattice/influence/core/bulk.hpp"
#include "contact/models/lattice/influence/core/operator.hpp"
#include "contact/models/lattice/influence/core/short_strips.hpp"
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

namespace {

using Released = nb::call_guard<nb::gil_scoped_release>;

void require(bool fits, const char* text) {
    if (!fits) throw nb::value_error(text);
}

template <int N>
using Shape_ = std::array<long, N>;

void require_strips(const StripGrid& grid, const StripBasis& basis) {
    require(grid.x.shape[1] == basis.M() + 3, "grid: does not fit to the basis");
}

}  // namespace

void bind_influence(nb::module_& m) {
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
    structure<BulkCompliance>(m, "BulkCompliance", {"arc", "values", "filled", "moves", "bounds"},
                              "Compliance of a body between its lines.");
    m.def(
        "antiderivatives",
        [](const PairTables& tables, const StripGrid& grid, const Blocks& jumps) {
            require(jumps.shape == Shape_<3>{grid.size(), grid.x.shape[1] - 2, 3}, "jumps: must be (S, M + 1, 3)");
            return antiderivatives(tables, grid, jumps);
        },
        "tables"_a, "grid"_a, "jumps"_a, Released(),
        "Whether all distances lie in the tables, and V (S, M + 3, 3), the antiderivative of the displacement along x, "
        "by jumps (S, M + 1, 3) of traction times width.");
    m.def(
        "operator",
        [](const PairTables& tables, const StripGrid& grid, const Blocks& jumps, const StripBasis& basis, bool rolls) {
            require_strips(grid, basis);
            require(jumps.shape == Shape_<3>{grid.size(), basis.M() + 1, 3}, "jumps: must be (S, M + 1, 3)");
            Operator made{tables, grid, jumps, basis, rolls};
            bool inside = made.fill();
            return std::tuple{inside, made.A, made.V};
        },
        "tables"_a, "grid"_a, "jumps"_a, "basis"_a, "rolls"_a, Released(),
        "Whether all distances lie in the tables, derivative (n, n) of slips and moments by tractions, modes and ends, "
        "and V (S, M + 3, 3). Rows and columns strip by strip: slips along and across by tractions along and across "
        "(if rolling), moments by modes and ends.");
    m.def(
        "slips_and_moments",
        [](const Blocks& V, const StripGrid& grid, const StripBasis& basis) {
            require_strips(grid, basis);
            require(V.shape == Shape_<3>{grid.size(), basis.M() + 3, 3}, "V: must be (S, M + 3, 3)");
            return slips_and_moments(V, grid, basis);
        },
        "V"_a, "grid"_a, "basis"_a, Released(),
        "Elastic slips (S, 2, M) and moments (S, MOMENTS) m of the normal displacement, from V (S, M + 3, 3).");
    m.def(
        "add_short_strips",
        [](const PairTables& tables, const StripGrid& grid, const Rows& values, const StripBasis& basis, bool rolls,
           const View<double, 3>& V) {
            require_strips(grid, basis);
            require(values.shape == Shape_<2>{grid.size(), basis.block(rolls)}, "values: must be (S, block)");
            require(V.shape == Shape_<3>{grid.size(), basis.M() + 3, 3}, "V: must be (S, M + 3, 3)");
            return add_short_strips(tables, grid, values, basis, rolls, V);
        },
        "tables"_a, "grid"_a, "values"_a, "basis"_a, "rolls"_a, "V"_a, Released(),
        "Add to the antiderivative V (S, M + 3, 3) on short strips, by the pressure in values (S, block); False where "
        "distances exceed the tables.");
    m.def(
        "add_short_strips_derivative",
        [](const PairTables& tables, const StripGrid& grid, const Rows& values, const StripBasis& basis, bool rolls,
           const View<double, 2>& A, const View<double, 3>& V) {
            long n = grid.size() * basis.block(rolls);
            require_strips(grid, basis);
            require(values.shape == Shape_<2>{grid.size(), basis.block(rolls)}, "values: must be (S, block)");
            require(A.shape == Shape_<2>{n, n}, "A: must be (S block, S block)");
            require(V.shape == Shape_<3>{grid.size(), basis.M() + 3, 3}, "V: must be (S, M + 3, 3)");
            return add_short_strips_derivative(tables, grid, values, basis, rolls, A, V);
        },
        "tables"_a, "grid"_a, "values"_a, "basis"_a, "rolls"_a, "A"_a, "V"_a, Released(),
        "As add_short_strips, and add the derivatives of the moments by modes and ends to the operator A (n, n).");
}
