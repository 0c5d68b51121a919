"""Declarations of the variables and attributes of results, from which they are written and by which they are read."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from wheelrail.scenes.schema.errors import SceneError

if TYPE_CHECKING:
    from xarray import Dataset, Variable


class Declared(NamedTuple):
    """Declaration of a variable.

    Parameters:
        dims: names of its dimensions.
        units: of its values; empty for texts.
        text: meaning.
        needed: whether a file without it is refused.
    """

    dims: tuple[str, ...]
    units: str
    text: str
    needed: bool = True

    @property
    def attributes(self) -> dict[str, str]:
        """Attributes of the variable."""
        return {name: value for name, value in (("units", self.units), ("long_name", self.text)) if value}


Schema = Mapping[str, Declared]


def filled(schema: Schema, values: Mapping[str, Any]) -> dict[str, Variable]:
    """Variables of declared names with their dimensions, units and meanings; raises KeyError for another name.

    Parameters:
        schema: declarations.
        values: arrays by name.
    """
    from xarray import Variable

    return {
        name: Variable(schema[name].dims, getattr(value, "data", value), schema[name].attributes)
        for name, value in values.items()
    }


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
        if (found.dtype.kind in "fiub") != bool(declared.units):
            kind = "numbers" if declared.units else "texts"
            raise SceneError(f"{file}: {name}: values of type {found.dtype}; must be {kind}")
    for name, needed in attributes.items():
        value = data.attrs.get(name)
        if needed is str and not isinstance(value, str):
            raise SceneError(f"{file}: attribute {name}: {_shown(value)}; must be a text")
        if needed is float and not (isinstance(value, int | float | np.number) and isfinite(value)):
            raise SceneError(f"{file}: attribute {name}: {_shown(value)}; must be a number")


def _shown(value: object) -> str:
    return "missing" if value is None else f"{value!r:.60}"
