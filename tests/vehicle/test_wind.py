"""Crosswind: gust by quadrature, loads by their resultant, overturning of a rigid vehicle, springs by their energy."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import atan2, hypot, pi
from pathlib import Path

import numpy as np
import pytest
from planar_vehicle import PlanarVehicle
from scipy.integrate import quad
from standin_contact import CONTACT

from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.support.arrays import Array
from wheelrail.support.text_file import FileRefused
from wheelrail.vehicle.crosswind.critical_wind import LIMIT, NEAR, WindyVehicle, critical_wind
from wheelrail.vehicle.crosswind.gust import BAND, Gust
from wheelrail.vehicle.crosswind.gust_run import gust_run
from wheelrail.vehicle.crosswind.wind import NAMES, Crosswind, WindCoefficients, WindTableError, read_coefficients
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.vehicle import Vehicle
from wheelrail.vehicle.track.track import Track

YAW = np.linspace(0.0, 0.5 * pi, 19)


def coefficients(**factors: float) -> WindCoefficients:
    """Coefficients that are factors of the sine of the yaw angle, exact to 4e-3."""
    values = np.array([factors.get(name, 0.0) for name in NAMES])
    return WindCoefficients(YAW, np.sin(YAW)[:, None] * values)


def vehicle_of(stiffening: float = 1.0) -> Vehicle:
    vehicle = load_vehicle()
    elements = {
        name: replace(own, stiffness=tuple(k * stiffening if isinstance(k, float) else k for k in own.stiffness))
        for name, own in vehicle.elements.items()
    }
    springs = {
        name: replace(own, stiffness=tuple(stiffening * k for k in own.stiffness))
        for name, own in vehicle.rotational_springs.items()
    }
    return replace(vehicle, elements=elements, rotational_springs=springs)


def windy(
    table: WindCoefficients, *, vehicle: Vehicle | None = None, left: bool = False, at: float = 40.0
) -> WindyVehicle:
    dynamics = VehicleDynamics(vehicle or load_vehicle(), Track(), CONTACT, at)
    return WindyVehicle(dynamics, Crosswind(table, "car_body", 0.0, from_left=left), at)


@pytest.mark.parametrize("seed", range(3))
def test_gust_by_quadrature(seed: int) -> None:
    draw = np.random.default_rng(seed)
    gust, width = Gust(draw.uniform(10.0, 50.0), draw.uniform(0.3, 2.8)), draw.uniform(1.0, 40.0)
    assert gust.peak / gust.mean == pytest.approx(1.6946, abs=1e-4)  # gust factor

    def density(f: float) -> float:
        return float((1.0 + 70.8 * (f * 96.0 / gust.mean) ** 2) ** (-5.0 / 6.0))

    moment, total = quad(lambda f: f**2 * density(f), *BAND)[0], quad(density, *BAND, limit=200)[0]
    assert gust.duration == pytest.approx(4.1825 / (2.0 * np.sqrt(moment / total)), rel=1e-4)
    for x in draw.uniform(-60.0, 60.0, 4):
        wind = quad(lambda s: gust.averaged(np.array([s]), 0.0)[0], x - width / 2, x + width / 2, points=[0.0])[0]
        assert gust.averaged(np.array([x]), width)[0] == pytest.approx(wind / width, rel=1e-8)
    assert gust.averaged(np.zeros(1), 0.0)[0] == pytest.approx(gust.peak)


@pytest.mark.parametrize("seed", range(3))
def test_loads_have_forces_and_moments_of_the_coefficients(seed: int) -> None:
    """Sum of all forces about the point at top of rail; wind from the other side is the mirror image."""
    draw = np.random.default_rng(seed)
    table = WindCoefficients(YAW, draw.normal(size=(len(YAW), 6)))
    speed, wind, angle, x = draw.uniform(5.0, 60.0), draw.uniform(5.0, 40.0), draw.uniform(0.4, 1.5), draw.normal()

    def resultant(left: bool) -> Array:
        forces = Crosswind(table, "car_body", x, angle, left).loads(speed, wind).forces
        parts = [(np.subtract(f.point, (x, 0.0, 0.0)), [load.at(0.0, 0.0) for load in f.components]) for f in forces]
        return np.sum([[*force, *np.cross(arm, force)] for arm, force in parts], axis=0)

    along, across = speed + wind * np.cos(angle), wind * np.sin(angle)
    c = [np.interp(atan2(across, along), YAW, column) for column in table.values.T]
    pressure = 0.5 * 1.225 * 10.0 * hypot(along, across) ** 2
    expected = pressure * np.array([c[0], c[1], c[2], -3.0 * c[3], 3.0 * c[4], 3.0 * c[5]])
    np.testing.assert_allclose(resultant(False), expected, rtol=1e-9)
    np.testing.assert_allclose(resultant(True), expected * [1, -1, 1, -1, 1, -1], rtol=1e-9)


def test_overturning_of_a_rigid_vehicle() -> None:
    """Unloading by statics of a rigid body on its wheels: half of the lift, and over their distance the moments
    of wind and shifted weight.
    """
    own = windy(coefficients(cFy=4.0, cFz=1.5, cMx=2.5), vehicle=vehicle_of(300.0))
    for wind in (15.0, 25.0):
        air, yaw = np.hypot(own.speed, wind), np.arctan2(wind, own.speed)
        pressure = 0.5 * 1.225 * 10.0 * air**2 * np.sin(yaw)
        at, weight = own.at(wind), own.dynamics.vehicle.weight
        masses = [body.mass for body in own.dynamics.vehicle.bodies.values()]
        shift = np.average(own.dynamics.coordinates.split(at.state)[0][:, 1], weights=masses)
        lift = 1.5 * pressure
        lost = 0.5 * lift + (2.5 * 3.0 * pressure + (weight - lift) * shift) / 1.5
        found = own.unloading(own.windward(at.contacts)).mean()
        assert found == pytest.approx(lost / (0.5 * weight), abs=2e-4)


@cache
def _found() -> tuple[WindyVehicle, float]:
    own = windy(coefficients(cFy=4.0, cFz=1.5, cMx=2.5))
    critical = own.critical()
    assert critical is not None
    assert critical.reached
    return own, critical.wind


def test_critical_wind_of_springs_by_their_energy() -> None:
    """Three masses: moments of the weights of body and bogies at their places of least energy, and of the wind."""
    own, wind = _found()
    near, d, vehicle = own.at(wind), own.dynamics, own.dynamics.vehicle
    assert own.unloading(own.windward(near.contacts)).max() == pytest.approx(LIMIT, abs=NEAR)
    position, _, _ = d.coordinates.split(near.state)
    places = {name: position[vehicle.names.index(name)][[1, 2, 3]].tolist() for name in vehicle.wheelsets}
    _, side, lift, overturning, _, _ = own.crosswind.wrench(own.speed, wind)
    forces = [("car_body", (s, 0.0), 0.5 * np.array([side, lift + s * overturning])) for s in (1.0, -1.0)]
    static = dict(zip(vehicle.elements, d.suspension.static_loads.tolist(), strict=True))
    rest = PlanarVehicle(vehicle, static, places, forces=forces).rest()
    for name, (y, z, roll) in rest.items():
        np.testing.assert_allclose(position[vehicle.names.index(name)][[1, 2, 3]], [y, z, roll], rtol=0.01, atol=2e-4)
    weights = sum(vehicle.bodies[name].mass * vehicle.gravity * at[0] for name, at in {**places, **rest}.items())
    y, z, roll = rest["car_body"]  # the wind acts at the point of the body that is at top of rail
    height = vehicle.bodies["car_body"].height
    up, across = z + height * (1.0 - np.cos(roll)), y + height * np.sin(roll)
    moment = weights + side * up - lift * across - overturning * np.cos(roll)
    right = 0.5 * (vehicle.weight - lift) - moment / 1.5
    found = own.unloading(own.windward(near.contacts)).mean()
    assert 1.0 - right / (0.5 * vehicle.weight) == pytest.approx(found, abs=1e-3)


def test_wind_from_the_left_and_lateral_acceleration() -> None:
    own, wind = _found()
    turned = windy(own.crosswind.coefficients, left=True)
    values = own.unloading(own.windward(own.at(20.0).contacts))
    np.testing.assert_allclose(turned.unloading(turned.windward(turned.at(20.0).contacts)), values, rtol=1e-3)
    curved = replace(own, acceleration=0.6).critical()
    assert curved is not None
    assert curved.wind < 0.92 * wind


def test_long_gusts_are_steady_wind(monkeypatch: pytest.MonkeyPatch) -> None:
    """Through a gust of 400 m the unloading is that of steady wind; the wind is averaged over the vehicle."""
    own, wind = _found()
    peak = 0.8 * wind
    steady = own.unloading(own.windward(own.at(peak).contacts)).max()
    run = gust_run(own, peak, 21.56)
    assert run.completed
    assert run.wind.max() == pytest.approx(Gust(peak).averaged(np.zeros(1), 21.56)[0], rel=1e-3)
    monkeypatch.setattr(Gust, "length", property(lambda gust: 400.0))
    slow = gust_run(own, peak, 21.56)
    assert slow.unloading.max() == pytest.approx(steady, abs=0.015)


def test_search_of_a_known_limit() -> None:
    """Of unloading that grows as the square of the wind, and of a vehicle that is lost before."""
    for limit in (8.0, 33.0, 90.0):
        found = critical_wind(lambda wind, at=limit: LIMIT * np.array([0.5, 1.0]) * (wind / at) ** 2, 20.0)
        assert found is not None
        assert (found.wind, found.gear, found.reached) == (pytest.approx(limit, rel=1e-3), 1, True)
    lost = critical_wind(lambda wind: np.array([wind / 50.0]) if wind < 30.0 else None, 20.0)
    assert lost is not None
    assert (lost.wind, lost.reached) == (pytest.approx(30.0, abs=0.03), False)
    assert critical_wind(lambda wind: np.array([1e-3 * wind]), 20.0) is None


HEAD = "yaw, cFy, cMx\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("yaw, cFy\n0, 1\n", "row 1: column cMx is missing"),
        ("# a\nyaw, cFy, cMx, cD\n", "row 2: 'cD': must have yaw (deg), cFx"),
        (f"{HEAD}0, 1, 2\n", "1 rows of numbers: must be at least 2"),
        (f"{HEAD}0, 1, 2\n0, 1, 2\n", "row 3, yaw = 0: must be greater than 0, the previous"),
        (f"{HEAD}0, 1\n", "row 2: 2 values, must be 3: yaw, cFy, cMx"),
        (f"{HEAD}0, 1, x\n", "row 2, cMx = 'x': must be a number with a decimal point from -100 to 100"),
        (f"{HEAD}-5, 1, 2\n", "row 2, yaw = '-5': must be a number with a decimal point from 0 to 90 deg"),
        ("", "column yaw is missing"),
    ],
)
def test_files_that_are_refused(text: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "wind.csv"
    file.write_text(text)
    with pytest.raises(FileRefused) as refused:
        read_coefficients(file, 10.0, 3.0)
    assert message in str(refused.value)
    assert str(file) in str(refused.value)


def test_a_file_and_its_reach(tmp_path: Path) -> None:
    file = tmp_path / "wind.csv"
    file.write_text("# a coach\nyaw; cMx; cFy\n0; 0; 0\n30; 2; 4\n")
    table = read_coefficients(file, 8.0, 2.0)
    np.testing.assert_allclose(table.at(np.radians(15.0)), [0.0, 2.0, 0.0, 1.0, 0.0, 0.0])
    crosswind = Crosswind(table, "car_body", 0.0)
    with pytest.raises(
        WindTableError, match=r"40 m/s at a speed of 30 m/s has a yaw angle of 53\.1 deg: must be within"
    ):
        crosswind.wrench(30.0, 40.0)
