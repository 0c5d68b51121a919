"""Keys of a scene that its computation uses."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wheelrail.scenes.schema.scene import RunScene

STANDARD = ("normal", "tangential", "merge_distance")
PENALTY = ("stiffness_per_area", "regularisation", "normal_law")
ELASTIC = ("surface_size", "laws", "cell", "bodies", "degree", "points", "strips", "cells", "slip_order", *PENALTY)
LATTICE = ("strips", "cells")


def used_keys(scene: RunScene) -> dict[str, Any]:
    """Keys used by a run, by table, with resolved defaults of the discretisation, without missing values."""
    data: dict[str, Any] = json.loads(json.dumps(scene.model_dump()))
    unused = set() if scene.has_elements else set(ELASTIC)
    unused |= set() if scene.model == "standard" else set(STANDARD)
    if scene.has_elements:
        how = scene.discretisation
        data |= {"bodies": how.bodies, "points": how.points, "degree": how.degree}
        data |= {"strips": how.strips, "cells": how.cells} if how.points == "lattice" else {}
        unused |= {"slip_order"} if how.points == "lattice" else set(LATTICE)
        unused |= set() if how.bodies == "solid" else {"cell"}
        unused |= {"degree"} if how.bodies == "half-space" else set()
        unused |= set(PENALTY) if scene.laws == "exact" else set()
        if scene.normal_law is not None:
            unused.add("stiffness_per_area")
    if not scene.frictional:
        unused |= {"falling", "slip_order", "regularisation", "tangential"}
    for name, table in (scene.wheelsets or {}).items():  # where none is a value
        own = table.model_dump(mode="json", exclude_unset=True)
        data["wheelsets"][name] = {key: value or False for key, value in own.items()}
    return _with_values({key: value for key, value in data.items() if key not in unused})


def _with_values(table: dict[str, Any]) -> dict[str, Any]:
    return {
        key: _with_values(value) if isinstance(value, dict) else value
        for key, value in table.items()
        if value is not None
    }
