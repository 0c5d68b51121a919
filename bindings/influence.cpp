// Python's face of displacements by loads on strips.
#include "contact/models/lattice/influence/core/bulk.hpp"
#include "contact/models/lattice/influence/core/pair_tables.hpp"
#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

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
}
