"""Tables of wear: profiles over the distance, and cases of the duty."""

from __future__ import annotations

from collections.abc import Sequence
from operator import itemgetter
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.meshes.profiles.measures import LIMITS, outside_limits
from wheelrail.scenes.datasets.result_table import Column, ResultTable
from wheelrail.scenes.datasets.wear import WEAR

if TYPE_CHECKING:
    from xarray import Dataset

MOST = 12  # rows of steps
SEVERE, CHANGING = 0.01, 0.1  # shares of the severe branch and of the error of a step that are told
GROOVE, NARROW = 10e-3, 0.8  # m, width of a groove, and share of a case's wear in a groove
LARGE = 0.42  # m, radius of wheels from which on limits hold
CORNER = 5e-3  # m: gauge corners of rails have radii of 8 to 13 mm
BALANCED = 1e-4  # of a wheel load, residual of equilibria that is told
NAMES = ("distance", "depth", "Sh", "Sd", "qR", "hollow", "removed_section", "conicity", "step_error")
RAIL_MEASURES = ("W1", "W3", "rail_section")
SHOWN = ("Sh", "Sd", "qR", "hollow", "removed_section")


def tables(data: Dataset) -> list[ResultTable]:
    """Tables of a Dataset of `wheelrail.scenes.datasets.wear`."""
    wheels = [_steps(data, number) for number in range(data.sizes["profile"])]
    return [*wheels, *([_rails(data)] if "rail" in data.dims else []), _cases(data)]


def remarks(data: Dataset) -> list[str]:
    """Words on limits: of wheels in service, severe branches, long steps, balance, grooves, coefficients."""
    found = [words for number in range(data.sizes["profile"]) for words in _worn_out(data.isel(profile=number))]
    severe = np.nanmax(data["severe_share"].values, initial=0.0)
    if severe > SEVERE:
        found.append(f"up to {100 * severe:.0f} % of the wear by {data.attrs['law_remark']}")
    error = data["step_error"].values
    if (latest := error[np.isfinite(error).all(axis=1)]).size and latest[-1].max() > CHANGING:
        found.append(
            f"rates change by {200 * latest[-1].max():.0f} % over the last step: shorter steps (depth) may differ"
        )
    width = np.diff(data["s"].values).mean()
    for k, name in enumerate(data["case"].values):
        if (residual := np.nanmax(data["residual"].values[:, k], initial=0.0)) > BALANCED:
            found.append(f"{name}: forces balance within {100 * residual:.2g} % of a wheel load, for a contact's jumps")
        rate = data["depth_rate"].values[0, k].sum(axis=0)
        window = np.convolve(rate, np.ones(max(round(GROOVE / width), 1)), mode="same").max()
        if rate.sum() > 0.0 and window > NARROW * rate.sum():
            found.append(
                f"{name}: {100 * window / rate.sum():.0f} % of its wear lies in {1e3 * GROOVE:.0f} mm: a groove, which "
                "other rails, gauges or irregularities in the duty would widen"
            )
    if data.attrs["law_unsure"]:
        found.append(f"not compared with the source of the law: {data.attrs['law_unsure']}")
    return found


def _worn_out(own: Dataset) -> list[str]:
    """Words on one profile: measures where they leave their limits first, and grooves that no rail fits."""
    name, km = str(own["profile"].values), 1e-3 * own["distance"].values
    outside = [outside_limits({key: float(own[key].values[step]) for key in LIMITS}) for step in range(len(km))]
    first = {key: next((i for i, words in enumerate(outside) if key in words), 0) for key in LIMITS}
    large = own["rolling_radius"].values[0] > LARGE
    told = [f"{name}, {km[i]:.0f} km: {outside[i][key]}" for key, i in first.items() if large and i > 0]
    groove = own["groove"].values if "groove" in own else np.full(len(km), np.nan)  # older results have none
    if len(steps := np.flatnonzero(groove < CORNER)):
        told.append(
            f"{name}, from {km[steps[0]]:.0f} km on: grooves sharper than gauge corners of rails, to a radius of "
            f"{1e3 * np.nanmin(groove):.1f} mm: the duty has few cases, or the contact is noisy"
        )
    return told


def _steps(data: Dataset, number: int) -> ResultTable:
    """Measures of one profile over the distance; of many steps some."""
    own, count = data.isel(profile=number), data.sizes["step"]
    steps = np.unique(np.linspace(0, count - 1, min(count, MOST)).astype(int))
    rows = [
        {
            "step": int(step),
            "depth": float(own["depth"].values[step].max()),
            **{name: float(own[name].values[step]) for name in (*SHOWN, "step_error")},
            **{name: float(data[name].values[step]) for name in ("distance", "conicity")},
        }
        for step in steps
    ]
    columns = [
        Column("step", "step", itemgetter("step"), "1", 0),
        *(Column.showing(WEAR[name], itemgetter(name), name) for name in NAMES),
    ]
    title = f"Wear of the profile {str(data['profile'].values[number])!r} over the distance"
    return ResultTable("steps", title, columns, rows)


def _rails(data: Dataset) -> ResultTable:
    """Rails at the last step."""
    last = data.isel(step=-1)
    rows = [
        {
            "rail": str(name),
            "depth": float(np.nanmax(last["rail_depth"].values[k])),
            **{key: float(last[key].values[k]) for key in RAIL_MEASURES},
        }
        for k, name in enumerate(data["rail"].values)
    ]
    columns = [
        Column("rail", "rail", itemgetter("rail")),
        Column.showing(WEAR["rail_depth"], itemgetter("depth"), "rail_depth"),
        *(Column.showing(WEAR[name], itemgetter(name), name) for name in RAIL_MEASURES),
    ]
    passages = float(last["passages"].values)
    return ResultTable("rails", f"Wear of the rails after {passages:.4g} wheelsets", columns, rows)


def _cases(data: Dataset) -> ResultTable:
    """Cases of the duty at the new profiles and at the last step with rates."""
    rated = np.flatnonzero(np.isfinite(data["t_gamma"].values).all(axis=1))
    rows: Sequence[Any] = [
        {
            "case": str(name),
            "share": float(data["share"].values[k]),
            "t_gamma": float(data["t_gamma"].values[rated[0], k]),
            "last": float(data["t_gamma"].values[rated[-1], k]),
            "section": float(1e13 * _section(data, rated[0], k)),
        }
        for k, name in enumerate(data["case"].values)
        if len(rated)
    ]
    columns = [
        Column("case", "case", itemgetter("case")),
        Column("share", "share", itemgetter("share"), "%", 1),
        Column("t_gamma", "T-gamma, new", itemgetter("t_gamma"), "N", 1),
        Column("t_gamma_last", "T-gamma, last", itemgetter("last"), "N", 1),
        Column("", "mm² in 10 000 km, new", itemgetter("section"), "", 2),
    ]
    return ResultTable("cases", "Cases of the duty, mean of the wheels", columns, rows)


def _section(data: Dataset, step: int, case: int) -> float:
    """Section removed per distance in a case, m, mean of the profiles."""
    rate = data["depth_rate"].values[step, case]
    return float(rate.sum(axis=-1).mean() * np.diff(data["s"].values).mean())
