"""Flange back on a check rail: places and curvatures against the surfaces themselves, friction, springs, tangents."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

from wheelrail.contact.analytical.hertz import hertz, modulus
from wheelrail.contact.geometry.flange_back import CheckRail, FlangeBack
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.loading.flexible_contact import FlexibleContact
from wheelrail.contact.loading.flexible_state import FlexibleState
from wheelrail.contact.loading.flexible_wheelset import Flexibility
from wheelrail.contact.models.check_rail import CREEP, CheckRailContact
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.meshes.profiles.library import load_profile
from wheelrail.support.arrays import Array

V, R, MU = 3.0, 0.46, 0.3
MODULUS = modulus((210e9, 0.3), (210e9, 0.3))
MOUNTING = Mounting(0.75, 0.7535, R)
BACK = FlangeBack(-0.070, 0.0095, 0.0205)
RAIL = CheckRail(0.7175 - 0.041 - MOUNTING.rail_y, 0.02, 0.010)
MODEL = CheckRailContact(BACK, RAIL, R, MODULUS, MU)


def contact(model: CheckRailContact = MODEL) -> WheelsetContact:
    return WheelsetContact(model, MOUNTING)


def touching(
    depth: float, yaw: float, curvature: float, roll: float = 0.0, of: WheelsetContact | None = None
) -> WheelsetState:
    """State of a rolling wheelset whose left flange back is so deep, m."""
    turn = V * curvature / (1.0 + MOUNTING.rail_y * curvature)  # of the track, for that curvature of the rail
    state = WheelsetState(z=1e-4, roll=roll, yaw=yaw, speed=V, pitch_rate=V / R, frame_rate=(0.0, 0.0, turn))
    own = of or contact()
    y = brentq(lambda y: own(replace(state, y=y), "left").approach - depth, -0.02, 0.02, xtol=1e-15)
    return replace(state, y=y)


def wheel_height(state: WheelsetState, point: Array) -> Array:
    """Distance m of points (..., 3) from the flange's edge, a ring, in the frame of the left rail."""
    centre = np.array([0.0, state.y - MOUNTING.rail_y, R + state.z])
    x, y, z = np.moveaxis((point - centre) @ state.rotation, -1, 0)
    y = y - MOUNTING.wheel_y - BACK.y - BACK.rounding
    return np.asarray(np.hypot(np.hypot(x, z) - R - BACK.height, y) - BACK.rounding)


def rail_height(curvature: float, point: Array) -> Array:
    """Height m of points (..., 3) over the check rail's face and edge, those of parallel curves of the track."""
    x, y, z = np.moveaxis(point, -1, 0)
    y = y - 0.5 * curvature * x**2 - RAIL.y + RAIL.rounding
    z = z - RAIL.height + RAIL.rounding
    return np.asarray(np.where(z > 0.0, np.hypot(y, z), y) - RAIL.rounding)


def rail_distance(curvature: float, point: Array) -> float:
    """Smallest distance m of a point outside of the rail from its sections."""

    def squared(x: float) -> float:
        return float(rail_height(0.0, point - [0.0, 0.5 * curvature * x**2, 0.0]) ** 2 + (x - point[0]) ** 2)

    found = minimize_scalar(squared, bounds=(point[0] - 2e-3, point[0] + 2e-3), method="bounded", options=FINE)
    return float(np.sqrt(found.fun))


FINE = {"xatol": 1e-10}
CASES = [(0.03, 0.0, 0.0), (-0.03, 0.04, 1e-3), (0.004, 0.04, -2e-3), (0.0, 0.04, 0.0), (-0.05, -0.02, 1e-3)]


