"""The command `wheelrail`: output and exit codes."""

from __future__ import annotations

import json
import logging
import os
import re
import signal
import subprocess
import sys
import textwrap
from io import StringIO
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from rich.console import Console
from spring_contact import SpringContact
from standin_contact import CONTACT, FunctionContact
from typer.testing import CliRunner

from wheelrail.cli.main import app
from wheelrail.contact.kinematics.wheelset_state import Mounting
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.scenes.contacts import solve as solve_module
from wheelrail.scenes.datasets.result_table import json_text
from wheelrail.scenes.quantity import fixed, significant
from wheelrail.scenes.runs.progress import case_bar
from wheelrail.support.terminal import messages_on

SCENES = Path(__file__).parents[2] / "scenes"
HERTZ, WHEELSET = (SCENES / name for name in ("hertz.toml", "wheelset.toml"))
SIDE_KEYS = {"force", "moment", "normal_force", "tangential_force", "approach", "z", "roll", "patches", "statistics"}
PATCH_KEYS = {
    *("area", "max_pressure", "normal_force", "semi_axes", "contact_angle", "wheel_s", "rail_s", "x", "stick_area"),
    "tangential_force",
}


@pytest.fixture
def spring(monkeypatch: pytest.MonkeyPatch) -> SpringContact:
    """A spring instead of the finite elements, for Hertz pairs and wheelsets."""
    model = SpringContact()
    pairs = SimpleNamespace(hertz_pair=lambda *args, **options: model)
    monkeypatch.setitem(sys.modules, "wheelrail.contact.models.builders", pairs)
    mounting = Mounting(wheel_y=0.75, rail_y=0.76, radius=0.46)

    def contact(scene: object, profiles: object) -> WheelsetContact:
        model.touch = 0.46 - 1.8e-4
        return WheelsetContact(model, mounting)

    monkeypatch.setattr("wheelrail.scenes.contacts.solve.wheelset_contact", contact)
    return model


def contact(file: Path, *options: str) -> Any:
    return CliRunner().invoke(app, ["contact", str(file), *options])


def vehicle(command: str, monkeypatch: pytest.MonkeyPatch, *options: str) -> Any:
    monkeypatch.setattr("wheelrail.scenes.runs.steady.run_contact", lambda scene, names: (CONTACT, None))
    return CliRunner().invoke(app, [command, str(SCENES / "curve.toml"), *options])


def test_modes_are_printed_for_each_speed(monkeypatch: pytest.MonkeyPatch) -> None:
    outcome = vehicle("modes", monkeypatch, "--speed", "10", "--speed", "30")
    assert outcome.exit_code == 0
    assert "straight track at 10 m/s" in outcome.stdout
    second = outcome.stdout.split("at 30 m/s")[1]
    assert re.search(r"1\.08 +0\.1345 .*car_body_z 100%", second)
    assert re.search(r"160\.3 +1\.0000 +-1007 .*wheelset_pitch 100%", second)


def test_curving_is_printed_for_each_speed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Values of the paper's curve; the stand-in contact has no patches."""
    outcome = vehicle("curving", monkeypatch, "--speed", "20", "--speed", "45")
    assert outcome.exit_code == 0
    for text in (
        r"cant deficiency \[mm\] +-9\.0",
        r"cant deficiency \[mm\] +198\.0",
        r"vertical force Q.*36\.58  73\.18",
    ):
        assert re.search(text, outcome.stdout)
    assert "cant 60 mm" in outcome.stdout
    assert "45" in vehicle("curving", monkeypatch).stdout.splitlines()[0]  # the scene's speed


