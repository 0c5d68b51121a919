// Checks of Python's inputs to the equations of strips.
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

// Strips of a lattice, ascending.
inline std::vector<long> strips_of(Indices numbers, long K) {
    std::vector<long> strips(numbers.begin(), numbers.end());
    long before = -1;
    for (long k : strips) {
        require(k > before && k < K, "strips: must be ascending numbers of the lattice");
        before = k;
    }
    return strips;
}

inline Array<long, 1> array_of(const std::vector<long>& numbers) {
    Array<long, 1> copy(long(numbers.size()));
    std::copy(numbers.begin(), numbers.end(), copy.begin());
    return copy;
}

}  // namespace wr
