"""Cooperrider's bogie: published linear critical speed, and limit cycles of its equations solved by another program.

References: B. Hassard's page on the model of Kaas-Petersen, Acta Mechanica 61 (1986) 89-107, gives the Hopf bifurcation
at 68.66 m/s; the cycles are those of the published equations (seven degrees of freedom, small angles), written apart
from this package and solved by LSODA with a relative tolerance of 1e-7: they vanish between 66.68 and 66.70 m/s.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import inf

import pytest
from vermeulen_johnson import VermeulenJohnson

from wheelrail.scenes.builders.vehicle_file import MANCHESTER, load_vehicle
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.vehicle import Vehicle
from wheelrail.vehicle.simulation.limit_cycle import CycleSearch, bisected_fold, fold_bracket, limit_cycles
from wheelrail.vehicle.steady.critical_speed import critical_speed
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.track.constant_curve import ConstantCurve
from wheelrail.vehicle.track.track import Track

WEIGHTLESS = 1e-6  # m/s2: the published equations have no gravity


@cache
def bogie() -> Vehicle:
    return load_vehicle(MANCHESTER.with_name("cooperrider_bogie.toml"))


def dynamics(speed: float, gravity: float = WEIGHTLESS, bound: float = 10e3) -> VehicleDynamics:
    vehicle = replace(bogie(), gravity=gravity)
    return VehicleDynamics(vehicle, Track(), VermeulenJohnson(load=vehicle.mean_wheel_load, bound=bound), speed)


def test_loads_of_the_wheels_are_the_published_ones() -> None:
    """Of the full car from which the data come: 66.66 kN."""
    assert bogie().mean_wheel_load == pytest.approx(66.66e3, rel=1e-3)


@pytest.mark.parametrize("gravity", [WEIGHTLESS, 9.81])
def test_linear_critical_speed(gravity: float) -> None:
    """The linear creep force, without its saturation; gravity adds 0.014 m/s."""
    found = critical_speed(dynamics(68.0, gravity, inf), (60.0, 75.0))
    assert found is not None
    assert found.speed == pytest.approx(68.66, abs=0.02)


def test_cycles_and_the_speed_at_which_they_vanish() -> None:
    """Subcritical: large cycles live below the linear critical speed, where small motions decay."""
    search = CycleSearch(smallest=5e-4, longest=60.0)
    kick = dict.fromkeys(("wheelset_1", "wheelset_2", "frame"), 1.0)
    cycles = list(limit_cycles(dynamics(70.0), (70.0, 67.0, 66.0), kick, search))
    assert [cycle.status for cycle in cycles] == ["limit cycle", "limit cycle", "dies out"]
    assert 1e3 * cycles[0].amplitude == pytest.approx([10.19, 10.01], abs=0.02)
    assert cycles[0].frequency == pytest.approx(3.983, abs=0.003)
    assert 1e3 * cycles[1].amplitude == pytest.approx([9.48, 9.26], abs=0.02)
    cycles += bisected_fold(dynamics(70.0), cycles, 0.3, search)
    bracket = fold_bracket(cycles)
    assert bracket is not None
    kept, dying = bracket
    assert dying.speed < 66.69 < kept.speed < dying.speed + 0.3
    assert kept.growth < 0.0


def test_the_held_car_body_stays_on_the_centre_line_of_a_curve() -> None:
    solution = equilibrium(replace(dynamics(30.0, 9.81), track=ConstantCurve(30.0, 1e-3, 0.1).track))
    assert solution.residual < 1e-7
    position, _, _ = solution.dynamics.coordinates.split(solution.state)
    assert position[0, [0, 1, 3, 4, 5]].tolist() == [0.0] * 5
    kick = {"car_body": 0.1}
    with pytest.raises(ValueError, match="car_body: held laterally"):
        next(limit_cycles(dynamics(30.0), [30.0], kick))
