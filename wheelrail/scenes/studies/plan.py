"""Cases of a study: all combinations of the points of its dimensions, each a validated scene."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import floor, prod
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

from wheelrail.scenes.builders.vehicle_tables import (
    VEHICLE_FILE,
    is_of_vehicle,
    located,
    unit_in_vehicle,
    value_at,
    with_own_values,
)
from wheelrail.scenes.schema.edits import changed, keys_of, without
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.messages import unit_of, whole
from wheelrail.scenes.schema.scene import KINDS, HertzScene, Scene, checked
from wheelrail.scenes.studies.schema import Between, Convergence, LatinHypercube, StudyTable
from wheelrail.scenes.studies.validation import SceneChecker, study_messages

MAX_CASES = 10_000  # cases, to detect typing errors
MAX_MESSAGES = 5  # error messages about cases
MAX_CASES_AFTER_ERROR = 500  # cases validated after the first error
SAMPLE = "sample"  # the dimension of a Latin hypercube
VARIATION = "variation"  # the dimension of parameters that are varied one at a time; its first point varies none


@dataclass(frozen=True)
class StudyAxis:
    """Dimension of n points, each with a value of every parameter.

    Parameters:
        name: of the dimension.
        values: by parameter.
        reference: whether the last point is the reference of errors.
        common: values of the reference for parameters of other dimensions, and for further keys of the scene.
        where: location in the study file.
    """

    name: str
    values: Mapping[str, Sequence[Any]]
    reference: bool = False
    common: Mapping[str, Any] = field(default_factory=dict)
    where: str = "grid"

    def __len__(self) -> int:
        return len(next(iter(self.values.values())))

    def points(self) -> list[dict[str, Any]]:
        return [dict(zip(self.values, row, strict=True)) for row in zip(*self.values.values(), strict=True)]

    def location(self, name: str, index: int) -> str:
        """Location in the study file of the value of a parameter at a point."""
        if self.reference and index == len(self) - 1:
            return f"convergence.reference.{name}"
        return f"{self.where}.{name}" + ("" if self.name in (SAMPLE, VARIATION) else f"[{index}]")


@dataclass(frozen=True)
class StudyCase:
    """Index in the grid, parameters, and the scene as tables and validated."""

    index: tuple[int, ...]
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
    names = [name for _, table in study.parameter_tables for name in table]
    base = with_own_values(without(base, study.without, f"{path}: without"), names)
    base = changed(base, {located(name, base): value for name, value in study.set.items()}, path)
    kind = base.get("kind")
    _check_vehicle(study, base, names, path)
    if not isinstance(kind, str) or kind not in KINDS:
        checked({key: value for key, value in base.items() if key != VEHICLE_FILE}, file)  # raises the error
    model = KINDS[str(kind)]
    axes = _axes(study, lambda name: not is_of_vehicle(name) and whole(model, keys_of(name)))
    if study.one_at_a_time:
        axes.append(_one_at_a_time(study.one_at_a_time, base, path))
    over = None if study.convergence is None else _over(study.convergence, axes, model, path)
    axes = [over if over and axis.name == over.name else axis for axis in axes]
    if (count := prod(map(len, axes))) > MAX_CASES:
        sizes = " x ".join(f"{len(axis)} {axis.name}" for axis in axes)
        raise SceneError(f"{path}: {count} cases ({sizes}): must be at most {MAX_CASES}")
    cases = _cases(axes, base, study, file, path)
    if study.histories:
        _check_histories(cases, path)
    units = {
        name: unit_in_vehicle(name, base) if located(name, base) != name else unit_of(model, keys_of(name))
        for axis in axes
        for name in axis.values
    }
    return Plan(study, tuple(axes), tuple(cases), units, base, str(kind), over)


def _axes(study: StudyTable, whole: Callable[[str], bool]) -> list[StudyAxis]:
    axes = [StudyAxis(dimension(name), {name: values}) for name, values in study.grid.items()]
    axes += [StudyAxis(dimension(next(iter(t))), t, where=f"together[{i}]") for i, t in enumerate(study.together)]
    if study.latin_hypercube is not None:
        samples = draw(study.latin_hypercube, set(filter(whole, study.latin_hypercube.ranges)))
        axes.append(StudyAxis(SAMPLE, samples, where="latin_hypercube.ranges"))
    return axes


def _check_vehicle(study: StudyTable, base: Mapping[str, Any], names: Sequence[str], path: str | Path) -> None:
    """Raises SceneError for a missing vehicle file, and for a vehicle without a run."""
    if VEHICLE_FILE in base:
        if base.get("kind") != "run":
            raise SceneError(f'{path}: vehicle: allowed only for a scene with kind = "run"')
        return
    if study.compute != "run":
        raise SceneError(f'{path}: compute = "{study.compute}": needs vehicle, a vehicle file')
    for name in names:
        if is_of_vehicle(name):
            raise SceneError(f"{path}: {name}: needs vehicle, a vehicle file")


def _one_at_a_time(ranges: Mapping[str, Between], base: Mapping[str, Any], path: str | Path) -> StudyAxis:
    """Dimension of the nominal point and both ends of every range. Raises SceneError for a value that is no number."""
    columns: dict[str, list[float]] = {}
    for k, (name, range_) in enumerate(ranges.items()):
        nominal = value_at(base, name)
        if isinstance(nominal, bool) or not isinstance(nominal, int | float):
            raise SceneError(f"{path}: one_at_a_time.{name}: must be a number that scene or vehicle file have")
        columns[name] = [float(nominal)] * (1 + 2 * len(ranges))
        columns[name][1 + 2 * k : 3 + 2 * k] = [range_.low, range_.high]
    return StudyAxis(VARIATION, columns, where="one_at_a_time")


def _cases(
    axes: Sequence[StudyAxis], base: Mapping[str, Any], study: StudyTable, file: Path, path: str | Path
) -> list[StudyCase]:
    """All combinations but the skipped ones, validated. Raises SceneError."""
    cases, checker, points = dict[tuple[int, ...], StudyCase](), SceneChecker(file), [axis.points() for axis in axes]

    def parameters_at(index: tuple[int, ...]) -> dict[str, Any]:
        return {name: value for at, i in zip(points, index, strict=True) for name, value in at[i].items()}

    def messages_of(index: tuple[int, ...]) -> Iterator[str]:
        parameters = parameters_at(index) | _common(axes, index)
        try:
            table = changed(base, {located(name, base): value for name, value in parameters.items()}, path)
            cases[index] = StudyCase(index, parameters, table, checker(table))
        except SceneError as error:
            locations = {name: f"set.{name}" for name in study.set}
            locations |= {
                name: axis.location(name, i) for axis, i in zip(axes, index, strict=True) for name in axis.values
            }
            locations |= {name: f"convergence.reference.{name}" for name in _common(axes, index)}
            values = ", ".join(f"{name} = {shown(value)}" for name, value in parameters.items())
            scene_errors = _scene_errors(base, file)
            for line, of_study in study_messages(error, locations, file=file, path=path):
                yield (
                    line
                    if of_study
                    else f"{file}: {line}"
                    if line in scene_errors
                    else f"{path}: with {values}: {line}"
                )

    all_indices = list(np.ndindex(*map(len, axes)))
    if study.skip:
        all_indices = [index for index in all_indices if not _skipped(study, axes, index, parameters_at(index))]
    if not all_indices:
        raise SceneError(f"{path}: skip: leaves no case")
    computed = set(all_indices)
    for indices in (_revealing_indices(axes), all_indices):
        messages, remaining = dict[str, None](), MAX_CASES_AFTER_ERROR
        for index in indices:
            if index not in cases and index in computed:
                messages |= dict.fromkeys(messages_of(index))
            remaining -= bool(messages)
            if len(messages) > MAX_MESSAGES or not remaining:
                break
        if messages:
            note = [f"{path}: more errors of this kind"] if len(messages) > MAX_MESSAGES else []
            raise SceneError("\n".join([*list(messages)[:MAX_MESSAGES], *note]))
    return [cases[index] for index in all_indices]


def _common(axes: Sequence[StudyAxis], index: tuple[int, ...]) -> dict[str, Any]:
    """Values of the reference case that override other dimensions; none for other cases."""
    common: dict[str, Any] = {}
    for axis, i in zip(axes, index, strict=True):
        if axis.reference and i == len(axis) - 1:
            common |= axis.common
    return common


def _skipped(
    study: StudyTable, axes: Sequence[StudyAxis], index: tuple[int, ...], parameters: Mapping[str, Any]
) -> bool:
    """Whether the study skips a case; references are never skipped."""
    if any(axis.reference and i == len(axis) - 1 for axis, i in zip(axes, index, strict=True)):
        return False
    return any(all(parameters[name] in values for name, values in table.items()) for table in study.skip)


def _revealing_indices(axes: Sequence[StudyAxis]) -> Iterator[tuple[int, ...]]:
    """Indices that reveal most errors: points of each dimension with the first of all others, extreme values first."""
    orders = [list(dict.fromkeys([*_extremes(axis), *range(len(axis))])) for axis in axes]
    for i, order in enumerate(orders):
        for k in order:
            yield tuple(k if i == j else 0 for j in range(len(axes)))


def _extremes(axis: StudyAxis) -> Iterator[int]:
    for values in filter(numbers, axis.values.values()):
        yield from (int(np.argmin(values)), int(np.argmax(values)))


def _scene_errors(base: Mapping[str, Any], file: Path) -> list[str]:
    """Errors of the scene itself, without the variation."""
    try:
        checked({key: value for key, value in base.items() if key != VEHICLE_FILE}, file)
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


def draw(cube: LatinHypercube, integers: set[str]) -> dict[str, list[Any]]:
    """Sampled values of every parameter, by name; integers: integer parameters, uniform including both ends."""
    from scipy.stats.qmc import LatinHypercube as Sampler

    unit = Sampler(d=len(cube.ranges), seed=cube.seed).random(cube.samples)
    samples: dict[str, list[Any]] = {}
    for (name, range_), fraction in zip(cube.ranges.items(), unit.T, strict=True):
        low, high = range_.low, range_.high
        if name in integers:
            low, high = round(low), round(high) + 1
        if range_.scale == "log":
            values = np.exp(np.log(low) + fraction * np.log(high / low))
        else:
            values = low + fraction * (high - low)
        samples[name] = [floor(v) if name in integers else float(v) for v in values]
    return samples


def _over(convergence: Convergence, axes: Sequence[StudyAxis], model: type[BaseModel], path: str | Path) -> StudyAxis:
    """Dimension of convergence, with a reference case as its last point."""
    numeric = [axis for axis in axes if axis.name != SAMPLE and numbers(next(iter(axis.values.values())))]
    by_name = {name: axis for axis in numeric for name in (axis.name, *axis.values)}
    if not numeric:
        raise SceneError(f"{path}: convergence: needs a numeric dimension in [grid] or [[together]]")
    if convergence.over is not None and convergence.over not in by_name:
        allowed = ", ".join(axis.name for axis in numeric)
        raise SceneError(f'{path}: convergence.over = "{convergence.over}": must be a numeric dimension: {allowed}')
    axis = by_name[convergence.over] if convergence.over else numeric[0]
    for name in convergence.rms_over:
        if name not in (other.name for other in axes):
            raise SceneError(f'{path}: convergence.rms_over = "{name}": must be a dimension')
    if axis.name in convergence.rms_over:
        raise SceneError(f'{path}: convergence.rms_over = "{axis.name}": must not be the dimension of convergence')
    if convergence.reference == "hertz":
        if model is not HertzScene:
            text = 'allowed only for kind = "hertz"; use the values of a finer case'
            raise SceneError(f'{path}: convergence.reference = "hertz": {text}')
        return axis
    if not axis.values.keys() <= convergence.reference.keys():
        raise SceneError(f"{path}: convergence.reference: must have the keys {', '.join(axis.values)}")
    finest = {name: convergence.reference[name] for name in axis.values}
    if finest in axis.points():
        raise SceneError(f"{path}: convergence.reference: must not be one of the values of {axis.name}")
    values = {name: [*values, finest[name]] for name, values in axis.values.items()}
    common = {name: value for name, value in convergence.reference.items() if name not in finest}
    return replace(axis, values=values, reference=True, common=common)


def _check_histories(cases: Sequence[StudyCase], path: str | Path) -> None:
    intervals = {case.scene.output.interval if case.scene.kind == "run" else None for case in cases}
    if None in intervals:
        raise SceneError(f'{path}: histories = true: allowed only for kind = "run"')
    if len(intervals) > 1 or 0.0 in intervals:
        raise SceneError(f"{path}: histories = true: requires the same output.interval, not 0, in all runs")


def numbers(values: Sequence[Any]) -> bool:
    """Whether all values are numbers."""
    return all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)
