// Checks of what Python gives to the equations of strips.
#pragma once
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "contact/models/lattice/system/core/equation_data.hpp"
#include "structures.hpp"

namespace wr {

using namespace nanobind::literals;

inline void require_values(Rows values, const EquationData& data) {
    require(data.fits(values), "values: must be (S, block) of the strips of the data");
}

inline void require_strips(Indices strips, long K) {
    for (long k : strips) require(k >= 0 && k < K, "strips: numbers beyond the lattice");
}

}  // namespace wr
