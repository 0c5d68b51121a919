"""Studies: validation, caching of cases, failures of cases and workers."""

from __future__ import annotations

import json
import logging
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fragile_worker import DEADLY, RAISING, fragile, talkative
from study_workers import Here
from typer.testing import CliRunner
from xarray import Dataset, open_dataset
from xarray.testing import assert_identical

from wheelrail.cli.main import app
from wheelrail.contact.analytical.hertz import hertz, modulus
from wheelrail.scenes.plots.fits import slope
from wheelrail.scenes.runs import run as scene_run
from wheelrail.scenes.schema.edits import changed
from wheelrail.scenes.schema.errors import RunFailed, SceneError
from wheelrail.scenes.schema.scene import RunScene, checked
from wheelrail.scenes.studies import plan as plan_module
from wheelrail.scenes.studies import run as run_module
from wheelrail.scenes.studies.job import Job
from wheelrail.scenes.studies.plan import MAX_CASES, Plan, plan
from wheelrail.scenes.studies.run import run_study
from wheelrail.scenes.studies.schema import check_study, load_study
from wheelrail.scenes.studies.solve import CaseResult, can_resume, solve
from wheelrail.scenes.studies.store import Store
from wheelrail.scenes.studies.workers import SchedulerGone, case_results, cluster, processes

ROOT = Path(__file__).parents[2]
SCENES = ROOT / "scenes"
BODY = {"radii": [0.46, 0.3], "E": 210e9, "nu": 0.3}
HERTZ = {
    "kind": "hertz",
    "model": "standard",
    "normal": "hertz",
    "load": 1e4,
    "friction": 0.0,
    "upper": BODY,
    "lower": BODY | {"radii": [float("inf"), 0.3]},
}


def study(**what: Any) -> dict[str, Any]:
    return {"scene": HERTZ, "workers": 1, **what}


def planned(**what: Any) -> Plan:
    return plan(check_study(study(**what)))


def exact(load: float) -> float:
    """Peak pressure of the pair."""
    steel = (210e9, 0.3)
    return hertz(0.5 / 0.46, 1 / 0.3, modulus(steel, steel), force=load).peak


# Computed cases


def test_a_grid_has_its_parameters_as_dimensions(here: Here) -> None:
    data = run_study(study(grid={"load": [1e4, 3e4], "upper.radii": [[0.46, 0.3], [0.5, 0.3], [0.46, 0.6]]}))
    assert dict(data["max_pressure"].sizes) == {"load": 2, "upper_radii": 3}
    assert list(data["upper_radii"].values) == ["[0.46, 0.3]", "[0.5, 0.3]", "[0.46, 0.6]"]
    assert set(data["status"].values.flat) == {"converged"}
    for load in (1e4, 3e4):
        np.testing.assert_allclose(
            data["max_pressure"].sel(load=load, upper_radii="[0.46, 0.3]"), exact(load), rtol=1e-6
        )
    assert all("units" in data[name].attrs for name in data if data[name].dtype.kind == "f")
    assert data["load"].attrs["units"] == "N"


def test_parameters_that_change_together_are_one_dimension(here: Here) -> None:
    data = run_study(
        study(
            together=[{"load": [1e4, 2e4, 3e4], "friction": [0.0, 0.1, 0.2]}],
            set={"speed": 10.0, "creepage": [0, 0, 0.0]},
        )
    )
    assert dict(data["area"].sizes) == {"load": 3}
    assert data["friction"].dims == ("load",)


def test_hypercube_is_uniform_and_reproducible(here: Here) -> None:
    cube = {
        "samples": 16,
        "seed": 3,
        "ranges": {"load": {"low": 1e3, "high": 1e5, "scale": "log"}, "upper.nu": {"low": 0.2, "high": 0.4}},
    }
    data = run_study(study(latin_hypercube=cube))
    assert dict(data["area"].sizes) == {"sample": 16}
    shares = np.sort((np.log10(data["load"].values) - 3) / 2)
    assert np.all(np.floor(16 * shares) == np.arange(16))  # one in every sixteenth, on the logarithm
    assert np.all(np.floor(16 * np.sort((data["upper_nu"].values - 0.2) / 0.2)) == np.arange(16))
    again = planned(latin_hypercube=cube)
    np.testing.assert_array_equal([case.parameters["load"] for case in again.cases], data["load"].values)
    other = planned(latin_hypercube=cube | {"seed": 4})
    assert [case.parameters for case in other.cases] != [case.parameters for case in again.cases]


