"""The cases of a study: all combinations of the points of its dimensions, every one a checked scene."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import floor, prod
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

from wheelrail.scenes.schema.edits import changed, keys_of, without
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.messages import unit_of, whole
from wheelrail.scenes.schema.scene import KINDS, HertzScene, Scene, checked
from wheelrail.scenes.studies.schema import Convergence, LatinHypercube, StudyTable
from wheelrail.scenes.studies.validation import Checking, complaints

MOST = 10_000  # cases: a slip of the pen multiplies quickly
SHOWN = 5  # complaints about cases
FURTHER = 500  # cases that are looked at for more complaints
SAMPLE = "sample"  # the dimension of a Latin hypercube


@dataclass(frozen=True)
class StudyAxis:
    """A dimension: n points, each with a value for every one of its parameters; where these stand in the study."""

    name: str
    values: Mapping[str, Sequence[Any]]
    reference: bool = False  # whether the last point is the one that errors are counted from
    where: str = "grid"

    def __len__(self) -> int:
        return len(next(iter(self.values.values())))

    def points(self) -> list[dict[str, Any]]:
        return [dict(zip(self.values, row, strict=True)) for row in zip(*self.values.values(), strict=True)]

    def place(self, name: str, index: int) -> str:
        """Where in the study the value of a parameter at a point stands."""
        if self.reference and index == len(self) - 1:
            return f"convergence.reference.{name}"
        return f"{self.where}.{name}" + ("" if self.name == SAMPLE else f"[{index}]")


@dataclass(frozen=True)
class StudyCase:
    """Place in the grid, the parameters there, and the scene as a table and checked."""

    place: tuple[int, ...]
    parameters: Mapping[str, Any]
    table: Mapping[str, Any]
    scene: Scene

    def __str__(self) -> str:
        return ", ".join(f"{name} = {shown(value)}" for name, value in self.parameters.items())


@dataclass(frozen=True)
class Plan:
    """Dimensions and cases of a study; units of parameters by name; where files in the scenes are looked for."""

    study: StudyTable
    axes: tuple[StudyAxis, ...]
    cases: tuple[StudyCase, ...]
    units: Mapping[str, str]
    scene: Mapping[str, Any]
    kind: str
    convergence: StudyAxis | None = None

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(len(axis) for axis in self.axes)


def plan(study: StudyTable, path: str | Path = "study") -> Plan:
    """All cases of a study, checked; path names it in errors.

    Raises SceneError for too many cases, and for those that are no scene: file, case, key, value and what is allowed.
    """
    base, file = study.base(Path(path).parent)
    base = changed(without(base, study.without, f"{path}: without"), study.set, path)
    kind = base.get("kind")
    if not isinstance(kind, str) or kind not in KINDS:
        checked(base, file)  # which says what is allowed
    model = KINDS[str(kind)]
    axes = _axes(study, lambda name: whole(model, keys_of(name)))
    over = None if study.convergence is None else _over(study.convergence, axes, model, path)
    axes = [over if over and axis.name == over.name else axis for axis in axes]
    if (count := prod(map(len, axes))) > MOST:
        sizes = " x ".join(f"{len(axis)} {axis.name}" for axis in axes)
        raise SceneError(f"{path}: {count} cases ({sizes}): must be {MOST} at most")
    cases = _cases(axes, base, study.set, file, path)
    if study.histories:
        _check_histories(cases, path)
    units = {name: unit_of(model, keys_of(name)) for axis in axes for name in axis.values}
    return Plan(study, tuple(axes), tuple(cases), units, base, str(kind), over)


def _axes(study: StudyTable, whole: Callable[[str], bool]) -> list[StudyAxis]:
    axes = [StudyAxis(dimension(name), {name: values}) for name, values in study.grid.items()]
    axes += [StudyAxis(dimension(next(iter(t))), t, where=f"together[{i}]") for i, t in enumerate(study.together)]
    if study.latin_hypercube is not None:
        drawn = draw(study.latin_hypercube, set(filter(whole, study.latin_hypercube.ranges)))
        axes.append(StudyAxis(SAMPLE, drawn, where="latin_hypercube.ranges"))
    return axes


def _cases(
    axes: Sequence[StudyAxis], base: Mapping[str, Any], fixed: Mapping[str, Any], file: Path, path: str | Path
) -> list[StudyCase]:
    """All combinations, checked; the first complaints, where there are any. fixed: what base has from the study."""
    found, check, points = dict[tuple[int, ...], StudyCase](), Checking(file), [axis.points() for axis in axes]

    def complaints_of(place: tuple[int, ...]) -> Iterator[str]:
        parameters = {name: value for at, i in zip(points, place, strict=True) for name, value in at[i].items()}
        try:
            table = changed(base, parameters, path)
            found[place] = StudyCase(place, parameters, table, check(table))
        except SceneError as error:
            places = {name: f"set.{name}" for name in fixed}
            places |= {name: axis.place(name, i) for axis, i in zip(axes, place, strict=True) for name in axis.values}
            said = ", ".join(f"{name} = {shown(value)}" for name, value in parameters.items())
            own = _own(base, file)
            for line, placed in complaints(error, places, file=file, path=path):
                yield line if placed else f"{file}: {line}" if line in own else f"{path}: with {said}: {line}"

    every = list(np.ndindex(*map(len, axes)))
    for places in (_alone(axes), every):
        wrong, left = dict[str, None](), FURTHER
        for place in places:
            if place not in found:
                wrong |= dict.fromkeys(complaints_of(place))
            left -= bool(wrong)
            if len(wrong) > SHOWN or not left:
                break
        if wrong:
            more = [f"{path}: and more of that kind"] if len(wrong) > SHOWN else []
            raise SceneError("\n".join([*list(wrong)[:SHOWN], *more]))
    return [found[place] for place in every]


def _alone(axes: Sequence[StudyAxis]) -> Iterator[tuple[int, ...]]:
    """Places that show nearly everything that can be wrong: the points of each dimension with the first of all others,
    those of extreme values before the rest.
    """
    orders = [list(dict.fromkeys([*_extremes(axis), *range(len(axis))])) for axis in axes]
    for i, order in enumerate(orders):
        for k in order:
            yield tuple(k if i == j else 0 for j in range(len(axes)))


def _extremes(axis: StudyAxis) -> Iterator[int]:
    for values in filter(numbers, axis.values.values()):
        yield from (int(np.argmin(values)), int(np.argmax(values)))


def _own(base: Mapping[str, Any], file: Path) -> list[str]:
    """Complaints about the scene as it is, without what the study varies."""
    try:
        checked(base, file)
    except SceneError as error:
        return [line.removeprefix(f"{file}: ") for line in str(error).splitlines()]
    return []


def dimension(parameter: str) -> str:
    """A name that NetCDF and xarray like."""
    return parameter.replace(".", "_")


def shown(value: Any) -> str:
    """A value as a short text."""
    if isinstance(value, float | np.floating):
        return f"{value:.6g}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(shown, value))}]"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key} = {shown(inner)}" for key, inner in value.items()) + "}"
    return str(value)


def draw(cube: LatinHypercube, wholes: set[str]) -> dict[str, list[Any]]:
    """Values of every parameter, by name; of whole numbers both ends are as likely as the rest."""
    from scipy.stats.qmc import LatinHypercube as Sampler

    unit = Sampler(d=len(cube.ranges), seed=cube.seed).random(cube.samples)
    found: dict[str, list[Any]] = {}
    for (name, between), share in zip(cube.ranges.items(), unit.T, strict=True):
        low, high = between.low, between.high
        if name in wholes:
            low, high = round(low), round(high) + 1
        if between.scale == "log":
            values = np.exp(np.log(low) + share * np.log(high / low))
        else:
            values = low + share * (high - low)
        found[name] = [floor(v) if name in wholes else float(v) for v in values]
    return found


def _over(wanted: Convergence, axes: Sequence[StudyAxis], model: type[BaseModel], path: str | Path) -> StudyAxis:
    """The dimension of convergence, with the reference as its last point where that is a case."""
    possible = [axis for axis in axes if axis.name != SAMPLE and numbers(next(iter(axis.values.values())))]
    known = {name: axis for axis in possible for name in (axis.name, *axis.values)}
    if not possible:
        raise SceneError(f"{path}: convergence: there is no dimension of numbers in [grid] or [[together]]")
    if wanted.over is not None and wanted.over not in known:
        allowed = ", ".join(axis.name for axis in possible)
        raise SceneError(f'{path}: convergence.over = "{wanted.over}": must be a dimension of numbers: {allowed}')
    over = known[wanted.over] if wanted.over else possible[0]
    if wanted.reference == "hertz":
        if model is not HertzScene:
            says = 'only for scenes of kind = "hertz"; give values of a finer case'
            raise SceneError(f'{path}: convergence.reference = "hertz": {says}')
        return over
    if over.values.keys() != wanted.reference.keys():
        raise SceneError(f"{path}: convergence.reference: must have values for {', '.join(over.values)} and no others")
    if wanted.reference in over.points():
        raise SceneError(f"{path}: convergence.reference: must not be among the values of {over.name} itself")
    values = {name: [*values, wanted.reference[name]] for name, values in over.values.items()}
    return replace(over, values=values, reference=True)


def _check_histories(cases: Sequence[StudyCase], path: str | Path) -> None:
    intervals = {case.scene.output.interval if case.scene.kind == "run" else None for case in cases}
    if None in intervals:
        raise SceneError(f'{path}: histories = true: only for scenes of kind = "run"')
    if len(intervals) > 1 or 0.0 in intervals:
        raise SceneError(f"{path}: histories = true: needs one output.interval for all runs, and not 0")


def numbers(values: Sequence[Any]) -> bool:
    """Whether all values are numbers."""
    return all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)
