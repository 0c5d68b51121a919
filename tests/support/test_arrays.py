"""Arrays of vectors of eight, which lie in one line of the cache each."""

from __future__ import annotations

import numpy as np
import pytest

from wheelrail.support.arrays import LINE, aligned


@pytest.mark.parametrize("shape", [(1, 8), (3, 6, 8), (700, 6, 8), (7, 5)])
def test_aligned_arrays_begin_at_a_line_of_the_cache(shape: tuple[int, ...]) -> None:
    kept = [aligned(shape) for _ in range(5)]  # at different places
    for values in kept:
        assert values.shape == shape
        assert values.ctypes.data % LINE == 0
        assert values.flags.c_contiguous
        values[...] = np.pi
        assert (values == np.pi).all()
