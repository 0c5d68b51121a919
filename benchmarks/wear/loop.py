"""Checks of the loop of wear: hands, shares, resuming, bodies that are kept; and its time over a long duty."""

from __future__ import annotations

import resource
from collections.abc import Iterator, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Any

import numpy as np
from xarray import Dataset

from benchmarks.wear.check import Check
from wheelrail.scenes.wear.cases import Duty
from wheelrail.scenes.wear.jobs import workers
from wheelrail.scenes.wear.loop import STEPS, WearLoop
from wheelrail.scenes.wear.schema import CONTACTS, check_wear
from wheelrail.support.arrays import Array
from wheelrail.support.cache import cache_folder

SCENES = Path(__file__).parents[2] / "scenes"
FILES = {"scene": str(SCENES / "vehicle.toml"), "vehicle": str(SCENES / "manchester_vehicle.toml")}
ELASTIC = {"scene": str(SCENES / "vehicle_elastic.toml"), "vehicle": FILES["vehicle"]}
LAW = {"name": "usfd", "scale": 0.18}
SHARP = {"curvature": 1.0 / 600.0, "cant": 0.1, "speed": 25.0}
WIDE = {"curvature": 1.0 / 1200.0, "cant": 0.06, "speed": 35.0}
KEPT = 3  # largest number of worn bodies
STRIPS = {"model": "condensed", "laws": "exact", "surface_size": 1e-3, "strips": 6, "cells": 10}


def worn(*duty: Mapping[str, Any], folder: Path | None = None, resume: bool = False, **more: Any) -> Dataset:
    """Results of cases on the standard contact."""
    table = check_wear({**FILES, "law": LAW, "until": 1e6, "depth": 1e-4, "duty": duty, **more})
    return WearLoop(Duty(table, Path("wear.toml")), folder).run(resume=resume)


def hands() -> Iterator[Check]:
    """Mirror images of both hands, their mean, and linear shares."""
    left, right = (
        worn({"share": 1.0, "steady": {**SHARP, "curvature": hand / 600.0}}, profiles="sides") for hand in (1.0, -1.0)
    )
    depth, mirrored = left["depth"].values[-1], right["depth"].values[-1, ::-1]
    yield Check("depths of both hands, mirror images, m", float(np.abs(depth - mirrored).max()), 1e-9)
    both = worn({"share": 1.0, "steady": SHARP, "both_hands": True}, profiles="sides")
    rates, mean = both["area_rate"].values[0, 0], 0.5 * left["area_rate"].values[0].sum(axis=0)
    yield Check("both hands against their mean, of the largest", _of_largest(rates, mean), 1e-9)
    mixed = worn({"share": 0.25, "steady": SHARP}, {"share": 0.75, "steady": WIDE}, until=1.0)
    width = float(np.diff(mixed["s"].values).mean())
    expected = width * np.einsum("c,cps->ps", mixed["share"].values, mixed["depth_rate"].values[0])
    yield Check("linear in the shares, of the largest", _of_largest(mixed["area_rate"].values[0], expected), 1e-12)


def _of_largest(values: Array, expected: Array) -> float:
    return float(np.abs(values - expected).max() / np.abs(expected).max())


def resumed() -> Iterator[Check]:
    """A loop that is resumed after its first step; files in the cache of bodies that are renewed in each step."""
    duty = {"share": 0.6, "steady": WIDE}, {"share": 0.4, "steady": SHARP}
    with TemporaryDirectory(prefix="wheelrail-wear-") as name:
        folder = Path(name)
        whole = worn(*duty, folder=folder, until=4e6)
        for file in sorted((folder / STEPS).iterdir())[1:]:
            file.unlink()
        again = worn(*duty, folder=folder, until=4e6, resume=True)
    same = all(
        np.array_equal(whole[key].values, again[key].values, equal_nan=True)
        for key in whole.data_vars
        if key != "seconds"
    )
    yield Check("resumed loop: variables of other bits", float(not same), 0.0)
    elastic = {"share": 1.0, "steady": SHARP, "set": STRIPS}
    worn(elastic, until=1.0)
    before = _cached()
    worn(elastic, until=2e6, depth=1e-4, renew=1e-6)
    yield Check("files of worn bodies in the cache", float(_cached() - before), KEPT)


