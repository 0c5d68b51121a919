"""Files of tables: what does not belong together, is changed or damaged is refused with one line."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import wheelrail as wr
from wheelrail.contact.kinematics.frames import RigidMotion, Twist
from wheelrail.contact.models.table.force_table import ForceTable, FrictionTable, NormalTable, TreadFrame
from wheelrail.contact.models.table.model import TableContact
from wheelrail.scenes.datasets.force_table import content_hash, force_tables, table_dataset
from wheelrail.scenes.datasets.netcdf import read, write

PAIR = {"wheel": "S1002", "rail": "UIC60-benchmark"}
FILE = Path("t.nc")


@dataclass
class NoErrors:
    points: Any = None
    force: Any = None
    moment: Any = None

    def __post_init__(self) -> None:
        self.points, self.force, self.moment = np.zeros((2, 7)), np.zeros((2, 3)), np.zeros((2, 3))


def linear_table() -> ForceTable:
    """Vertical load of a level that grows by 1e6 N^(2/3) per metre of depth; no friction force."""
    y, node, level = np.array([-1e-3, 0.0, 1e-3]), np.zeros(1), np.array([0.0, 1000.0, 2000.0])
    values = np.zeros((3, 1, 1, 3, 9))
    values[..., 0] = -level * 1e-6
    creepages = np.array([-1.0, 0.0, 1.0])
    friction = FrictionTable(y, node, node, level[1:], creepages, creepages, np.zeros(3 * 2 * 9 * 6), 0.3)
    return ForceTable(TreadFrame(0.46, 0.0), NormalTable(y, node, node, level, values.ravel()), friction)


def stored() -> xr.Dataset:
    return table_dataset({"left": linear_table()}, {"left": NoErrors()}, {"pairs": json.dumps({"left": {}})})  # type: ignore[dict-item]


CHANGES: dict[str, tuple[Callable[[xr.Dataset], xr.Dataset], str]] = {
    "a value": (lambda d: d.assign(left_normal_values=2.0 * d["left_normal_values"]), "changed or damaged"),
    "values in reverse": (
        lambda d: d.assign(left_normal_values=(d["left_normal_values"].dims, d["left_normal_values"].values[::-1])),
        "changed or damaged",
    ),
    "an attribute": (lambda d: d.assign_attrs(left_friction=0.2), "changed or damaged"),
    "no hash": (lambda d: d.drop_attrs(deep=False).assign_attrs(kind="force table"), "of an earlier version"),
}
SEALED: dict[str, tuple[Callable[[xr.Dataset], xr.Dataset], str]] = {
    "missing values": (lambda d: d.drop_vars("left_normal_values"), "left_normal_values: missing"),
    "missing nodes": (lambda d: d.drop_vars("left_friction_y"), "left_friction_y: missing"),
    "other dimensions": (
        lambda d: d.assign(left_friction_values=("q", d["left_friction_values"].values.ravel()[:1])),
        "left_friction_values: over q: must be over left_friction_y",
    ),
    "nodes in reverse": (
        lambda d: d.assign_coords(left_normal_y=d["left_normal_y"].values[::-1].copy()),
        "y: its nodes must increase",
    ),
    "no nodes": (lambda d: d.isel(left_friction_lateral=slice(0, 0)), "lateral: float64 of shape"),
    "not a number": (lambda d: d.assign(left_normal_values=d["left_normal_values"] * np.nan), "must be finite"),
    "single precision": (lambda d: d.astype("f4"), "float32"),
    "a column less": (lambda d: d.isel(friction_value=slice(1, None)), "6 at each node"),
    "texts": (lambda d: d.assign_coords(left_normal_y=["a", "b", "c"]), "must be finite numbers"),
    "sides": (lambda d: d.assign_attrs(sides="right"), "sides = 'right': must be left, or left right"),
    "a coefficient": (lambda d: d.assign_attrs(left_friction=np.nan), "coefficient of friction = nan"),
    "a radius": (lambda d: d.assign_attrs(left_radius="wide"), "left_radius = 'wide': must be a number"),
    "a radius of 0": (lambda d: d.assign_attrs(left_radius=0.0), "must be lengths"),
}


@pytest.mark.parametrize("name", CHANGES)
def test_what_is_not_what_was_written_is_refused(name: str) -> None:
    change, message = CHANGES[name]
    with pytest.raises(wr.SceneError, match=message):
        force_tables(change(stored()), FILE)


@pytest.mark.parametrize("name", SEALED)
def test_arrays_that_do_not_belong_together_are_refused(name: str) -> None:
    change, message = SEALED[name]
    data = change(stored())
    with pytest.raises(wr.SceneError, match=message):
        force_tables(data.assign_attrs(content=content_hash(data)), FILE)


@pytest.mark.parametrize("pairs", ["x", "[1]", "{}", "[" * 100_000])
def test_pairs_of_no_table_are_refused(pairs: str, tmp_path: Path) -> None:
    data = stored().assign_attrs(pairs=pairs)
    write(data.assign_attrs(content=content_hash(data)), tmp_path / "t.nc")
    with pytest.raises(wr.SceneError, match=r"t\.nc: pairs: "):
        wr.Wheelset(**PAIR, model="table", table=tmp_path / "t.nc").element()


def test_a_copy_by_another_program_is_a_table(tmp_path: Path) -> None:
    write(stored(), tmp_path / "t.nc")
    with xr.open_dataset(tmp_path / "t.nc") as data:
        data.load().to_netcdf(tmp_path / "copy.nc", engine="netcdf4")
    (first,), (second,) = (force_tables(read(tmp_path / name), FILE).values() for name in ("t.nc", "copy.nc"))
    np.testing.assert_array_equal(first.normal.values, second.normal.values)


@pytest.mark.parametrize("z", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("velocity", [0.0, np.nan])
def test_what_is_no_place_has_no_force(z: float, velocity: float) -> None:
    """The load is level^(3/2) where the place is one; a status, not zero force, where it or the velocity is none."""
    still = np.zeros(3)

    def result(z: float, lateral: float) -> Any:
        table = linear_table()
        pose = table.frame.pose(2e-4, z, 0.0, 0.0)
        wheel = Twist(np.array([-20.0, lateral, 0.0]), still, pose.origin)
        return TableContact(table)(pose, RigidMotion(wheel, Twist(np.array([-20.0, 0.0, 0.0]), still, still)))

    assert result(-1.5e-3, 0.0).force[2] == pytest.approx(1500.0**1.5)
    assert result(z, velocity).status.startswith("failed: table: z of the wheel")
    if np.isnan(velocity):
        assert result(-1.5e-3, velocity).status.startswith("failed: table: z of the wheel")