def test_integer_parameters_are_sampled_as_integers() -> None:
    scene = {**HERTZ, "surface_size": 1e-3, "model": "condensed"}
    del scene["normal"]
    cube = {"samples": 60, "ranges": {"cells": {"low": 6, "high": 11}}}
    drawn = [case.parameters["cells"] for case in planned(scene=scene, latin_hypercube=cube).cases]
    assert {value: drawn.count(value) for value in drawn} == dict.fromkeys(range(6, 12), 10)


def test_sides_of_a_wheelset_and_a_hypercube_for_every_model() -> None:
    table = load_study(SCENES / "study_samples.toml").model_dump(exclude_none=True) | {
        "grid": {"normal": ["hertz", "kik-piotrowski"]}
    }
    found = plan(check_study(table))
    assert found.shape == (2, 64)
    job = Job.of(found.cases[0])
    sides = solve(job).sides
    assert list(sides) == ["left", "right"]
    assert sides["left"]["vertical_force"] > 1e4


@pytest.mark.parametrize("name", ["study_mesh", "study_curve", "study_samples"])
def test_shipped_studies_are_valid(name: str) -> None:
    assert plan(load_study(SCENES / f"{name}.toml"), SCENES / f"{name}.toml").cases


def test_a_run_gives_its_extremes_and_histories(here: Here, tmp_path: Path) -> None:
    short = {
        "track.tangent": 5.0,
        "track.transition_length": 5.0,
        "track.curve": 5.0,
        "normal": "hertz",
        "tangential": "polach",
    }
    table = load_study(SCENES / "study_curve.toml").model_dump(exclude_none=True)
    table |= {"set": table["set"] | short, "grid": {"friction": [0.3], "vehicle.speed": [40.0, 45.0]}}
    data = run_study(table, tmp_path)
    assert set(data["status"].values.flat) == {"completed"}
    history = data["history_wheelset_y"].sel(vehicle_speed=45.0, friction=0.3)
    assert float(data["largest_wheelset_y"].sel(vehicle_speed=45.0, friction=0.3)) == float(np.abs(history).max())
    assert data["history_lateral_force"].dims == ("friction", "vehicle_speed", "time", "side")
    assert (tmp_path / "study.png").exists()


# Errors and their order


def test_the_order_is_the_slope_of_the_error() -> None:
    size = np.array([1.0, 0.5, 0.25, 0.125])
    assert slope(size, 0.3 * size**2) == pytest.approx(2.0)
    assert slope(size, np.array([1e-2, np.nan, 1e-3, 0.0])) != slope(size, 0.3 * size)
    assert np.isnan(slope(size, np.array([1e-2, np.nan, np.nan, 0.0])))


def test_strips_converge_to_hertz(here: Here, tmp_path: Path) -> None:
    scene = {key: value for key, value in HERTZ.items() if key != "normal"} | {
        "model": "condensed",
        "surface_size": 1e-3,
    }
    cells = {"cells": [6, 8, 11, 16, 22], "strips": [6, 8, 11, 16, 22]}
    data = run_study(study(scene=scene, together=[cells], convergence={"reference": "hertz"}), tmp_path)
    assert float(data["reference_max_pressure"][0]) == pytest.approx(exact(1e4))
    assert float(data["relative_error_max_pressure"][-1]) < 0.3e-2
    assert float(data["order_area"]) > 0.5  # errors scatter with the place of the outer strips
    assert float(abs(data["relative_error_area"])[-1]) < 1e-2
    assert 1.6 < float(data["order_max_pressure"]) < 3.5  # squares of the pressure are parabolas across an ellipse
    assert (tmp_path / "convergence.png").exists()


def test_finer_case_as_reference(here: Here) -> None:
    radii = {"load": [1e4, 2e4, 4e4]}
    data = run_study(study(grid=radii, convergence={"over": "load", "reference": {"load": 8e4}}))
    assert dict(data["area"].sizes) == {"load": 3}
    np.testing.assert_allclose(data["relative_error_area"], 1 - np.array([1 / 8, 1 / 4, 1 / 2]) ** (2 / 3), rtol=1e-6)


