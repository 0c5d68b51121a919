"""Steady curving of a vehicle on worn wheels, whose penetration in the flange root has several shallow maxima."""

from __future__ import annotations

import json
from itertools import count, pairwise
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline

from wheelrail.meshes.curves.arc_length import CurveSegment, curve
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.scenes.builders.wheelset import inclined_profiles, wheelset_contact
from wheelrail.scenes.schema.scene import load_scene
from wheelrail.vehicle import VehicleDynamics, equilibrium
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.steady import continuation
from wheelrail.vehicle.track.constant_curve import ConstantCurve

SCENES = Path(__file__).parents[2] / "scenes"


def worn_wheel() -> Profile:
    """S1002 after nine steps of a wear loop in curves: removed depth over arc length, `worn_profile.json`."""
    data, new = json.loads(Path(__file__).with_name("worn_profile.json").read_text()), named_profile("S1002")
    depths = 1e-6 * np.array(data["depth_um"])
    edges = np.linspace(*new.s_range, len(depths) + 1)
    removed = make_interp_spline(edges, np.concatenate([[0.0], np.cumsum(depths * np.diff(edges))]), k=5)
    depth, slope = removed.derivative(1), removed.derivative(2)
    inner = new.breaks[1:-1]
    corners = inner[np.hypot(*(new.tangent(inner + 1e-12) - new.tangent(inner - 1e-12)).T) > 1e-13]
    ends = np.concatenate([[new.breaks[0]], corners, [new.breaks[-1]]])

    def part(a: float, b: float) -> CurveSegment:
        def velocity(s: np.ndarray) -> np.ndarray:
            s = np.clip(s, a + 1e-13, b - 1e-13)
            tangent = new.tangent(s) @ [1, 1j]
            return np.asarray(tangent * (1.0 - depth(s) * new.curvature(s)) - slope(s) * 1j * tangent)

        def position(s: np.ndarray) -> np.ndarray:
            at = np.clip(s, a + 1e-13, b - 1e-13)
            surface = (new.point(at) - depth(at)[..., None] * new.normal(at)) @ [1, 1j]
            return np.asarray(surface + (s - at) * velocity(s))

        knots = np.union1d(new.breaks, edges[1:-1])
        knots = knots[(knots > a + 1e-6) & (knots < b - 1e-6)]
        return CurveSegment(position, velocity, np.concatenate([[a], knots, [b]]))

    whole = curve([part(a, b) for a, b in pairwise(ends)])
    raw = Profile(whole.breaks - 0.5 * whole.breaks[-1], whole.coefficients, "worn", "wheel")
    return raw.transformed(0.0, 0.0, -float(raw.s_at_y(0.0)))


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
