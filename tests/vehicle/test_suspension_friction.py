"""Coulomb friction in series with a spring: closed forms, a loop of hysteresis, another integrator, limit cases."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from linear_creep import LinearCreep
from plane import mirror_signs
from scipy.integrate import solve_ivp
from sliding_mass import MASS, on_a_slider
from standin_contact import CONTACT

from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.loads import LoadTable
from wheelrail.vehicle.multibody.elements import InvalidVehicle
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
from wheelrail.vehicle.multibody.vehicle import Vehicle
from wheelrail.vehicle.simulation.checkpoint import Checkpoint, Checkpoints
from wheelrail.vehicle.simulation.energy_balance import energy_balance
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.simulation.time_run import Recording
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.steady.modes import held_wheelset_modes, modes
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon


def run(dynamics: VehicleDynamics, end: float, position: float = 0.0, rate: float = 0.0, rtol: float = 1e-3) -> History:
    initial = np.zeros(dynamics.size)
    initial[:2] = position, rate
    return simulate(dynamics, (0.0, end), initial=initial, steps=StepSettings("rosenbrock", rtol, 1e-3 * rtol))


DRAWN = np.random.default_rng(44).uniform(size=(4, 4))


@pytest.mark.parametrize("drawn", DRAWN, ids=str)
@pytest.mark.parametrize("direction", [0, 1, 2], ids="xyz")
def test_a_mass_slides_to_rest_where_friction_has_taken_its_energy(direction: int, drawn: Array) -> None:
    """Slip: kinetic energy less that of the spring at its limit, over the force; then it vibrates on the spring."""
    mass, limit = 500.0 + 2e3 * drawn[0], 1e3 + 4e3 * drawn[1]
    stiffness, speed = 1e6 + 9e6 * drawn[2], 0.8 + 0.7 * drawn[3]
    rigid = {"friction": limit, "friction_stiffness": stiffness, "stiffness": 1e-9 if direction == 2 else 0.0}
    dynamics = on_a_slider(direction=direction, mass=mass, **rigid)
    if direction == 2:  # no weight, for the same closed form
        dynamics = replace(dynamics, vehicle=replace(dynamics.vehicle, gravity=1e-12))
    found = run(dynamics, 2.5 * mass * speed / limit, rate=speed)
    assert found.status == "completed"
    slip = (0.5 * mass * speed**2 - 0.5 * limit**2 / stiffness) / limit
    np.testing.assert_allclose(found.series[-1], [slip], rtol=2e-3)
    assert np.abs(found.state[-1, 0] - found.series[-1, 0]) < limit / stiffness * 1.001
    assert found.cost.steps.accepted < 250
    balance = energy_balance(found)
    assert balance.work[-1, balance.causes.index("friction")] == pytest.approx(-limit * found.series[-1, 0], rel=1e-12)


@pytest.mark.parametrize("drawn", DRAWN, ids=str)
def test_a_closed_loop_dissipates_its_area(drawn: Array) -> None:
    """4 F (A - F / k) a cycle of amplitude A, on steps of any length that do not meet the turning points."""
    limit, stiffness = 1e3 + 4e3 * drawn[0], 1e6 + 9e6 * drawn[1]
    amplitude = limit / stiffness * (1.5 + 3 * drawn[2])
    dynamics = on_a_slider(friction=limit, friction_stiffness=stiffness)
    steps = 4 * (4 + int(4 * drawn[3])) + 1  # a cycle
    times, state = np.linspace(0.0, 3.0, 3 * steps + 1), np.zeros(3)
    forces, positions, slips = [0.0], [0.0], [0.0]
    for t0, t in pairwise(times.tolist()):
        end = np.array([amplitude * np.sin(2 * np.pi * t), 2 * np.pi * amplitude * np.cos(2 * np.pi * t), state[2]])
        assert dynamics.settle is not None
        end, _ = dynamics.settle(t0, state, t, end)
        slips.append(slips[-1] + abs(end[2] - state[2]))
        state = end
        forces.append(-float(dynamics.bodies.element_states([dynamics.speed_profile(t)], state[None])[1][0, 0, 1]))
        positions.append(state[0])
    slip = slips[-1] - slips[steps]
    assert limit * slip == pytest.approx(2 * 4 * limit * (amplitude - limit / stiffness), rel=5e-4)
    assert np.max(forces) == pytest.approx(limit, rel=1e-9)
    assert np.min(forces) == pytest.approx(-limit, rel=1e-9)


@pytest.mark.parametrize("part", [0.5, 0.9])
def test_a_force_below_the_limit_is_borne_without_creep(part: float) -> None:
    dynamics = on_a_slider(
        LoadTable(((0.0, 0.0), (1.0, part * 2e3))), friction=2e3, friction_stiffness=1e7, damping=4e4
    )
    found = run(dynamics, 20.0)
    assert found.state[-1, 0] == pytest.approx(part * 2e3 / 1e7, rel=1e-3)
    assert found.series[-1, 0] == 0.0


def test_a_force_beyond_the_limit_accelerates_the_mass_by_the_difference() -> None:
    found = run(on_a_slider(2.5e3, friction=2e3, friction_stiffness=1e7, damping=10.0), 2.0)
    rates = found.state[found.time > 1.0, 1]
    times = found.time[found.time > 1.0]
    assert (rates[-1] - rates[0]) / (times[-1] - times[0]) == pytest.approx(0.5e3 / MASS, rel=0.02)


def event(function: Any, direction: float) -> Any:
    function.terminal, function.direction = True, direction
    return function


def event_driven(drawn: Array, position: float, end: float, force: float) -> tuple[float, float]:
    """Position m and slider m at the end: each phase of sticking and sliding by itself up to its event."""
    limit, series, spring, damper = drawn
    time, state, sliding = 0.0, np.array([position, 0.0]), 0.0
    slider = float(position - np.clip(position, -limit / series, limit / series))
    while time < end:

        def rate(t: float, x: Array, slider: float = slider, sliding: float = sliding) -> list[float]:
            friction = sliding * limit if sliding else series * (x[0] - slider)
            return [x[1], (force - spring * x[0] - damper * x[1] - friction) / MASS]

        events = [event(lambda t, x: x[1], -sliding)]
        if not sliding:
            events = [event(lambda t, x, way=w, at=slider: series * (x[0] - at) - way * limit, w) for w in (1.0, -1.0)]
        part = solve_ivp(rate, (time, end), state, events=events, rtol=1e-10, atol=1e-13, max_step=0.01)
        time, state = float(part.t[-1]), part.y[:, -1]
        if sliding:
            slider, sliding = float(state[0] - sliding * limit / series), 0.0
        elif part.status == 1:
            sliding = 1.0 if len(part.t_events[0]) else -1.0
    return float(state[0]), slider


@pytest.mark.parametrize("drawn", DRAWN, ids=str)
def test_vibration_is_that_of_an_integrator_that_finds_the_events(drawn: Array) -> None:
    limit, series = 200.0 + 800.0 * drawn[0], 1e5 + 9e5 * drawn[1]
    spring, damper, force = 1e5 + 2e5 * drawn[2], 100.0 + 1e3 * drawn[3], 2e3 * drawn[0]
    element = {"friction": limit, "friction_stiffness": series, "stiffness": spring, "damping": damper}
    position, slider = event_driven(np.array([limit, series, spring, damper]), 0.03, 2.0, force)
    errors = []
    for rtol in (1e-2, 1e-4):
        found = run(on_a_slider(force, **element), 2.0, position=0.03, rtol=rtol)
        errors.append(max(abs(found.state[-1, 0] - position), abs(found.series[-1, 0] - slider)))
    assert errors[0] < 3e-3
    assert errors[1] < 3e-5
    assert found.cost.steps.rejected + found.cost.steps.failed < 0.3 * found.cost.steps.accepted


def test_modes_and_equilibria_stick() -> None:
    """A stuck slider leaves the springs in parallel; beyond its limit an equilibrium is that of motion one way."""
    element: Any = {"friction": 2e3, "friction_stiffness": 3e6, "stiffness": 1e6}
    element["axle"] = ("x", "y", "roll", "pitch", "yaw")
    (mode,) = held_wheelset_modes(on_a_slider(**element))
    assert mode.frequency == pytest.approx(np.sqrt(4e6 / MASS) / (2 * np.pi), rel=1e-9)
    for force in (1e3, 5e3, -9e3):
        at = equilibrium(on_a_slider(force, **element))
        drawn = abs(force) / 4e6 > 2e3 / 3e6
        expected = (force - np.sign(force) * 2e3) / 1e6 if drawn else force / 4e6
        assert at.state[0] == pytest.approx(expected, rel=1e-6)
        assert at.state[-1] == pytest.approx(expected - np.sign(force) * 2e3 / 3e6 if drawn else 0.0, abs=1e-9)
        mode, *_ = modes(at.dynamics, at)
        assert mode.frequency == pytest.approx(np.sqrt(4e6 / MASS) / (2 * np.pi), rel=1e-9)


def test_friction_follows_the_vertical_force_of_its_element() -> None:
    """A leaf spring whose friction is 20 % of its load: 4 / 3 of the friction under 4 / 3 of the load."""
    dynamics = on_a_slider(friction=1.0, friction_stiffness=1e7)
    vehicle = dynamics.vehicle
    part = replace(
        vehicle.elements["slider"],
        stiffness=(0.0, 1e4, 1e6),
        friction=(0.0, 0.0, 0.0),
        friction_coefficient=(0.0, 0.2, 0.0),
        friction_stiffness=(0.0, 1e7, 0.0),
    )
    bodies = vehicle.bodies | {"mass": replace(vehicle.bodies["mass"], held=("x", "roll", "pitch", "yaw"))}
    dynamics = replace(dynamics, vehicle=replace(vehicle, bodies=bodies, elements={"leaf": part}))
    travel, state = dynamics.speed_profile(0.0), np.zeros(dynamics.size)
    for down, load in ((0.0, 1.0), (-MASS * 9.81 / 3e6, 4 / 3), (1.0, 0.0)):
        state[1] = down
        assert dynamics.bodies.friction_limits(travel, state)[0] == pytest.approx(0.2 * load * MASS * 9.81, abs=1e-9)


def with_friction() -> Vehicle:
    """The benchmark vehicle with friction in place of the lateral dampers of its car body, and in its boxes."""
    vehicle = load_vehicle()
    primary = {"friction": (500.0, 300.0, 0.0), "friction_stiffness": (1e7, 5e6, 1e6)}
    secondary = {"friction_stiffness": (0.0, 2e6, 0.0), "friction": (0.0, 800.0, 0.0)}
    elements = {}
    for name, part in vehicle.elements.items():
        if name.startswith("primary"):
            part = replace(part, **primary, friction_coefficient=(0.0, 0.0, 0.02))
        elif "secondary" in name:
            part = replace(part, **secondary)
        elements[name] = part
    return replace(vehicle, elements=elements)


def test_mirror_image_of_a_vehicle_with_friction() -> None:
    histories = []
    for curvature in (1 / 400, -1 / 400):
        track = Track.curve(curvature=curvature, cant=0.06, transition=15.0, length=50.0)
        dynamics = VehicleDynamics(with_friction(), track, LinearCreep(), 30.0)
        histories.append(simulate(dynamics, (0.0, 0.8)))
    left, right = histories
    assert left.status == right.status == "completed"
    np.testing.assert_array_equal(right.time, left.time)
    np.testing.assert_array_equal(right.state, mirror_signs(left.dynamics.coordinates) * left.state)
    assert (np.abs(left.series[-1]) > 1e-5).sum() > 4  # sliders that moved


@pytest.mark.parametrize("method", ["rosenbrock", "ode45"])
def test_a_resumed_run_has_the_same_bits(method: str) -> None:
    track = Track.curve(curvature=1 / 400, cant=0.06, transition=15.0, length=50.0)
    dynamics, found = VehicleDynamics(with_friction(), track, LinearCreep(), 30.0), list[Checkpoint]()
    every = Checkpoints(5, lambda at: found.append(deepcopy(at)))

    def rows(checkpoints: Checkpoints) -> History:
        end = 0.6 if method == "rosenbrock" else 0.05
        recording = Recording(0.01, checkpoints)
        return simulate(dynamics, (0.0, end), steps=StepSettings(method, 3e-3, 3e-5), recording=recording)

    whole = rows(every)
    again = rows(replace(every, latest=found[len(found) // 2]))
    np.testing.assert_array_equal(again.state, whole.state)
    assert np.abs(whole.series[-1]).max() > (1e-5 if method == "rosenbrock" else 0.0)


def test_energy_of_a_wagon_with_friction() -> None:
    """The plane wagon on irregular rails, with friction in both stages, of which one follows the load."""
    track = Track.curve(curvature=1 / 600, cant=0.06, transition=30.0, length=200.0)
    dynamics = wagon_dynamics(Wagon(), track, CONTACT, 45.0)
    values = {"friction": (0.0, 300.0, 100.0), "friction_stiffness": (0.0, 2e6, 1e6)}
    elements = {
        name: replace(part, **values, friction_coefficient=(0.0, 0.02, 0.0)) if part.stiffness[2] else part
        for name, part in dynamics.vehicle.elements.items()
    }
    dynamics = replace(dynamics, vehicle=replace(dynamics.vehicle, elements=elements))
    initial = equilibrium(dynamics).state.copy()
    initial[dynamics.coordinates.count + np.array([0, 3, 6])] = 0.3, 0.2, 0.05  # m/s
    errors = []
    for rtol in (1e-3, 1e-4):
        steps = StepSettings("rosenbrock", rtol, 1e-2 * rtol)
        balance = energy_balance(simulate(dynamics, (0.0, 0.4), initial=initial, steps=steps))
        errors.append(balance.error)
    friction = balance.work[-1, balance.causes.index("friction")]
    assert friction < -0.05 * np.abs(balance.work).max()
    assert errors[1] < 1e-3


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"friction": -1.0}, "elements.slider.friction: must be zero or positive"),
        ({"friction": 1e3}, "elements.slider.friction_stiffness: must be positive where there is friction"),
        ({"friction_stiffness": 1e3}, "elements.slider.friction_stiffness: must be positive where there is friction"),
        ({"friction": 1e3, "friction_stiffness": np.inf}, "elements.slider.friction_stiffness: must be zero or pos"),
    ],
)
def test_invalid_friction(values: dict[str, float], message: str) -> None:
    with pytest.raises(InvalidVehicle, match=message):
        on_a_slider(**values)
