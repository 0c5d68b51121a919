"""Steady curving of a vehicle on worn wheels, whose penetration in the flange root has several shallow maxima."""

from __future__ import annotations

import json
from itertools import count
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from wheelrail.meshes.profiles.named import named_profile
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.scenes.builders.wheelset import inclined_profiles, wheelset_contact
from wheelrail.scenes.schema.scene import load_scene
from wheelrail.vehicle import VehicleDynamics, equilibrium
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.steady import continuation
from wheelrail.vehicle.steady.equilibrium import _newton
from wheelrail.vehicle.track.constant_curve import ConstantCurve

SCENES = Path(__file__).parents[2] / "scenes"


def worn_wheel() -> Profile:
    """S1002 after nine steps of a wear loop in curves: removed depth over arc length, `worn_profile.json`."""
    data, new = json.loads(Path(__file__).with_name("worn_profile.json").read_text()), named_profile("S1002")
    depths = 1e-6 * np.array(data["depth_um"])
    bounds = np.linspace(*new.s_range, len(depths) + 1)
    return new.worn(bounds, depths * np.diff(bounds))


def worn_vehicle() -> VehicleDynamics:
    scene, vehicle = load_scene(SCENES / "vehicle.toml"), load_vehicle(SCENES / "manchester_vehicle.toml")
    rail = inclined_profiles(scene)[1]  # type: ignore[arg-type]
    pair = (worn_wheel(), rail)
    contact = wheelset_contact(scene, {"left": pair, "right": pair})  # type: ignore[arg-type]
    at = ConstantCurve(speed=25.0, curvature=1 / 600.0, cant=0.1)
    return VehicleDynamics(vehicle, at.track, contact, at.speed)


def test_equilibrium_on_worn_wheels() -> None:
    """At 06d44fc Newton's method stalled at 3.2e-3 wheel loads, at a jump of 0.1, and the transient run did not end."""
    found = equilibrium(worn_vehicle())
    assert found.residual < 1e-4
    load = sum(sides[side].force[2] for sides in found.contacts.values() for side in ("left", "right"))
    assert load == pytest.approx(found.dynamics.vehicle.weight, rel=0.02)  # cant and curve: 1 / cos of 4 degrees


def test_a_transient_that_does_not_come_to_rest_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(continuation, "MOST_STEPS", 3)
    endless = (SimpleNamespace(t=0.1 * number, x=np.zeros(1)) for number in count())
    monkeypatch.setattr(continuation, "integrate", lambda *_, **__: endless)
    dynamics = worn_vehicle()
    with pytest.raises(StepFailure, match=r"the transient into the curve is at 0\.30 of 9 s after 3 steps"):
        continuation.transient_into_curve(dynamics, 0.0, np.zeros(dynamics.size))


def test_a_stall_below_the_acceptable_residual_is_an_equilibrium() -> None:
    """Where a force jumps no step reduces the residual: a loop of wear ended at 1.3e-5 wheel loads."""
    problem = SimpleNamespace(
        contacts=lambda state, near: {},
        residual=lambda state, contacts: np.where(state == 0.0, 1e-5, 1.0),
        jacobian=lambda state, contacts: -np.eye(1),
        dynamics=None,
        time=0.0,
        largest=np.ones(1),
        unknowns=np.arange(1),
    )
    start = np.zeros(1)
    assert _newton(problem, start, None, 1e-7, 1e-4).residual == 1e-5  # type: ignore[arg-type]
    with pytest.raises(StepFailure, match="stalled"):
        _newton(problem, start, None, 1e-7, 1e-6)  # type: ignore[arg-type]
