"""Time histories of the runs of a study on common times."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from wheelrail.scenes.studies.plan import Plan
from wheelrail.scenes.studies.solve import CaseResult


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