# Invalid studies

BAD = {
    "nothing varied": ({}, "nothing is varied"),
    "empty": ({"grid": {"load": []}}, "grid.load = []: must be an array of values, at least one"),
    "one value": ({"grid": {"load": 1e4}}, "grid.load = 10000.0: must be an array of values"),
    "duplicate": ({"grid": {"load": [1e4, 2e4, 1e4]}}, "grid: load: 10000.0 must be listed once"),
    "twice": ({"grid": {"load": [1e4]}, "set": {"load": 2e4}}, "load: must be named once"),
    "inside another": ({"grid": {"upper.radii": [[1.0, 1.0]], "upper.radii.0": [1.0]}}, "named once, is also set by"),
    "unknown key": ({"grid": {"frictoin": [0.1]}}, "study: grid.frictoin: unknown key; did you mean friction?"),
    "unknown in a table": ({"grid": {"upper.radius": [0.1]}}, "did you mean upper.radii?"),
    "no table": ({"grid": {"load.x": [0.1]}}, "grid.load.x: unknown key"),
    "no such place": ({"grid": {"upper.radii.2": [0.1]}}, "grid.upper.radii.2: unknown key"),
    "value": ({"grid": {"load": [1e4, -1.0]}}, "study: grid.load[1] = -1.0: must be a number from 0.001 to 1e+08 N"),
    "not a number": ({"grid": {"load": ["much"]}}, 'grid.load[0] = "much": must be a number'),
    "combination": (
        {"grid": {"friction": [0.0, 0.3]}},
        "with friction = 0.3: speed: missing: required if friction is not 0",
    ),
    "kind": ({"grid": {"kind": ["run"]}}, "a study has one kind of scene"),
    "other kind": ({"kind": "run", "grid": {"load": [1e4]}}, 'must be "study"'),
    "unequal": ({"together": [{"load": [1.0, 2.0], "friction": [0.0]}]}, "load has 2, friction has 1"),
    "range": (
        {"latin_hypercube": {"samples": 3, "ranges": {"load": {"low": 2.0, "high": 1.0}}}},
        "high = 1.0: must be greater than low = 2",
    ),
    "log of 0": (
        {"latin_hypercube": {"samples": 3, "ranges": {"load": {"low": 0.0, "high": 1.0, "scale": "log"}}}},
        "must be greater than 0",
    ),
    "no samples": (
        {"latin_hypercube": {"samples": 0, "ranges": {"load": {"low": 1.0, "high": 2.0}}}},
        "samples = 0: must be a whole number from 1",
    ),
    "a text drawn": (
        {"latin_hypercube": {"samples": 2, "ranges": {"model": {"low": 0.0, "high": 1.0}}}},
        'must be "condensed" or',
    ),
    "scene": (
        {"scene": "nowhere.toml", "grid": {"load": [1e4]}},
        'scene = "nowhere.toml": must be an existing scene file',
    ),
    "workers": ({"workers": 0, "grid": {"load": [1e4]}}, "workers = 0: must be a whole number from 1 to 1024"),
    "key": ({"gird": {"load": [1e4]}}, "gird: unknown key; did you mean grid?"),
    "histories": ({"histories": True, "grid": {"load": [1e4]}}, 'allowed only for kind = "run"'),
    "left out": ({"without": ["speed"], "grid": {"load": [1e4]}}, "without: speed: must be a key of the scene"),
    "reference": ({"grid": {"load": [1e4, 2e4]}, "convergence": {"reference": {"load": 2e4}}}, "must not be one of"),
    "over": (
        {"grid": {"load": [1e4]}, "convergence": {"over": "cells", "reference": "hertz"}},
        "must be a numeric dimension: load",
    ),
    "other reference": ({"grid": {"load": [1e4]}, "convergence": {"reference": "herz"}}, 'must be "hertz", or a table'),
}


@pytest.mark.parametrize("name", BAD)
def test_invalid_studies_name_the_reason(name: str) -> None:
    what, says = BAD[name]
    with pytest.raises(SceneError) as caught:
        planned(**what)
    assert says in str(caught.value)
    assert all(line.startswith("study: ") for line in str(caught.value).splitlines())


