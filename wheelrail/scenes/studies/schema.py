"""What a study may say, checked on reading: a scene, and what of it is varied how."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, Strict, ValidationError, ValidationInfo, field_validator, model_validator

from wheelrail.scenes.schema import quantities as q
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.messages import refuse
from wheelrail.scenes.schema.tables import SceneTable
from wheelrail.scenes.schema.toml import parse, read_text

Values = Annotated[tuple[Any, ...], Strict(False), Field(min_length=1)]
Count = Annotated[int, Strict(), q.Range(1, 100_000, whole=True)]
Processes = Annotated[int, Strict(), q.Range(1, 1024, whole=True)]


class Between(SceneTable):
    """A number from low to high, drawn evenly, or evenly in its logarithm; rounded where the scene wants whole ones."""

    low: q.Finite
    high: q.Finite
    scale: Literal["linear", "log"] = "linear"

    @model_validator(mode="after")
    def _ordered(self) -> Between:
        if not self.low < self.high:
            raise q.refuse(f"must be greater than low = {self.low:g}", "high")
        if self.scale == "log" and self.low <= 0.0:
            raise q.refuse('must be greater than 0 with scale = "log"', "low")
        return self


class LatinHypercube(SceneTable):
    """Samples spread evenly over ranges of parameters (McKay, Beckman, Conover 1979), the same for the same seed."""

    samples: Count
    seed: q.Seed = 1
    ranges: Annotated[dict[str, Between], Field(min_length=1)]


class Convergence(SceneTable):
    """How fast the error falls along one dimension, `over` (the first one of numbers, unless given).

    reference: "hertz", the closed form of a Hertz pair, or values for a case that is finer than all others.
    """

    over: str | None = None
    reference: Literal["hertz"] | Annotated[dict[str, Any], Field(min_length=1)]


class StudyTable(SceneTable):
    """A scene, keys of it to leave out (`without`), values that hold in all cases (`set`), and what is varied: values
    of a `grid`, tables of parameters that change `together`, a Latin hypercube; all their combinations are the cases.

    Parameters are keys of the scene, dotted into its tables and arrays: upper.radii, creepage.0. scene: a file, seen
    from the study's folder, or a table. workers: processes on this machine, one for each core unless given. histories:
    keep what runs did over time, not only how they ended.
    """

    kind: Literal["study"] = "study"
    scene: str | dict[str, Any]
    workers: Processes | None = None
    histories: bool = False
    without: Annotated[tuple[str, ...], Strict(False)] = ()
    set: dict[str, Any] = Field(default_factory=dict)
    grid: dict[str, Values] = Field(default_factory=dict)
    together: Annotated[tuple[dict[str, Values], ...], Strict(False)] = ()
    latin_hypercube: LatinHypercube | None = None
    convergence: Convergence | None = None

    @field_validator("scene")
    @classmethod
    def _found(cls, value: str | dict[str, Any], info: ValidationInfo) -> str | dict[str, Any]:
        """A file, relative to the study's folder, as its full path."""
        if not isinstance(value, str):
            return value
        file = Path((info.context or {}).get("folder", "."), value)
        if not file.is_file():
            raise q.refuse("must be the file of a scene that exists, seen from the study's folder")
        return str(file.resolve())

    @model_validator(mode="after")
    def _varied(self) -> StudyTable:
        if not any(self.tables):
            raise q.refuse("nothing is varied: give values in [grid], [[together]] or [latin_hypercube]", "grid")
        named = [(name, place) for place, table in self.places for name in table]
        for name, place in named:
            if not all(name.split(".")):
                raise q.refuse(f'"{name}" is no key: must be one of the scene, dotted into its tables', place)
            if name == "kind":
                raise q.refuse("kind cannot be varied: a study is of one kind of scene", place)
            others = [other for other, _ in named if other == name or other.startswith(name + ".")]
            if len(others) > 1:
                raise q.refuse(
                    f"{name} is named twice" + (f", also by {others[1]}" if others[1] != name else ""), place
                )
        for name, values in self.grid.items():
            _differ(name, "grid", values)
        for table in self.together:
            if len({len(values) for values in table.values()}) > 1:
                lengths = ", ".join(f"{name} has {len(values)}" for name, values in table.items())
                raise q.refuse(f"values that change together must be as many: {lengths}", "together")
            _differ(", ".join(table), "together", list(zip(*table.values(), strict=True)))
        return self

    @property
    def places(self) -> tuple[tuple[str, Mapping[str, Any]], ...]:
        """Tables that name parameters, with where in the study they are."""
        cube = self.latin_hypercube
        ranges = (("latin_hypercube", cube.ranges),) if cube else ()
        return (("set", self.set), ("grid", self.grid), *(("together", table) for table in self.together), *ranges)

    @property
    def tables(self) -> tuple[Mapping[str, Any], ...]:
        """What is varied, by name."""
        return tuple(table for place, table in self.places if place != "set")

    @property
    def processes(self) -> int:
        """On this machine."""
        return self.workers or len(os.sched_getaffinity(0))

    def base(self, folder: str | Path) -> tuple[dict[str, Any], Path]:
        """The scene's table, and the file that it is in, or would be in."""
        if isinstance(self.scene, str):
            file = Path(self.scene)
            return parse(read_text(file), file), file
        return self.scene, Path(folder, "scene")


def _differ(name: str, place: str, rows: Sequence[Any]) -> None:
    seen = set[Any]()
    for row in rows:
        if (known := _hashable(row)) in seen:
            raise q.refuse(f"{name}: {row!r} is listed twice", place)
        seen.add(known)


def _hashable(value: Any) -> Any:
    """What is equal where values are."""
    if isinstance(value, list | tuple):
        return tuple(map(_hashable, value))
    if isinstance(value, Mapping):
        return frozenset((key, _hashable(inner)) for key, inner in value.items())
    return value


def load_study(path: str | Path) -> StudyTable:
    """The study in a TOML file. Raises SceneError naming file, key, value and what is allowed."""
    return check_study(parse(read_text(Path(path)), path), path)


def check_study(data: Mapping[str, Any], path: str | Path = "study") -> StudyTable:
    """The study that a table describes; path names it in errors, and files in it are looked for beside it."""
    if "kind" in data and data["kind"] != "study":
        raise SceneError(f'{path}: kind = {data["kind"]!r}: must be "study"')
    data = _dotted(data)
    try:
        return StudyTable.model_validate(data, context={"folder": Path(path).parent})
    except ValidationError as error:
        raise refuse(error, StudyTable, data, path) from None


def _dotted(data: Mapping[str, Any]) -> dict[str, Any]:
    """Parameters that were written without quotes, `upper.radii = ...`, which TOML reads as tables in tables."""
    found = dict(data)
    for place in ("set", "grid"):
        if isinstance(data.get(place), Mapping):
            found[place] = _flat(data[place])
    if isinstance(data.get("together"), list | tuple):
        found["together"] = [_flat(table) if isinstance(table, Mapping) else table for table in data["together"]]
    for place, inner in (("latin_hypercube", "ranges"), ("convergence", "reference")):
        table = data.get(place)
        if isinstance(table, Mapping) and isinstance(table.get(inner), Mapping):
            found[place] = {**table, inner: _flat(table[inner])}
    return found


def _flat(table: Mapping[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in table.items():
        if isinstance(value, Mapping) and value and not value.keys() & Between.model_fields.keys():
            found |= {f"{name}.{inner}": below for inner, below in _flat(value).items()}
        else:
            found[name] = value
    return found
