"""Air springs, rods and bushings against closed forms."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from linear_creep import LinearCreep
from numpy_vehicle import kinematics
from sliding_mass import ALL, MASS, matrix_of, on_a_slider
from standin_contact import CONTACT

from wheelrail.scenes.builders.vehicle_file import MANCHESTER, load_vehicle
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.elements import InvalidVehicle, RotationalSpring, SuspensionElement
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
from wheelrail.vehicle.simulation.energy_balance import energy_balance
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.steady.modes import held_wheelset_modes
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.air_spring import POLYTROPIC, AirSpring
from wheelrail.vehicle.wagon.wagon import Wagon

AIR = AirSpring(5e5, 0.2, 0.02, 0.08, 2.0, 2e-3, 3.0)
DRAWN = np.random.default_rng(7).uniform(0.3, 3.0, size=(3, 4))


@pytest.mark.parametrize("drawn", DRAWN, ids=str)
@pytest.mark.parametrize("direction", [0, 1, 2], ids="xyz")
def test_frequency_response_of_a_spring_beside_a_surging_mass(direction: int, drawn: Array) -> None:
    """Receptance 1 / (K - m w^2) with the dynamic stiffness K of an air spring with linear damping."""
    spring, series, damper, mass = drawn * [4e5, 1e6, 2e4, 300.0]
    element = {"stiffness": spring, "series_stiffness": series, "damping": damper, "surge_mass": mass}
    dynamics = on_a_slider(direction=direction, **element)
    matrix, force = matrix_of(dynamics, np.zeros(4)), np.array([0.0, 1.0 / MASS, 0.0, 0.0])
    for omega in (0.5, 5.0, 20.0, 50.0, 200.0):
        found = np.linalg.solve(1j * omega * np.eye(4) - matrix, force)[0]
        moved = 1j * omega * damper - mass * omega**2
        stiffness = spring + series * moved / (series + moved)
        assert found == pytest.approx(1.0 / (stiffness - MASS * omega**2), rel=1e-9)


def test_dissipation_of_quadratic_damping() -> None:
    """8/3 C V^3 / w a cycle of a mass that moves with the amplitude V of its velocity: all force is the damper's."""
    damper, rigid, omega, velocity = 3e4, 1e9, 10.0, 0.2
    element = {"series_stiffness": rigid, "damping": damper, "surge_mass": 1e-3, "surge_exponent": 2.0}
    dynamics, work = on_a_slider(**element), 0.0
    for phase in np.linspace(0.0, 2 * np.pi, 400, endpoint=False):
        flow = velocity * np.cos(phase)
        state = np.array([0.0, flow, damper * flow * abs(flow) / rigid, flow])
        wrenches = np.zeros((1, 6))
        rates = dynamics.bodies.energy_rates(dynamics.speed_profile(0.0), state, wrenches)
        assert dynamics.accelerations(0.0, state, wrenches).rates[-1] == pytest.approx(0.0, abs=1e-6 * damper)
        work -= rates[3] * 2 * np.pi / omega / 400
    assert work == pytest.approx(8 / 3 * damper * velocity**3 / omega, rel=1e-4)


def test_air_spring_has_the_stiffnesses_and_the_resonance_of_its_volumes() -> None:
    """Both volumes, the bag alone, and Helmholtz' resonance of the column between both."""
    together, bag = AIR.volume + AIR.reservoir, AIR.volume
    compression = POLYTROPIC * AIR.pressure * AIR.area**2
    assert AIR.stiffness == pytest.approx(compression / together)
    assert AIR.stiffness + AIR.series_stiffness == pytest.approx(compression / bag)
    springs = POLYTROPIC * AIR.pressure * AIR.pipe_area * (1 / bag + 1 / AIR.reservoir)
    assert AIR.series_stiffness / AIR.mass == pytest.approx(springs / (AIR.density * AIR.pipe_length))
    # The same loss of power in the pipe.
    speed = 0.3
    lost = 0.5 * AIR.density * AIR.loss * (AIR.ratio * speed) ** 3 * AIR.pipe_area
    assert AIR.damping * speed**3 == pytest.approx(lost)


