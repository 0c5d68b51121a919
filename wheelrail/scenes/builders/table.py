"""Contact of one side by a table of forces, checked against the scene."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wheelrail.scenes.builders.laws import friction_law
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.profiles import Side
from wheelrail.scenes.schema.scene import OnRails
from wheelrail.support.text_file import json_value, present

if TYPE_CHECKING:
    from wheelrail.contact.kinematics.wheelset_state import Mounting
    from wheelrail.contact.models.table.force_table import ForceTable
    from wheelrail.contact.models.table.model import TableContact
    from wheelrail.meshes.profiles.profile import Profile

UNITS = {"radius": " m", "wheel_y": " m", "rail_y": " m", "E": " Pa"}
SAME = 1e-9  # relative difference of numbers


def constant_friction(scene: OnRails, side: Side) -> float:
    """Coefficient of friction of a side. Raises SceneError for a law that is not constant."""
    from wheelrail.contact.laws.friction import Coulomb

    law = friction_law(scene, side)
    if not isinstance(law, Coulomb):
        raise SceneError(f"friction = {law}: must be a constant coefficient for a table")
    return law.mu


def pair_identity(
    scene: OnRails, side: Side, pair: tuple[Profile, Profile], mounting: Mounting
) -> dict[str, float | str]:
    """Inputs of the forces of one side besides the model: profiles as hashes, dimensions, material and friction."""
    return {
        "wheel": pair[0].digest(),
        "rail": pair[1].digest(),
        "radius": scene.side(side).radius or mounting.radius,
        "wheel_y": mounting.wheel_y,
        "rail_y": mounting.rail_y,
        "E": scene.E,
        "nu": scene.nu,
        "friction": constant_friction(scene, side),
    }


def table_contact(scene: OnRails, side: Side, pair: tuple[Profile, Profile], mounting: Mounting) -> TableContact:
    """Contact model of one side from the table of the scene.

    Parameters:
        scene: with `table`.
        side: left or right.
        pair: profiles of wheel and inclined rail.
        mounting: of the side.

    Raises SceneError for a file that is no table, and one of another pair, naming what differs.
    """
    from wheelrail.contact.models.table.model import TableContact

    assert scene.table is not None
    file = Path(scene.table)
    tables, identities = read_tables(file, file.stat().st_mtime_ns if present(file) else 0)
    own = side if side in tables else "left"
    for key, value in pair_identity(scene, side, pair, mounting).items():
        stored, unit = identities[own].get(key), UNITS.get(key, "")
        if isinstance(value, str):
            if value != stored:
                raise SceneError(f"{file.name}: made for another {key} profile than that of the {side} side")
        elif not isinstance(stored, float | int):
            raise SceneError(f"{file.name}: made for {key} = {stored!r}: must be a number")
        elif not abs(value - stored) <= SAME * abs(stored):
            raise SceneError(f"{file.name}: made for {key} = {stored:g}{unit}; the {side} side has {value:g}{unit}")
    return TableContact(tables[own])


@lru_cache(maxsize=4)
def read_tables(file: Path, stamp: int) -> tuple[dict[str, ForceTable], dict[str, dict[str, Any]]]:
    """Force tables, and the inputs of their computation, by side.

    Parameters:
        file: to read.
        stamp: its time of modification.

    Raises SceneError.
    """
    from wheelrail.scenes.datasets.force_table import force_tables
    from wheelrail.scenes.datasets.netcdf import read

    data = read(file)
    tables = force_tables(data, file)
    try:
        pairs = json_value(str(data.attrs.get("pairs")))
    except ValueError as error:
        raise SceneError(f"{file}: pairs: not valid JSON: {error}") from None
    if not isinstance(pairs, dict) or not all(isinstance(pairs.get(side), dict) for side in tables):
        raise SceneError(f"{file}: pairs: must have a table for each side")
    return tables, pairs
