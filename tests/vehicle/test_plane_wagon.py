"""The plane wagon as a layout of the general vehicle."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from linear_creep import LinearCreep
from standin_contact import CONTACT

from wheelrail.scenes.schema.scene import RunScene, load_scene
from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.equations import Dynamics, Wrench
from wheelrail.vehicle.dynamics.state import graded
from wheelrail.vehicle.integration.integrate import StepSettings, integrate
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.equations import VehicleDynamics, VehicleEvaluation
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian, VehicleLinearisation
from wheelrail.vehicle.multibody.modes import vehicle_modes
from wheelrail.vehicle.multibody.plane_wagon import plane_vehicle
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.steady.modes import modes
from wheelrail.vehicle.track.alignment import Segment
from wheelrail.vehicle.track.speed_profile import SpeedProfile
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.force_law import ForceLaw
from wheelrail.vehicle.wagon.wagon import PRIMARY, SECONDARY, Wagon

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


def both(wagon: Wagon, track: Track, contact, speed) -> tuple[Dynamics, VehicleDynamics]:  # type: ignore[no-untyped-def]
    return Dynamics(wagon, track, contact, speed), VehicleDynamics(plane_vehicle(wagon), track, contact, speed)


def outwards(vehicle: VehicleDynamics) -> Array:
    """Signs of a state in the plane wagon's order, whose lateral Maxwell elements count outwards."""
    right = [name.startswith("right") for name in vehicle.vehicle.elements]
    signs = [-1.0 if right[e] and j == 1 else 1.0 for e, j in vehicle.coordinates.maxwell]
    return np.concatenate([np.ones(20), signs])


@pytest.mark.parametrize("name", WAGONS)
def test_accelerations(name: str) -> None:
    """Through transitions of curvature, cant and gradient while the speed changes."""
    arc = Segment("arc", 200.0, 1 / 300, 0.1, gradient=0.01, vertical_radius=2000.0)
    track = Track.of([Segment("tangent", 5.0, gradient=0.0), Segment("transition", 60.0), arc])
    wagon, vehicle = both(WAGONS[name], track, LinearCreep(), SpeedProfile.through((0.0, 2.0), (10.0, 30.0)))
    random, sign = np.random.default_rng(5), outwards(vehicle)
    scale = np.concatenate([np.full(10, 1e-2), np.full(10, 0.1), np.full(wagon.size - 20, 1e-3)])
    for time in (0.3, 1.0, 1.8):
        state, wrench = scale * random.normal(size=wagon.size), 1e4 * random.normal(size=6)
        expected, yaw = wagon.accelerations(wagon.frame(time), state, Wrench(wrench[:3], wrench[3:]))
        actual, reactions = vehicle.accelerations(time, sign * state, wrench[None])
        np.testing.assert_allclose(sign[10:] * actual, expected, rtol=0.0, atol=1e-13 * np.abs(expected).max())
        assert reactions[2, 5] / np.cos(state[8]) == pytest.approx(float(yaw.item()), rel=1e-12)
        np.testing.assert_allclose(
            sign * vehicle(time, sign * state).rate, wagon(time, state).rate, rtol=0.0, atol=1e-11
        )


def test_states_in_a_curve() -> None:
    """The curve of the paper by one Jacobian, which is a parameter of the method."""
    scene = load_scene("scenes/curve.toml")
    assert isinstance(scene, RunScene)
    wagon, vehicle = both(Wagon(), scene.track.track(), CONTACT, 45.0)
    settings = StepSettings("rosenbrock", 3e-3, graded(3e-6))
    start, ends = equilibrium(wagon).state, []
    exact = VehicleJacobian(vehicle, StepStatistics())

    def jacobian(time: float, state: Array, at: Any) -> VehicleLinearisation:
        contacts = at.contacts if "wheelset" in at.contacts else {"wheelset": at.contacts}
        return exact(time, state, VehicleEvaluation(at.rate, contacts))

    for dynamics in (wagon, vehicle):
        exact.differences = None
        steps = integrate(dynamics, 0.0, start, 10.0, settings, jacobian=jacobian)
        ends.append(np.array([np.append(step.t, step.x) for step in steps]))
    expected, actual = ends
    assert np.abs(actual - expected)[:, 1:].max() < 1e-9


def test_modes() -> None:
    wagon, vehicle = both(Wagon(), Track(), CONTACT, 45.0)
    expected, actual = modes(wagon), vehicle_modes(vehicle)
    assert [mode.eigenvalue for mode in actual] == pytest.approx([mode.eigenvalue for mode in expected], rel=1e-8)
