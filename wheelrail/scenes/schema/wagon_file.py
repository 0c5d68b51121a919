"""Reading and writing of wagon files (TOML)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic_core import PydanticCustomError

from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.messages import entry_message
from wheelrail.scenes.schema.override import WAGON, overridden
from wheelrail.scenes.schema.toml import parse, read_text

if TYPE_CHECKING:
    from wheelrail.vehicle.wagon.wagon import Wagon


def load_wagon(path: str | Path, base: Wagon | None = None) -> Wagon:
    """Wagon with the values of a TOML file.

    Parameters:
        path: wagon file.
        base: values missing in the file; the Manchester wagon by default.

    Raises SceneError naming file, key, value and what is allowed.
    """
    from wheelrail.vehicle.wagon.wagon import Wagon

    data = parse(read_text(Path(path)), path)
    try:
        changed: Wagon = overridden(base or Wagon(), data)
    except PydanticCustomError as error:
        context = error.context or {}
        key = str(context["key"])
        raise SceneError(f"{path}: {entry_message(tuple(key.split('.')), data, str(context['allowed']))}") from None
    return changed


def wagon_toml(wagon: Wagon) -> str:
    """The wagon as TOML with units in comments; reading it gives the same wagon."""
    return "\n".join(_lines(wagon)) + "\n"


def _lines(part: Any, title: str = "") -> Iterator[str]:
    """Values of a dataclass, then tables of its nested dataclasses."""
    from wheelrail.vehicle.wagon.force_law import ForceLaw

    if title:
        yield from ("", f"[{title}]")
    values = {field.name: getattr(part, field.name) for field in fields(part)}
    units = {name: allowed.unit for name, allowed in WAGON.items()}
    for name, value in values.items():
        unit = "fraction of it in the plane model" if title == "scaling" else units.get(name)
        if isinstance(value, ForceLaw):
            yield from (f"{name} = [  # {unit}", *(f"  [{float(x)!r}, {float(f)!r}]," for x, f in value.points), "]")
        elif isinstance(value, float | int):
            yield f"{name} = {float(value)!r}  # {unit}"
    for name, value in values.items():
        if not isinstance(value, ForceLaw | float | int):
            yield from _lines(value, name)