def _cached() -> int:
    return sum(1 for _ in cache_folder().rglob("*.npz"))


def _curves(wide: float, sharp: float, keys: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Cases of R = 1200 and 600 m at two speeds with shares each; keys of their scenes."""
    speeds = (WIDE, wide, 35.0), (WIDE, wide, 30.0), (SHARP, sharp, 25.0), (SHARP, sharp, 20.0)
    return [
        {"share": share, "steady": {**steady, "speed": speed}, "both_hands": True, "set": keys}
        for steady, share, speed in speeds
    ]


def _resident() -> float:
    """Memory of this process, MB."""
    pages = int(Path("/proc/self/statm").read_text(encoding="utf-8").split()[1])
    return pages * resource.getpagesize() / 2.0**20


def resolutions(until: float) -> None:
    """Depth after a distance m in four curves by strips, cells and steps, printed.

    Differences are those from 6 strips of 8 cells, RMS over the profile.
    """
    print("\n| strips | cells | step mm | steps | processor s | section mm2 | deepest mm | Sd mm | differs % |")
    print("|---" * 9 + "|")
    first = None
    for strips, cells, depth in (6, 8, 1e-4), (4, 6, 1e-4), (4, 6, 2e-4):
        begun, keys = process_time(), {**CONTACTS["condensed"], "strips": strips, "cells": cells}
        data = worn(*_curves(0.35, 0.15, keys), scene=ELASTIC["scene"], until=until, depth=depth)
        end = data["depth"].values[-1, 0]
        first = end if first is None else first
        figures = [1e3 * depth, data.sizes["step"] - 1, process_time() - begun]
        figures += [1e6 * float(data["removed_section"][-1, 0]), 1e3 * end.max(), 1e3 * float(data["Sd"][-1, 0])]
        figures.append(100.0 * float(np.linalg.norm(end - first) / np.linalg.norm(first)))
        print(f"| {strips} | {cells} | " + " | ".join(f"{value:.4g}" for value in figures) + " |", flush=True)


def duty(until: float, processes: int = 1, **more: Any) -> Dataset:
    """Wear of the Manchester vehicle on straight irregular track and in four curves, printed by step.

    Parameters:
        until: distance, m.
        processes: that solve the cases of a step.
        more: keys of the wear file in place of elastic contact of curves and lifted wheels of the straight.
    """

    straight = {
        "share": 0.4,
        "name": "straight",
        "scene": str(SCENES / "vehicle_irregular.toml"),
        "start": 50.0,
        "set": {"track.segments": [{"kind": "tangent", "length": 160.0}]},
    }
    keys = {} if more.get("contact") == {} else CONTACTS["condensed"]
    table = {
        **ELASTIC,
        "law": LAW,
        "until": until,
        "depth": 1e-4,
        "interval": 6.0,
        "contact": "condensed",
        "duty": [straight, *_curves(0.2, 0.1, keys)],
        **more,
    }
    print("\n| step | km | max mm | Sh | Sd | qR | conicity | error % | s | processor s | MB |\n" + "|---" * 11 + "|")
    clock, row = [perf_counter(), process_time()], [0]

    def report(done: float, words: str) -> None:
        number = len(loop.steps)
        if number <= row[0]:
            return
        row[0], last, now = number, loop.steps[-1], [perf_counter(), process_time()]
        figures = [1e-3 * float(last["distance"]), 1e3 * float(last["depth"].max())]
        figures += [1e3 * float(last[name].values[0]) for name in ("Sh", "Sd", "qR")]
        figures += [float(last["conicity"]), 100.0 * float(last["step_error"].values[0])]
        figures += [now[0] - clock[0], now[1] - clock[1], _resident()]
        print(f"| {number - 1} | " + " | ".join(f"{value:.4g}" for value in figures) + " |", flush=True)
        clock[:] = now

    begun = perf_counter(), process_time()
    with workers(processes, None) as executor:
        loop = WearLoop(Duty(check_wear(table), Path("wear.toml")), None, report, executor)
        data = loop.run()
    seconds, processor = perf_counter() - begun[0], process_time() - begun[1]
    print(
        f"\n{data.attrs['status']}: {1e-3 * until:.0f} km, {len(loop.steps)} steps, {seconds:.0f} s, {processor:.0f} s "
        "of the first process' processor time"
    )
    return data