def test_no_run_or_no_equilibrium_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    nothing = FunctionContact(lambda *_: ContactResult.separated())
    for command in ("modes", "curving"):
        refused = CliRunner().invoke(app, [command, str(HERTZ)])
        assert refused.exit_code == 2
        assert "wheelrail contact" in refused.stderr
    monkeypatch.setattr("wheelrail.scenes.runs.steady.run_contact", lambda scene, names: (nothing, None))
    failed = CliRunner().invoke(app, ["modes", str(SCENES / "curve.toml")])
    assert failed.exit_code == 1
    assert "50 mm" in failed.stderr


def edited(tmp_path: Path, source: Path, *changes: tuple[str, str]) -> Path:
    text = source.read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    (tmp_path / "scene.toml").write_text(text)
    return tmp_path / "scene.toml"


def test_hertz_json_has_the_keys_of_the_contract(spring: SpringContact) -> None:
    outcome = contact(HERTZ, "--json")
    assert outcome.exit_code == 0
    report = json.loads(outcome.stdout)
    assert (report["status"], report["model"], report["laws"]) == ("converged", "condensed", "exact")
    found = report["contact"]
    assert set(found) >= SIDE_KEYS
    assert found["force"][2] == pytest.approx(10e3, rel=1e-9)
    assert found["approach"] == pytest.approx((10e3 / spring.stiffness) ** (2 / 3), rel=1e-9)
    assert found["z"] == -found["approach"]
    (patch,) = found["patches"]
    assert set(patch) >= PATCH_KEYS
    assert found["tangential_force"] == patch["tangential_force"]
    assert found["statistics"]["contact_solves"] == len(spring.calls)
    assert found["statistics"]["newton"] == 3


def test_hertz_approach_is_one_solve(spring: SpringContact, tmp_path: Path) -> None:
    report = json.loads(contact(edited(tmp_path, HERTZ, ("load = 10e3", "approach = 25e-6")), "--json").stdout)
    assert len(spring.calls) == 1
    assert report["contact"]["approach"] == 25e-6
    assert report["contact"]["force"][2] == pytest.approx(spring.stiffness * 25e-6**1.5)


@pytest.mark.parametrize(
    ("changes", "sides"),
    [
        ([], ("left", "right")),
        ([('sides = ["left", "right"]', 'sides = ["right"]')], ("right",)),
        ([("roll = 0.0", 'roll = "solve"')], ("left", "right")),
        ([("wheel_load = 57e3", "axle_load = 114e3")], ("left", "right")),
        ([("wheel_load = 57e3", "z = -0.00025")], ("left", "right")),
    ],
)
def test_wheelset_json(
    spring: SpringContact, tmp_path: Path, changes: list[tuple[str, str]], sides: tuple[str, ...]
) -> None:
    outcome = contact(edited(tmp_path, WHEELSET, *changes), "--json")
    assert outcome.exit_code == 0
    report = json.loads(outcome.stdout)
    assert {"left", "right"} & set(report) == set(sides)
    for side in sides:
        assert set(report[side]) >= SIDE_KEYS
        assert report[side]["status"] == "converged"
    if not any("z = " in new for _, new in changes):
        assert [report[side]["force"][2] for side in sides] == pytest.approx([57e3] * len(sides), rel=1e-8)
    else:
        assert [report[side]["z"] for side in sides] == [-0.00025] * 2
        assert len(spring.calls) == 2
    assert sum(report[side]["statistics"]["contact_solves"] for side in sides) == len(spring.calls)


def test_raised_wheelset_is_separated(spring: SpringContact, tmp_path: Path) -> None:
    outcome = contact(edited(tmp_path, WHEELSET, ("wheel_load = 57e3", "z = 0.01")), "--json")
    assert outcome.exit_code == 0
    report = json.loads(outcome.stdout)
    assert report["status"] == report["left"]["status"] == "separated"
    assert report["left"]["patches"] == []
    assert report["left"]["force"] == [0.0, 0.0, 0.0]


def test_readable_table(spring: SpringContact) -> None:
    outcome = contact(WHEELSET)
    assert outcome.exit_code == 0
    for text in ("left", "right", "normal force [kN]", "57.000", "peak pressure [MPa]"):
        assert text in outcome.stdout


