"""Schema of study files: a scene, and the variation of its parameters."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, Strict, ValidationError, ValidationInfo, field_validator, model_validator

from wheelrail.scenes.schema import quantities as q
from wheelrail.scenes.schema.edits import flat
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.messages import validation_error
from wheelrail.scenes.schema.tables import SceneTable
from wheelrail.scenes.schema.toml import parse, read_text
from wheelrail.support.text_file import DEEPEST, present

Values = Annotated[tuple[Any, ...], Strict(False), Field(min_length=1)]
Count = Annotated[int, Strict(), q.Range(1, 100_000, whole=True)]
Processes = Annotated[int, Strict(), q.Range(1, 1024, whole=True)]


class Between(SceneTable):
    """Uniform or log-uniform distribution from low to high; rounded for integer keys."""

    low: q.Finite
    high: q.Finite
    scale: Literal["linear", "log"] = "linear"

    @model_validator(mode="after")
    def _ordered(self) -> Between:
        if not self.low < self.high:
            raise q.reject(f"must be greater than low = {self.low:g}", "high")
        if self.scale == "log" and self.low <= 0.0:
            raise q.reject('must be greater than 0 with scale = "log"', "low")
        return self


RANGE = frozenset(Between.model_fields)


class LatinHypercube(SceneTable):
    """Latin hypercube samples over ranges of parameters (McKay, Beckman, Conover 1979), reproducible by seed."""

    samples: Count
    seed: q.Seed = 1
    ranges: Annotated[dict[str, Between], Field(min_length=1)]


class Convergence(SceneTable):
    """Order of convergence along one dimension.

    over: the dimension; the first numeric one by default.
    reference: "hertz", the closed form, or the values of a case finer than all others; with further keys of the scene
        it is common to the points of their dimensions.
    quantities: names of the compared quantities; all by default.
    rms_over: dimensions over which errors are averaged (root mean square): errors of single cases scatter with the
        position of the patch edge between grid points.
    finest: number of values, the finest ones, for the fitted order; all by default.
    """

    over: str | None = None
    reference: Literal["hertz"] | Annotated[dict[str, Any], Field(min_length=1)]
    quantities: Annotated[tuple[str, ...], Strict(False), Field(min_length=1)] | None = None
    rms_over: Annotated[tuple[str, ...], Strict(False)] = ()
    finest: Annotated[int, Strict(), q.Range(2, 1000, whole=True)] | None = None

    @field_validator("quantities")
    @classmethod
    def _physical(cls, names: tuple[str, ...] | None) -> tuple[str, ...] | None:
        from wheelrail.scenes.studies.quantities import PHYSICAL

        for name in names or ():
            if name not in PHYSICAL:
                near = get_close_matches(name, PHYSICAL, n=1, cutoff=0.6)
                hint = f"; did you mean {near[0]}?" if near else ""
                raise q.reject(f"{name}: must be a quantity of the results{hint}")
        return names


class StudyTable(SceneTable):
    """A study; its cases are all combinations of `grid`, `together` and `latin_hypercube`.

    scene: file, relative to the study's folder, or a table. vehicle: vehicle file, whose values are parameters, too:
    vehicle.elements.primary.stiffness.1. compute: the run in time, the steady curve or the critical speed of a scene of
    a run with a vehicle file. one_at_a_time: each parameter alone at both ends of its range. workers: processes on this
    machine, one per core by default. histories: store time histories of runs. without: keys to remove from the scene.
    set: values for all cases. grid: values by parameter. together: tables of parameters that change at the same time.
    skip: tables of values, by parameter; cases that have all values of a table are not computed. Parameters are dotted
    keys of the scene:
    upper.radii, creepage.0.
    """

    kind: Literal["study"] = "study"
    scene: str | dict[str, Any]
    vehicle: str | None = None
    compute: Literal["run", "curving", "critical"] = "run"
    workers: Processes | None = None
    histories: bool = False
    without: Annotated[tuple[str, ...], Strict(False)] = ()
    set: dict[str, Any] = Field(default_factory=dict)
    grid: dict[str, Values] = Field(default_factory=dict)
    together: Annotated[tuple[dict[str, Values], ...], Strict(False)] = ()
    latin_hypercube: LatinHypercube | None = None
    one_at_a_time: dict[str, Between] = Field(default_factory=dict)
    skip: Annotated[tuple[dict[str, Values], ...], Strict(False)] = ()
    convergence: Convergence | None = None

    @field_validator("scene")
    @classmethod
    def _existing(cls, value: str | dict[str, Any], info: ValidationInfo) -> str | dict[str, Any]:
        """A file, relative to the study's folder, as its full path."""
        if not isinstance(value, str):
            return value
        file = Path((info.context or {}).get("folder", "."), value)
        if not (present(file) and file.is_file()):
            raise q.reject("must be an existing scene file, relative to the study's folder")
        return str(file.resolve())

    @field_validator("vehicle")
    @classmethod
    def _vehicle(cls, value: str | None, info: ValidationInfo) -> str | None:
        """A vehicle file as its full path."""
        if value is not None:
            file = Path((info.context or {}).get("folder", "."), value)
            if not (present(file) and file.is_file()):
                raise q.reject("must be an existing vehicle file, relative to the study's folder")
            return str(file.resolve())
        return None

    @model_validator(mode="after")
    def _varied(self) -> StudyTable:
        if not any(self.tables):
            raise q.reject(
                "nothing is varied; values in [grid], [[together]], [latin_hypercube], [one_at_a_time] are required",
                "grid",
            )
        parameters = [(name, location) for location, table in self.parameter_tables for name in table]
        for name, location in parameters:
            if not all(name.split(".")) or name.count(".") > DEEPEST:
                raise q.reject(f'"{name[:100]}": must be a dotted key of the scene', location)
            if name == "kind":
                raise q.reject("kind: must not be varied; a study has one kind of scene", location)
            conflicts = [
                parameter for parameter, _ in parameters if parameter == name or parameter.startswith(name + ".")
            ]
            if len(conflicts) > 1:
                raise q.reject(
                    f"{name}: must be named once"
                    + (f", is also set by {conflicts[1]}" if conflicts[1] != name else ""),
                    location,
                )
        for name, values in self.grid.items():
            _differ(name, "grid", values)
        for table in self.together:
            if len({len(values) for values in table.values()}) > 1:
                lengths = ", ".join(f"{name} has {len(values)}" for name, values in table.items())
                raise q.reject(f"all parameters must have equally many values: {lengths}", "together")
            _differ(", ".join(table), "together", list(zip(*table.values(), strict=True)))
        self._check_skipped()
        return self

    def _check_skipped(self) -> None:
        """Raises a validation error for a skipped value that no case has."""
        varied = {name: values for table in (self.grid, *self.together) for name, values in table.items()}
        for name, values in ((name, values) for table in self.skip for name, values in table.items()):
            if name not in varied:
                raise q.reject(f"{name}: must be a parameter of [grid] or [[together]]", "skip")
            for value in values:
                if value not in varied[name]:
                    raise q.reject(f"{name}: {value!r} must be one of its values", "skip")

    @property
    def parameter_tables(self) -> tuple[tuple[str, Mapping[str, Any]], ...]:
        """Tables of parameters with their location in the study."""
        cube = self.latin_hypercube
        ranges: tuple[tuple[str, Mapping[str, Any]], ...] = (("latin_hypercube", cube.ranges),) if cube else ()
        ranges += (("one_at_a_time", self.one_at_a_time),) if self.one_at_a_time else ()
        return (("set", self.set), ("grid", self.grid), *(("together", table) for table in self.together), *ranges)

    @property
    def tables(self) -> tuple[Mapping[str, Any], ...]:
        """Tables of the varied parameters."""
        return tuple(table for location, table in self.parameter_tables if location != "set")

    @property
    def processes(self) -> int:
        """Number of processes on this machine."""
        return self.workers or len(os.sched_getaffinity(0))

    def base(self, folder: str | Path) -> tuple[dict[str, Any], Path]:
        """Tables of the scene and of the vehicle, and the scene's file (hypothetical for a scene in the study)."""
        from wheelrail.scenes.builders.vehicle_tables import VEHICLE_FILE, vehicle_tables

        file = Path(self.scene) if isinstance(self.scene, str) else Path(folder, "scene")
        tables = parse(read_text(file), file) if isinstance(self.scene, str) else self.scene
        return (tables if self.vehicle is None else {**tables, VEHICLE_FILE: vehicle_tables(self.vehicle)}), file


