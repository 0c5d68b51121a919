"""How-to pages do what they say: their study files and Python code run as they stand."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from study_workers import Here

import wheelrail as wr
from wheelrail.scenes.studies import run
from wheelrail.scenes.studies.run import run_study

mpl.use("Agg")
ROOT = Path(__file__).parents[2]


def blocks(page: str, language: str) -> list[str]:
    """Code blocks of a how-to page in a language."""
    text = (ROOT / "docs" / "how-to" / f"{page}.md").read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a copy of the scene that the page names; studies are worked on in this process."""
    monkeypatch.setattr(run, "processes", lambda count: Here())
    shutil.copy(ROOT / "scenes" / "hertz.toml", tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_convergence_study_of_the_page(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "my_study.toml").write_text(blocks("convergence", "toml")[0])
    (code,) = blocks("convergence", "python")
    names: dict[str, Any] = {}
    exec(compile(code, "convergence.md", "exec"), names)
    data = names["study"].data
    assert set(data["status"].values.flat) == {"converged"}
    assert re.fullmatch(r"peak pressure: order \d\.\d ± \d\.\d\n", capsys.readouterr().out)
    exact, penalty = (data.sel(laws=name) for name in ("exact", "paper"))
    assert 1.0 < float(exact["order_approach"]) < 2.6
    assert float(exact["relative_error_approach"][-1]) < 0.08
    shift = (penalty["approach"] - exact["approach"]).isel(surface_size=-1) * 2.0 * 1e15
    peak = penalty["reference_max_pressure"].isel(surface_size=-1)
    assert float((shift / peak).mean()) == pytest.approx(1.0, abs=0.15)  # p0 / (2 K), with the coarse grid's p0^2


def test_the_penalty_study_of_the_page(folder: Path) -> None:
    (folder / "penalty.toml").write_text(blocks("convergence", "toml")[1])
    data = run_study(folder / "penalty.toml")
    assert set(data["status"].values.flat) == {"converged"}
    for name in ("max_pressure", "approach"):
        assert float(data[f"order_{name}"]) == pytest.approx(1.0, abs=0.05)


def test_own_law_of_the_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The law in Python, and the same in a scene whose command line allows its module."""
    import os
    import subprocess
    import sys

    (code,) = blocks("laws", "python")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my_laws.py").write_text(code.split("solution =")[0])
    (tmp_path / "run_my_laws.py").write_text(f"{code}\nassert solution.ok\n")
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    scene = (ROOT / "scenes" / "hertz.toml").read_text(encoding="utf-8")
    own, stribeck, power = blocks("laws", "toml")
    without = re.sub(r"^friction = .*$", "", scene, flags=re.MULTILINE)
    (tmp_path / "scene.toml").write_text(f"{without}\n{own}")
    (command,) = (block for block in blocks("laws", "sh") if "--laws" in block)
    options = command.split()[1:]
    for arguments in (["run_my_laws.py"], ["-m", "wheelrail.cli", *options]):
        line = [sys.executable, *arguments]
        done = subprocess.run(
            line, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=300, check=False
        )
        assert done.returncode == 0, done.stderr
    from wheelrail.contact.laws.friction import Stribeck
    from wheelrail.contact.laws.normal import PowerPenalty
    from wheelrail.scenes.builders.laws import laws
    from wheelrail.scenes.schema.scene import parse_scene

    assert laws(parse_scene(f"{without}\n{stribeck}")).friction == Stribeck(0.4, 0.2, 0.5)
    law = power.partition("\n\n")[2]
    paper = re.sub(r"^laws = .*$", 'laws = "paper"', scene, flags=re.MULTILINE)
    paper = paper if 'laws = "paper"' in paper else 'laws = "paper"\n' + paper
    assert laws(parse_scene(f"{paper}\n{law}")).normal == PowerPenalty(2e17, 1.5)


def test_the_element_of_the_page(capsys: pytest.CaptureFixture[str]) -> None:
    """The step of the page ends where the wheelset's own momentum balance says."""
    (code,) = blocks("element", "python")
    names: dict[str, Any] = {}
    exec(compile(code, "element.md", "exec"), names)
    assert re.fullmatch(r"-0\.\d{4} mm, \d+\.\d kN, \d+ MPa\n", capsys.readouterr().out)
    assert abs(names["residual"]) < 1e-6 * names["weight"]
    assert names["element"].solve(z=names["z"], speed=20.0).ok


def test_weave_of_a_free_wheelset_in_exudyn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The wavelength is that of Klingel for cones."""
    pytest.importorskip("exudyn")
    monkeypatch.chdir(tmp_path)
    (code,) = blocks("export", "python")
    names: dict[str, Any] = {}
    exec(compile(code, "export.md", "exec"), names)
    assert names["wavelength"] == pytest.approx(names["klingel"], rel=0.01)
    assert pytest.approx(names["conicity"], abs=1e-4) == 0.0526


def test_the_braked_vehicle_of_the_page(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """The tables fit the scene; the vehicle comes to a halt with the deceleration of the closed form."""
    from wheelrail.scenes.schema.scene import RunScene, parse_scene

    monkeypatch.chdir(ROOT)
    plain = (ROOT / "scenes" / "vehicle.toml").read_text(encoding="utf-8").replace("[vehicle]\nspeed = 25.0", "")
    torques, free, forces = blocks("traction", "toml")
    scene = parse_scene(f"{plain}\n{torques}\n{free}\n{forces}")
    assert isinstance(scene, RunScene)
    assert scene.keys_of_vehicle_files == ["torque", "force", "vehicle.free_speed"]
    (code,) = blocks("traction", "python")
    names: dict[str, Any] = {}
    exec(compile(code, "traction.md", "exec"), names)
    assert names["measured"] == pytest.approx(names["expected"], rel=2e-3)
    assert re.fullmatch(
        r"completed: 15\.\d s, 12\d m, -1\.01\d m/s2 \(closed form -1\.012\)\n", capsys.readouterr().out
    )


def noisy_file(file: Path, profile: Any, start: float, stop: float, shift: float, sign: float) -> None:
    """MiniProf file of points 0.2 mm apart with 5 µm of noise, rounded to 0.1 µm."""
    points = profile.point(np.arange(start, stop, 2e-4))
    points = (points + 5e-6 * np.random.default_rng(17).standard_normal(points.shape)) * (sign, 1.0) + (shift, 0.0)
    lines = (f"{1e3 * y:.4f} {1e3 * z:.4f}" for y, z in points)
    file.write_text("ProgramName=MiniProf\nColumnDef=X,Y\n\n" + "\n".join(lines))


def test_the_noisy_pair_of_the_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Measured wheels and a measured rail, a contact and a run through a curve; and the scene's tables."""
    from wheelrail.meshes.profiles.named import named_profile
    from wheelrail.scenes.schema.scene import parse_scene

    monkeypatch.chdir(tmp_path)
    wheel, rail = named_profile("S1002"), named_profile("60E1").inclined(0.025)
    start, stop = wheel.s_range[0] + 1e-3, float(wheel.s_at_y(58e-3))
    for name in ("worn_wheel", "worn_wheel_right"):
        noisy_file(tmp_path / f"{name}.whl", wheel, start, stop, 0.070, 1.0)
    noisy_file(tmp_path / "worn_rail.ban", rail, rail.s_range[0] + 1e-3, rail.s_range[1] - 1e-3, 0.0, -1.0)
    curve = (ROOT / "scenes" / "curve.toml").read_text(encoding="utf-8")
    (tmp_path / "curve.toml").write_text(curve)
    code, _ = blocks("profile", "python")
    names: dict[str, Any] = {}
    exec(compile(code, "profile.md", "exec"), names)
    assert re.search(r"noise of about 5(\.\d)? µm; noise = 5(\.\d)?e-06 m: error", capsys.readouterr().out)
    exact = wr.Wheelset(wheel, rail, laying_angle=0.0, model="standard").solve(wheel_load=57e3, speed=45.0)
    pressures = [float(solution.data.patch_max_pressure.sel(side="left")[0]) for solution in (names["contact"], exact)]
    assert pressures[0] == pytest.approx(pressures[1], rel=0.3)
    run = names["run"]
    assert run.status == "completed"
    assert np.abs(run.data.body_y.sel(body="wheelset")).max() < 8e-3
    text = curve[: curve.index("[profiles]")] + curve[curve.index("[track]") :]
    (tables,) = blocks("profile", "toml")
    scene = parse_scene(f"{text}\n{tables}", tmp_path / "curve.toml")
    assert scene.side("right").friction == 0.25  # type: ignore[union-attr]
    assert scene.side("left").radius == 0.46  # type: ignore[union-attr]


def test_the_worn_wheel_of_the_page(capsys: pytest.CaptureFixture[str]) -> None:
    _, code = blocks("profile", "python")
    names: dict[str, Any] = {"wr": wr}
    exec(compile(code, "profile.md", "exec"), names)
    assert (
        "Sh 28 mm, Sd 31.87 mm, qR 10.16 mm, hollow 0 mm, rolling_radius 460 mm, removed_section 10.63 mm²"
        in capsys.readouterr().out
    )
    assert names["places"] == pytest.approx(names["contact"].results["left"].patches[0].wheel_s, abs=1e-3)
