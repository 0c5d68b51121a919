"""Contact patches as named variables with units."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.results.packed_patches import WIDTH, PackedPatches
from wheelrail.scenes.quantities import PATCH_FIELDS
from wheelrail.scenes.quantity import Schema, filled

if TYPE_CHECKING:
    from xarray import Variable

    from wheelrail.contact.results.result import Patch


def patch_variables(lists: Sequence[Sequence[Patch]], schema: Schema, shape: tuple[int, ...]) -> dict[str, Variable]:
    """Variables of a schema over dimensions of a sample and patch, padded with NaN.

    Parameters:
        lists: patches of every sample, in C order of the dimensions.
        schema: declarations.
        shape: sizes of these dimensions.

    The index of a patch is its place in the list of its sample.
    """
    packed = [PackedPatches.of(patches) for patches in lists]
    counts = np.array([len(patches) for patches in packed], dtype=int).reshape(shape)
    present = np.arange(max(1, counts.max(initial=0))) < counts[..., None]
    listed = PackedPatches(np.concatenate([np.empty((0, WIDTH)), *(patches.values for patches in packed)]))
    padded: dict[str, Any] = {"patches": counts}
    for field, names in PATCH_FIELDS.items():
        columns = listed.column(field).T if isinstance(names, tuple) else [listed.column(field)]
        for name, values in zip(np.atleast_1d(names).tolist(), columns, strict=True):
            padded[name] = np.full(present.shape + values.shape[1:], np.nan)
            padded[name][present] = values
    return filled(schema, {name: padded[name] for name in schema if name in padded})
