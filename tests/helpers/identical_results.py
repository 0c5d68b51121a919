"""Compares results of two versions bit by bit: `python tests/helpers/identical_results.py BEFORE AFTER`.

Each folder holds the JSON of `wheelrail contact SCENE --json` as *.json and results of `wheelrail run` and `wheelrail
study` as *.nc, under the same names. Times of computation, versions and dates are left out.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import xarray

VOLATILE = ("seconds", "created", "versions", "wall")  # parts of names of times, dates and machines


def volatile(name: str) -> bool:
    return any(part in name for part in VOLATILE)


def differing_json(before: Any, after: Any, path: str = "") -> Iterator[str]:
    """Keys with different values."""
    if isinstance(before, dict) and isinstance(after, dict):
        for key in {**before, **after}:
            if not volatile(key):
                yield from differing_json(before.get(key), after.get(key), f"{path}.{key}")
    elif isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        for index, pair in enumerate(zip(before, after, strict=True)):
            yield from differing_json(*pair, f"{path}[{index}]")
    elif before != after and not (before is None and after is None):
        yield f"{path}: {before!r} {after!r}"


def differing_netcdf(before: Path, after: Path, renamed: dict[str, str]) -> Iterator[str]:
    """Variables that differ in any bit; renamed: names of before by names of after."""
    with (
        xarray.open_dataset(before, engine="netcdf4", decode_times=False) as old,
        xarray.open_dataset(after, engine="netcdf4", decode_times=False) as new,
    ):
        old_names = {renamed.get(str(name), str(name)): str(name) for name in old.variables}
        for name in sorted({*old_names, *map(str, new.variables)}):
            if volatile(name):
                continue
            if name not in new.variables or name not in old_names:
                yield f"{name}: in one of both only"
                continue
            a, b = old[old_names[name]].values, new[name].values
            if a.shape != b.shape or a.dtype != b.dtype or not _same(a, b):
                yield f"{name}: largest difference {_largest(a, b)}"


def _same(a: np.ndarray[Any, Any], b: np.ndarray[Any, Any]) -> bool:
    return bool((a == b).all()) if a.dtype.kind in "OU" else a.tobytes() == b.tobytes()


def _largest(a: np.ndarray[Any, Any], b: np.ndarray[Any, Any]) -> float:
    return float(np.nanmax(np.abs(a - b))) if a.shape == b.shape and a.dtype.kind == "f" else math.nan


def compare(before: Path, after: Path, renamed: dict[str, str] | None = None) -> tuple[list[str], list[str]]:
    """Names of the files compared, and lines about what differs."""
    files = [file.relative_to(before) for ending in ("*.json", "*.nc") for file in before.rglob(ending)]
    names = sorted(str(file) for file in files if "cases" not in file.parts)  # cases of studies are in study.nc
    lines = []
    for name in names:
        if not (after / name).exists():
            lines.append(f"{name}: missing")
        elif name.endswith(".json"):
            pair = (json.loads((folder / name).read_text(encoding="utf-8")) for folder in (before, after))
            lines += [f"{name}{line}" for line in differing_json(*pair)]
        else:
            lines += [f"{name}: {line}" for line in differing_netcdf(before / name, after / name, renamed or {})]
    return names, lines


if __name__ == "__main__":
    arguments = [argument for argument in sys.argv[1:] if "=" not in argument]
    changed = dict(argument.split("=") for argument in sys.argv[1:] if "=" in argument)  # OLD=NEW names of variables
    compared, differences = compare(Path(arguments[0]), Path(arguments[1]), changed)
    print("\n".join([*differences, f"{len(compared)} files compared, {len(differences)} differences"]))
    sys.exit(bool(differences) or not compared)
