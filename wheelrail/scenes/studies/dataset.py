"""Results of a study as one Dataset over its dimensions."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.datasets.input_files import FILES, packed
from wheelrail.scenes.datasets.netcdf import machine
from wheelrail.scenes.studies.plan import Plan, numbers, shown
from wheelrail.scenes.studies.quantities import QUANTITIES
from wheelrail.scenes.studies.solve import CaseResult
from wheelrail.support.version import commit

if TYPE_CHECKING:
    from xarray import Dataset


def dataset(plan: Plan, results: Mapping[tuple[int, ...], CaseResult]) -> Dataset:
    """Dataset with parameters as coordinates and quantities by side; NaN for missing values.

    Parameters:
        plan: of the study.
        results: of the computed cases by index.

    status of a case: "converged", "separated", "completed", "failed" with its error, or "not computed". The reference
    of a convergence study, if it is a case, is the last one along its dimension.
    """
    from xarray import Dataset

    arrays = StudyDataset(plan, results)
    data = Dataset(arrays.variables(), coords=arrays.coordinates(), attrs=_attributes(plan))
    if plan.study.histories:
        data = data.assign(histories(plan, results))
    return data


@dataclass(frozen=True)
class StudyDataset:
    """Arrays over the dimensions of a plan."""

    plan: Plan
    results: Mapping[tuple[int, ...], CaseResult]

    @property
    def dims(self) -> tuple[str, ...]:
        return tuple(axis.name for axis in self.plan.axes)

    @property
    def sides(self) -> list[str]:
        """Sides of all cases; none for a Hertz pair."""
        if self.plan.kind == "hertz":
            return []
        if self.plan.kind == "run":
            return ["left", "right"]
        names = {side for case in self.plan.cases for side in getattr(case.scene, "sides", ())}
        return [side for side in ("left", "right") if side in names]

    def coordinates(self) -> dict[str, Any]:
        """Every parameter along its dimension, as text unless numeric; samples of a hypercube by number."""
        coordinates: dict[str, Any] = {}
        for axis in self.plan.axes:
            for name, values in axis.values.items():
                attrs = (
                    {"long_name": name, "units": self.plan.units[name] or "1"}
                    if numbers(values)
                    else {"long_name": name}
                )
                column = np.array(values if numbers(values) or _texts(values) else [shown(value) for value in values])
                coordinates[name.replace(".", "_")] = (axis.name, column, attrs)
            if axis.name not in coordinates:
                coordinates[axis.name] = (axis.name, np.arange(len(axis)), {"long_name": "number of the sample"})
        if self.sides:
            coordinates["side"] = ("side", self.sides)
        return coordinates

    def variables(self) -> dict[str, Any]:
        coordinates = self.coordinates()
        side_names = [
            name
            for name in QUANTITIES
            if any(name in values for result in self.results.values() for values in result.sides.values())
        ]
        case_names = [name for name in QUANTITIES if any(name in result.whole for result in self.results.values())]
        variables: dict[str, Any] = {}
        for name in side_names:
            dims = (*self.dims, "side") if self.sides else self.dims
            variables[name + "_result" * (name in coordinates)] = dims, self._sided(name), QUANTITIES[name].attributes
        for name in case_names:
            values = self._filled(lambda result, name=name: result.whole.get(name, np.nan), np.nan)  # type: ignore[misc]
            variables[name] = self.dims, values, QUANTITIES[name].attributes
        attrs = {"units": "s", "long_name": "computing time of the case including preparation"}
        variables["seconds"] = (self.dims, self._filled(lambda result: result.seconds, np.nan), attrs)
        skipped = np.full(self.plan.shape, fill_value=True)
        for case in self.plan.cases:
            skipped[case.index] = False
        for name, missing in (("status", "not computed"), ("error", ""), ("host", "")):
            values = self._filled(lambda result, name=name: getattr(result, name), missing)  # type: ignore[misc]
            if name == "status":
                values[skipped] = "skipped"
            variables[name] = (self.dims, values.astype(str), {"long_name": f"{name} of the case"})
        return variables

    def _sided(self, name: str) -> Any:
        if not self.sides:
            return self._filled(lambda result: result.sides.get("contact", {}).get(name, np.nan), np.nan)
        columns = [
            self._filled(lambda result, side=side: result.sides.get(side, {}).get(name, np.nan), np.nan)  # type: ignore[misc]
            for side in self.sides
        ]
        return np.stack(columns, axis=-1)

    def _filled(self, value: Any, missing: Any) -> Any:
        values = np.full(self.plan.shape, missing, dtype=float if isinstance(missing, float) else object)
        for index, result in self.results.items():
            values[index] = value(result)
        return values


def _attributes(plan: Plan) -> dict[str, Any]:
    from wheelrail.scenes.studies.job import computer

    study = plan.study
    return {
        "title": f"Study of {Path(study.scene).name if isinstance(study.scene, str) else 'a scene'}",
        "kind": "study",
        "scene_kind": plan.kind,
        "study": json.dumps(study.model_dump(), default=list),
        "scene": json.dumps(plan.scene, default=list),
        FILES: packed((case.table, case.scene.model_dump()) for case in plan.cases),
        "versions": ", ".join(f"{name} {number}" for name, number in computer().items()),
        "commit": commit(),
        "machine": machine(),
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def _texts(values: Any) -> bool:
    return all(isinstance(value, str) for value in values)


def histories(plan: Plan, results: Mapping[tuple[int, ...], CaseResult]) -> dict[str, Any]:
    """Variables over the dimensions and `time`, NaN after the end of a run.

    Parameters:
        plan: of the study.
        results: of the computed cases by index.

    All runs have the same sampling interval, hence equal times; a last sample between two times of the longest run is
    omitted.
    """
    runs = {index: result.histories for index, result in results.items() if result.histories}
    if not runs:
        return {}
    longest = max((run["time"]["values"] for run in runs.values()), key=lambda times: times[-1])
    time = np.array(longest)
    dims = (*(axis.name for axis in plan.axes), "time")
    variables: dict[str, Any] = {}
    for name, history in next(iter(runs.values())).items():
        if name == "time":
            continue
        inner = np.shape(history["values"])[1:]
        values = np.full((*plan.shape, len(time), *inner), np.nan)
        for index, run in runs.items():
            run_time = np.array(run["time"]["values"])
            index_in_time = np.clip(np.searchsorted(time, run_time - 1e-9), 0, len(time) - 1)
            same = np.abs(time[index_in_time] - run_time) < 1e-9
            values[(*index, index_in_time[same])] = np.array(run[name]["values"])[same]
        attrs = {"units": history["units"], "long_name": history["long_name"]}
        variables[f"history_{name}"] = ((*dims, "side") if inner else dims, values, attrs)
    variables["time"] = ("time", time, {"units": "s", "long_name": "time"})
    return variables
