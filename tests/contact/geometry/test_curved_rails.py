"""Wheels on rails that are curved in plan: penetration, forces and their derivatives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from small_strips import few_strips
from standard_pair import MOUNTING, RAIL, WHEEL, wheel_on_rail
from test_core import moved

from wheelrail.bindings import _contact as core
from wheelrail.contact.geometry.strip_surfaces import ProfileStrips
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.builders import wheel_rail_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.lattice.system.surface import surface_data

RADIUS, SPEED = 0.46, 5.0
MODELS = {"standard": wheel_on_rail, "strips": few_strips}


def in_curve(radius: float, **at: float) -> WheelsetState:
    """A wheelset in a curve to the left of a radius m, negative to the right."""
    rates = {"pitch_rate": SPEED / RADIUS} | at
    return WheelsetState(**rates, speed=SPEED, frame_rate=(0.0, 0.0, SPEED / radius))


def on_arc(pose: Pose, s: float) -> tuple[float, float]:
    """Largest penetration m of a line of the wheel at s m in a rail that is a body of revolution, and where, m."""
    (y, z), (ty, tz) = WHEEL.point(np.array([s]))[0], WHEEL.tangent(np.array([s]))[0]
    r = RADIUS + z

    def seen(angle: float) -> np.ndarray:
        """The point in the section through the axis of the curve."""
        x, across, height = pose.origin + pose.rotation @ [r * np.sin(angle), y, -r * np.cos(angle)]
        centre = 1.0 / pose.plan
        return np.array([[centre - np.sign(centre) * np.hypot(centre - across, x), height]])

    def away(angle: float) -> np.ndarray:
        point = seen(angle)
        return np.asarray(point - RAIL.point(RAIL.closest(point).s))[0]

    def height(angle: float) -> float:
        return float(away(angle) @ RAIL.normal(RAIL.closest(seen(angle)).s)[0])

    angles = np.linspace(-0.3, 0.3, 61)
    i = int(np.argmin([height(angle) for angle in angles]))
    found = minimize_scalar(height, bounds=angles[[max(i - 1, 0), min(i + 1, 60)]], options={"xatol": 1e-9})
    normal = pose.rotation @ [ty * np.sin(found.x), -tz, -ty * np.cos(found.x)]
    return float(away(found.x) @ normal[1:]), RADIUS * float(found.x)


def test_penetration_is_that_of_a_rail_bent_to_an_arc() -> None:
    """At 15 to 60 m and up to 50 mrad of yaw, up to 50 mm ahead of the axle."""
    surfaces, rng = surface_data(ProfileStrips(WHEEL, RAIL, RADIUS)), np.random.default_rng(1)
    effects, errors, places = [], [], []
    for _ in range(12):
        radius, yaw, roll = (
            rng.choice([-1, 1]) * rng.uniform(15, 60),
            rng.uniform(-0.05, 0.05),
            rng.uniform(-3e-3, 3e-3),
        )
        pose, _ = MOUNTING.left_pair(in_curve(radius, y=rng.uniform(0.0, 7e-3), z=-1e-4, roll=roll, yaw=yaw))
        lines = np.sort(rng.uniform(-0.044, 0.03, 6))
        found, x, _ = core.crests(surfaces, *pose.arrays, lines)
        straight, _, _ = core.crests(surfaces, *replace(pose, plan=0.0).arrays, lines)
        for own, depth, along, flat in zip(lines, found.depth, x, straight.depth, strict=True):
            true, place = on_arc(pose, own)
            effects.append(depth - flat), errors.append(depth - true), places.append(along - place)
    assert np.abs(effects).max() > 1e-5
    assert np.abs(errors).max() < 0.02 * np.abs(effects).max()
    assert np.abs(errors).mean() < 0.01 * np.abs(effects).mean()
    assert np.abs(places).max() < 2e-5  # m


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize(
    "at", [{"y": 5.2e-3, "z": -6e-5, "yaw": -0.03}, {"y": -2e-3, "z": -4e-4, "yaw": 0.02}], ids=["flange", "tread"]
)
def test_tangent(name: str, at: dict[str, float]) -> None:
    """Forces and moments at 20 m against differences."""
    contact = MODELS[name]()
    state = in_curve(20.0, roll=1e-4, y_rate=0.01, yaw_rate=2e-3, **at)
    result = contact(state, "left")
    assert result.ok, result.status
    assert result.patches
    tangent, loads = np.asarray(contact.tangent(state, "left", result)), []
    steps = np.array([2e-8, 2e-8, 1e-7, 1e-7, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5])
    for name_of, step in zip(WheelsetState.coordinates, steps, strict=True):
        pair = []
        for way in (1.0, -1.0):
            moved = contact(replace(state, **{name_of: getattr(state, name_of) + way * step}), "left")
            pair.append(np.array([*moved.force, *moved.moment]))
        loads.append((pair[0] - pair[1]) / (2.0 * step))
    scale = np.abs(tangent).max(axis=0)
    np.testing.assert_allclose(tangent / scale, np.transpose(loads) / scale, atol=2e-4)


@pytest.mark.parametrize("name", MODELS)
def test_mirror_images(name: str) -> None:
    contact = MODELS[name]()
    state = in_curve(-25.0, y=5.2e-3, z=-6e-5, yaw=0.02)
    left, right = contact(state, "left"), contact(state.mirrored(), "right")
    np.testing.assert_array_equal(left.force, np.array([1.0, -1.0, 1.0]) * right.force)
    assert np.linalg.norm(left.force) > 1e4


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("radius", [-15.0, 50.0])
def test_normal_forces_do_work_as_on_a_straight_rail(name: str, radius: float) -> None:
    """None but for the size of the patch, as the rail flows along its own curve."""
    model = wheel_on_rail(0.0).model if name == "standard" else few_strips().model.frictionless

    def share(pose: Pose, motion: RigidMotion) -> float:
        """Power of the normal forces over force times speed."""
        own = model(pose, motion)
        assert own.ok, own.status
        velocity = motion.rail.velocity - np.cross(motion.rail.rotation, motion.rail.reference)
        power = own.force @ velocity + own.moment @ motion.rail.rotation
        return float(power / (SPEED * np.linalg.norm(own.force)))

    at = {"y": 5.2e-3, "z": -5e-5, "yaw": 0.03}
    straight = share(*MOUNTING.left_pair(in_curve(np.inf, **at)))
    pose, motion = MOUNTING.left_pair(in_curve(radius, **at))
    off = [abs(share(rail, motion) - straight) for rail in (pose, replace(pose, plan=0.0))]
    assert off[1] > 5e-5
    assert off[0] < 0.15 * off[1]


def test_points_of_grids() -> None:
    """Largest penetration as on strips; derivatives by the pose against differences, of points that stay."""
    how = Discretisation(2e-3, bodies="waveguide", points="grid")
    pair = wheel_rail_pair((WHEEL, RAIL), RADIUS, (Material(), Material()), ContactLaws(friction=0.3), how).geometry
    pose, _ = MOUNTING.left_pair(in_curve(-20.0, y=5.2e-3, z=-6e-5, yaw=0.03))
    points, approach = pair.contact_points(pose, 2)
    assert approach == pytest.approx(pair.rigid.approach(pose), abs=2e-6)
    assert abs(approach - pair.contact_points(replace(pose, plan=0.0), 2)[1]) > 1e-6
    changes = points.sensitivity.penetration(points, pose.origin)
    for k in range(6):
        depth = []
        for way in (1e-7, -1e-7):
            at = moved(pose, k, way)
            found = pair.contact_points(replace(at, plan=pose.plan), 2)[0]
            depth.append(dict(zip(found.node.tolist(), found.penetration.tolist(), strict=True)))
        stay = [n for n, node in enumerate(points.node.tolist()) if all(node in own for own in depth)]
        expected = [(depth[0][node] - depth[1][node]) / 2e-7 for node in points.node[stay].tolist()]
        assert len(stay) > 0.9 * len(points.node)
        np.testing.assert_allclose(changes[k, stay], expected, atol=1e-8)


@pytest.mark.parametrize("radius", [-15.0, 15.0])
def test_derivative_by_yaw_on_a_flange_far_ahead(radius: float) -> None:
    """The slope along the profile changes with the angle along the circle, too."""
    contact, state = wheel_on_rail(), in_curve(radius, y=5.6e-3, z=-3e-5, roll=1e-4, yaw=-0.05)
    after, before = (contact(replace(state, yaw=state.yaw + step), "left") for step in (1e-7, -1e-7))
    expected = np.array([*(after.force - before.force), *(after.moment - before.moment)]) / 2e-7
    tangent = np.asarray(contact.tangent(state, "left", contact(state, "left")))[:, 3]
    np.testing.assert_allclose(tangent, expected, atol=2e-6 * np.abs(expected).max())
