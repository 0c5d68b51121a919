"""Coupled vehicles: each as if alone without couplers, momentum, draw gears with friction, files of trains."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from linear_creep import LinearCreep
from sliding_mass import matrix_of

from wheelrail.scenes.builders.vehicle import car_bodies, floor_points
from wheelrail.scenes.builders.vehicle_file import MANCHESTER, load_vehicle, parse_vehicle, vehicle_text
from wheelrail.scenes.builders.wheelset import wheelset_contact
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene, load_scene
from wheelrail.scenes.views.vehicle_poses import DrawnVehicle
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.elements import SuspensionElement
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.vehicle import Vehicle, VehicleBody
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.force_law import ForceLaw

TWO = """
[vehicles]
first = { file = "coach.toml", x = 0.0 }
second = { file = "coach.toml", x = -25.0, turned = true }
"""
BUFFERS = """
[elements.buffer]
upper = "first_car_body"
lower = "second_car_body"
points = [[-12.5, 0.875, 1.06], [-12.5, -0.875, 1.06]]
stiffness = [[[-0.1, -6e5], [0.0, 0.0], [0.1, 0.0]], 0.0, 0.0]
friction = [2e4, 0.0, 0.0]
friction_stiffness = [5e6, 0.0, 0.0]
"""


PARTS = ("bodies", "elements", "rotational_springs")


def train(folder: Path, text: str) -> Path:
    (folder / "coach.toml").write_text(MANCHESTER.read_text(encoding="utf-8"), encoding="utf-8")
    file = folder / "train.toml"
    file.write_text(text, encoding="utf-8")
    return file


def of(vehicle: Vehicle) -> VehicleDynamics:
    return VehicleDynamics(
        vehicle, Track.curve(curvature=1 / 500, cant=0.1, transition=100.0, length=200.0), LinearCreep(), 20.0
    )


def test_uncoupled_vehicles_are_each_alone_bit_for_bit() -> None:
    """Accelerations, reactions and derivatives in random states, in a transition."""
    coach = load_vehicle()
    parts_alone = [coach.placed("first", 0.0), coach.turned.placed("second", -25.0)]
    merged = [{**getattr(parts_alone[0], key), **getattr(parts_alone[1], key)} for key in PARTS]
    alone, dynamics = [of(part) for part in parts_alone], of(Vehicle(*merged))
    random = np.random.default_rng(1)
    n, c = alone[0].size, alone[0].coordinates.count
    assert dynamics.size == 2 * n
    parts = [np.concatenate([k * c + np.arange(c), 2 * c + k * c + np.arange(c)]) for k in (0, 1)]
    for time in (2.0, 5.0):
        state = random.normal(size=2 * n) * np.repeat([1e-2, 0.1], 2 * c)
        wrenches = 1e4 * random.normal(size=(8, 6))
        found, jacobian = dynamics.accelerations(time, state, wrenches), jacobian_of(dynamics, time, state, wrenches)
        for k, (own, places) in enumerate(zip(alone, parts, strict=True)):
            loads = wrenches[4 * k : 4 * k + 4]
            expected = own.accelerations(time, state[places], loads)
            np.testing.assert_array_equal(found.rates[k * c : (k + 1) * c], expected.rates)
            np.testing.assert_array_equal(found.reactions[7 * k : 7 * k + 7], expected.reactions)
            block = jacobian[k * c : (k + 1) * c]
            np.testing.assert_array_equal(block[:, places], jacobian_of(own, time, state[places], loads))
            np.testing.assert_array_equal(block[:, parts[1 - k]], 0.0)


def jacobian_of(dynamics: VehicleDynamics, time: float, state: Array, wrenches: Array) -> Array:
    return dynamics.bodies.derivatives(dynamics.speed_profile(time), 0.0, state, wrenches).by_state


def wagons(**coupler: Any) -> VehicleDynamics:
    """Two equal wagons that roll without creep forces, with one element between them."""
    bodies: dict[str, VehicleBody] = {}
    elements: dict[str, SuspensionElement] = {}
    for name, x in (("front", 0.0), ("rear", -12.0)):
        bodies[name] = VehicleBody(20e3, (2e4, 2e5, 2e5), x, 1.2)
        for end, place in (("leading", x + 3.0), ("trailing", x - 3.0)):
            axle = f"{name}_{end}"
            bodies[axle] = VehicleBody(1e3, (600.0, 1.0, 600.0), place, 0.46, wheelset=True)
            for side in (1.0, -1.0):
                point = (place, side, 0.46)
                spring = SuspensionElement(name, axle, point, (1e7, 3e6, 1e6), (1e5, 2e4, 2e4), turn=1.0)
                elements[f"{axle}_{side:+.0f}"] = spring
    elements["coupler"] = SuspensionElement("front", "rear", (-6.0, 0.0, 1.2), **coupler)
    contact = LinearCreep(longitudinal_creep=0.0, lateral_creep=0.0, conicity=0.0, load=44e3 * 9.81 / 8)
    return VehicleDynamics(Vehicle(bodies, elements, {}), Track(), contact, 5.0)


def collision(dynamics: VehicleDynamics, speed: float, end: float) -> tuple[Array, Array]:
    """Rates (2, 2) along the track of both wagons before and after, and their momenta (rows,) of the run."""
    initial = np.zeros(dynamics.size)
    c, names = dynamics.coordinates, dynamics.vehicle.names
    rear = [c.count + c.index(name, 0) for name in names if name.startswith("rear")]
    initial[rear] = speed
    initial[[c.count + c.index(n, 4) for n in dynamics.vehicle.wheelsets if n.startswith("rear")]] = speed / 0.46
    found = simulate(dynamics, (0.0, end), initial=initial, steps=StepSettings("rosenbrock", 1e-4, 1e-6))
    assert found.status == "completed"
    along = np.array([c.count + c.index(name, 0) for name in names])
    momenta = found.state[:, along] @ dynamics.mass
    mean = np.array([[rates[:3] @ dynamics.mass[:3], rates[3:] @ dynamics.mass[3:]] for rates in found.state[:, along]])
    return mean / dynamics.mass[:3].sum(), momenta


@pytest.mark.parametrize("speed", [0.3, 1.1])
def test_momentum_of_a_collision_on_elastic_buffers(speed: float) -> None:
    """Equal masses exchange their velocities; nothing acts on both but the buffers."""
    buffer = ForceLaw(((-0.2, -4e5), (0.0, 0.0), (0.1, 0.0)))
    rates, momenta = collision(wagons(stiffness=(buffer, 0.0, 0.0)), speed, 1.0)
    np.testing.assert_allclose(momenta, momenta[0], rtol=1e-6)
    assert rates[-1] == pytest.approx([speed, 0.0], abs=0.03 * speed)  # bodies vibrate on their axles


def test_draw_gear_with_friction_takes_the_energy_of_a_collision() -> None:
    """What is left of the relative velocity where the buffer's force is that of friction.

    Two masses m with the relative velocity v have the energy m v^2 / 4 beside that of their common motion.
    """
    speed, limit, stiffness, series = 1.0, 3e4, 2e6, 1e7
    buffer = ForceLaw(((-0.2, -4e5), (0.0, 0.0), (0.1, 0.0)))
    dynamics = wagons(stiffness=(buffer, 0.0, 0.0), friction=(limit, 0.0, 0.0), friction_stiffness=(series, 0.0, 0.0))
    rates, momenta = collision(dynamics, speed, 0.45)
    np.testing.assert_allclose(momenta, momenta[0], rtol=1e-6)
    mass, stuck = dynamics.mass[:3].sum(), limit / series
    # Compression a: k a^2 / 2 of the buffer, F^2 / 2 k_s of the slider's spring, F (a - F / k_s) of friction.
    start = mass * speed**2 / 4 + 0.5 * limit * stuck
    deepest = (-limit + np.sqrt(limit**2 + 2 * stiffness * start)) / stiffness
    balanced = limit / stiffness
    left = 0.5 * stiffness * (deepest**2 - balanced**2) - limit * (deepest - balanced - 2 * stuck)
    fastest = (rates[:, 0] - rates[:, 1]).max()
    assert fastest == pytest.approx(np.sqrt(4 * left / mass), rel=0.03)


@cache
def freight(name: str) -> VehicleDynamics:
    vehicle, scene = (
        load_vehicle(MANCHESTER.with_name(f"{name}.toml")),
        load_scene(MANCHESTER.with_name("vehicle.toml")),
    )
    assert isinstance(scene, RunScene)
    track = Track.curve(tangent=20.0, curvature=1 / 600, cant=0.1, transition=60.0, length=200.0)
    return VehicleDynamics(vehicle, track, wheelset_contact(scene), 20.0)


def test_links_of_the_freight_wagon_slide_in_a_curve() -> None:
    """Longitudinal force of a box beyond its limit: spring and the part of the load, opposite to the deflection."""
    dynamics = freight("freight_wagon")
    at = equilibrium(dynamics, time=8.0)
    travel = at.dynamics.speed_profile(at.time)
    (deflections,), (forces,) = at.dynamics.bodies.element_states([travel], at.state[None])
    boxes = [i for i, name in enumerate(dynamics.vehicle.elements) if name.startswith("box")]
    load = np.array(dynamics.suspension.static_loads[boxes]) - 1.2e6 * deflections[boxes, 2]
    x = deflections[boxes, 0]
    assert np.abs(x).min() > 5e-3
    np.testing.assert_allclose(forces[boxes, 0], -650e3 * x - 0.04 * load * np.sign(x), rtol=1e-6)


@pytest.mark.parametrize("name", ["freight_wagon", "freight_train"])
def test_freight_runs_into_a_curve(name: str) -> None:
    """All comes to rest where the balance of the sum of Y holds: m (v^2 / R - g cant / base) but for small angles."""
    dynamics = freight(name)
    run = simulate(dynamics, (0.0, 13.0))
    assert run.status == "completed"
    mass, rest = dynamics.mass.sum(), run.force[-1, :, :, 1].sum()
    cant = np.arcsin(0.1 / 1.5)
    needed = mass * (20.0**2 / 600 * np.cos(cant) - 9.81 * np.sin(cant))
    assert rest == pytest.approx(needed, rel=0.02, abs=100.0)
    np.testing.assert_array_equal(run.series[-1], run.series[-4])  # no slider creeps
    assert run.cost.steps.accepted < 250


def test_a_file_of_a_train(tmp_path: Path) -> None:
    file = train(tmp_path, TWO + BUFFERS + '[speed_hold]\nbody = "first_car_body"\n')
    found = load_vehicle(file)
    assert found.bodies["second_wheelset_1"].x == pytest.approx(-25.0 - 10.78)
    assert found.speed_hold is not None
    assert len(found.wheelsets) == 8
    # Results keep the texts of all files: the train is the same where they are gone.
    text = vehicle_text(file)
    (tmp_path / "coach.toml").unlink()
    assert parse_vehicle(text, file) == found
    dynamics = VehicleDynamics(replace(found, speed_hold=None), Track(), LinearCreep(), 20.0)
    assert np.isfinite(matrix_of(dynamics, np.zeros(dynamics.size))).all()


def test_bodies_stand_on_their_own_wheelsets() -> None:
    """Couplers do not make one wagon the bogie of the other, in pictures."""
    dynamics = freight("freight_train")
    carriers = DrawnVehicle(dynamics.vehicle, dynamics.track, 1.0).carriers
    assert carriers == {f"{name}_body": [f"{name}_wheelset_2", f"{name}_wheelset_1"] for name in ("first", "second")}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (TWO.replace("-25.0", "-1e5"), "vehicles.second.x = -100000.0: must be a number from -2000"),
        (TWO + "[vehicles.third]\nx = 3.0\n", "vehicles.third.file: missing"),
        (TWO.replace('"coach.toml", x = 0.0', '"train.toml", x = 0.0'), "must be a vehicle, no train"),
        (TWO + "wheel_y = 0.5\n", "vehicles"),
        ("wheel_y = 0.5\n" + TWO, r"must have the same wheel_y, 0\.5, as the other vehicles; it is 0\.75"),
        (TWO + BUFFERS.replace('"first_car_body"', '"car_body"'), 'elements.buffer_1.upper.*no body "car_body"'),
        (TWO.replace("coach.toml", "couch.toml"), "couch.toml"),
    ],
)
def test_what_is_wrong_in_a_train_is_named(text: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=message):
        load_vehicle(train(tmp_path, text))


def test_every_wagon_of_a_train_is_a_car_body() -> None:
    vehicle = freight("freight_train").vehicle
    bodies = car_bodies(vehicle)
    assert len(bodies) == 2
    assert all(set(below) <= set(vehicle.wheelsets) for below in bodies.values())
    assert car_bodies(load_vehicle()).keys() == {"car_body"}
    places = floor_points(vehicle, 1.2)
    for name, below in bodies.items():
        assert places[f"{name} front"][1][0] == max(vehicle.bodies[own].x for own in below)