def test_tables_are_plain_text_in_a_pipe(spring: SpringContact, monkeypatch: pytest.MonkeyPatch) -> None:
    """No lines of boxes, no control sequences, no line broken, titles in one line."""
    outputs = [
        contact(WHEELSET).stdout,
        CliRunner().invoke(app, ["track", str(SCENES / "irregular.toml")]).stdout,
        vehicle("curving", monkeypatch).stdout,
        vehicle("modes", monkeypatch).stdout,
    ]
    for text in outputs:
        assert set(text) <= {chr(code) for code in range(32, 127)} | set("µ²°±‰\n"), sorted(set(text))
    assert outputs[1].splitlines()[0].endswith("at the end of each segment")
    assert all(len(line.split()) >= 7 for line in outputs[1].splitlines()[1:])


def test_quiet_and_verbose(spring: SpringContact, monkeypatch: pytest.MonkeyPatch) -> None:
    """Before and after the command; an option holds for one call; errors are always printed."""

    def solved(pose: object, motion: object, guess: object) -> ContactResult:
        log = logging.getLogger("wheelrail.contact")
        log.info("told")
        log.debug("detail")
        return model(pose, motion, guess)  # type: ignore[arg-type]

    model = SpringContact()
    pairs = SimpleNamespace(hertz_pair=lambda *args, **options: solved)
    monkeypatch.setitem(sys.modules, "wheelrail.contact.models.builders", pairs)

    def stderr(*arguments: str) -> str:
        outcome = CliRunner().invoke(app, arguments)
        assert outcome.exit_code == 0
        assert "10.000" in outcome.stdout
        return outcome.stderr

    scene = str(HERTZ)
    for arguments in (["contact", scene, "--quiet"], ["contact", "-q", scene], ["-q", "contact", scene]):
        assert stderr(*arguments) == ""
    normal = stderr("contact", scene)
    assert "told" in normal
    assert "detail" not in normal
    for arguments in (["contact", scene, "--verbose"], ["-v", "contact", scene]):
        assert "detail" in stderr(*arguments)
    refused = CliRunner().invoke(app, ["run", "-q", scene])
    assert (refused.exit_code, refused.stdout) == (2, "")
    assert "use wheelrail contact" in refused.stderr


def test_shell_completion() -> None:
    # the shell is named: it is detected among the parents of the process otherwise
    line = [sys.executable, "-m", "wheelrail.cli", "--show-completion", "bash"]
    named = {**os.environ, "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"}
    script = subprocess.run(line, capture_output=True, text=True, check=True, env=named).stdout
    assert "_WHEELRAIL_COMPLETE=complete_bash" in script
    words = {**os.environ, "_WHEELRAIL_COMPLETE": "complete_bash", "COMP_WORDS": "wheelrail cu", "COMP_CWORD": "1"}
    offered = subprocess.run([sys.executable, "-m", "wheelrail.cli"], capture_output=True, text=True, env=words)
    assert offered.stdout.split() == ["curving"]


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [(320.4, 2, "320"), (12345.6, 4, "12350"), (0.512, 2, "0.51"), (-0.0, 2, "0"), (3e-7, 2, "3e-07"), (7.0, 2, "7")],
)
def test_figures_have_no_exponent_above_one(value: float, digits: int, text: str) -> None:
    assert significant(value, digits) == text
    assert fixed(-1e-9, 2) == "0.00"


def test_forces_have_no_minus_before_zero(spring: SpringContact) -> None:
    assert "-0.0 " not in contact(WHEELSET).stdout
    assert not re.search(r"-0\.0+(?!\d)", contact(WHEELSET).stdout)


FEW = ("# strips = 12", "strips = 8\ncells = 10\nerror_estimate = true  # strips")
STRESSED = ("[upper] ", '[stress]\nbody = "lower"\ndepths = [1e-3, 2e-3]\n[upper] ')
SLOWER = ("surface_size = 0.5e-3", "surface_size = 1e-3")


