"""Vehicle files, and the commands that use them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from wheelrail.cli.main import app
from wheelrail.scenes.builders.vehicle_file import MANCHESTER, load_vehicle
from wheelrail.scenes.runs.steady import critical_speed_results
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.vehicle.multibody.elements import SuspensionElement
from wheelrail.vehicle.steady.critical_speed import CriticalSpeed
from wheelrail.vehicle.steady.modes import Mode
from wheelrail.vehicle.wagon.wagon import BOGIE, BUMPSTOP, CAR_BODY, PRIMARY, SECONDARY, WHEELSET

SCENE = Path(__file__).parents[2] / "scenes" / "vehicle.toml"
TEXT = MANCHESTER.read_text(encoding="utf-8")

TWO_AXLES = """
bodies.frame = { mass = 20e3, inertia = [3e4, 4e5, 4e5], x = 0.0, height = 1.2 }
bodies.front = { type = "axle", x = 4.0 }
bodies.rear = { type = "axle", x = -4.0 }
body_types.axle = { mass = 1500.0, inertia = [900.0, 100.0, 900.0], height = 0.46, wheelset = true }
element_types.box = { upper = "frame", stiffness = [1e7, 4e6, [[-0.1, -1e5], [0.0, 0.0], [0.1, 2e5]]], turn = 1.0 }
elements.front = { type = "box", lower = "front", points = [[4.0, 1.0, 0.46], [4.0, -1.0, 0.46]] }
elements.rear = { type = "box", lower = "rear", points = [[-4.0, 1.0, 0.46], [-4.0, -1.0, 0.46]] }
elements.damper = { upper = "frame", lower = "rear", points = [[-4.0, 0.0, 0.46]], damping = [0.0, 2e4, 0.0], \
series_stiffness = [inf, 5e6, inf] }
"""


def test_the_benchmark_vehicle_has_the_data_of_the_wagon() -> None:
    """The same masses, inertias, heights, springs, dampers and bumpstop as the plane model's whole vehicle."""
    vehicle = load_vehicle()
    for name, body in (("car_body", CAR_BODY), ("rear_bogie", BOGIE), ("wheelset_3", WHEELSET)):
        own = vehicle.bodies[name]
        assert (own.mass, own.height) == (body.mass, body.height)
        assert own.inertia == (body.roll_inertia, body.pitch_inertia, body.yaw_inertia)
    for name, stage in (("primary_4_2", PRIMARY), ("front_secondary_1", SECONDARY)):
        element = vehicle.elements[name]
        assert element.stiffness[1:] == (stage.lateral_stiffness, stage.vertical_stiffness)
        assert element.damping[1:] == (stage.lateral_damping, stage.vertical_damping)
        assert (abs(element.point[1]), element.point[2]) == (stage.spring_y, stage.spring_height)
    assert vehicle.elements["rear_bumpstop"].stiffness == (0.0, BUMPSTOP, 0.0)
    assert vehicle.weight == pytest.approx(436368.42)
    assert len(vehicle.elements) == 16


def test_another_vehicle(tmp_path: Path) -> None:
    file = tmp_path / "two_axles.toml"
    file.write_text(TWO_AXLES, encoding="utf-8")
    vehicle = load_vehicle(file)
    assert vehicle.wheelsets == ("front", "rear")
    damper = vehicle.elements["damper"]
    assert isinstance(damper, SuspensionElement)
    assert damper.series_stiffness[1] == 5e6
    assert vehicle.speed_hold is None


def replaced(old: str, new: str) -> Callable[[str], str]:
    return lambda text: text.replace(old, new, 1)


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (replaced("mass = 32000.0", "mass = -1.0"), "bodies.car_body.mass = -1.0: must be a number from 1 to 1e+06 kg"),
        (
            replaced('type = "bogie", x = 9.5', 'type = "bogy", x = 9.5'),
            "bodies.front_bogie.type = 'bogy': must be one",
        ),
        (
            replaced('lower = "wheelset_1"', 'lower = "wheelset_9"'),
            'elements.primary_1_1.lower: missing: no body "wheel',
        ),
        (replaced("turn = 1.0", "turn = 2.0"), "elements.primary_1.turn = 2.0: must be a number from 0 to 1"),
        (replaced('body = "car_body"', 'body = "engine"'), 'speed_hold.body = "engine": must be one of car_body'),
        (replaced("[0.025, 0.0]", "[0.025, -5.0]"), "elements.front_bumpstop.stiffness = "),
        (replaced("damping = [0.0, 32e3, 20e3]", "dampings = [0.0]"), "unknown key; did you mean elements.front_secon"),
        (
            lambda text: text.replace("9.5, -1.0, 0.8275", "9.5, 1.0, 0.8275"),
            "bodies.car_body: must be carried by vert",
        ),
        (replaced("x = 0.0\n", 'x = 0.0\nheld = ["y", "sway"]\n'), "bodies.car_body.held"),
        (lambda text: "[bodies]", "elements: missing"),
        (replaced("x = 0.0\n", 'x = 0.0\nheld = ["x", "x"]\n'), 'held = ["x", "x"]: must name each coordinate once'),
        (
            replaced("[56800.0, 1.97e6, 1.97e6]", "[56800.0, 9.97e6, 1.97e6]"),
            "none of the three greater than the sum of the other two",
        ),
        (
            lambda text: text.replace("31.391e6, 3.884e6, 1.220e6", "31.391e6, 0.0, 1.220e6"),
            "_bogie: must be held laterally by a spring, or y be one of held",
        ),
        (
            lambda text: text.replace("31.391e6,", "0.0,"),
            ": must be held along the track by a spring, or x be one of held",
        ),
    ],
)
def test_what_is_wrong_is_named(edit: Callable[[str], str], message: str, tmp_path: Path) -> None:
    file = tmp_path / "vehicle.toml"
    assert edit(TEXT) != TEXT
    file.write_text(edit(TEXT), encoding="utf-8")
    with pytest.raises(SceneError) as error:
        load_vehicle(file)
    assert str(error.value).startswith(str(file))
    assert message in str(error.value)


