"""Laws of wear from tables, as in scene files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any

from wheelrail.contact.wear.laws import (
    Archard,
    Energy,
    Kth,
    PearceSherratt,
    TGamma,
    Usfd,
    WearLaw,
    WearTable,
    Zone,
)

LAWS: Mapping[str, type[WearLaw]] = {
    "archard": Archard,
    "kth": Kth,
    "usfd": Usfd,
    "energy": Energy,
    "table": WearTable,
    "t-gamma": TGamma,
    "pearce-sherratt": PearceSherratt,
}


def law_from(table: Mapping[str, Any]) -> WearLaw:
    """Law of a table as in scene files: name, coefficients, scale, zones; points alone make a "table".

    Raises ValueError that names the key, its value and what is allowed.
    """
    values = dict(table)
    name = values.pop("name", "table" if "points" in values else None)
    if name not in LAWS:
        raise ValueError(f"law: name = {name!r}: must be one of {', '.join(LAWS)}")
    law = LAWS[name]
    keys = [part.name for part in fields(law)]
    if name in ("usfd", "pearce-sherratt"):  # whose points are the law
        keys.remove("points")
    if unknown := [key for key in values if key not in keys]:
        raise ValueError(f"law: {unknown[0]}: unknown for {name}, which has {', '.join(sorted(keys))}")
    if name in ("table", "t-gamma") and "points" not in values:
        raise ValueError(f'law: points: missing; "{name}" needs two or more pairs of numbers')
    zones = values.get("zones", ())
    if not (isinstance(zones, Sequence) and all(isinstance(zone, Mapping) for zone in zones)):
        raise ValueError(f"law: zones = {zones!r}: must be a list of tables with factor and angle or s")
    if zones:
        values["zones"] = tuple(_zone(zone) for zone in zones)
    return law(**values)


def _zone(table: Mapping[str, Any]) -> Zone:
    keys = [part.name for part in fields(Zone)]
    if unknown := [key for key in table if key not in keys]:
        raise ValueError(f"zone: {unknown[0]}: unknown, a zone has {', '.join(keys)}")
    if "factor" not in table:
        raise ValueError("zone: factor: missing; must be a number of at least 0")
    limits = {key: tuple(table[key]) for key in ("angle", "s") if isinstance(table.get(key), list | tuple)}
    return Zone(**{**table, **limits})