def test_error_estimate_and_stress_on_demand(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One solve on strips on waveguide blocks, shown in two ways: requested outputs only."""
    solve, solved = solve_module.solve_contact, list[Any]()

    def once(*given: Any) -> Any:
        solved.extend([] if solved else [solve(*given)])
        return solved[0]

    monkeypatch.setattr(solve_module, "solve_contact", once)
    scene = edited(tmp_path, HERTZ, FEW, STRESSED, SLOWER)
    outcome = contact(scene, "--json", "--picture", str(tmp_path / "patch.png"))
    assert outcome.exit_code == 0, outcome.stderr
    report = json.loads(outcome.stdout)
    assert [report[key] for key in ("model", "laws", "bodies", "points")] == [
        "condensed",
        "exact",
        "waveguide",
        "lattice",
    ]
    found = report["contact"]
    assert found["statistics"]["points"] == 8 * 12  # a patch that is long has more cells
    assert set(found["error_estimate"]) == {"force", "moment", "max_pressure", "area"}
    assert 0 < found["error_estimate"]["force"] < 0.05 * 10e3
    assert 0 < found["error_estimate"]["max_pressure"] < 0.1 * found["patches"][0]["max_pressure"]
    assert set(found["stress"]) == {"lower"}
    (below,) = found["stress"]["lower"]["patches"]
    assert below["depth"] == [1e-3, 2e-3]
    assert np.array(below["stress"]).shape == (2, 3, 3)
    assert [z for _, _, z in below["position"]] == pytest.approx([-1e-3, -2e-3])
    # the axis of an elliptic contact: von Mises 0.55 to 0.62 p0 at about half the shorter semi-axis, less with depth
    mises = np.array(below["von_mises"]) / found["patches"][0]["max_pressure"]
    assert 0.55 < mises[0] < 0.68
    assert mises[1] < mises[0]
    assert below["largest"] == {"von_mises": below["von_mises"][0], "depth": 1e-3}
    assert (tmp_path / "patch.png").read_bytes().startswith(b"\x89PNG")
    text = contact(scene).stdout
    for line in (
        "exact, waveguide bodies, lattice points",
        "contact points",
        "error estimate: force",
        "von Mises stress, lower",
    ):
        assert line in text


def test_optional_outputs_are_omitted_by_default(spring: SpringContact) -> None:
    found = json.loads(contact(HERTZ, "--json").stdout)
    assert found["points"] == "lattice"
    assert not {"error_estimate", "stress"} & set(found["contact"])


def test_depths_outside_the_body_are_exit_code_2(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    from wheelrail.contact.stress.subsurface import LoadedBody

    def outside(*_: object) -> None:
        raise ValueError("place [0. -0.1] m lies outside the section")

    monkeypatch.setattr(LoadedBody, "below", outside)
    outcome = contact(edited(tmp_path, HERTZ, FEW, STRESSED, SLOWER), "--json")
    assert (outcome.exit_code, outcome.stdout) == (2, "")
    assert "stress.depths: lower: place" in outcome.stderr


def test_a_missing_c_compiler_is_one_line(tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(HERTZ.read_text(encoding="utf-8"), encoding="utf-8")
    there = {"PYTHONPATH": str(Path(__file__).parents[2]), "WHEELRAIL_CACHE": str(tmp_path / "cache")}
    there |= dict.fromkeys(("HOME", "PATH"), str(tmp_path))
    command = [sys.executable, "-m", "wheelrail.cli", "contact", str(scene)]
    done = subprocess.run(command, env=there, capture_output=True, text=True, timeout=100)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.splitlines()[-1].startswith(f"{scene}: laws need a C compiler")
    assert "Traceback" not in done.stderr


def test_unknown_figure_format_is_rejected(spring: SpringContact, tmp_path: Path) -> None:
    outcome = contact(HERTZ, "--picture", str(tmp_path / "patch.txt"))
    assert outcome.exit_code == 2
    assert "must end in .png" in outcome.stderr
    assert spring.calls == []


def test_failed_load_is_a_status_and_exit_code_1(spring: SpringContact) -> None:
    spring.deepest = 1e-6
    outcome = contact(HERTZ, "--json")
    assert outcome.exit_code == 1
    report = json.loads(outcome.stdout)
    assert report["status"].startswith("failed: contact: ")
    assert "off the mesh" in report["status"]
    assert outcome.stderr.rstrip().endswith(report["status"])


def test_failed_contact_reports_no_force(spring: SpringContact, tmp_path: Path) -> None:
    spring.deepest = 1e-6
    outcome = contact(edited(tmp_path, HERTZ, ("load = 10e3", "approach = 25e-6")), "--json")
    assert outcome.exit_code == 1
    assert set(json.loads(outcome.stdout)["contact"]) == {"status", "statistics"}


def test_unexpected_error_is_reported_as_json(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(scene: object, *_: object) -> None:
        raise MemoryError("no room for the compliance")

    monkeypatch.setattr("wheelrail.scenes.contacts.solve.solve_contact", broken)
    outcome = contact(HERTZ, "--json")
    assert outcome.exit_code == 1
    assert json.loads(outcome.stdout)["status"] == "failed: MemoryError: no room for the compliance"
    assert "Traceback" in outcome.stderr


def test_ctrl_c_during_a_contact_solve(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(scene: object, *_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("wheelrail.scenes.contacts.solve.solve_contact", interrupted)
    outcome = contact(HERTZ, "--json")
    assert (outcome.exit_code, outcome.stdout) == (130, "")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["contact", "nowhere.toml", "--json"], "nowhere.toml: cannot be read"),
        (["contact", str(SCENES / "paper_curve.toml")], "use wheelrail run"),
        (["run", str(HERTZ)], "use wheelrail contact"),
    ],
)
def test_bad_input_is_exit_code_2(arguments: list[str], says: str) -> None:
    outcome = CliRunner().invoke(app, arguments)
    assert outcome.exit_code == 2
    assert outcome.stdout == ""
    assert says in outcome.stderr
    assert "Traceback" not in outcome.stderr


def test_track_is_shown_and_drawn(tmp_path: Path) -> None:
    file = tmp_path / "track.png"
    outcome = CliRunner().invoke(app, ["track", str(SCENES / "irregular.toml"), "--picture", str(file)])
    assert outcome.exit_code == 0
    assert "bloss" in outcome.output
    assert file.stat().st_size > 20_000
    own, vehicle = tmp_path / "vehicle.png", SCENES / "manchester_vehicle.toml"
    arguments = ["track", str(SCENES / "irregular.toml"), "--picture", str(own), "--vehicle", str(vehicle)]
    assert CliRunner().invoke(app, arguments).exit_code == 0
    assert own.read_bytes() != file.read_bytes()  # irregularities begin at its front wheelset
    for arguments, says in (
        (["hertz.toml"], "for a single contact use wheelrail contact"),
        (["curve.toml", "--picture", "x.gif"], "must end"),
    ):
        refused = CliRunner().invoke(app, ["track", str(SCENES / arguments[0]), *arguments[1:]])
        assert refused.exit_code == 2
        assert says in refused.output


def test_malformed_scene_is_exit_code_2_without_traceback(tmp_path: Path) -> None:
    outcome = contact(edited(tmp_path, HERTZ, ("friction = 0.3", "friction = 3")), "--json")
    assert (outcome.exit_code, outcome.stdout) == (2, "")
    assert "friction = 3: must be a number from 0 to 2" in outcome.stderr


def test_unusable_profile_file_is_exit_code_2(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "worn.whl").write_text("this is no profile\n")
    monkeypatch.setitem(sys.modules, "wheelrail.contact.models.builders", SimpleNamespace(wheel_rail_pair=None))
    outcome = contact(edited(tmp_path, WHEELSET, ('"S1002" ', '"worn.whl" ')), "--json")
    assert (outcome.exit_code, outcome.stdout) == (2, "")
    assert "worn.whl" in outcome.stderr
    assert "Traceback" not in outcome.stderr


def test_json_contains_no_nan() -> None:
    text = json_text({"a": np.array([1.0, np.nan]), "b": (np.float64(np.inf), 2), "c": {"d": np.int64(3)}})
    assert json.loads(text) == {"a": [1.0, None], "b": [None, 2], "c": {"d": 3}}


def test_output_of_libraries_does_not_reach_standard_output() -> None:
    code = "import os; from wheelrail.support.terminal import stdout_for_results\n"
    code += "with stdout_for_results():\n    os.write(1, b'noise from C'); print('noise')\nprint('result')"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "result\n"
    assert "noise from C" in done.stderr


LOGGED = """
import logging, sys
import wheelrail
from wheelrail.support.terminal import stdout_for_results
def log():
    ours = ("wheelrail.contact.some", 20), ("wheelrail.scenes.some", 10)
    for name, level in (*ours, ("", 20), ("UFL", 30), ("other", 30), ("other", 40)):
        logging.getLogger(name).log(level, "%s at %d", name or "root", level)
log()
with stdout_for_results():
    logging.basicConfig()  # as FFCx does
    log()
print("result")
logging.getLogger("wheelrail.contact.some").warning("afterwards")
"""


def test_commands_show_messages_of_this_package_and_errors_of_libraries() -> None:
    """Outside of commands, messages of this package go nowhere until the user configures logging."""
    done = subprocess.run([sys.executable, "-c", LOGGED], capture_output=True, text=True, check=True)
    assert done.stdout == "result\n"
    before, during = ["UFL at 30", "other at 30", "other at 40"], ["wheelrail.contact.some at 20", "other at 40"]
    assert done.stderr.splitlines() == before + during


def test_messages_are_lines_above_a_progress_bar() -> None:
    console = Console(file=StringIO(), force_terminal=True, width=80)
    long = "compliance of a solid's surface in z, groups of nodes: 12 of 123, 456 s left, [bold]as written[/bold]"
    with messages_on(console), case_bar(console, 3) as done:
        done(True)
        logging.getLogger("wheelrail.contact.elasticity.solid_compliance").info(long)
        done(True)
    assert isinstance(console.file, StringIO)
    lines = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", console.file.getvalue()).replace("\r", "\n").split("\n")
    assert long in lines
    assert any(line.startswith("2/3 cases") for line in lines)
    assert not logging.getLogger("wheelrail").isEnabledFor(logging.INFO)


def test_messages_are_not_mixed_with_results(spring: SpringContact, monkeypatch: pytest.MonkeyPatch) -> None:
    solve = SpringContact.__call__

    def logged(model: SpringContact, *given: Any) -> ContactResult:
        logging.getLogger("wheelrail.contact.elasticity.solid_compliance").info("5 s left")
        return solve(model, *given)

    monkeypatch.setattr(SpringContact, "__call__", logged)
    outcome = contact(HERTZ, "--json")
    assert json.loads(outcome.stdout)["status"] == "converged"
    assert "5 s left\n" in outcome.stderr


def test_help_imports_nothing_heavy() -> None:
    code = (
        "import sys\nfrom wheelrail.cli.main import main\nsys.argv = ['wheelrail', '--help']\n"
        "try:\n    main()\nexcept SystemExit:\n    pass\nprint('LOADED', *sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    help_text, loaded = done.stdout.split("LOADED")
    heavy = {"numpy", "scipy", "pydantic", "xarray", "matplotlib", "dolfinx", "petsc4py", "mpi4py", "gmsh", "pyvista"}
    assert heavy & set(loaded.split()) == set()
    assert "contact" in help_text
    assert "run" in help_text


RUN = textwrap.dedent(
    """
    import os, signal, sys
    from dataclasses import replace
    import wheelrail.scenes.runs.run
    from spring_contact import patch
    from standin_contact import MOUNTING, SmoothContact
    from wheelrail.contact.models.wheelset import WheelsetContact

    stop_after = int(sys.argv.pop(1))

    class Contact(SmoothContact):
        calls = 0

        def __call__(self, pose, motion, guess=None):
            Contact.calls += 1
            if Contact.calls == stop_after:
                os.kill(os.getpid(), signal.SIGINT)
            result = super().__call__(pose, motion, guess)
            return replace(result, patches=(patch(float(result.force[2]), result.force),) * result.ok)

    wheelrail.scenes.runs.run.run_contact = lambda scene, names: (WheelsetContact(Contact(), MOUNTING), None)
    from wheelrail.cli.main import main
    main()
    """
)


def run(tmp_path: Path, *, stop_after: int) -> subprocess.CompletedProcess[str]:
    """The command `wheelrail run` on a short curve and a smooth spring, with a Ctrl-C at one of the contact solves."""
    scene = edited(
        tmp_path,
        SCENES / "paper_curve.toml",
        ("tangent = 50.0", "tangent = 2.0"),
        ("transition_length = 100.0", "transition_length = 7.0"),
        ("curve = 200.0", "curve = 1.0"),
    )
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(SCENES.parent / "tests/helpers"), str(SCENES.parent)]),
    }
    command = [sys.executable, "-c", RUN, str(stop_after), "run", str(scene), "--out", str(tmp_path / "out")]
    return subprocess.run(command, capture_output=True, text=True, env=environment, check=False)


@pytest.mark.parametrize(("stop_after", "code", "status"), [(0, 0, "completed"), (400, 130, "interrupted")])
def test_interrupted_run_stores_all_results(tmp_path: Path, stop_after: int, code: int, status: str) -> None:
    import xarray

    done = run(tmp_path, stop_after=stop_after)
    assert done.returncode == code, done.stderr
    with xarray.open_dataset(tmp_path / "out" / "run.nc") as data:
        assert data.attrs["status"] == status
        assert data.attrs["scene"].startswith("# The curve of the paper")
        end = float(data["distance"][-1])
        assert end == pytest.approx(10.0) if status == "completed" else 0.5 < end < 10.0
        solves = data["contact_solves"].values
        assert (data.sizes["time"], int(data.attrs["steps_accepted"])) == (len(data["time"]), data.sizes["time"] - 1)
    assert f"{status} at {end:.1f} m" in done.stdout
    for name in ("run.nc", "lateral_displacement.png", "lateral_force.png", "vertical_force.png"):
        assert (tmp_path / "out" / name).stat().st_size > 0
        assert str(tmp_path / "out" / name) in done.stdout
    assert str(solves[0]) in done.stdout
    assert "m, " in done.stderr  # the progress


def test_ctrl_c_before_the_first_step_writes_nothing(tmp_path: Path) -> None:
    done = run(tmp_path, stop_after=3)
    assert done.returncode == 128 + signal.SIGINT
    assert "interrupted before the first step" in done.stdout
    assert not list((tmp_path / "out").iterdir())


def test_exception_in_a_contact_is_a_failure(spring: SpringContact, monkeypatch: pytest.MonkeyPatch) -> None:
    nan = ContactResult(np.full(3, np.nan), np.zeros(3), approach=1e-5, status="converged")
    monkeypatch.setattr(SpringContact, "__call__", lambda self, pose, motion, guess: nan)
    outcome = contact(HERTZ, "--json")
    assert outcome.exit_code == 1
    assert json.loads(outcome.stdout)["status"].startswith("failed")
