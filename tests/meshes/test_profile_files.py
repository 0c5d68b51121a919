"""Profile files as users bring them: every kind gives the curve from which it was written."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import wheelrail as wr
from wheelrail.meshes.bodies.outlines import rail_outline
from wheelrail.meshes.profiles.formats import ProfileError
from wheelrail.meshes.profiles.measurement import measured
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.meshes.profiles.profile import Kind, Profile
from wheelrail.support.arrays import Array

WHEEL, RAIL = named_profile("S1002"), named_profile("60E1").inclined(0.025)
CURVES: dict[Kind, Profile] = {"wheel": WHEEL, "rail": RAIL}
SIMPACK = (
    "header.begin\n type = {type}\nheader.end\nspline.begin\n units.len.f = 1000.\npoint.begin\n{points}point.end\n"
    "spline.end\n"
)
MINIPROF = "ProgramName=MiniProf Envision\nDate=12-05-2023\nColumnDef=X,Y,A,C,N\nXOffset=0.0\n\n"
VI = "$---UNITS\n[UNITS]\nLENGTH = 'mm'\n[PROFILE_DATA]\n{ y z }\n"


def points_of(kind: Kind, spacing: float = 5e-4) -> Array:
    """Points (n, 2) mm at a spacing m along the part that instruments measure."""
    curve = CURVES[kind]
    stop = float(curve.s_at_y(59e-3)) if kind == "wheel" else curve.s_range[1] - 1e-3
    return 1e3 * curve.point(np.arange(curve.s_range[0] + 1e-3, stop, spacing))


def rows(points: Array, line: str = "{:.6f} {:.6f}\n") -> str:
    return "".join(line.format(y, z) for y, z in points)


def numbered(points: Array, line: str) -> str:
    return "".join(line.format(i, y, z) for i, (y, z) in enumerate(points, start=1))


def some(points: Array, line: str, every: int) -> str:
    """Rows of which every few ones are replaced."""
    return "".join(line if i % every == 0 else f"{y:.6f};{z:.6f}\n" for i, (y, z) in enumerate(points))


def moved(points: Array, i: int, dy: float, dz: float) -> Array:
    """Points of which one is moved, mm."""
    return np.where(np.arange(len(points))[:, None] == i, points + np.array([dy, dz]), points)


def swapped(points: Array, i: int) -> Array:
    order = np.arange(len(points))
    order[[i, i + 1]] = i + 1, i
    return np.asarray(points[order])


def misfit(found: Profile, curve: Profile, aligned: bool) -> float:
    """Largest distance m from a curve within its measured part; the origin of a rail is its own highest point."""
    points = found.point(found.samples(2e-4))
    points = points[(np.abs(points[:, 0]) < 57e-3) & (points[:, 1] > -34e-3)]
    offset = 0.0
    for _ in range(4 if aligned else 0):
        closest = curve.closest(points - (offset, 0.0))
        normal = curve.normal(closest.s)[:, 0]
        offset += float((closest.distance * normal).sum() / (normal**2).sum())
    return float(np.abs(curve.closest(points - (offset, 0.0)).distance).max())


# suffix, text of points in mm: all kinds hold the same curve
KINDS: dict[str, tuple[str, Callable[[Array], str | bytes]]] = {
    "plain": (".txt", rows),
    "field side first": (".txt", lambda p: rows(p[::-1])),
    "z downwards": (".txt", lambda p: rows(p * (1, -1))),
    "metres": (".csv", lambda p: rows(1e-3 * p, "{:.9f},{:.9f}\n")),
    "metres in titles": (".csv", lambda p: "y_m,z_m\n" + rows(1e-3 * p, "{:.9f},{:.9f}\n")),
    "inches": (".dat", lambda p: rows(p / 25.4, "{:.8f}\t{:.8f}\n")),
    "decimal commas": (".csv", lambda p: "Y [mm];Z [mm]\n" + rows(p, "{:.6f};{:.6f}\n").replace(".", ",")),
    "decimal commas, blanks": (".txt", lambda p: rows(p).replace(".", ",")),
    "decimal commas, tabs": (".tsv", lambda p: "Nr.\tY\tZ\n" + numbered(p, "{}\t{:.6f}\t{:.6f}\n").replace(".", ",")),
    "decimal commas, quotes": (".csv", lambda p: '"Y","Z"\n' + rows(p, '"{:.6f}","{:.6f}"\n').replace(".", ",")),
    "quotes": (".csv", lambda p: '"Point","Y (mm)","Z (mm)"\n' + numbered(p, '"{}","{:.6f}","{:.6f}"\n')),
    "mark and CRLF": (".csv", lambda p: ("\ufeffDepot Süd;7\n\n" + rows(p, "{:.6f};{:.6f}\n")).replace("\n", "\r\n")),
    "Latin-1": (".txt", lambda p: ("Gerät 7, Übergang\n12.03.2021\n" + rows(p)).encode("latin-1")),
    "UTF-16": (".txt", lambda p: ("y\tz\n" + rows(p, "{:.6f}\t{:.6f}\n")).encode("utf-16")),
    "count": (".txt", lambda p: f"{len(p)} 2\n" + rows(p)),
    "date": (".txt", lambda p: "2024-05-03 depot 7\n20240503 1215\n03 05 2024\n" + rows(p)),
    "columns x, y, z": (".csv", lambda p: "".join(f"12.5,{y:.6f},{z:.6f}\n" for y, z in p)),
    "columns by title": (".csv", lambda p: "z;y\n" + rows(p[:, ::-1], "{:.6f};{:.6f}\n")),
    "missing rows": (".csv", lambda p: some(p, "NaN;NaN\n", 17)),
    "missing cells": (".csv", lambda p: some(p, "1.0;\n", 17)),
    "repeated points": (".txt", lambda p: rows(np.repeat(p, 1 + (np.arange(len(p)) % 9 == 0), axis=0))),
    "zeros at the end": (".txt", lambda p: rows(np.concatenate([p, np.zeros((30, 2))]))),
    "a point out of order": (".txt", lambda p: rows(moved(p, 20, 0.5, 0.3))),
    "swapped lines": (".txt", lambda p: rows(swapped(p, len(p) // 2))),
    "a spike": (".txt", lambda p: rows(moved(p, len(p) // 2, 0.0, 3.0))),
    "VI-Rail": (".out", lambda p: VI + rows(p * (1, -1))),
    "Fortran": (".txt", lambda p: rows(p, "{:.8E} {:.8E}\n").replace("E", "D")),
}


@pytest.mark.parametrize("kind", ["wheel", "rail"])
def test_every_kind_of_file_gives_its_curve(tmp_path: Path, kind: Kind) -> None:
    points, curve = points_of(kind), CURVES[kind]
    worst = {}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for name, (suffix, write) in KINDS.items():
            text = write(points)
            file = tmp_path / f"{name}{suffix}"
            file.write_bytes(text if isinstance(text, bytes) else text.encode())
            worst[name] = misfit(wr.profile(file, kind), curve, kind == "rail")
    coarse = 3e-6  # cubics through points 0.5 mm apart, across the jumps of curvature
    assert {name: value for name, value in worst.items() if value > coarse} == {}


@pytest.mark.parametrize(
    ("suffix", "kind", "text", "shift"),
    [
        (".prw", "wheel", SIMPACK.format(type=1, points="{points}"), 0.0),
        (".whl", "wheel", MINIPROF + "{points}", 70.0),
        (".mpt", "wheel", MINIPROF + "{points}", 70.0),
        (".wheel", "wheel", "{points}", 0.0),
        (".wpf", "wheel", VI + "{points}", 0.0),
        (".txt", "wheel", "{points}", -65.0),
        (".ban", "rail", MINIPROF + "{points}", 0.0),
        (".prr", "rail", SIMPACK.format(type=0, points="{points}"), 0.0),
    ],
)
def test_formats_and_origins(tmp_path: Path, suffix: str, kind: Kind, text: str, shift: float) -> None:
    """From the rolling circle, the flange back (MiniProf) or the field side, which the tip shows to 0.02 mm."""
    signs = {".ban": (-1, 1), ".prr": (1, -1)}.get(suffix, (1, 1))
    file = tmp_path / f"file{suffix}"
    file.write_text(text.replace("{points}", rows((points_of(kind) + np.array([shift, 0.0])) * signs)))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = wr.profile(file, kind)
    assert misfit(found, CURVES[kind], kind == "rail") < (3e-5 if shift < 0.0 else 3e-6)
    assert len(caught) == (shift < 0.0)
    assert found.measurement is not None
    assert found.measurement.convention


@pytest.mark.parametrize("every", [2, 3, 4])
def test_long_files_may_change_their_separators(tmp_path: Path, every: int) -> None:
    """As a rail of a public program does in its thousand lines, a tab in every second one."""
    points = points_of("rail", 1e-4)
    lines = (f"{y:.5f}{' ' if i % every else chr(9)}{z:.5f}\n" for i, (y, z) in enumerate(points))
    (tmp_path / "rail.dat").write_text("".join(lines))
    assert misfit(wr.profile(tmp_path / "rail.dat", "rail"), RAIL, aligned=True) < 3e-6


def test_what_was_left_out_is_reported_with_its_line(tmp_path: Path) -> None:
    for points, says in (
        (moved(points_of("rail"), 20, 0.5, 0.3), "line 21, "),
        (swapped(points_of("rail"), 90), "line 91, "),
        (np.repeat(points_of("rail"), 2, axis=0), "repeated points from line 2 "),
    ):
        (tmp_path / "rail.txt").write_text(rows(points))
        assert says in str(wr.profile(tmp_path / "rail.txt", "rail").measurement)


@pytest.mark.parametrize("value", [-9999.0, 9999.0, 1e30])
def test_a_value_that_marks_missing_points_is_named(tmp_path: Path, value: float) -> None:
    for kind in ("wheel", "rail"):
        points = points_of(kind)  # type: ignore[arg-type]
        points[100, 1] = value
        (tmp_path / "file.txt").write_text("\n".join(f"{y:.6g} {z:.6g}" for y, z in points))
        with pytest.raises(ProfileError, match=rf"line 101: z = {value:.6g} ".replace("+", r"\+")):
            wr.profile(tmp_path / "file.txt", kind)  # type: ignore[arg-type]


def test_mirrored_files_are_a_warning(tmp_path: Path) -> None:
    """A flange shows the side, and is turned; a leaning head suggests it only."""
    for kind, kept in (("wheel", False), ("rail", True)):
        file = tmp_path / f"{kind}.txt"
        file.write_text(rows(points_of(kind) * (-1, 1)))  # type: ignore[arg-type]
        with pytest.warns(UserWarning, match="mirror = ") as caught:
            found = wr.profile(file, kind)  # type: ignore[arg-type]
        assert len(caught) == 1
        assert (misfit(found, CURVES[kind], kind == "rail") > 1e-4) == kept  # type: ignore[index]
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            found = wr.profile(file, kind, mirror=True)  # type: ignore[arg-type]
        assert misfit(found, CURVES[kind], kind == "rail") < 3e-6  # type: ignore[index]


def test_points_are_changed_as_asked_for(tmp_path: Path) -> None:
    points = points_of("wheel")
    file = tmp_path / "wheel.txt"
    file.write_text(rows((points - (40.0, 7.0)) * (1, -1) * 10.0))
    found = wr.profile(file, "wheel", scale=0.1, shift=(0.040, -0.007), flip=True)
    assert misfit(found, WHEEL, False) < 3e-6
    pair = {"wheel": str(file), "rail": "60E1", "wheel_scale": 0.1, "wheel_shift": [0.040, -0.007]}
    for keys in ({**pair, "wheel_flip": True}, {**pair, "right": {"wheel_flip": True}}):
        wheelset = wr.Wheelset(model="standard", friction=0.3, **keys)  # type: ignore[arg-type]
        assert misfit(wheelset.rigid.on("right").pair.wheel, WHEEL, False) < 3e-6
    with pytest.raises(ValueError, match="mirrored: unknown argument; did you mean mirror"):
        wr.profile(file, "wheel", mirrored=True)
    with pytest.raises(ValueError, match="rail_mirror = true: allowed only with a file of the rail"):
        wr.Wheelset("S1002", "60E1", model="standard", friction=0.3, rail_mirror=True)


def test_formats_that_define_their_signs_need_no_flange_and_no_head(tmp_path: Path) -> None:
    """A crowned disc, a cone, and a plane, whose highest point is its end."""
    y = np.linspace(-30.0, 30.0, 121)
    shapes = {"disc": np.sqrt(100.0**2 - y**2) - 100.0, "cone": -0.2 * y}
    for name, z in shapes.items():
        file = tmp_path / f"{name}.prw"
        file.write_text(SIMPACK.format(type=1, points=rows(np.stack([-y, z], axis=1) * (-1, 1))))
        found = wr.profile(file)
        at = np.linspace(-0.028, 0.028, 50)
        exact = np.interp(1e3 * at, y, z) * 1e-3
        np.testing.assert_allclose(found.point(found.s_at_y(at))[:, 1], exact, atol=4e-7)
    file = tmp_path / "plane.prr"
    file.write_text(SIMPACK.format(type=0, points=rows(np.stack([y, 0.2 * y], axis=1))))
    with pytest.warns(UserWarning, match="the highest point is an end"):
        plane = wr.profile(file)
    np.testing.assert_allclose(plane.tangent([-0.01, 0.0, 0.01])[:, 1], -0.2 / np.hypot(1.0, 0.2), atol=1e-6)


def test_a_rail_with_its_foot_is_read_as_its_head(tmp_path: Path) -> None:
    """Also upside down, and starting anywhere."""
    polygon = 1e3 * rail_outline(named_profile("60E1")).polygon(5e-4)
    for name, points in (("closed", polygon), ("turned", np.roll(polygon, -80, axis=0)[::-1] * (1, -1))):
        (tmp_path / f"{name}.txt").write_text(rows(points))
        assert misfit(wr.profile(tmp_path / f"{name}.txt", "rail"), named_profile("60E1"), True) < 3e-6


def test_noise_of_a_laser_is_that_of_the_running_band() -> None:
    """Vertical noise at equal steps of y; a third of it is normal to the flanks."""
    y = np.arange(-68e-3, 58e-3, 2e-4)
    points = WHEEL.point(WHEEL.s_at_y(y))
    points[:, 1] += 2e-5 * np.random.default_rng(3).standard_normal(len(points))
    measurement = measured(points, None, "file")
    assert measurement.noise == pytest.approx(2e-5, rel=0.12)
    assert "noise = " in str(measurement)


def test_a_part_of_a_rail_head(tmp_path: Path) -> None:
    """Half-spaces need no more than the running surface; the rest of meshed bodies is the standard head."""
    (tmp_path / "part.txt").write_text(rows(points_of("rail")[points_of("rail")[:, 0] < 11.9]))
    part = wr.profile(tmp_path / "part.txt", "rail", inclination=0.025)
    sections = [rail_outline(rail).polygon(5e-4) for rail in (part, RAIL)]
    area = [0.5 * (y @ np.roll(z, 1) - z @ np.roll(y, 1)) for y, z in (section.T for section in sections)]
    assert abs(area[0] / area[1] - 1.0) < 1e-3
    (tmp_path / "broad.txt").write_text(rows(points_of("rail") * (1.4, 1.0)))
    elsewhere = wr.profile(tmp_path / "broad.txt", "rail")
    with pytest.raises(ValueError, match=r"from the standard section on the .* side.*half-space"):
        rail_outline(elsewhere)
    load = {"friction": 0.0, "strips": 16, "cells": 6, "bodies": "half-space"}
    given, whole = (
        wr.Wheelset("S1002", rail, laying_angle=0.0, **load).solve(y=0.0, wheel_load=60e3, sides=["left"]).patches
        for rail in (part, RAIL)
    )
    assert given.max_pressure.max() == pytest.approx(whole.max_pressure.max(), rel=0.02)
