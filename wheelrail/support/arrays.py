"""Types of arrays: `Array` of floats, `Complex`, `Nodes` (indices), `Mask` (booleans)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Nodes = NDArray[np.int64]
Mask = NDArray[np.bool_]
