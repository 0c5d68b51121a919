"""Tables of contact forces as a Dataset, and back."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.schema.errors import SceneError
from wheelrail.support.cache import content_digest

if TYPE_CHECKING:
    from xarray import Dataset, Variable

    from wheelrail.contact.models.table.force_table import ForceTable
    from wheelrail.contact.tables.errors import TableErrors

KIND, HASH = "force table", "content"  # value of an attribute, name of another
NODES = {  # of the axes, with units and meaning
    "y": ("m", "lateral position of the tread from its nominal one"),
    "roll": ("1", "sine of the roll angle"),
    "yaw": ("1", "tangent of the yaw angle"),
    "level": ("N^(2/3)", "vertical load without friction, to the power 2/3"),
    "longitudinal": ("1", "asinh of the longitudinal creepage over its scale"),
    "lateral": ("1", "asinh of the lateral creepage over its scale"),
}
STAGES = {"normal": tuple(NODES)[:4], "friction": tuple(NODES)}
VALUES = {
    "normal": "height of the tread m, point of the resultant from the tread x, y, z m, lateral and longitudinal force "
    "over the vertical one, moment about the point over it x, y, z m",
    "friction": "change of force by friction along x, lateral tangent and normal, and of the moment over 0.01 m about "
    "x, y, z, over friction coefficient times vertical load",
}


def table_dataset(
    tables: Mapping[str, ForceTable], errors: Mapping[str, TableErrors], attributes: Mapping[str, Any]
) -> Dataset:
    """Dataset of the force tables of one side, or of both sides if different.

    Parameters:
        tables: by side.
        errors: at random points, by side.
        attributes: of the Dataset.
    """
    from xarray import Dataset

    variables: dict[str, Variable] = {}
    for side, table in tables.items():
        for stage, own in (("normal", table.normal), ("friction", table.friction)):
            variables |= _stage_variables(f"{side}_{stage}", stage, own)
        variables |= _error_variables(side, errors[side])
    places = {
        f"{side}_{key}": getattr(table.frame, key) for side, table in tables.items() for key in ("radius", "lateral")
    }
    coefficients = {f"{side}_friction": table.friction.coefficient for side, table in tables.items()}
    data = Dataset(variables).assign_attrs(kind=KIND, sides=" ".join(tables), **places, **coefficients, **attributes)
    return data.assign_attrs({HASH: content_hash(data)})


def content_hash(data: Dataset) -> str:
    """Hash of all variables and attributes but itself; the same when another program copies them."""
    attributes = {str(name): dict(values.attrs) for name, values in data.variables.items()}
    attributes[""] = {name: value for name, value in data.attrs.items() if name != HASH}
    text = json.dumps(attributes, sort_keys=True, default=lambda value: np.asarray(value).tolist())
    arrays = {f"{name} {' '.join(map(str, v.dims))}": v.values for name, v in data.variables.items()}
    return content_digest(text, arrays).decode()


def _stage_variables(name: str, stage: str, table: Any) -> dict[str, Variable]:
    from xarray import Variable

    axes = STAGES[stage]
    dims = [f"{name}_{axis}" for axis in axes]
    nodes = [getattr(table, axis) for axis in axes]
    variables = {
        dim: Variable(dim, values, {"units": NODES[axis][0], "long_name": NODES[axis][1]})
        for dim, axis, values in zip(dims, axes, nodes, strict=True)
    }
    values = table.values.reshape(*map(len, nodes), -1)
    variables[f"{name}_values"] = Variable([*dims, f"{stage}_value"], values, {"long_name": VALUES[stage]})
    return variables


def _error_variables(side: str, errors: TableErrors) -> dict[str, Variable]:
    from xarray import Variable

    from wheelrail.contact.tables.errors import VARIABLES

    point = f"{side}_point"
    about = "table less contact model, over the vertical load"
    return {
        f"{side}_points": Variable([point, "variable"], errors.points, {"long_name": ", ".join(VARIABLES)}),
        f"{side}_force_error": Variable([point, "component"], errors.force, {"units": "1", "long_name": about}),
        f"{side}_moment_error": Variable([point, "component"], errors.moment, {"units": "m", "long_name": about}),
    }


def force_tables(data: Dataset, file: Path) -> dict[str, ForceTable]:
    """Tables by side of a Dataset.

    Parameters:
        data: from a file.
        file: for errors.

    Raises SceneError for a Dataset of anything else, naming what is missing or does not fit.
    """
    from wheelrail.contact.models.table.force_table import ForceTable, FrictionTable, NormalTable, TreadFrame

    if data.attrs.get("kind") != KIND:
        raise SceneError(f"{file}: not a table of contact forces; wheelrail table makes one")
    if HASH not in data.attrs:
        raise SceneError(f"{file}: of an earlier version, without a hash of its content; wheelrail table makes it anew")
    if data.attrs[HASH] != content_hash(data):
        raise SceneError(f"{file}: its content is not what wheelrail table has written: changed or damaged")
    sides = str(data.attrs.get("sides")).split()
    if sides not in (["left"], ["left", "right"]):
        raise SceneError(f"{file}: sides = {data.attrs.get('sides')!r}: must be left, or left right")
    tables = {}
    for side in sides:
        radius, lateral, coefficient = (
            _number(data, f"{side}_{key}", file) for key in ("radius", "lateral", "friction")
        )
        normal, friction = (_stage(data, f"{side}_{stage}", stage, file) for stage in STAGES)
        try:
            tables[side] = ForceTable(
                TreadFrame(radius, lateral), NormalTable(**normal), FrictionTable(**friction, coefficient=coefficient)
            )
        except ValueError as error:
            raise SceneError(f"{file}: {side} side: {error}") from None
    return tables


def _number(data: Dataset, name: str, file: Path) -> float:
    """Attribute that is a number."""
    value = data.attrs.get(name)
    if not isinstance(value, int | float | np.integer | np.floating):
        raise SceneError(f"{file}: {name} = {value!r}: must be a number")
    return float(value)


def _stage(data: Dataset, name: str, stage: str, file: Path) -> dict[str, Any]:
    """Nodes by axis, and values, of one stage."""
    dims = [f"{name}_{axis}" for axis in STAGES[stage]]
    expected = {**{dim: (dim,) for dim in dims}, f"{name}_values": (*dims, f"{stage}_value")}
    for variable, own in expected.items():
        if variable not in data.variables:
            raise SceneError(f"{file}: {variable}: missing")
        if data[variable].dims != own:
            raise SceneError(
                f"{file}: {variable}: over {', '.join(map(str, data[variable].dims))}: must be over {', '.join(own)}"
            )
    return {
        variable.removeprefix(f"{name}_"): np.ascontiguousarray(data[variable].values).ravel() for variable in expected
    }
