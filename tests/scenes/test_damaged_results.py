"""Files of results that are damaged, altered or none: every command ends with one line and exit code 2."""

from __future__ import annotations

import gzip
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

import wheelrail as wr
from wheelrail.cli.main import app
from wheelrail.scenes.datasets.contact import ATTRIBUTES, check_contact
from wheelrail.scenes.datasets.netcdf import read, write
from wheelrail.scenes.datasets.run_file import ATTRIBUTES as RUN_ATTRIBUTES
from wheelrail.scenes.datasets.run_file import run_of
from wheelrail.scenes.plots.runs import pictures_of
from wheelrail.scenes.quantities import CONTACT, RUN
from wheelrail.scenes.quantity import Schema

SIZES = {"time": 5, "side": 2, "edge": 2, "axis": 3, "body": 3, "wheelset": 2, "element": 2, "patch": 1, "series": 1}
NAMES = {
    "side": ["left", "right"],
    "edge": ["low", "high"],
    "axis": ["x", "y", "z"],
    "body": ["car", "one", "two"],
    "wheelset": ["one", "two"],
}
FILE = Path("run.nc")


def made(schema: Schema, attributes: dict[str, type]) -> xr.Dataset:
    """Results with the declared variables, mostly zero."""
    variables: dict[str, Any] = {}
    for name, declared in schema.items():
        shape = tuple(SIZES.get(dim, 2) for dim in declared.dims)
        values = (
            np.zeros(shape) if declared.unit else np.array(NAMES.get(name, [f"{name} {k}" for k in range(shape[0])]))
        )
        variables[name] = (declared.dims, values, declared.attributes)
    data = xr.Dataset(variables, attrs={name: "text" if kind is str else 1.0 for name, kind in attributes.items()})
    rising = np.linspace(0.0, 40.0, SIZES["time"])
    return data.assign_coords(time=("time", rising), distance=("time", rising))


KINDS = {"run": (RUN, RUN_ATTRIBUTES), "contact": (CONTACT, ATTRIBUTES)}
CHECKS: dict[str, Callable[[xr.Dataset, Path], object]] = {"run": run_of, "contact": check_contact}
CHANGES: dict[str, Callable[[xr.Dataset], xr.Dataset]] = {
    "time in reverse": lambda d: d.assign_coords(time=("time", d["time"].values[::-1].copy())),
    "time at rest": lambda d: d.assign_coords(time=("time", 0.0 * d["time"].values)),
    "time not a number": lambda d: d.assign_coords(time=("time", np.nan * d["time"].values)),
    "time renamed": lambda d: d.rename(time="t"),
    "no sample": lambda d: d.isel(time=slice(0, 0)),
    "distance in reverse": lambda d: d.assign_coords(distance=("time", d["distance"].values[::-1].copy())),
    "distance beyond all": lambda d: d.assign_coords(distance=("time", 1e300 * d["distance"].values)),
    "sides renamed": lambda d: d.assign_coords(side=["l", "r"]),
    "one side": lambda d: d.isel(side=slice(0, 1)),
    "no side": lambda d: d.isel(side=slice(0, 0)),
    "no patch": lambda d: d.isel(patch=slice(0, 0)),
    "texts": lambda d: d.assign(lateral_force=d["lateral_force"].astype(str)),
    "dimensions in another order": lambda d: d.assign(lateral_force=d["lateral_force"].transpose()),
    "another length": lambda d: d.drop_vars("approach").assign(approach=("n", np.zeros(7))),
    "a number": lambda d: d.assign(approach=0.0),
    "a speed not a number": lambda d: d.assign(speed=d["speed"] * np.nan),
    "no attributes": lambda d: d.drop_attrs(),
    "no wheelset": lambda d: d.isel(wheelset=slice(0, 0)),
    "a wheelset that is no body": lambda d: d.assign_coords(wheelset=["one", "three"]),
    "two bodies of one name": lambda d: d.assign_coords(body=["one", "one", "two"]),
    "numbers for names": lambda d: d.assign_coords(body=[1, 2, 3], wheelset=[2, 3]),
    "a body nowhere": lambda d: d.assign(body_y=d["body_y"].where(d["time"] > 0.0)),
}