def test_too_many_cases_are_rejected() -> None:
    many = [1e4 + i for i in range(200)]
    with pytest.raises(SceneError, match=rf"40000 cases \(200 load x 200 friction\): must be at most {MAX_CASES}"):
        planned(grid={"load": many, "friction": [1e-3 * i for i in range(200)]})


def test_first_of_many_errors_are_reported() -> None:
    with pytest.raises(SceneError) as caught:
        planned(grid={"load": [-1.0 - i for i in range(50)]})
    assert str(caught.value).count("\n") == 5
    assert str(caught.value).endswith("more errors of this kind")


RUN = {"scene": str(SCENES / "curve.toml")}
MANY = [1e-5 * i for i in range(10_000)]
HUNDRED = [20.0 + 0.1 * i for i in range(100)]
LATE = {
    "the last of 10 000 numbers": ({"friction": [*MANY[:-1], 3.0]}, "friction[9999] = 3.0: must be a number from", 600),
    "one in the middle": ({"friction": [*MANY[:5000], 3.0, *MANY[5001:]]}, "friction[5000] = 3.0: must be a numb", 600),
    "two dimensions": (
        {"vehicle.speed": HUNDRED, "vehicle.roll_bar": [*(1e4 * v for v in HUNDRED[1:]), -1.0]},
        "grid.vehicle.roll_bar[99] = -1.0: must be zero or positive",
        600,
    ),
}