def test_energy_of_a_wagon_on_air() -> None:
    dynamics = wagon_dynamics(Wagon(), Track(), CONTACT, 45.0)
    air: Any = {"series_stiffness": (np.inf, np.inf, 4e5), "surge_mass": (0.0, 0.0, 200.0)}
    elements = {
        name: replace(part, damping=(0.0, 0.0, 2e4), surge_exponent=(1.0, 1.0, 2.0), **air) if part.damping[2] else part
        for name, part in dynamics.vehicle.elements.items()
    }
    dynamics = replace(dynamics, vehicle=replace(dynamics.vehicle, elements=elements))
    initial = equilibrium(dynamics).state.copy()
    initial[dynamics.coordinates.count + np.array([1, 4, 2])] = 0.2, 0.3, 0.05  # m/s
    steps = StepSettings("rosenbrock", 1e-4, 1e-6)
    balance = energy_balance(simulate(dynamics, (0.0, 0.5), initial=initial, steps=steps))
    assert np.abs(balance.gap).max() < -0.02 * balance.work[-1, balance.causes.index("dampers")]


def on_rods(**values: Any) -> VehicleDynamics:
    """A mass free in x, z and pitch beside a wheelset that is held, on a spring, with a rod forwards and downwards."""
    dynamics = on_a_slider(stiffness=0.0)
    vehicle = dynamics.vehicle
    spring = SuspensionElement("mass", "axle", (0.0, 0.0, 1.0), (1e4, 1e4, 1e6))
    rod = SuspensionElement("mass", "axle", (0.3, 0.2, 1.2), lower_point=(0.9, -0.1, 0.5), **values)
    mass = replace(vehicle.bodies["mass"], held=())
    bodies = vehicle.bodies | {"mass": mass}
    springs = {"bushing": RotationalSpring("mass", "axle", (1e5, 1e5, 1e5))}
    changed = replace(vehicle, bodies=bodies, elements={"spring": spring, "rod": rod}, rotational_springs=springs)
    return replace(dynamics, vehicle=changed)


def test_force_of_a_rod_is_along_it_and_has_its_change_of_length() -> None:
    dynamics, random = on_rods(stiffness=(2e6, 0.0, 0.0)), np.random.default_rng(3)
    travel = dynamics.speed_profile(0.0)
    for _ in range(5):
        state = np.concatenate([random.normal(size=6) * [0.05, 0.05, 0.05, 0.1, 0.1, 0.1], np.zeros(6)])
        (deflections,), (forces,) = dynamics.bodies.element_states([travel], state[None])
        motion = kinematics(dynamics)(travel, state)
        upper = motion.position[0] + motion.axes[0] @ [0.3, 0.2, 0.2]
        gap = upper - (motion.position[1] + motion.axes[1] @ [0.9, -0.1, 0.04])
        longer = np.linalg.norm(gap) - np.sqrt(0.6**2 + 0.3**2 + 0.7**2)
        assert deflections[1] == pytest.approx([longer, 0.0, 0.0], abs=1e-12)
        assert forces[1] == pytest.approx([-2e6 * longer, 0.0, 0.0], abs=1e-5)
        loads = [replace(dynamics, vehicle=replace(dynamics.vehicle, elements=e)).bodies.motions(travel, state)[1]
                 for e in (dynamics.vehicle.elements, {"spring": dynamics.vehicle.elements["spring"]})]  # fmt: skip
        force, moment = (loads[0] - loads[1])[0]
        along = -2e6 * longer * gap / np.linalg.norm(gap)
        np.testing.assert_allclose(force, along, atol=1e-5)
        np.testing.assert_allclose(moment, np.cross(upper - motion.position[0], along), atol=1e-5)


def test_a_rod_guides_an_arm() -> None:
    """A stiff rod at an angle leaves a mass one direction: sideways of it, by the springs there."""
    dynamics = on_rods(stiffness=(1e10, 0.0, 0.0))
    held = replace(dynamics.vehicle.bodies["mass"], held=("roll", "pitch", "yaw", "y"))
    vehicle = replace(dynamics.vehicle, bodies=dynamics.vehicle.bodies | {"mass": held})
    rod = replace(vehicle.elements["rod"], lower_point=(0.9, 0.2, 0.4))  # downwards by 0.8 on 0.6 m
    vehicle = replace(vehicle, elements=vehicle.elements | {"rod": rod})
    slowest = held_wheelset_modes(replace(dynamics, vehicle=vehicle))[0]
    expected = 0.8**2 * 1e4 + 0.6**2 * 1e6  # N/m, across the rod
    assert slowest.frequency == pytest.approx(np.sqrt(expected / MASS) / (2 * np.pi), rel=1e-4)
    assert slowest.shape[1] / slowest.shape[0] == pytest.approx(0.6 / 0.8, rel=1e-3)


