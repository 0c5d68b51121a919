// Constituents of a strip contact at any pose: surfaces, tables, basis, laws.
#pragma once
#include <memory>
#include <vector>

#include "contact/geometry/core/surface_gap.hpp"
#include "contact/models/lattice/influence/core/lattice_tables.hpp"
#include "contact/models/lattice/system/core/contact_lines.hpp"
#include "contact/models/lattice/system/core/equation_data.hpp"

namespace wr {

struct LatticeSetting {
    Owned<SurfaceData> surface;
    Owned<Lines> lines;        // of the wheel's whole profile; none for quadrics
    Array<double, 2> outline;  // (2, n) m, places across, ascending, and heights of the rail's surface
    std::shared_ptr<LatticeTables> tables;
    // Bases of strips: the model's own one; equal cells of unloaded strips, along the probed range and around a
    // maximum; and equal cells at starts without an earlier result, in the order in which they are tried.
    Owned<StripBasis> basis, first, second;
    std::vector<Owned<StripBasis>> starts;
    Owned<ResidualCode> law;
    double margin = 0.0;          // m, largest gap that displacements may close
    long apart = 1;               // strips between those at which the penetration is estimated first
    double tolerance = 0.0;       // of the last step, relative to the largest pressure and length
    double least_pressure = 0.0;  // Pa, mean over a cell, below which a solution counts as one with tension

    // Whether there are tractions.
    bool rolls() const { return law.code; }
    // Whether the motion is a tangential displacement, which counts at a speed of 1 m/s.
    bool shifts() const { return rolls() && basis.slip_power == 1; }
    long cells() const { return basis.M(); }
    // Unknowns of a strip.
    long block() const { return basis.block(rolls()); }
    long strips() const { return tables->lattice.middle.size(); }
    bool fits() const {
        bool right = surface.fits() && tables && law.fits() && apart > 0 && !starts.empty() && first.M() > 2 &&
                     second.M() > 2 && outline.shape[0] == 2 && strips() > 2;
        if (surface.revolves) right = right && lines.fits() && lines.of(surface.rail) && outline.shape[1] > 0;
        return right;
    }
};

}  // namespace wr