@pytest.mark.parametrize("name", LATE)
def test_invalid_value_is_detected_early(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    grid, says, most = LATE[name]
    looked = list[Any]()
    monkeypatch.setattr(plan_module, "changed", lambda *what: looked.append(what) or changed(*what))
    with pytest.raises(SceneError) as caught:
        plan(check_study({**RUN, "grid": grid}))
    assert says in str(caught.value)
    assert 1 < len(looked) <= most


def test_last_combination_is_validated() -> None:
    says = r"wheelset\.flange_back_distance\[1\] = 1\.5: must be less than the gauge of 1\.435 m"
    with pytest.raises(SceneError, match=says):
        plan(check_study({**RUN, "grid": {"track.gauge": [1.6, 1.435], "wheelset.flange_back_distance": [1.36, 1.5]}}))


def test_cases_are_validated_like_single_scenes() -> None:
    """A valid table of one case is not validated again, with the same result."""
    grid = {
        "vehicle.speed": [30.0, 40.0],
        "vehicle.roll_bar": [1e6, 2e6],
        "track.curve": [200.0, 300.0],
        "wheelset.radius": [0.45, 0.46],
    }
    found = plan(check_study({**RUN, "grid": grid}))
    assert len(found.cases) == 16
    for case in found.cases:
        alone = checked(case.table, SCENES / "curve.toml")
        assert case.scene == alone
        assert case.scene.model_dump() == alone.model_dump()
        assert case.scene.model_fields_set == alone.model_fields_set
    assert len({id(case.scene.track) for case in found.cases}) == 2  # type: ignore[union-attr]


def test_command_rejects_invalid_studies_before_computing(tmp_path: Path) -> None:
    file = tmp_path / "bad.toml"
    file.write_text(f'scene = "{SCENES / "hertz.toml"}"\n[grid]\nload = [1e4, 6e40]\n')
    found = CliRunner().invoke(app, ["study", str(file), "--out", str(tmp_path / "out")])
    assert found.exit_code == 2
    assert f"{file}: grid.load[1] = 6e+40: must be a number" in found.output
    assert not (tmp_path / "out").exists()


# Stored cases


def test_only_missing_cases_are_computed(here: Here, tmp_path: Path) -> None:
    first = run_study(study(grid={"load": [1e4, 2e4]}), tmp_path, pictures=False)
    assert len(here.jobs) == 2
    again = run_study(study(grid={"load": [1e4, 2e4]}), tmp_path, pictures=False)
    assert len(here.jobs) == 2
    assert again.identical(first.assign_attrs(created=again.attrs["created"]))
    more = run_study(study(grid={"load": [1e4, 1.5e4, 2e4]}), tmp_path, pictures=False)
    assert len(here.jobs) == 3
    np.testing.assert_array_equal(more["area"].sel(load=[1e4, 2e4]), first["area"])
    run_study(study(grid={"load": [1e4, 2e4]}), tmp_path, fresh=True, pictures=False)
    assert len(here.jobs) == 5


@pytest.mark.parametrize("damage", ["cut", "flipped", "empty", "other", "garbage"])
def test_damaged_case_is_recomputed(damage: str, tmp_path: Path, here: Here) -> None:
    run_study(study(grid={"load": [1e4, 2e4]}), tmp_path, pictures=False)
    one, two = sorted((tmp_path / "cases").iterdir())
    whole = one.read_bytes()
    number = whole.index(b"max_pressure") + 18
    spoiled = {
        "cut": whole[:-7],
        "flipped": whole[:number] + bytes([whole[number] ^ 1]) + whole[number + 1 :],
        "empty": b"",
        "other": two.read_bytes(),
        "garbage": bytes(range(128, 256)),
    }
    one.write_bytes(spoiled[damage])
    data = run_study(study(grid={"load": [1e4, 2e4]}), tmp_path, pictures=False)
    assert len(here.jobs) == 3
    np.testing.assert_allclose(data["max_pressure"], [exact(1e4), exact(2e4)], rtol=1e-6)


def test_case_key_depends_on_file_contents(tmp_path: Path) -> None:
    scene = SCENES / "curve.toml"
    wagon = tmp_path / "wagon.toml"
    wagon.write_text("roll_bar = 1e6\n")
    table = {"scene": str(scene), "grid": {"vehicle.wagon": [str(wagon)], "friction": [0.3]}}
    case = plan(check_study(table)).cases[0]
    one = Job.of(case)
    with one.scene() as (there, folder):
        assert there.kind == "run"
        assert Path(str(there.vehicle.wagon)).is_relative_to(folder)
        assert there.vehicle.on(None).roll_bar == 1e6
    assert Job.of(case).key == one.key
    wagon.write_text("roll_bar = 2e6\n")
    assert Job.of(case).key != one.key


def test_identical_scenes_are_computed_once(here: Here) -> None:
    data = run_study(study(latin_hypercube={"samples": 6, "ranges": {"upper.nu": {"low": 0.3, "high": 0.3 + 1e-16}}}))
    assert 1 <= len(here.jobs) < 6
    assert set(data["status"].values.flat) == {"converged"}


def test_case_that_cannot_be_stored_is_reported_and_used(
    here: Here, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "cases").write_text("in the way")
    data = run_study(study(grid={"load": [1e4, 2e4]}), tmp_path, pictures=False)
    assert "a case not stored" in capsys.readouterr().err
    assert set(data["status"].values.flat) == {"converged"}


# Failures


def test_failed_case_has_its_error_and_others_continue(here: Here, tmp_path: Path) -> None:
    scene = json.loads(json.dumps(load_study(SCENES / "study_samples.toml").base(SCENES)[0]))
    fix = {"model": "standard", "laws": "exact", "normal": "hertz", "tangential": "polach"}
    table = {"scene": scene, "set": fix, "grid": {"track.gauge_height": [0.014, 0.049], "wheelset.y": [0.0, 1e-3]}}
    data = run_study(table, tmp_path, pictures=False)
    assert list(data["status"].values[0]) == ["converged", "converged"]
    assert list(data["status"].values[1]) == ["failed", "failed"]
    assert "profiles" in str(data["error"].values[1, 0])
    assert np.isnan(data["max_pressure"].values[1]).all()
    assert np.isfinite(data["max_pressure"].values[0]).all()
    before = len(here.jobs)
    run_study(table, tmp_path, pictures=False)
    assert len(here.jobs) == before  # the stored failure is reused


def cases(*loads: float) -> list[Job]:
    return [Job.of(case) for case in planned(grid={"load": list(loads)}).cases]


def test_a_worker_that_dies_takes_one_case_with_it() -> None:
    with processes(2) as executor:
        jobs = cases(1e4, DEADLY, 3e4, RAISING, 5e4, 6e4)
        results = {job.table["load"]: result for job, result in case_results(executor, jobs, fragile)}
    assert {load for load, result in results.items() if result.ok} == {1e4, 3e4, 5e4, 6e4}
    assert "ended abruptly" in results[DEADLY].error
    assert "ZeroDivisionError" in results[RAISING].error
    assert results[DEADLY].lost
    assert results[1e4].whole["threads"] == 1
    assert not any(Path("/proc", str(int(result.whole["pid"]))).exists() for result in results.values() if result.ok)


def test_a_worker_that_dies_between_two_cases_is_replaced() -> None:
    with processes(1) as executor:
        pids = []
        for load in (1e4, 3e4, 5e4):
            ((_, result),) = case_results(executor, cases(load), fragile)
            pids.append(int(result.whole["pid"]))
            if load == 3e4:
                os.kill(pids[-1], signal.SIGKILL)
                assert waited_for(lambda: not Path("/proc", str(pids[-1])).exists())
    assert pids[0] == pids[1] != pids[2]


def test_workers_have_one_thread_before_numpy_is_loaded(monkeypatch: pytest.MonkeyPatch) -> None:
    """Libraries read the number of threads when they are loaded."""
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "2")
    with processes(1) as executor:
        assert executor.submit(eval, "'numpy' in __import__('sys').modules").result() is False
        assert executor.submit(os.getenv, "OPENBLAS_NUM_THREADS").result() == "1"


