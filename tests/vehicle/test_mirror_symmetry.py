"""A right-hand curve is bitwise the mirror image of the left-hand one, for every contact and integrator."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import inf

import numpy as np
import pytest
from linear_creep import LinearCreep
from plane import mirror_signs
from small_strips import few_strips
from standard_pair import wheel_on_rail
from standin_contact import CONTACT

from wheelrail.contact.kinematics.frames import MIRROR
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
from wheelrail.vehicle.multibody.vehicle import Vehicle
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon


def into_a_curve(contact: object, curvature: float, method: str, end: float) -> History:
    track = Track.curve(curvature=curvature, cant=0.06, transition=15.0, length=50.0)
    dynamics = wagon_dynamics(Wagon(), track, contact, 45.0)  # type: ignore[arg-type]
    return simulate(dynamics, (0.0, end), steps=StepSettings(method, 3e-3, 3e-6))


@pytest.mark.parametrize(
    ("contact", "method", "end"),
    [
        (lambda: CONTACT, "ode45", 0.1),
        (lambda: CONTACT, "rosenbrock", 0.4),
        (wheel_on_rail, "rosenbrock", 0.4),
        (lambda: wheel_on_rail(normal="hertz", tangential="polach"), "rosenbrock", 0.3),
        (few_strips, "rosenbrock", 0.25),
    ],
    ids=["explicit", "implicit by differences", "standard", "hertz and polach", "strips"],
)
def test_mirror_image(contact: Callable[[], object], method: str, end: float) -> None:
    left, right = (into_a_curve(contact(), curvature, method, end) for curvature in (1 / 600, -1 / 600))
    assert left.status == right.status == "completed"
    np.testing.assert_array_equal(right.time, left.time)
    np.testing.assert_array_equal(right.state, mirror_signs(left.dynamics.coordinates) * left.state)
    np.testing.assert_array_equal(right.force[:, 0], MIRROR * left.force[:, 0, ::-1])
    np.testing.assert_array_equal(right.moment[:, 0], -MIRROR * left.moment[:, 0, ::-1])
    assert np.abs(left.state[-1, 6]) > 1e-4  # m: effect of the curve


def with_series_springs(vehicle: Vehicle, stiffness: float) -> Vehicle:
    """A vehicle with springs in series with all dampers."""
    elements = {
        name: replace(element, series_stiffness=tuple(stiffness if c else inf for c in element.damping))
        for name, element in vehicle.elements.items()
    }
    return replace(vehicle, elements=elements)


@pytest.mark.parametrize("series_stiffness", [inf, 6e6], ids=["rigid", "series springs"])
@pytest.mark.parametrize("contact", [LinearCreep, wheel_on_rail], ids=["linear", "standard"])
def test_mirror_image_of_a_vehicle_in_three_dimensions(
    contact: Callable[[], VehicleContact], series_stiffness: float
) -> None:
    """Equilibrium on the tangent, then a transition; y, roll and yaw of all bodies change their signs."""
    vehicle, histories = with_series_springs(load_vehicle(), series_stiffness), []
    for curvature in (1 / 600, -1 / 600):
        track = Track.curve(curvature=curvature, cant=0.06, transition=15.0, length=50.0)
        dynamics = VehicleDynamics(vehicle, track, contact(), 45.0)
        histories.append(simulate(dynamics, (0.0, 0.1)))
    left, right = histories
    assert left.status == right.status == "completed"
    np.testing.assert_array_equal(right.time, left.time)
    np.testing.assert_array_equal(right.state, mirror_signs(left.dynamics.coordinates) * left.state)
    assert np.array_equal(left.series.shape[1] > 0, series_stiffness < inf)
    assert np.abs(left.state[-1, 6 + 1]) > 1e-5  # m: effect of the transition on the front bogie