@pytest.mark.parametrize("kind", KINDS)
def test_results_as_declared_are_read(kind: str) -> None:
    schema, attributes = KINDS[kind]
    CHECKS[kind](made(schema, attributes), FILE)
    CHECKS[kind](made({name: own for name, own in schema.items() if own.needed}, attributes), FILE)


@pytest.mark.parametrize("kind", KINDS)
def test_each_missing_variable_is_named(kind: str) -> None:
    data = made(*KINDS[kind])
    for name, declared in KINDS[kind][0].items():
        if declared.needed:
            with pytest.raises(
                wr.SceneError,
                match=r"run\.nc: must contain results of a run"
                if kind != "contact" and name in ("body_y", "patches")
                else rf"run\.nc: {name}: ",
            ):
                CHECKS[kind](data.drop_vars(name), FILE)


@pytest.mark.parametrize("kind", KINDS)
def test_each_attribute_of_another_type_is_named(kind: str) -> None:
    schema, attributes = KINDS[kind]
    data = made(schema, attributes)
    for name, needed in attributes.items():
        for value in (None, 7) if needed is str else (None, "7", np.nan, [1.0, 2.0], ""):
            altered = data.copy()
            altered.attrs = {key: own for key, own in data.attrs.items() if key != name}
            altered.attrs |= {} if value is None else {name: value}
            with pytest.raises(wr.SceneError, match=rf"run\.nc: attribute {name}: "):
                CHECKS[kind](altered, FILE)


@pytest.mark.parametrize("name", CHANGES)
def test_altered_results_are_refused(name: str) -> None:
    with pytest.raises(wr.SceneError, match=r"^run\.nc: [^\n]+$"):
        run_of(CHANGES[name](made(*KINDS["run"])), FILE)


def test_solutions_without_a_variable_are_one_line(tmp_path: Path) -> None:
    """`wheelrail.open` of a solution that another program wrote: whole, without one variable, with more patches."""
    file = tmp_path / "solution.nc"
    made(CONTACT, ATTRIBUTES).to_netcdf(file)
    assert wr.open(file).status == "text"
    made(CONTACT, ATTRIBUTES).drop_vars("pressure").to_netcdf(file)
    with pytest.raises(wr.SceneError, match=r"solution\.nc: pressure: missing; must be over point$"):
        wr.open(file)
    data = made(CONTACT, ATTRIBUTES)
    data["patches"][:] = 2
    with pytest.raises(wr.SceneError, match=r"solution\.nc: patches: must be whole numbers from 0 to 1"):
        check_contact(data, file)


@pytest.mark.parametrize("picture", ["body_motion", "wheel_load"])
def test_names_with_dollar_signs_are_drawn(picture: str, tmp_path: Path) -> None:
    """In Matplotlib text between dollar signs is mathematics, and an error where it is none."""
    names = ["$\\frac$", "$x^$", "<b>$"]
    data = made(*KINDS["run"]).assign_coords(body=names, wheelset=names[1:])
    pictures_of(data)[picture](data).savefig(tmp_path / "a.png", dpi=20)


def fifo(path: Path) -> None:
    os.mkfifo(path)


def content(data: bytes) -> Callable[[Path], object]:
    return lambda path: path.write_bytes(data)


def whole(folder: Path) -> bytes:
    write(made(RUN, RUN_ATTRIBUTES), folder / "whole.nc")
    return (folder / "whole.nc").read_bytes()