def test_messages_of_workers_are_logged_here(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.INFO, "wheelrail"), processes(2) as executor:
        assert all(result.ok for _, result in case_results(executor, cases(1e4, 2e4, 3e4), talkative))
    messages = [(record.name, record.levelname, record.getMessage()) for record in caplog.records]
    assert sorted(messages) == [("wheelrail.contact.work", "INFO", f"{load:g} N, 5 %") for load in (1e4, 2e4, 3e4)]


def test_lost_case_is_recomputed_next_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    gone = Here(lambda job: CaseResult("failed", "gone", lost=True) if job.table["load"] == 2e4 else solve(job))
    monkeypatch.setattr(run_module, "processes", lambda count: gone)
    data = run_study(study(grid={"load": [1e4, 2e4]}), tmp_path, pictures=False)
    assert list(data["status"].values) == ["converged", "failed"]
    back = Here()
    monkeypatch.setattr(run_module, "processes", lambda count: back)
    data = run_study(study(grid={"load": [1e4, 2e4]}), tmp_path, pictures=False)
    assert [job.table["load"] for job in back.jobs] == [2e4]
    assert list(data["status"].values) == ["converged", "converged"]


def test_worker_of_another_version_is_rejected() -> None:
    job = cases(1e4)[0]
    found = solve(replace(job, computer={**job.computer, "sources": "another"}))
    assert found.lost
    assert "another version" in found.error


# Killed and restarted


def started(file: Path, out: Path) -> subprocess.Popen[bytes]:
    line = [sys.executable, "-c", "from wheelrail.cli.main import main; main()", "study", str(file), "--out", str(out)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.Popen(
        line, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    )


def waited_for(what: Callable[[], object], seconds: float = 60.0) -> bool:
    end = time.monotonic() + seconds
    while not (found := what()) and time.monotonic() < end:
        time.sleep(0.02)
    return bool(found)


def alive(session: int) -> list[int]:
    """Processes of a session."""
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, _, own = stat.read_text().rsplit(")", 1)[1].split()[:4]
        except OSError:
            continue
        if int(own) == session and state != "Z":
            found.append(int(stat.parent.name))
    return found


KEPT = "[!.]*.json"  # temporaries of a killed writer begin with a dot
SLOW = """
kind = "study"
scene = "SCENE"
workers = 2
[set]
laws = "exact"
cells = 8
strips = 6
[grid]
friction = [0.10, 0.14, 0.18, 0.22, 0.24, 0.26, 0.30, 0.34, 0.38, 0.40]
"""


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT])
def test_interrupted_study_resumes_and_leaves_no_process(how: signal.Signals, tmp_path: Path, here: Here) -> None:
    file, out = tmp_path / "slow.toml", tmp_path / "out"
    file.write_text(SLOW.replace("SCENE", str(SCENES / "hertz.toml")))
    process = started(file, out)
    assert waited_for(lambda: len(list((out / "cases").glob(KEPT))) >= 2)
    os.kill(process.pid, how)
    code = process.wait(timeout=60)
    assert waited_for(lambda: not alive(process.pid), 30.0)
    assert code == (130 if how == signal.SIGINT else -signal.SIGKILL)
    kept = {path.name: path.stat().st_mtime_ns for path in (out / "cases").glob(KEPT)}
    assert 2 <= len(kept) < 10
    if how == signal.SIGINT:
        with open_dataset(out / "study.nc") as data:
            assert sorted(set(data["status"].values)) == ["converged", "not computed"]
            assert int(np.isfinite(data["area"]).sum()) == len(kept)
        return
    data = run_study(file, out, pictures=False)
    assert len(here.jobs) == 10 - len(kept)
    assert set(data["status"].values) == {"converged"}
    assert kept.items() <= {path.name: path.stat().st_mtime_ns for path in (out / "cases").glob(KEPT)}.items()
    for case in plan(load_study(file), file).cases:
        job = Job.of(case)
        if f"{job.key}.json" in kept:  # computed by the process that was killed
            again, before = solve(job), Store(out / "cases").load(job.key)
            assert before is not None
            assert again.sides["contact"]["max_pressure"] == before.sides["contact"]["max_pressure"]
            break


