"""Sway on canted track: closed form of one stage, and least energy of two stages with shifting, rolling bodies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from planar_vehicle import PlanarVehicle
from standin_contact import CONTACT

from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.vehicle import Vehicle
from wheelrail.vehicle.steady.sway import _on_cant, sway
from wheelrail.vehicle.track.track import Track

BODIES = ("car_body", "front_bogie", "rear_bogie")


def dynamics_of(vehicle: Vehicle) -> VehicleDynamics:
    return VehicleDynamics(vehicle, Track(), CONTACT, 20.0)


def planar(vehicle: Vehicle, angle: float, places: Mapping[str, Array]) -> PlanarVehicle:
    static = dict(zip(vehicle.elements, dynamics_of(vehicle).suspension.static_loads.tolist(), strict=True))
    return PlanarVehicle(vehicle, static, places, angle)


@pytest.mark.parametrize("factor", [1.0, 0.6, 1.7])
def test_one_stage_in_closed_form(factor: float) -> None:
    """Body on bogies whose primary springs hardly yield: m g h / (k - m g h), h above the springs."""
    vehicle = load_vehicle()
    elements = {
        name: replace(own, stiffness=tuple(1e4 * k if isinstance(k, float) else k for k in own.stiffness))
        if name.startswith("primary")
        else replace(own, stiffness=(own.stiffness[0], *(factor * k for k in own.stiffness[1:])))
        if "secondary" in name
        else own
        for name, own in vehicle.elements.items()
    }
    body = vehicle.bodies["car_body"]
    lever = body.mass * vehicle.gravity * (body.height - 0.8275)
    stiffness = 4.0 * factor * 430e3 * 1.0**2 + 2.0 * 961e3
    found, bogie, _ = sway(dynamics_of(replace(vehicle, elements=elements)), [0.01], BODIES)
    assert bogie.coefficient == pytest.approx(-0.003, abs=5e-4)  # of the wheelsets that shift on their cones
    expected = bogie.coefficient + lever / (stiffness - lever) * (1.0 + bogie.coefficient)
    assert found.coefficient == pytest.approx(expected, rel=5e-4)


def test_two_stages_by_least_energy() -> None:
    """Springs, roll bars, bumpstops at finite rotations above the wheelsets where they stand."""
    vehicle = load_vehicle()
    near = None
    for cant in (0.02, 0.08, 0.15):
        near = _on_cant(dynamics_of(vehicle), cant, near)
        at = near.dynamics.coordinates.split(near.state)[0][:, [1, 2, 3]]
        places = {name: at[vehicle.names.index(name)] for name in vehicle.wheelsets}
        rest = planar(vehicle, np.arcsin(cant / near.dynamics.track.base), places).rest()
        for own in sway(dynamics_of(vehicle), [cant], BODIES):
            y, _, roll = rest[own.body]
            assert own.coefficient == pytest.approx(-roll / own.angle, rel=1e-3)
            assert own.shift == pytest.approx(y, rel=2e-3)
            assert own.centre == pytest.approx(vehicle.bodies[own.body].height + y / roll, abs=5e-3)


def test_shifts_add_to_the_sway() -> None:
    """The weight of the body beside the middle of the bogies rolls these: 0.165 instead of 0.145."""
    vehicle, angle = load_vehicle(), 0.01
    places = dict.fromkeys(vehicle.wheelsets, np.zeros(3))
    free = -planar(vehicle, angle, places).rest()["car_body"][2] / angle
    held = {
        name: replace(own, stiffness=(own.stiffness[0], 1e9, own.stiffness[2])) if "secondary" in name else own
        for name, own in vehicle.elements.items()
    }
    fixed = -planar(replace(vehicle, elements=held), angle, places).rest()["car_body"][2] / angle
    assert (free, fixed) == (pytest.approx(0.1648, abs=1e-4), pytest.approx(0.1452, abs=1e-3))
    (found, *_) = sway(dynamics_of(vehicle), [0.02], BODIES)
    assert found.coefficient == pytest.approx(free, rel=4e-3)  # wheelsets roll by little


def test_turned_cant_is_the_mirror_image() -> None:
    one, other = (sway(dynamics_of(load_vehicle()), [cant], BODIES)[0] for cant in (0.1, -0.1))
    assert other.coefficient == pytest.approx(one.coefficient, rel=1e-6)
    assert other.shift == pytest.approx(-one.shift, rel=1e-5)
