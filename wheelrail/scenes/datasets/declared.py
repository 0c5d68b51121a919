"""Check of the variables and attributes of a file of results by their declarations."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.scenes.quantity import Schema
from wheelrail.scenes.schema.errors import SceneError

if TYPE_CHECKING:
    from xarray import Dataset


def check(data: Dataset, file: Path, schema: Schema, attributes: Mapping[str, type]) -> None:
    """Raise SceneError naming the first variable or attribute that is missing or not as declared.

    Parameters:
        data: of a file.
        file: for messages.
        schema: declarations of the variables; others are passed over.
        attributes: needed ones, str or float, the latter finite.
    """
    for name, declared in schema.items():
        if name not in data.variables:
            if declared.needed:
                raise SceneError(f"{file}: {name}: missing; must be over {', '.join(declared.dims)}")
            continue
        found = data[name].variable
        if found.dims != declared.dims:
            found_dims, dims = (", ".join(map(str, names)) for names in (found.dims, declared.dims))
            raise SceneError(f"{file}: {name}: is over {found_dims or 'nothing'}; must be over {dims}")
        if (found.dtype.kind in "fiub") != bool(declared.unit):
            kind = "numbers" if declared.unit else "texts"
            raise SceneError(f"{file}: {name}: values of type {found.dtype}; must be {kind}")
    for name, needed in attributes.items():
        value = data.attrs.get(name)
        if needed is str and not isinstance(value, str):
            raise SceneError(f"{file}: attribute {name}: {_shown(value)}; must be a text")
        if needed is float and not (isinstance(value, int | float | np.number) and isfinite(value)):
            raise SceneError(f"{file}: attribute {name}: {_shown(value)}; must be a number")


def _shown(value: object) -> str:
    return "missing" if value is None else f"{value!r:.60}"