STEPS = 10  # from one checkpoint to the next
CURVE = f"""
scene = "{SCENES / "curve.toml"}"
without = ["strips", "cells"]
workers = 1
histories = true
[set]
model = "standard"
laws = "exact"
normal = "hertz"
tangential = "polach"
output.checkpoint = {STEPS}
output.interval = 0.1
track = {{ tangent = 20.0, transition_length = 40.0, curve = 60.0 }}
[grid]
friction = [0.3]
"""


@dataclass
class Counted:
    """A contact that counts what it solves."""

    contact: Any
    solved: int = 0

    def __call__(self, *what: Any) -> Any:
        self.solved += 1
        return self.contact(*what)

    def solve_side(self, states: Any, *what: Any) -> Any:
        self.solved += len(states)
        return self.contact.solve_side(states, *what)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.contact, name)


def numbers(data: Dataset) -> Dataset:
    """Results without computing times and date."""
    return data.drop_vars([name for name in data if "seconds" in str(name)]).assign_attrs(created="")


def test_killed_run_resumes_from_its_checkpoint(tmp_path: Path, here: Here, monkeypatch: pytest.MonkeyPatch) -> None:
    solved, made = list[Counted](), scene_run.run_contact

    def counted(scene: RunScene, names: Any) -> tuple[Any, Any]:
        contact, structure = made(scene, names)
        solved.append(Counted(contact))
        return solved[-1], structure

    monkeypatch.setattr(scene_run, "run_contact", counted)
    file = tmp_path / "curve.toml"
    file.write_text(CURVE)
    undisturbed = run_study(file, tmp_path / "whole", pictures=False)
    ended = [".json", ".nc"]
    assert sorted(path.suffix for path in (tmp_path / "whole" / "cases").iterdir()) == ended

    process, cases = started(file, tmp_path / "killed"), tmp_path / "killed" / "cases"
    assert waited_for(lambda: any(path.stat().st_size > 40_000 for path in cases.glob("[!.]*")))
    os.kill(process.pid, signal.SIGKILL)
    process.wait(timeout=60)
    assert waited_for(lambda: not alive(process.pid), 30.0)
    (left,) = cases.iterdir()
    assert left.suffix == ".checkpoints"
    content = left.read_bytes()
    with Job.of(plan(load_study(file), file).cases[0]).scene() as (scene, _):
        assert can_resume(scene, left)
        assert not can_resume(scene.model_copy(update={"friction": 0.31}), left)
        for spoiled in (b"", content[:900], content.replace(b"S1002", b"S1003"), bytes(range(256))):
            left.write_bytes(spoiled)
            assert not can_resume(scene, left)

    left.write_bytes(content)
    again = run_study(file, tmp_path / "killed", pictures=False)
    assert_identical(numbers(again), numbers(undisturbed))
    assert solved[1].solved < 0.9 * solved[0].solved
    assert sorted(path.suffix for path in cases.iterdir()) == ended
    next(cases.glob(KEPT)).unlink()
    left.write_bytes(content[:900])
    assert_identical(numbers(run_study(file, tmp_path / "killed", pictures=False)), numbers(undisturbed))
    assert solved[2].solved == solved[0].solved
    assert sorted(path.suffix for path in cases.iterdir()) == ended