def _differ(name: str, location: str, rows: Sequence[Any]) -> None:
    values = set[Any]()
    for row in rows:
        if (value := _hashable(row)) in values:
            raise q.reject(f"{name}: {row!r} must be listed once", location)
        values.add(value)


def _hashable(value: Any) -> Any:
    """Hashable equivalent of a value."""
    if isinstance(value, list | tuple):
        return tuple(map(_hashable, value))
    if isinstance(value, Mapping):
        return frozenset((key, _hashable(inner)) for key, inner in value.items())
    return value


def load_study(path: str | Path) -> StudyTable:
    """Validated study of a TOML file. Raises SceneError naming file, key, value and what is allowed."""
    return check_study(parse(read_text(Path(path)), path), path)


def check_study(data: Mapping[str, Any], path: str | Path = "study") -> StudyTable:
    """Validated study of a table; path: its file, for errors, to whose folder paths in the study are relative."""
    if "kind" in data and data["kind"] != "study":
        raise SceneError(f'{path}: kind = {data["kind"]!r}: must be "study"')
    data = _dotted(data)
    try:
        return StudyTable.model_validate(data, context={"folder": Path(path).parent})
    except ValidationError as error:
        raise validation_error(error, StudyTable, data, path) from None


def _dotted(data: Mapping[str, Any]) -> dict[str, Any]:
    """Dotted names of parameters written without quotes, `upper.radii = ...`, which TOML reads as nested tables."""
    study = dict(data)
    for key in ("set", "grid", "one_at_a_time"):
        if isinstance(data.get(key), Mapping):
            study[key] = flat(data[key], RANGE)
    for key in ("together", "skip"):
        if isinstance(data.get(key), list | tuple):
            study[key] = [flat(table, RANGE) if isinstance(table, Mapping) else table for table in data[key]]
    for key, inner in (("latin_hypercube", "ranges"), ("convergence", "reference")):
        table = data.get(key)
        if isinstance(table, Mapping) and isinstance(table.get(inner), Mapping):
            study[key] = {**table, inner: flat(table[inner], RANGE)}
    return study