def wheelrail(*arguments: str) -> str:
    outcome = CliRunner().invoke(app, [*arguments[:1], str(SCENE), "--vehicle", str(MANCHESTER), *arguments[1:]])
    assert outcome.exit_code == 0, outcome.stderr
    return outcome.stdout


def test_commands() -> None:
    curving = wheelrail("curving")
    assert "wheelset_4" in curving
    assert "47.20  62.46" in curving
    assert "70.67 m/s" in wheelrail("critical", "--from", "66", "--to", "74")
    assert "no linear critical speed from 40 m/s to 45 m/s" in wheelrail("critical", "--from", "40", "--to", "45")
    assert "54.55  54.55" in wheelrail("equilibrium", "--speed", "30")
    assert "Linear modes on straight track at 30 m/s" in wheelrail("modes", "--speed", "30")


def test_critical_speed_on_strips_is_a_mean_over_their_places(tmp_path: Path) -> None:
    """Two places of few strips on half-spaces, and text for given values."""
    scene = tmp_path / "strips.toml"
    few = {"strips = 8 ": 'bodies = "half-space"\nstrips = 6 ', "cells = 10 ": "cells = 6 "}
    text = SCENE.with_name("vehicle_elastic.toml").read_text(encoding="utf-8")
    for old, new in few.items():
        assert old in text
        text = text.replace(old, new)
    scene.write_text(text, encoding="utf-8")
    options = ["--vehicle", str(MANCHESTER), "--from", "60", "--to", "110", "--places", "2"]
    outcome = CliRunner().invoke(app, ["critical", str(scene), *options])
    assert outcome.exit_code == 0, outcome.stderr
    assert "mean of 2 places of the strips" in outcome.stdout
    mode = Mode(complex(0.0, 35.0), np.ones(1, dtype=complex), np.ones(1), ("wheelset_y",))
    found = [CriticalSpeed(speed, mode) for speed in (81.0, 82.0, 84.0)]
    (text,) = critical_speed_results(found, (60.0, 110.0)).parts
    assert str(text).splitlines()[0] == (
        "linear critical speed: 82.33 ± 0.88 m/s (296.4 km/h), mean of 3 places of the strips (81.00 to 84.00 m/s)"
    )
    some = critical_speed_results([*found, None], (60.0, 110.0))
    assert "at 1 of 4 places of the strips" in str(some.parts[0])
    assert (some.report["critical_speeds"], some.report["critical_speed"]) == ([81.0, 82.0, 84.0, None], None)


def test_commands_on_cooperriders_bogie(tmp_path: Path) -> None:
    scene, vehicle = SCENE.with_name("cooperrider.toml"), SCENE.with_name("cooperrider_bogie.toml")

    def stdout(command: str, *options: str) -> str:
        outcome = CliRunner().invoke(app, [command, str(scene), "--vehicle", str(vehicle), *options])
        assert outcome.exit_code == 0, outcome.stderr
        return outcome.stdout

    assert "66.60  66.60  66.60  66.60" in stdout("equilibrium")
    assert "linear critical speed: 33.37 m/s" in stdout("critical", "--from", "20", "--to", "40")
    assert "wheelset_2" in stdout("curving")
    assert "completed at 300.0 m" in stdout("run", "--out", str(tmp_path))


def test_invalid_arguments_of_commands(tmp_path: Path) -> None:
    swapped = ["critical", str(SCENE), "--vehicle", str(MANCHESTER), "--from", "50", "--to", "40"]
    outcome = CliRunner().invoke(app, swapped)
    assert (outcome.exit_code, outcome.stderr) == (2, "--from 50: must be less than --to 40\n")
    file = tmp_path / "small.toml"
    file.write_text(TEXT.replace("height = 0.46 ", "height = 0.42 "), encoding="utf-8")
    outcome = CliRunner().invoke(app, ["equilibrium", str(SCENE), "--vehicle", str(file)])
    assert outcome.exit_code == 2
    assert "bodies.wheelset_1.height = 0.42: must be 0.46 m, wheelset.radius of the scene" in outcome.stderr
