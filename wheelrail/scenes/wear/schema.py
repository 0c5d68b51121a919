"""Schema of wear files: a vehicle, its duty, a law of wear, and the steps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import product
from math import inf, prod
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AllowInfNan, Field, Strict, ValidationError, ValidationInfo, field_validator, model_validator

from wheelrail.scenes.schema import quantities as q
from wheelrail.scenes.schema.edits import flat
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.messages import validation_error
from wheelrail.scenes.schema.tables import SceneTable
from wheelrail.scenes.schema.toml import parse, read_text
from wheelrail.support.text_file import present

# Keys of a named contact, the fewest strips and cells: 6 and 8 take 2.4 times as long, and change the depth by 3 % RMS
# after 20 000 km in four curves, steps of twice the depth by 15 %.
CONTACTS = {"condensed": {"laws": "exact", "surface_size": 1e-3, "strips": 4, "cells": 6}}
SHARES = 1e-6  # largest error of the sum of shares or weights
MOST_CASES = 1000  # to detect typing errors
STEADY = "steady."  # begin of the varied keys of a curve
TITLED = "steady.curvature", "steady.speed"  # told by the title of a case without a name

RemovedDepth = Annotated[q.Finite, q.Range(1e-6, 2e-3, "m", "0.05 mm is 5e-5")]
Travel = Annotated[q.Finite, q.Range(1.0, 1e10, "m", "100 000 km is 1e8")]
LongestStep = Annotated[float, Strict(), AllowInfNan(True), q.Range(1.0, inf, "m", "1000 km is 1e6")]
Passages = Annotated[q.Finite, q.Range(1e-9, 1e3, "1/m", "of wheelsets, per m of the vehicle's distance")]
Interval = Annotated[q.Finite, q.Range(1e-2, 1e3, "m", "between rows of runs")]
Measure = Annotated[q.Finite, q.Range(0.0, 0.1, "m", "26 mm is 26e-3")]
Share = Annotated[q.Finite, q.Range(1e-6, 1.0, hint="of the distance")]
Weights = Annotated[tuple[Annotated[q.Finite, q.Range(1e-6, 1.0)], ...], Strict(False)]
Values = Annotated[tuple[Any, ...], Strict(False), Field(min_length=1)]


class SteadyTable(SceneTable):
    """A steady curve: curvature, 1/m, positive to the left; cant, m; speed, m/s."""

    curvature: q.Curvature
    cant: q.Cant = 0.0
    speed: q.RunSpeed


class DutyTable(SceneTable):
    """A case of the duty: a run, or a steady curve, with its share of the distance.

    scene: file of a run, by default that of the wear file. steady: a curve in place of the run. both_hands: curves to
    the right count as often as those to the left. start: distance, m, from which the rows of a run count. set: values
    of keys of the scene, by dotted names. vary: lists of such values, or of those of the curve (steady.speed); their
    combinations are cases. weights: of these values, parts of the share; equal by default. name: for tables and
    pictures.
    """

    name: str | None = None
    share: Share
    scene: str | None = None
    steady: SteadyTable | None = None
    both_hands: bool = False
    start: q.Length = 0.0
    set: dict[str, Any] = Field(default_factory=dict)
    vary: dict[str, Values] = Field(default_factory=dict)
    weights: dict[str, Weights] = Field(default_factory=dict)

    @field_validator("scene")
    @classmethod
    def _existing(cls, value: str | None, info: ValidationInfo) -> str | None:
        return None if value is None else _file(value, info)

    @model_validator(mode="after")
    def _one_kind(self) -> DutyTable:
        if self.both_hands and self.steady is None:
            raise q.reject("allowed only with steady; a run has the curves of its track", "both_hands")
        for name, values in self.vary.items():
            if twice := [value for value in values if values.count(value) > 1]:
                raise q.reject(f"{name}: {twice[0]!r} must be listed once", "vary")
            if name in self.set:
                raise q.reject(f"{name}: must be in set or in vary", "vary")
            if name.startswith(STEADY) and self.steady is None:
                raise q.reject(f"{name}: allowed only with steady", "vary")
        for name, weights in self.weights.items():
            if len(weights) != len(self.vary.get(name, ())):
                raise q.reject(f"{name}: must have a weight for each of its values in vary", "weights")
            if abs(sum(weights) - 1.0) > SHARES:
                raise q.reject(f"{name}: weights sum to {sum(weights):.6g}: must be 1", "weights")
        if prod(map(len, self.vary.values())) > MOST_CASES:
            raise q.reject(f"must have at most {MOST_CASES} combinations", "vary")
        tuple(self.cases(0))  # raises for curves that are not allowed
        return self

    def cases(self, number: int) -> Iterator[DutyTable]:
        """One case for each combination of varied values, with its part of the share; of the number-th case from 0."""
        lists = [
            [(name, value, weight) for value, weight in zip(values, self._weights(name), strict=True)]
            for name, values in self.vary.items()
        ]
        for chosen in product(*lists):
            values = {name: value for name, value, _ in chosen}
            own = self.model_copy(update={"steady": self._steady(values)})
            told = TITLED if self.name is None else ()
            words = [f"{name} = {value}" for name, value in values.items() if name not in told]
            yield own.model_copy(
                update={
                    "name": ", ".join([own.title(number), *words]),
                    "share": self.share * prod(weight for *_, weight in chosen),
                    "set": self.set | {name: value for name, value in values.items() if not name.startswith(STEADY)},
                }
            )

    def _weights(self, name: str) -> tuple[float, ...]:
        count = len(self.vary[name])
        return self.weights.get(name, (1.0 / count,) * count)

    def _steady(self, values: Mapping[str, Any]) -> SteadyTable | None:
        """The curve with varied values."""
        if self.steady is None:
            return None
        own = {name.removeprefix(STEADY): value for name, value in values.items() if name.startswith(STEADY)}
        try:
            return SteadyTable.model_validate(self.steady.model_dump() | own)
        except ValidationError as error:
            raise q.reject(f"{validation_error(error, SteadyTable, own, 'steady')}", "vary") from None

    def title(self, number: int) -> str:
        """Name of the case, the number-th one from 0."""
        if self.name is not None:
            return self.name
        if self.steady is None:
            return f"{number + 1}: run"
        radius = f"R {1.0 / abs(self.steady.curvature):.0f} m" if self.steady.curvature else "straight"
        return f"{number + 1}: {radius}, {self.steady.speed:g} m/s"


class ReprofileTable(SceneTable):
    """Limits at which the wheels are turned to the new profile: least Sd and qR, largest Sh and hollow, m.

    apart: whether each wheelset is turned at its own limits, with both wheels; otherwise all are.
    """

    Sd: Measure | None = None
    qR: Measure | None = None
    Sh: Measure | None = None
    hollow: Measure | None = None
    apart: bool = False


class RailTable(SceneTable):
    """Wear of the rails. passages: of wheelsets over a place, per m that the vehicle travels. depth: of a step, m."""

    passages: Passages
    depth: RemovedDepth = 5e-5


class WearTable(SceneTable):
    """Wear of the wheel profiles of a vehicle.

    scene: file of a run whose contact, track and wheels all cases have that name no other. vehicle: file; by
    default the plane wagon of the scene. law: name, coefficients, scale and zones of a law of wear. until:
    distance, m. depth: largest of a step, m. step: its longest distance, m. profiles: "one" for all wheels, or one
    for each of the "sides", "wheelsets" or "wheels". turned: whether the vehicle runs half of each case turned end for
    end. contact: keys of the scene for another contact that wears, or its model; each wheel is lifted to its load in
    the motion. interval: between rows of runs, m. renew: depth, m, after which the compliance of the bodies follows
    the worn profile. reprofile: limits of measures. rails: their wear; none by default.
    """

    kind: Literal["wear"] = "wear"
    scene: str
    vehicle: str | None = None
    law: dict[str, Any]
    until: Travel
    depth: RemovedDepth = 5e-5
    step: LongestStep = inf
    profiles: Literal["one", "sides", "wheelsets", "wheels"] = "one"
    turned: bool = False
    contact: dict[str, Any] = Field(default_factory=dict)
    interval: Interval = 2.0
    renew: RemovedDepth = 5e-4
    reprofile: ReprofileTable | None = None
    rails: RailTable | None = None
    duty: Annotated[tuple[DutyTable, ...], Strict(False), Field(min_length=1)]

    @field_validator("scene", "vehicle")
    @classmethod
    def _existing(cls, value: str | None, info: ValidationInfo) -> str | None:
        return None if value is None else _file(value, info)

    @field_validator("contact", mode="before")
    @classmethod
    def _named(cls, value: Any) -> Any:
        return {"model": value, **CONTACTS.get(value, {})} if isinstance(value, str) else value

    @field_validator("law")
    @classmethod
    def _known(cls, value: dict[str, Any]) -> dict[str, Any]:
        from wheelrail.contact.wear.law_tables import law_from

        try:
            law_from(value)
        except (TypeError, ValueError) as error:
            raise q.reject(f"{error}".removeprefix("law: ")) from None
        return value

    @model_validator(mode="after")
    def _whole(self) -> WearTable:
        total = sum(case.share for case in self.duty)
        if abs(total - 1.0) > SHARES:
            raise q.reject(f"shares sum to {total:.6g}: must be 1", "duty")
        names = [case.name for case in self.cases]
        if twice := [name for name in names if names.count(name) > 1]:
            raise q.reject(f"name = {twice[0]!r}: must be that of one case", "duty")
        if self.reprofile is not None and self.reprofile.apart and self.profiles in ("one", "sides"):
            raise q.reject('apart = true: allowed only with profiles = "wheelsets" or "wheels"', "reprofile")
        if len(names) > MOST_CASES:
            raise q.reject(f"has {len(names)} cases: must be at most {MOST_CASES}", "duty")
        return self

    @property
    def sides_apart(self) -> bool:
        """Whether left and right wheels have profiles of their own."""
        return self.profiles in ("sides", "wheels")

    @property
    def cases(self) -> tuple[DutyTable, ...]:
        """Cases of the duty, named, with one value of each varied key."""
        return tuple(case for number, own in enumerate(self.duty) for case in own.cases(number))


def _file(value: str, info: ValidationInfo) -> str:
    """Full path of a file, relative to the folder of the wear file."""
    file = Path((info.context or {}).get("folder", "."), value)
    if not (present(file) and file.is_file()):
        raise q.reject("must be an existing file, relative to the folder of the wear file")
    return str(file.resolve())


def load_wear(path: str | Path) -> WearTable:
    """Validated wear file. Raises SceneError naming file, key, value and what is allowed."""
    return check_wear(parse(read_text(Path(path)), path), path)


def check_wear(data: Mapping[str, Any], path: str | Path = "wear") -> WearTable:
    """Validated table; path: its file, for errors, to whose folder paths are relative."""
    if data.get("kind", "wear") != "wear":
        raise SceneError(f'{path}: kind = {data["kind"]!r}: must be "wear"')
    data = dict(data)
    if isinstance(data.get("duty"), list | tuple):
        data["duty"] = [_dotted(case) if isinstance(case, Mapping) else case for case in data["duty"]]
    try:
        return WearTable.model_validate(data, context={"folder": Path(path).parent})
    except ValidationError as error:
        raise validation_error(error, WearTable, data, path) from None


def _dotted(case: Mapping[str, Any]) -> dict[str, Any]:
    """A case with dotted names that are written without quotes, which TOML reads as nested tables."""
    named = {key: case[key] for key in ("set", "vary", "weights") if isinstance(case.get(key), Mapping)}
    return {**case, **{key: flat(table) for key, table in named.items()}}
