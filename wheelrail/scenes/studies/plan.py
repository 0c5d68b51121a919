"""Cases of a study: all combinations of the points of its dimensions, each a validated scene."""

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
from wheelrail.scenes.studies.validation import SceneChecker, study_messages

MOST = 10_000  # cases, to detect typing errors
SHOWN = 5  # error messages about cases
FURTHER = 500  # cases validated after the first error
SAMPLE = "sample"  # the dimension of a Latin hypercube


@dataclass(frozen=True)
class StudyAxis:
    """Dimension of n points, each with a value of every parameter; where: its place in the study file."""

    name: str
    values: Mapping[str, Sequence[Any]]
    reference: bool = False  # whether the last point is the reference of errors
    where: str = "grid"

    def __len__(self) -> int:
        return len(next(iter(self.values.values())))

    def points(self) -> list[dict[str, Any]]:
        return [dict(zip(self.values, row, strict=True)) for row in zip(*self.values.values(), strict=True)]

    def place(self, name: str, index: int) -> str:
        """Place in the study file of the value of a parameter at a point."""
        if self.reference and index == len(self) - 1:
            return f"convergence.reference.{name}"
        return f"{self.where}.{name}" + ("" if self.name == SAMPLE else f"[{index}]")


@dataclass(frozen=True)
class StudyCase:
    """Index in the grid, parameters, and the scene as tables and validated."""

    place: tuple[int, ...]
    parameters: Mapping[str, Any]
    table: Mapping[str, Any]
    scene: Scene

    def __str__(self) -> str:
        return ", ".join(f"{name} = {shown(value)}" for name, value in self.parameters.items())


@dataclass(frozen=True)
class Plan:
    """Dimensions and cases of a study; units of parameters by name; tables and kind of the scene."""

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
    """All cases of a study, validated.

    Parameters:
        study: validated study.
        path: its file, for errors.

    Raises SceneError for too many cases, and for invalid ones, naming file, case, key, value and what is allowed.
    """
    base, file = study.base(Path(path).parent)
    base = changed(without(base, study.without, f"{path}: without"), study.set, path)
    kind = base.get("kind")
    if not isinstance(kind, str) or kind not in KINDS:
        checked(base, file)  # raises the error
    model = KINDS[str(kind)]
    axes = _axes(study, lambda name: whole(model, keys_of(name)))
    over = None if study.convergence is None else _over(study.convergence, axes, model, path)
    axes = [over if over and axis.name == over.name else axis for axis in axes]
    if (count := prod(map(len, axes))) > MOST:
        sizes = " x ".join(f"{len(axis)} {axis.name}" for axis in axes)
        raise SceneError(f"{path}: {count} cases ({sizes}): must be at most {MOST}")
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
    """All combinations, validated; fixed: values that the study sets in all cases. Raises SceneError."""
    found, check, points = dict[tuple[int, ...], StudyCase](), SceneChecker(file), [axis.points() for axis in axes]

    def messages_of(place: tuple[int, ...]) -> Iterator[str]:
        parameters = {name: value for at, i in zip(points, place, strict=True) for name, value in at[i].items()}
        try:
            table = changed(base, parameters, path)
            found[place] = StudyCase(place, parameters, table, check(table))
        except SceneError as error:
            places = {name: f"set.{name}" for name in fixed}
            places |= {name: axis.place(name, i) for axis, i in zip(axes, place, strict=True) for name in axis.values}
            values = ", ".join(f"{name} = {shown(value)}" for name, value in parameters.items())
            own = _own(base, file)
            for line, placed in study_messages(error, places, file=file, path=path):
                yield line if placed else f"{file}: {line}" if line in own else f"{path}: with {values}: {line}"

    every = list(np.ndindex(*map(len, axes)))
    for places in (_alone(axes), every):
        wrong, left = dict[str, None](), FURTHER
        for place in places:
            if place not in found:
                wrong |= dict.fromkeys(messages_of(place))
            left -= bool(wrong)
            if len(wrong) > SHOWN or not left:
                break
        if wrong:
            more = [f"{path}: more errors of this kind"] if len(wrong) > SHOWN else []
            raise SceneError("\n".join([*list(wrong)[:SHOWN], *more]))
    return [found[place] for place in every]