@pytest.mark.parametrize(("yaw", "curvature", "roll"), CASES)
def test_forces_are_those_of_hertz_on_the_surfaces_themselves(yaw: float, curvature: float, roll: float) -> None:
    """Penetration, place and curvatures by brute force: points of the ring, and the gap along the normal."""
    state = touching(2e-5, yaw, curvature, roll)
    centre = np.array([0.0, state.y - MOUNTING.rail_y, R + state.z])
    forth, axle, up = state.rotation.T

    def ring(angle: Array) -> Array:
        arm = np.sin(angle)[..., None] * forth - np.cos(angle)[..., None] * up
        return np.asarray(centre + (MOUNTING.wheel_y + BACK.y + BACK.rounding) * axle + (R + BACK.height) * arm)

    result = contact()(state, "left")
    assert len(result.patches) == (2 if yaw == 0.0 else 1)
    for patch in result.patches:
        near = np.arcsin(patch.x / R)
        found = minimize_scalar(
            lambda a: rail_distance(curvature, ring(np.array(a))),
            bounds=(near - 0.1, near + 0.1),
            method="bounded",
            options=FINE,
        )
        assert BACK.rounding - found.fun == pytest.approx(result.approach, abs=2e-9)
        circle = ring(np.array(found.x))
        steps = 1e-6 * np.eye(3)
        normal = np.array([rail_height(curvature, circle + d) - rail_height(curvature, circle - d) for d in steps])
        normal /= np.linalg.norm(normal)
        point = circle - BACK.rounding * normal
        assert patch.x == pytest.approx(point[0], abs=2e-6)
        assert patch.rail_y == pytest.approx(point[1], abs=2e-5)
        one = np.cross(normal, [0.0, 0.0, 1.0])
        one /= np.linalg.norm(one)
        axes = np.array([one, np.cross(normal, one)])

        def gap(u: float, v: float, normal: Array = normal, point: Array = point, axes: Array = axes) -> float:
            at = point + u * axes[0] + v * axes[1]
            wheel, rail = (
                brentq(lambda h: float(f(at + h * normal)), -1e-3, 1e-3, xtol=1e-16)  # noqa: B023
                for f in (lambda p: wheel_height(state, p), lambda p: rail_height(curvature, p))
            )
            return wheel - rail  # type: ignore[no-any-return]

        h, middle = 5e-5, gap(0.0, 0.0)
        xx, yy = ((gap(h * a, h * b) + gap(-h * a, -h * b) - 2.0 * middle) / h**2 for a, b in ((1, 0), (0, 1)))
        xy = (gap(h, h) + gap(-h, -h) - gap(h, -h) - gap(-h, h)) / (4.0 * h**2)
        low, high = 0.5 * np.linalg.eigvalsh([[xx, xy], [xy, yy]])
        expected = hertz(low, high, MODULUS, approach=result.approach)
        assert patch.normal_force == pytest.approx(expected.force, rel=2e-3)
        assert patch.max_pressure == pytest.approx(expected.peak, rel=2e-3)
        assert patch.semi_axes == pytest.approx(expected.semi_axes, rel=4e-3)


def test_friction_takes_the_power_of_the_rigid_slip() -> None:
    """A wheel that rolls turns about its lowest point: slip w at a height h and a distance x is (w h, 0, -w x)."""
    state = touching(2e-5, 0.02, 0.0)
    (patch,) = contact()(state, "left").patches
    point = np.array([patch.x, patch.rail_y, 0.0])
    height = RAIL.height - RAIL.rounding
    spin = state.rotation[:, 1] * V / R
    arm = np.array([point[0], point[1] - state.y + MOUNTING.rail_y, height - R - state.z])
    slip = np.array([V, 0.0, 0.0]) + np.cross(spin, arm)
    assert patch.frictional_power == pytest.approx(MU * patch.normal_force * np.linalg.norm(slip), rel=2e-3)
    assert np.hypot(*patch.tangential_force) == pytest.approx(MU * patch.normal_force, rel=1e-3)
    creep = np.hypot(*patch.creepage[:2]) * V
    exact = MU * patch.normal_force * creep**2 / np.hypot(creep, CREEP)
    assert patch.frictional_power == pytest.approx(exact, rel=1e-12)
    assert contact().rubbing(0.5)(state, "left").patches[0].frictional_power == pytest.approx(0.5 * exact)


def test_a_spring_in_series_has_the_same_force() -> None:
    stiffness = 20e6
    soft = contact(replace(MODEL, rail=replace(RAIL, stiffness=stiffness)))
    state = touching(3e-4, 0.03, 0.01)
    (patch,) = soft(state, "left").patches
    rigid = touching(3e-4 - patch.normal_force / stiffness, 0.03, 0.01)
    assert patch.normal_force == pytest.approx(contact()(rigid, "left").patches[0].normal_force, rel=1e-3)


def test_tangents_are_differences_and_mirror_images_exact() -> None:
    rng = np.random.default_rng(5)
    own = contact(replace(MODEL, rail=replace(RAIL, stiffness=50e6)))
    for curvature, yaw in ((0.04, 0.0), (0.0, 0.03), (-0.03, -0.04), (0.02, 0.01)):
        state = touching(1e-4, yaw, curvature, 1e-3, own)
        rates = dict(
            zip(("y_rate", "z_rate", "roll_rate", "yaw_rate"), rng.uniform(-0.1, 0.1, 4).tolist(), strict=True)
        )
        state = replace(state, **rates)
        for side, at in (("left", state), ("right", state.mirrored())):

            def wrench(**change: float) -> Array:
                found = own(replace(at, **change), side)  # type: ignore[arg-type] # noqa: B023
                return np.concatenate([found.force, found.moment])

            found = own.tangent(at, side, own(at, side))  # type: ignore[arg-type]
            for j, name in enumerate(at.coordinates):
                value, step = getattr(at, name), 1e-8 if j < 4 else 1e-5
                slope = (wrench(**{name: value + step}) - wrench(**{name: value - step})) / (2.0 * step)
                assert found[:, j] == pytest.approx(slope, rel=1e-6, abs=1e-6 * np.abs(slope).max()), name
        mirrored = own(state.mirrored(), "right").mirrored()
        assert np.array_equal(mirrored.force, own(state, "left").force)
        assert np.array_equal(mirrored.moment, own(state, "left").moment)