def test_bushings_damp_rotations() -> None:
    """Roll of a body of inertia J on K and C: its frequency and damping ratio."""
    held = tuple(name for name in ALL if name != "roll")
    dynamics = on_a_slider(stiffness=1.0)
    bodies = dynamics.vehicle.bodies | {"mass": replace(dynamics.vehicle.bodies["mass"], held=held)}
    springs = {"bushing": RotationalSpring("mass", "axle", (2e5, 0.0, 0.0), (3e3, 0.0, 0.0))}
    vehicle = replace(dynamics.vehicle, bodies=bodies, rotational_springs=springs)
    (mode,) = held_wheelset_modes(replace(dynamics, vehicle=vehicle))
    assert mode.frequency == pytest.approx(np.sqrt(2e5 / 500.0) / (2 * np.pi), rel=1e-9)
    assert mode.damping == pytest.approx(3e3 / (2 * np.sqrt(2e5 * 500.0)), rel=1e-9)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"surge_mass": 10.0}, "surge_mass: must be zero without series_stiffness"),
        ({"surge_exponent": 4.0}, "surge_exponent: must be from 1 to 3"),
        ({"surge_exponent": 2.0, "damping": 1e3, "series_stiffness": 1e5}, "surge_exponent: must be 1 without surge_m"),
    ],
)
def test_invalid_surge(values: dict[str, float], message: str) -> None:
    part = SuspensionElement("mass", "axle", (0.0, 0.0, 1.0), **{k: (v,) * 3 for k, v in values.items()})
    with pytest.raises(InvalidVehicle, match=message):
        part.check("elements.slider")


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"stiffness": (1e6, 1e6, 0.0)}, "elements.rod.stiffness: must be"),
        ({"friction_coefficient": (0.1, 0.0, 0.0), "friction_stiffness": (1e6, 0.0, 0.0)}, "rod.friction_coefficient"),
    ],
)
def test_invalid_rods(values: dict[str, Any], message: str) -> None:
    with pytest.raises(InvalidVehicle, match=message):
        on_rods(**values)
    with pytest.raises(InvalidVehicle, match=r"elements\.rod\.lower_point: must be 0\.001 m"):
        SuspensionElement("mass", "axle", (0.0, 0.0, 1.0), lower_point=(0.0, 0.0, 1.0)).check("elements.rod")


AIR_TABLE = """
air_spring = { pressure = 5e5, area = 0.2, volume = 0.02, reservoir = 0.08, pipe_length = 2.0, pipe_area = 2e-3, \
loss = 3.0 }
"""


def with_secondary(text: str) -> str:
    return MANCHESTER.read_text(encoding="utf-8").replace(
        "stiffness = [160e3, 160e3, 430e3]\ndamping = [0.0, 32e3, 20e3]\n", text
    )


def test_a_vehicle_file_with_air_springs_rods_and_bushings(tmp_path: Path) -> None:
    file = tmp_path / "metro.toml"
    text = with_secondary(f"stiffness = [160e3, 160e3, 0.0]\ndamping = [0.0, 32e3, 0.0]\n{AIR_TABLE}")
    text = text.replace(
        "points = [[9.5, 0.0, 0.60]] }", "points = [[9.5, 0.0, 0.60]], lower_points = [[8.5, 0.0, 0.6]] }"
    )
    text = text.replace("[element_types.bumpstop]", "[element_types.bumpstop]\nrotational_stiffness = [1e3, 2e3, 3e3]")
    file.write_text(text, encoding="utf-8")
    vehicle = load_vehicle(file)
    part = vehicle.elements["front_secondary_1"]
    assert (part.stiffness[2], part.series_stiffness[2]) == (AIR.stiffness, AIR.series_stiffness)
    assert (part.surge_mass[2], part.damping[2], part.surge_exponent[2]) == (AIR.mass, AIR.damping, 2.0)
    assert vehicle.elements["front_rod"].length == pytest.approx(1.0)
    assert vehicle.rotational_springs["rear_bumpstop"].stiffness == (1e3, 2e3, 3e3)
    dynamics = VehicleDynamics(vehicle, Track(), LinearCreep(), 30.0)
    run = simulate(dynamics, (0.0, 0.3))
    assert run.status == "completed"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"damping = [0.0, 32e3, 20e3]\n{AIR_TABLE}", "air_spring: must be with .* without vertical damping"),
        ("lower_points = [[9.5, 0.0, 0.5]]\n", "lower_points = .*: must be as many as points, 2"),
        (AIR_TABLE.replace("area = 0.2", "area = -0.2"), "air_spring.area = -0.2: must be a number from 0.001"),
    ],
)
def test_what_is_wrong_in_a_file_is_named(text: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "metro.toml"
    file.write_text(with_secondary(text), encoding="utf-8")
    with pytest.raises(SceneError, match=message):
        load_vehicle(file)