# A cluster


def test_cluster_gives_identical_results_despite_a_killed_worker(tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    from dask import config

    table = study(grid={"load": [1e4, 2e4, 3e4, 4e4]})
    with (
        config.set({"distributed.worker.daemon": True, "distributed.comm.timeouts.connect": "20s"}),
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=1, processes=True, dashboard_address=None, protocol="tcp://"
        ) as local,
    ):
        data = run_study(table, tmp_path, pictures=False, scheduler=local.scheduler_address)
        with cluster(local.scheduler_address) as executor:
            assert all(result.ok for _, result in case_results(executor, cases(1e4)))
            pid = executor.submit(os.getpid).result()
            os.kill(pid, signal.SIGKILL)  # its nanny starts another one
            assert all(result.ok for _, result in case_results(executor, cases(5e4, 6e4)))
            assert executor.submit(os.getpid).result() != pid
    assert set(data["status"].values) == {"converged"}
    np.testing.assert_allclose(data["max_pressure"], [exact(load) for load in data["load"].values], rtol=1e-6)


def test_lost_scheduler_ends_the_study_and_keeps_finished_cases(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Dying(Here):
        """Cancels all jobs but two when the second one is done."""

        def __enter__(self) -> Here:
            self.futures = list[Future[CaseResult]]()
            return super().__enter__()

        def submit(self, work: Any, job: Job) -> Any:  # type: ignore[override]
            self.futures.append(Future() if len(self.futures) > 1 else super().submit(work, job))
            if len(self.futures) > 2:
                self.futures[1].add_done_callback(partial(cancel, self.futures[-1]))
            return self.futures[-1]

    def cancel(future: Future[CaseResult], _: object) -> None:
        future.cancel()
        future.set_running_or_notify_cancel()

    table = study(grid={"load": [1e4, 2e4, 3e4, 4e4, 5e4]})
    monkeypatch.setattr(run_module, "cluster", lambda address: Dying())
    with pytest.raises(SchedulerGone, match="the same command continues, with another --scheduler or without one"):
        run_study(table, tmp_path, pictures=False, scheduler="tcp://127.0.0.1:8786")
    with open_dataset(tmp_path / "study.nc") as data:
        assert list(data["status"].values) == ["converged"] * 2 + ["not computed"] * 3
    here = Here()
    monkeypatch.setattr(run_module, "processes", lambda count: here)
    data = run_study(table, tmp_path, pictures=False)
    assert set(data["status"].values) == {"converged"}
    assert len(here.jobs) == 3


def test_a_killed_scheduler_cancels_the_remaining_jobs() -> None:
    pytest.importorskip("distributed")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
    dask, environment = [sys.executable, "-m", "dask"], {**os.environ, "PYTHONPATH": str(ROOT)}
    options = ["--no-dashboard", "--host", "127.0.0.1"]
    commands = (
        [*dask, "scheduler", *options, "--port", address.rpartition(":")[2]],
        [*dask, "worker", address, *options, "--nthreads", "1", "--no-nanny"],
    )
    running = [subprocess.Popen(line, env=environment, stderr=subprocess.DEVNULL) for line in commands]
    results = []
    try:
        with cluster(address) as executor, pytest.raises(SchedulerGone):  # noqa: PT012
            for _, result in case_results(executor, cases(1e4, 2e4, 3e4, 4e4, 5e4, 6e4)):
                results.append(result)
                running[0].kill()
    finally:
        for process in running:
            process.kill()
            process.wait()
    assert 1 <= len(results) < 6
    assert all(result.ok for result in results)


def test_no_cluster_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("wheelrail.scenes.studies.workers.TIMEOUT", "1s")
    with pytest.raises(RunFailed, match="no scheduler answers"):
        run_study(study(grid={"load": [1e4]}), tmp_path, scheduler="tcp://127.0.0.1:9")
    with pytest.raises(SceneError, match="must be an address"):
        run_study(study(grid={"load": [1e4]}), tmp_path, scheduler="nonsense://x")


def test_names_of_many_dots_are_refused() -> None:
    with pytest.raises(SceneError, match="must be a dotted key of the scene"):
        check_study({"scene": {}, "grid": {"a." * 30_000 + "b": [1]}})