def test_tangents_by_motions_of_hubs_and_rails_are_differences() -> None:
    """The check rail moves with its rail: a rail that moves to the left acts as a wheelset that moves to the right."""
    rng = np.random.default_rng(6)
    own = FlexibleContact(contact(replace(MODEL, rail=replace(RAIL, stiffness=50e6))), Flexibility())
    state = touching(2e-4, 0.01, 0.02, 1e-3, own.contact)
    sizes = np.repeat([1e-5, 1e-4, 1e-5, 1e-4], [6, 6, 4, 2])
    at = FlexibleState(**vars(state), motions=tuple((sizes * rng.uniform(-1.0, 1.0, 18)).tolist()))

    def wrench(moved: FlexibleState) -> Array:
        found = own(moved, "left")
        return np.concatenate([found.force, found.moment])

    found = own.tangent(at, "left", own(at, "left"))
    for j in range(18):
        step = 1e-8 * np.eye(18)[j]
        ahead, behind = (replace(at, motions=tuple((np.array(at.motions) + s * step).tolist())) for s in (1.0, -1.0))
        slope = (wrench(ahead) - wrench(behind)) / 2e-8
        assert found[:, 9 + j] == pytest.approx(slope, rel=1e-4, abs=1e-5 * np.abs(found[:, :9]).max()), j
    rest = FlexibleState(**vars(state))
    slopes = own.tangent(rest, "left", own(rest, "left"))
    assert slopes[:3, 9 + 12] == pytest.approx(-slopes[:3, 0], rel=1e-3, abs=1e3)


@pytest.mark.parametrize("seed", range(6))
def test_depths_of_random_shapes(seed: int) -> None:
    """Wheels, edges, heights and poses at random: the deepest point of 100 001 points of the ring."""
    rng = np.random.default_rng(seed)
    radius, height = rng.uniform(0.25, 0.5), rng.uniform(-0.008, 0.04)
    back = FlangeBack(-0.07, rng.uniform(0.002, 0.02), rng.uniform(0.004, 0.03))
    model = CheckRailContact(back, CheckRail(-0.077, height, rng.uniform(0.003, 0.03)), radius, MODULUS, MU)
    own, curvature = WheelsetContact(model, Mounting(0.75, 0.7535, radius)), rng.uniform(-0.066, 0.066)
    state = WheelsetState(
        z=rng.uniform(-2e-3, 2e-3), roll=rng.uniform(-3e-3, 3e-3), yaw=rng.uniform(-0.06, 0.06), speed=V
    )
    state = replace(state, pitch_rate=V / radius, frame_rate=(0.0, 0.0, V * curvature / (1.0 + 0.7535 * curvature)))
    angle, (forth, axle, up) = np.linspace(-0.75, 0.75, 100_001), state.rotation.T

    def depth(y: float) -> float:
        out = (radius + back.height) * (np.sin(angle)[:, None] * forth - np.cos(angle)[:, None] * up)
        x, across, z = (np.array([0.0, y - 0.7535, radius + state.z]) + (0.68 + back.rounding) * axle + out).T
        across, z = (
            across - 0.5 * curvature * x**2 + 0.077 + model.rail.rounding,
            z - height + model.rail.rounding,
        )
        apart = np.where(z > 0.0, np.where(across > 0.0, np.hypot(across, z), z), across) - model.rail.rounding
        return float(back.rounding - apart.min())

    y = brentq(lambda y: depth(y) - 2e-5, -0.03, 0.03, xtol=1e-12)
    result = own(replace(state, y=y), "left")
    assert result.status == "converged"
    shift = ((1e-3, 0.0), (0.0, 0.0))
    for side, touching_state in (
        ("left", replace(state, y=y + 1e-3, rail_shift=shift)),
        ("right", replace(state, y=y).mirrored()),
    ):
        assert not model.clears(own.mounting, touching_state, side)  # type: ignore[arg-type]
    assert model.clears(own.mounting, replace(state, y=0.1), "left")
    assert result.approach == pytest.approx(2e-5, abs=2e-6)  # along the normal, not in the section
    assert all(patch.frictional_power > 0.0 for patch in result.patches)


def test_open_and_impossible_contacts_say_so() -> None:
    state = touching(2e-5, 0.03, 0.0)
    for y, yaw in ((0.02, 0.03), (5e-3, 0.03), (0.0, 0.0)):
        assert contact()(replace(state, y=y, yaw=yaw), "left").status == "separated"

    assert "as wide as its edge" in contact()(replace(state, y=state.y - 4e-3), "left").status
    above = replace(state, y=-0.045, z=0.05 - 1e-5)
    assert contact()(above, "left").status == "failed: the flange is on top of the check rail"


def test_the_back_of_a_profile() -> None:
    """Of the drawing of S1002: rounding of 20.5 mm about a point 9.519 mm beyond the rolling circle."""
    back = FlangeBack.of(load_profile("S1002", "wheel"), -0.070)
    assert (back.y, back.height, back.rounding) == pytest.approx((-0.070, 9.519e-3, 20.5e-3), abs=1e-6)
    with pytest.raises(ValueError, match="begins at y = -70 mm, not on the flange's back"):
        FlangeBack.of(load_profile("S1002", "wheel"), -0.072)
