"""Manchester benchmark vehicle 1 on S1002 wheels and 60E1 rails by the standard contact.

Reference figures of the curve are those of a program written before this one, with the contact in another program text:
the same vehicle in a single compiled function, absolute positions by a table of the centre line. It agreed with Exudyn,
too. Its patches have their centre at the deepest point and a paraboloid as bound, and slide along elastic displacements
over flexibilities, which takes power: ALLOWED is for this difference.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from wheelrail.contact.geometry.rigid_surfaces import RigidWheelRail
from wheelrail.contact.kinematics.wheelset_state import Mounting
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.standard.model import StandardContact
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.coordinates import Y
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.wheel_forces import WheelsetForces, wheelset_forces
from wheelrail.vehicle.simulation.limit_cycle import CycleSearch
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.steady.critical_speed import critical_speed, least_damped
from wheelrail.vehicle.steady.equilibrium import Equilibrium, equilibrium
from wheelrail.vehicle.steady.modes import modes
from wheelrail.vehicle.track.constant_curve import ConstantCurve
from wheelrail.vehicle.track.irregularity import Irregularities
from wheelrail.vehicle.track.irregularity_spectrum import ERRI
from wheelrail.vehicle.track.track import Track

CURVE = ConstantCurve(speed=25.0, curvature=1 / 600, cant=0.1)


def dynamics(speed: float, *, track: Track | None = None, friction: float = 0.3) -> VehicleDynamics:
    wheel, rail = named_profile("S1002"), named_profile("60E1").inclined(0.025)
    model = StandardContact(RigidWheelRail(wheel, rail, 0.46), ContactLaws(friction=friction))
    contact = WheelsetContact(model, Mounting(0.75, rail.gauge_offset(1.435, 0.014), 0.46))
    return VehicleDynamics(load_vehicle(), track or Track(), contact, speed)


@cache
def in_curve(way: float) -> tuple[Equilibrium, list[WheelsetForces]]:
    curve = ConstantCurve(CURVE.speed, way * CURVE.curvature, CURVE.cant)
    solution = equilibrium(dynamics(CURVE.speed, track=curve.track))
    return solution, list(wheelset_forces(solution.dynamics, solution.state, solution.contacts).values())


def test_wheel_loads_on_straight_track() -> None:
    """Equal within the pitch moments of rolling resistance and the force that keeps the speed."""
    solution = equilibrium(dynamics(30.0))
    assert solution.residual < 1e-7
    wheelsets = wheelset_forces(solution.dynamics, solution.state, solution.contacts).values()
    loads = np.array([[w.left.vertical, w.right.vertical] for w in wheelsets])
    assert loads == pytest.approx(54546.0525, abs=1.0)
    assert loads.sum() == pytest.approx(436368.42, abs=0.01)
    positions = solution.state[:42].reshape(7, 6)
    assert 1e3 * positions[3:, 2] == pytest.approx(-0.2279, abs=2e-4)


def test_wheelsets_enter_irregular_rails_one_after_another() -> None:
    """At first the front wheelset alone is on irregular rails."""
    samples = ERRI["low"].irregularities(60.0, seed=1)
    front = load_vehicle().bodies["wheelset_1"].x
    track = Track(irregularities=Irregularities.faded(samples.stations, samples.values, start=front))
    history = simulate(dynamics(30.0, track=track), (0.0, 0.08), steps=StepSettings("rosenbrock", 3e-3, 3e-5))
    assert history.status == "completed"
    changes = np.ptp(history.force[:, :, 0, 2], axis=0)
    assert changes[0] > 100.0
    assert changes[2:].max() < 0.1 * changes[0]


@pytest.mark.parametrize(("friction", "speed", "frequency"), [(0.3, 70.67, 5.980), (0.4, 68.08, 6.063)])
def test_critical_speed(friction: float, speed: float, frequency: float) -> None:
    found = critical_speed(dynamics(speed, friction=friction), (64.0, 74.0))
    assert found is not None
    assert found.speed == pytest.approx(speed, abs=0.05)
    assert found.mode.frequency == pytest.approx(frequency, abs=0.01)
    lateral = [n.endswith(("_y", "_yaw")) for n in found.mode.names]
    assert found.mode.energy_fraction[lateral].sum() > 0.9


# y mm, yaw mrad; Q, Y kN left and right; longitudinal force kN left and right; T gamma N left and right
TABLE = [
    [-6.020, -3.585, 47.22, 62.44, 9.75, 12.91, -10.68, 10.47, 72.4, 111.1],
    [-1.358, 0.294, 48.56, 61.04, -2.07, 3.39, 5.44, -5.44, 4.1, 4.7],
    [-5.864, -3.326, 48.33, 61.29, 10.35, 10.21, -10.55, 10.36, 66.0, 101.7],
    [-1.036, 0.530, 47.69, 61.91, -3.56, 5.09, 6.47, -6.47, 7.2, 7.5],
]
ALLOWED = [0.04, 0.025, 0.03, 0.03, 0.05, 0.06, 0.09, 0.09, 3.2, 2.2]


def row(w: WheelsetForces) -> list[float]:
    wheels = (w.left, w.right)
    forces = [1e-3 * f for f in (*(x.vertical for x in wheels), *(x.guiding for x in wheels))]
    return [1e3 * w.y, 1e3 * w.yaw, *forces, *(1e-3 * x.longitudinal for x in wheels), *(x.wear_number for x in wheels)]


def test_steady_curve_of_600_m() -> None:
    solution, wheelsets = in_curve(1.0)
    assert solution.residual < 1e-7
    for w, expected in zip(wheelsets, TABLE, strict=True):
        assert (np.abs(np.array(row(w)) - expected) < ALLOWED).all(), (row(w), expected)
    position = solution.state[:42].reshape(7, 6)
    assert 1e3 * position[0, 1] == pytest.approx(45.17, abs=0.02)
    assert 1e3 * position[0, 3] == pytest.approx(6.111, abs=0.005)
    assert 1e3 * position[1:3, 1] == pytest.approx([-3.140, -2.896], abs=0.03)
    assert 1e3 * position[1:3, 5] == pytest.approx([-1.705, -1.443], abs=0.022)


def test_lateral_forces_in_the_curve_carry_the_unbalanced_acceleration() -> None:
    solution, wheelsets = in_curve(1.0)
    mass = solution.dynamics.vehicle.weight / 9.81
    total = sum(w.left.guiding - w.right.guiding for w in wheelsets)
    assert total == pytest.approx(-mass * CURVE.unbalanced(), rel=1e-3)


def test_a_right_hand_curve_is_the_mirror_image() -> None:
    (left, left_forces), (right, right_forces) = in_curve(1.0), in_curve(-1.0)
    mirror = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
    np.testing.assert_allclose(right.state[:42].reshape(7, 6), mirror * left.state[:42].reshape(7, 6), atol=1e-9)
    for a, b in zip(left_forces, right_forces, strict=True):
        assert a.left.guiding == pytest.approx(b.right.guiding, abs=1.0)
        assert a.right.vertical == pytest.approx(b.left.vertical, abs=1.0)


def test_a_small_motion_grows_as_its_mode_in_the_steps_of_a_search() -> None:
    """20 µm, twice the absolute tolerance, 1.8 m/s above the linear critical speed: the mode grows by 0.43 1/s."""
    model = dynamics(72.5)
    coordinates, at = model.coordinates, equilibrium(model)
    mode = least_damped(modes(model, at))
    places = [coordinates.index(f"wheelset_{i}", Y) for i in (1, 2, 3, 4)]
    shape = 20e-6 * mode.shape / np.abs(mode.shape[places]).max()
    initial, count = at.state.copy(), coordinates.count
    initial[:count] += shape.real
    initial[count : 2 * count] += (mode.eigenvalue * shape).real
    run = simulate(model, (0.0, 1.0), initial=initial, steps=CycleSearch().steps(mode))
    lateral = np.array([[run.state[i, places], run.state[i, count + np.array(places)]] for i in (0, -1)])
    size = [np.hypot(y, rate / mode.eigenvalue.imag).max() for y, rate in lateral]
    assert np.log(size[1] / size[0]) == pytest.approx(mode.eigenvalue.real, abs=0.04)