NONE_AT_ALL: dict[str, Callable[[Path], object]] = {
    "a pipe": fifo,
    "a device": lambda path: path.symlink_to("/dev/zero"),
    "a folder": Path.mkdir,
    "a loop": lambda path: path.symlink_to(path.name),
    "a dangling link": lambda path: path.symlink_to("nowhere"),
    "empty": content(b""),
    "zeros": content(bytes(5000)),
    "a page": content(b"<html>"),
    "a signature": content(b"\x89HDF\r\n\x1a\n" + b"\xff" * 3000),
    "classic": content(b"CDF\x01\0\0\0\0"),
    "half": lambda path: path.write_bytes((data := whole(path.parent))[: len(data) // 2]),
    "compressed": lambda path: path.write_bytes(gzip.compress(whole(path.parent))),
    "another results": lambda path: write(xr.Dataset({"a": ("n", np.zeros(3))}), path),
}


@pytest.mark.parametrize("name", NONE_AT_ALL)
def test_what_is_no_file_of_results_is_one_line(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    NONE_AT_ALL[name](Path("run.nc"))
    lines = (["report", "."], ["evaluate", "run.nc"], ["animate", "run.nc", "--out", "a.gif"])
    for line in lines:
        done = CliRunner().invoke(app, line)
        assert done.exit_code == 2, done.output
        assert len(done.stderr.splitlines()) == 1
    with pytest.raises((wr.SceneError, FileNotFoundError)):
        wr.open("run.nc")
    assert not Path("report.html").exists()
    assert not Path("a.gif").exists()


def test_every_flipped_byte_is_found(tmp_path: Path) -> None:
    data = whole(tmp_path)
    assert read(tmp_path / "whole.nc").attrs["scene"] == "text"
    for place in np.random.default_rng(39).integers(0, len(data) - 200, 200).tolist():
        (tmp_path / "whole.nc").write_bytes(data[:place] + bytes([data[place] ^ 4]) + data[place + 1 :])
        with pytest.raises(wr.SceneError, match=r"whole\.nc: its content is not what was written"):
            read(tmp_path / "whole.nc")


def test_results_of_other_programs_are_read(tmp_path: Path) -> None:
    """A part that xarray has written in place of the whole, and long texts."""
    write(made(RUN, RUN_ATTRIBUTES).assign_attrs(scene="é" * 40_000), tmp_path / "run.nc")
    with xr.open_dataset(tmp_path / "run.nc", engine="netcdf4", decode_times=False) as data:
        part = data.isel(time=slice(0, 3)).load()
    part.to_netcdf(tmp_path / "run.nc", engine="netcdf4")
    again = read(tmp_path / "run.nc")
    run_of(again, FILE)
    assert again.sizes["time"] == 3
    assert again.attrs["scene"] == "é" * 40_000


def test_arrays_beyond_memory_are_one_line(tmp_path: Path) -> None:
    import netCDF4

    with netCDF4.Dataset(tmp_path / "run.nc", "w") as file:
        file.createDimension("time", 10**13)
        file.createVariable("patches", "f8", ("time",), chunksizes=(1024,))
    done = CliRunner().invoke(app, ["evaluate", str(tmp_path / "run.nc")])
    assert done.exit_code == 2
    assert "GB of memory" in done.stderr


@pytest.mark.parametrize(
    "changed",
    [{4241: 227, 5782: 18, 6641: 239, 9827: 136}, {3480: 152, 7813: 184, 9197: 82}],
    ids=["HDF5 crashes", "HDF5 reads for ever"],
)
def test_files_of_other_programs_that_end_the_library(
    changed: dict[int, int], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without the hash at their end files are first read by another process."""
    file = tmp_path / "other.nc"
    with netCDF4.Dataset(file, "w") as data:
        data.createDimension("t", 200)
        data.createVariable("a", "f8", ("t",), zlib=True)[:] = np.arange(200.0)
        data["a"].units = "m"
        data.createVariable("s", str, ("t",))[0] = "abc"
        data.title = 2000 * "x"
    assert read(file)["a"][-1] == 199.0
    content = bytearray(file.read_bytes())
    for place, value in changed.items():
        content[place] = value
    file.write_bytes(content)
    monkeypatch.setattr("wheelrail.scenes.datasets.netcdf.PATIENCE", 2.0)
    with pytest.raises(wr.SceneError, match=r"other\.nc: not a readable NetCDF file, it may be damaged"):
        read(file)
