"""The plane wagon as a layout of the general vehicle: as its own program was, on stand-in contacts."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from linear_creep import LinearCreep
from standin_contact import CONTACT

from wheelrail.scenes.schema.scene import RunScene, load_scene
from wheelrail.vehicle.integration.integrate import StepSettings, integrate
from wheelrail.vehicle.integration.rosenbrock import ROS3PL, ROS34PW2
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian
from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.steady.modes import modes
from wheelrail.vehicle.track.alignment import Segment
from wheelrail.vehicle.track.speed_profile import SpeedProfile
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.force_law import ForceLaw
from wheelrail.vehicle.wagon.wagon import PRIMARY, SECONDARY, Wagon

HERE = Path(__file__).parent
CURVE = HERE.parents[1] / "scenes" / "curve.toml"
# Of the program that the plane wagon was, with its own equations of motion.
REFERENCE = json.loads((HERE / "plane_wagon_reference.json").read_text(encoding="utf-8"))
UNEVEN = ForceLaw(((-0.03, -9e3), (-0.01, -4e3), (0.0, 0.0), (0.01, 3e3), (0.02, 4e3)))
WAGONS = {
    "as it is": Wagon(),
    "laws": replace(Wagon(), secondary=replace(SECONDARY, turn=0.5, lateral_stiffness=UNEVEN)),
    "Maxwell elements": replace(
        Wagon(),
        primary=replace(PRIMARY, lateral_series_stiffness=7e6, vertical_series_stiffness=1e6),
        secondary=replace(SECONDARY, lateral_series_stiffness=6e6),
    ),
}


@pytest.mark.parametrize("name", WAGONS)
def test_accelerations(name: str) -> None:
    """At random states, through transitions of curvature, cant and gradient while the speed changes."""
    arc = Segment("arc", 200.0, 1 / 300, 0.1, gradient=0.01, vertical_radius=2000.0)
    track = Track.of([Segment("tangent", 5.0, gradient=0.0), Segment("transition", 60.0), arc])
    dynamics = wagon_dynamics(WAGONS[name], track, LinearCreep(), SpeedProfile.through((0.0, 2.0), (10.0, 30.0)))
    for sample in REFERENCE["accelerations"][name]:
        time, state, wrench = sample["time"], np.array(sample["state"]), np.array(sample["wrench"])
        expected, c = np.array(sample["accelerations"]), dynamics.coordinates.count
        state[2 * c :] = dynamics.coordinates.from_series @ state[2 * c :]  # the reference has left, then right springs
        found, _ = dynamics.accelerations(time, state, wrench[None])
        found[c:] = dynamics.coordinates.series @ found[c:]
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-13 * np.abs(expected).max())
        (yaw,) = dynamics.yaw_reactions(time, state, wrench[None])
        assert yaw == pytest.approx(sample["yaw_reaction"], rel=1e-12)


def test_states_in_the_curve_of_the_paper(monkeypatch: pytest.MonkeyPatch) -> None:
    """All steps of a run of 10 s, by the same Jacobian, which is a parameter of the method.

    The reference chose its steps by the difference to the companion as it is.
    """
    for method in (ROS3PL, ROS34PW2):
        monkeypatch.setitem(vars(method), "stiffly_accurate", False)
    scene, expected = load_scene(CURVE), REFERENCE["run"]
    assert isinstance(scene, RunScene)
    dynamics = wagon_dynamics(Wagon(), scene.track.track(), CONTACT, 45.0)
    np.testing.assert_allclose(equilibrium(dynamics).state, expected["start"], rtol=0.0, atol=1e-8)
    settings = StepSettings("rosenbrock", 3e-3, dynamics.tolerances(3e-6))
    jacobian = VehicleJacobian(dynamics, StepStatistics())
    steps = list(integrate(dynamics, 0.0, np.array(expected["start"]), 10.0, settings, jacobian=jacobian))
    assert len(steps) == expected["steps"]
    for number, state in expected["states"].items():
        np.testing.assert_allclose(steps[int(number)].x, state, rtol=0.0, atol=1e-9)


def test_modes() -> None:
    found = [mode.eigenvalue for mode in modes(wagon_dynamics(Wagon(), Track(), CONTACT, 45.0))]
    assert found == pytest.approx([complex(*value) for value in REFERENCE["modes"]], rel=1e-8)