def _alone(axes: Sequence[StudyAxis]) -> Iterator[tuple[int, ...]]:
    """Indices that reveal most errors: points of each dimension with the first of all others, extreme values first."""
    orders = [list(dict.fromkeys([*_extremes(axis), *range(len(axis))])) for axis in axes]
    for i, order in enumerate(orders):
        for k in order:
            yield tuple(k if i == j else 0 for j in range(len(axes)))


def _extremes(axis: StudyAxis) -> Iterator[int]:
    for values in filter(numbers, axis.values.values()):
        yield from (int(np.argmin(values)), int(np.argmax(values)))


def _own(base: Mapping[str, Any], file: Path) -> list[str]:
    """Errors of the scene itself, without the variation."""
    try:
        checked(base, file)
    except SceneError as error:
        return [line.removeprefix(f"{file}: ") for line in str(error).splitlines()]
    return []


def dimension(parameter: str) -> str:
    """Name of a dimension, allowed in NetCDF and xarray."""
    return parameter.replace(".", "_")


def shown(value: Any) -> str:
    """Short text of a value."""
    if isinstance(value, float | np.floating):
        return f"{value:.6g}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(shown, value))}]"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key} = {shown(inner)}" for key, inner in value.items()) + "}"
    return str(value)


def draw(cube: LatinHypercube, wholes: set[str]) -> dict[str, list[Any]]:
    """Sampled values of every parameter, by name; wholes: integer parameters, uniform including both ends."""
    from scipy.stats.qmc import LatinHypercube as Sampler

    unit = Sampler(d=len(cube.ranges), seed=cube.seed).random(cube.samples)
    found: dict[str, list[Any]] = {}
    for (name, between), fraction in zip(cube.ranges.items(), unit.T, strict=True):
        low, high = between.low, between.high
        if name in wholes:
            low, high = round(low), round(high) + 1
        if between.scale == "log":
            values = np.exp(np.log(low) + fraction * np.log(high / low))
        else:
            values = low + fraction * (high - low)
        found[name] = [floor(v) if name in wholes else float(v) for v in values]
    return found


def _over(wanted: Convergence, axes: Sequence[StudyAxis], model: type[BaseModel], path: str | Path) -> StudyAxis:
    """Dimension of convergence, with a reference case as its last point."""
    possible = [axis for axis in axes if axis.name != SAMPLE and numbers(next(iter(axis.values.values())))]
    by_name = {name: axis for axis in possible for name in (axis.name, *axis.values)}
    if not possible:
        raise SceneError(f"{path}: convergence: needs a numeric dimension in [grid] or [[together]]")
    if wanted.over is not None and wanted.over not in by_name:
        allowed = ", ".join(axis.name for axis in possible)
        raise SceneError(f'{path}: convergence.over = "{wanted.over}": must be a numeric dimension: {allowed}')
    over = by_name[wanted.over] if wanted.over else possible[0]
    if wanted.reference == "hertz":
        if model is not HertzScene:
            text = 'allowed only for kind = "hertz"; use the values of a finer case'
            raise SceneError(f'{path}: convergence.reference = "hertz": {text}')
        return over
    if over.values.keys() != wanted.reference.keys():
        raise SceneError(f"{path}: convergence.reference: must have exactly the keys {', '.join(over.values)}")
    if wanted.reference in over.points():
        raise SceneError(f"{path}: convergence.reference: must not be one of the values of {over.name}")
    values = {name: [*values, wanted.reference[name]] for name, values in over.values.items()}
    return replace(over, values=values, reference=True)


def _check_histories(cases: Sequence[StudyCase], path: str | Path) -> None:
    intervals = {case.scene.output.interval if case.scene.kind == "run" else None for case in cases}
    if None in intervals:
        raise SceneError(f'{path}: histories = true: allowed only for kind = "run"')
    if len(intervals) > 1 or 0.0 in intervals:
        raise SceneError(f"{path}: histories = true: requires the same output.interval, not 0, in all runs")


def numbers(values: Sequence[Any]) -> bool:
    """Whether all values are numbers."""
    return all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)
