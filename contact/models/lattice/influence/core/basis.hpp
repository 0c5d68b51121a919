// Constants of strips of M cells, and cells of strips.
#pragma once
#include <tuple>

#include "support/core/arrays.hpp"

namespace wr {

constexpr int MODES = 4;  // of pressure; with three, the gap left on a long strip gives its neighbour two places
constexpr int MOMENTS = MODES + 2;     // of the gap: the two more than modes determine the ends
constexpr int STATIONS = 6;            // along a strip, at which the penetration is evaluated
constexpr int SPLITS = 2;              // ways to split cells
constexpr int PARTS[SPLITS] = {4, 8};  // of a cell whose pressure displaces short strips, nearer ones and nearest ones

// Constants of strips of M cells, see `wheelrail.contact.models.lattice.influence.basis`.
struct StripBasis {
    Numbers marks;       // (M + 1,) cell boundaries from 0 (trailing end) to 1 (leading end)
    Numbers row_marks;   // (M + 3,) the same with two more cells ahead
    Rows mean;           // (M, MODES) mean of the pressure modes over the cells
    Blocks ends;         // (M, 2, MODES) values at the ends of the cells of linear functions with their moments
    Rows loads;          // (M, MODES) the same corrected for the variation within the cells
    Rows load_edges;     // (M + 1, MODES) their jumps at the marks
    Rows moments;        // (MOMENTS, M) weights of cell means in the moments of the gap
    Rows moment_edges;   // (MOMENTS, M + 1) of an antiderivative at the marks in those of a displacement, times length
    Rows edge_moments;   // (M + 1, MOMENTS) the same
    Rows slip_edges;     // (M, 4) of an antiderivative at a cell's first boundary and the next three in its slip,
    int slip_power = 0;  // times this power of the length: 2, or 1 for a tangential displacement
    Numbers own_slip;    // (M,) slips of cells by traction of 2 / (pi E*) on them in plane strain, or their lengths
    Numbers stations;    // (STATIONS,) places from 0 to 1
    Rows penetration;    // (MOMENTS, STATIONS) weights of the penetration there in its moments
    Rows cell_penetration;  // (M, STATIONS) the same in its means over the cells
    double longest = 0.0;   // length of the longest cell
    Numbers split_marks;    // (N + 1,) boundaries of the most of PARTS
    Blocks split_edges;     // (SPLITS, N + 1, MODES) jumps of the loads of these parts, less those of the fewer ones

    auto fields() {
        return std::tie(marks, row_marks, mean, ends, loads, load_edges, moments, moment_edges, edge_moments,
                        slip_edges, slip_power, own_slip, stations, penetration, cell_penetration, longest, split_marks,
                        split_edges);
    }
    bool fits() const {
        using Two = std::array<long, 2>;
        using Three = std::array<long, 3>;
        long m = M(), n = PARTS[SPLITS - 1] * m + 1;
        return m > 0 && row_marks.size() == m + 3 && mean.shape == Two{m, MODES} && ends.shape == Three{m, 2, MODES} &&
               loads.shape == mean.shape && load_edges.shape == Two{m + 1, MODES} && moments.shape == Two{MOMENTS, m} &&
               moment_edges.shape == Two{MOMENTS, m + 1} && edge_moments.shape == Two{m + 1, MOMENTS} &&
               slip_edges.shape == Two{m, 4} && (slip_power == 1 || slip_power == 2) && own_slip.size() == m &&
               stations.size() == STATIONS && penetration.shape == Two{MOMENTS, STATIONS} &&
               cell_penetration.shape == Two{m, STATIONS} && split_marks.size() == n &&
               split_edges.shape == Three{SPLITS, n, MODES};
    }
    long M() const { return marks.size() - 1; }
    // Columns and rows of a strip in the system of equations.
    long block(bool rolls) const { return (rolls ? 2 * M() : 0) + MOMENTS; }
};

// Cells of S strips.
struct StripGrid {
    Array<double, 2> x;       // (S, M + 3) m, boundaries and those of two more cells ahead, by length on the surface
    Array<double, 1> length;  // (S,) m
    Numbers width;            // (S,) m
    Numbers stretch;          // (S,) length on the surface over length on the rolling circle
    Indices strip;            // (S,) numbers on the lattice
    Numbers middle;           // (S,) m, across

    auto fields() { return std::tie(x, length, width, stretch, strip, middle); }
    bool fits() const {
        long s = x.size();
        return x.shape[1] > 0 && length.size() == s && width.size() == s && stretch.size() == s && strip.size() == s &&
               middle.size() == s;
    }
    long size() const { return x.size(); }
};

}  // namespace wr
