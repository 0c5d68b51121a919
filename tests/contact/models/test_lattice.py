"""Contact on a lattice of strips: exact derivatives, Hertz, the same answer from any start, and tangents."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from wheelrail.contact.analytical.hertz import Hertz, hertz, modulus
from wheelrail.contact.kinematics.frames import RigidMotion, Twist
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.laws.friction import FallingFriction, FrictionLaw, Stribeck
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.builders import hertz_pair, wheel_rail_pair
from wheelrail.contact.models.discretisation import Bodies, Discretisation
from wheelrail.contact.models.lattice.influence.basis import strip_basis
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.lattice.state import LatticeState
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.meshes.profiles.named import named_profile

STEEL = Material()
RADII, LOAD = (0.46, 0.30), 60e3
RADIUS, SPEED = 0.46, 20.0
TIGHT = 1e-8  # of the last Newton step
# windows of lateral positions m and heights m per m: tread, merging, birth of a second patch, flange
SWEEPS = {
    "tread": (-5.455e-3, -0.35296e-3, 0.012),
    "merging": (-0.480e-3, -0.2846e-3, 0.02),
    "birth": (4.790e-3, 0.1296e-3, 0.14),
    "flange": (6.430e-3, 0.602e-3, 0.4),
}


def flowing(xi: float = 0.0, eta: float = 0.0, phi: float = 0.0) -> RigidMotion:
    half, turn = 0.5 * np.array([xi, eta, 0.0]), np.array([0.0, 0.0, 0.5 * phi])
    back, origin = np.array([-1.0, 0.0, 0.0]), np.zeros(3)
    return RigidMotion(Twist(back + half, turn, origin), Twist(back - half, -turn, origin))


def exact() -> Hertz:
    return hertz(0.5 / RADII[0], 0.5 / RADII[1], modulus((STEEL.E, STEEL.nu), (STEEL.E, STEEL.nu)), force=LOAD)


def ellipse(friction: float = 0.0, **choices: Any) -> LatticeContact:
    how = Discretisation(1e-3, bodies="half-space", points="lattice", **choices)
    model = hertz_pair((RADII, (np.inf, np.inf)), (STEEL, STEEL), ContactLaws(friction=friction), how, load=LOAD)
    assert isinstance(model, LatticeContact)
    return model


@cache
def wheelset(friction: float | FrictionLaw, bodies: Bodies = "half-space") -> WheelsetContact:
    wheel, rail = named_profile("S1002"), named_profile("UIC60-benchmark")
    how = Discretisation(1e-3, bodies=bodies, points="lattice")
    laws = ContactLaws(friction=friction)
    model = replace(wheel_rail_pair((wheel, rail), RADIUS, (STEEL, STEEL), laws, how), tolerance=TIGHT)
    return WheelsetContact(model, Mounting(0.75, rail.gauge_offset(1.435, 0.014), RADIUS))


def rolling(y: float, z: float, yaw: float = 0.0, creepage: float = 0.0) -> WheelsetState:
    return WheelsetState(y=y, z=z, yaw=yaw, speed=SPEED, pitch_rate=SPEED / RADIUS * (1 + creepage))


def start(result: ContactResult) -> LatticeState:
    assert isinstance(result.warm_start, LatticeState)
    return result.warm_start


def test_modes_vanish_at_the_ends_and_carry_their_load() -> None:
    basis = strip_basis(10, rolling=True)
    length = 2 * np.diff(basis.marks)
    for values in (basis.mean, basis.loads):
        np.testing.assert_allclose(length @ values, [0.5 * np.pi, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(basis.moments.sum(axis=1), [1, 0, 0, 0, 0], atol=1e-12)
    middle = 0.5 * (basis.row_marks[1:] + basis.row_marks[:-1])
    antiderivative = np.concatenate([[0.0], np.cumsum(middle**2 * np.diff(basis.row_marks))])
    slip = [weight @ antiderivative[k : k + 4] for k, weight in enumerate(basis.slip_edges)]
    np.testing.assert_allclose(slip, -2 * middle[:-2], atol=1e-12)


@pytest.mark.parametrize("y", SWEEPS)
@pytest.mark.parametrize("friction", [0.0, 0.6])
def test_jacobian_of_all_unknowns(y: str, friction: float) -> None:
    """Ends, modes and tractions together, away from the solution, against differences of the residual."""
    place, height, _ = SWEEPS[y]
    contact = wheelset(friction)
    assert isinstance(contact.model, LatticeContact)
    state = rolling(place, height, 5e-3)
    problem = contact.model.problem(*contact.mounting.left_pair(state))
    found = start(contact(state, "left"))
    random = np.random.default_rng(1)
    scale = np.ones(found.values.shape) * 1e6
    scale[:, -2:] = 1e-6
    at = LatticeState(found.strips, found.values + scale * random.standard_normal(scale.shape))
    _, jacobian, rho = problem.linearise(at)
    direction = (scale * random.standard_normal(scale.shape)).ravel()
    step = 1e-3
    ahead, behind = (
        problem.evaluate(
            LatticeState(at.strips, at.values + sign * step * direction.reshape(scale.shape)), rho
        ).residual.ravel()
        for sign in (1, -1)
    )
    expected = (ahead - behind) / (2 * step)
    for rows in (np.arange(len(expected)) % scale.shape[1] < scale.shape[1] - 5, slice(None)):
        if np.any(expected[rows]):
            error = np.abs((jacobian @ direction)[rows] - expected[rows]).max()
            assert error < 2e-5 * np.abs(expected[rows]).max()


def test_hertz() -> None:
    """Peak and semi-axes within 1 %, and an error of the force of high order in the width of the strips."""
    errors = []
    for strips in (8, 16, 32):
        result = ellipse(strips=strips, cells=20)(hertz_pose(exact().approach), flowing(), None)
        patch = result.patches[0]
        assert patch.max_pressure == pytest.approx(exact().peak, rel=5e-3)
        np.testing.assert_allclose(patch.semi_axes, exact().semi_axes, rtol=0.01)
        errors.append(abs(result.force[2] / LOAD - 1))
    assert errors[0] < 2e-3
    assert errors[1] < 6e-4
    assert errors[2] < 1e-4


def test_rolling_ellipse() -> None:
    """Forces within half a per cent of a lattice twice as fine."""
    for motion in (flowing(4e-4, 2e-4, 0.1), flowing(3e-3), flowing(0.0, 0.0, 1.0)):
        coarse, fine = (
            ellipse(0.3, strips=strips, cells=cells)(hertz_pose(exact().approach), motion, None)
            for strips, cells in ((16, 10), (32, 20))
        )
        np.testing.assert_allclose(coarse.force, fine.force, atol=5e-3 * 0.3 * LOAD)


@pytest.mark.parametrize(("friction", "yaw"), [(0.0, 0.0), (0.3, 15e-3), (0.6, 5e-3)])
@pytest.mark.parametrize("sweep", SWEEPS)
def test_force_is_a_function_of_the_pose(sweep: str, friction: float, yaw: float) -> None:
    """From the neighbour in a sweep of 5 um, from a pose 0.3 mm away, and from none: 1e-6 of the load."""
    y, z, slope = SWEEPS[sweep]
    contact = wheelset(friction)
    earlier = contact(rolling(y, z, yaw), "left")
    far = contact(rolling(y - 3e-4, z - 3e-4 * slope, yaw), "left")
    for k in range(1, 4):
        state = rolling(y + 5e-6 * k, z + 5e-6 * k * slope, yaw)
        earlier = contact(state, "left", earlier)
        others = [contact(state, "left", guess) for guess in (None, far)]
        assert earlier.status == "converged"
        for other in others:
            np.testing.assert_allclose(other.force, earlier.force, atol=1e-6 * np.linalg.norm(earlier.force))
            np.testing.assert_array_equal(start(other).strips, start(earlier).strips)


@pytest.mark.parametrize(
    ("friction", "y", "z", "yaw"),
    [
        (0.8, 8.0e-3, 3.398e-3, 15e-3),  # a long strip enters beside loaded ones
        (0.8, 0.0, -0.482e-3, 0.0),  # coupled friction of the cold start's cells does not converge
    ],
)
def test_loads_up_to_a_meganewton(friction: float, y: float, z: float, yaw: float) -> None:
    """Approaches of 0.3 and 0.5 mm, with the same force from a pose 0.3 mm away."""
    contact = wheelset(friction)
    state = rolling(y, z, yaw)
    result, near = contact(state, "left"), contact(rolling(y - 3e-4, z, yaw), "left")
    assert result.status == near.status == "converged"
    assert np.linalg.norm(result.force) > 6e5
    np.testing.assert_allclose(contact(state, "left", near).force, result.force, rtol=0, atol=1e-6 * 6e5)


def test_strips_come_and_go_without_a_jump() -> None:
    """Second differences of the force over the birth of strips, over steps of 5 um."""
    y, z, slope = SWEEPS["birth"]
    contact = wheelset(0.0)
    forces, counts, result = [], [], None
    for k in range(16):
        result = contact(rolling(y + 5e-6 * k, z + 5e-6 * k * slope), "left", result)
        forces.append(result.force[2])
        counts.append(len(start(result).strips))
    assert len(set(counts)) > 1
    assert np.abs(np.diff(forces, 2)).max() < 2e-4 * forces[-1]


KEYS = ("y", "z", "roll", "yaw", "y_rate", "z_rate", "roll_rate", "pitch_rate")


@pytest.mark.parametrize(
    ("friction", "bodies", "place"),
    [
        (0.0, "half-space", (-5e-3, -0.34e-3, 5e-3)),
        (0.3, "half-space", (-5e-3, -0.34e-3, 5e-3)),
        (0.3, "half-space", (4.93e-3, 0.132e-3, 2e-3)),
        (0.6, "half-space", (6.5e-3, 0.62e-3, 15e-3)),
        (0.3, "waveguide", (4.93e-3, 0.132e-3, 2e-3)),
        (0.3, "waveguide", (6.5e-3, 0.62e-3, 15e-3)),
    ],
)
def test_tangent(friction: float, bodies: Bodies, place: tuple[float, float, float]) -> None:
    """Central differences over 0.2 um to 1e-4 of the largest entry of a row, moving ends included."""
    contact = wheelset(friction, bodies)
    state = replace(rolling(*place), y_rate=0.01, frame_rate=(0.0, 0.0, SPEED / 600))
    result = contact(state, "left")
    found = contact.tangent(state, "left", result)
    expected = np.zeros((6, 8))
    for k, key in enumerate(KEYS):
        step = 2e-7 if k < 4 else 2e-4
        ahead, behind = (
            contact(replace(state, **{key: getattr(state, key) + sign * step}), "left", result) for sign in (1, -1)
        )
        expected[:, k] = np.concatenate([ahead.force - behind.force, ahead.moment - behind.moment]) / (2 * step)
    rows = slice(1, None) if friction == 0 else slice(None)  # no longitudinal force without friction
    error = np.abs(found - expected)[rows] / np.abs(expected[rows]).max(axis=1, keepdims=True)
    assert error.max() < 1e-4
    if friction:
        rates = np.abs(found - expected)[:, 4:] / np.abs(expected[:, 4:]).max(axis=1, keepdims=True)
        assert rates.max() < 1e-3


def test_finite_bodies_from_any_start() -> None:
    contact = wheelset(0.3, "waveguide")
    y, z, slope = SWEEPS["birth"]
    earlier = contact(rolling(y, z, 5e-3), "left")
    state = rolling(y + 5e-6, z + 5e-6 * slope, 5e-3)
    from_earlier, from_none = contact(state, "left", earlier), contact(state, "left")
    np.testing.assert_allclose(from_earlier.force, from_none.force, atol=1e-6 * np.linalg.norm(from_none.force))


def test_falling_friction_reduces_the_force() -> None:
    falling = wheelset(FallingFriction(0.3, 0.4, 0.3))
    state = rolling(-5e-3, -0.34e-3, creepage=0.02)
    less, more = (contact(state, "left") for contact in (falling, wheelset(0.3)))
    limit = 0.3 * ((1 - 0.4) * np.exp(-0.3 * 0.02 * SPEED) + 0.4)
    assert np.hypot(*less.force[:2]) < np.hypot(*more.force[:2])
    assert np.hypot(*less.force[:2]) / less.force[2] == pytest.approx(limit, rel=0.02)


def test_right_wheel_is_the_mirror_image() -> None:
    contact = wheelset(0.3)
    state = rolling(4.8e-3, 0.131e-3, 2e-3)
    left, right = contact(state, "left"), contact(state.mirrored(), "right")
    np.testing.assert_allclose(right.force, left.force * [1, -1, 1], rtol=1e-12)


def test_no_contact_and_laws_that_do_not_fit() -> None:
    assert wheelset(0.3)(rolling(0.0, 1e-3), "left").status == "separated"
    with pytest.raises(ValueError, match="exact normal law"):
        replace(ellipse(), laws=ContactLaws.penalty())
    with pytest.raises(ValueError, match="at least 4"):
        ellipse(strips=3)


def test_own_law_agrees_with_fitted_cells() -> None:
    """Creep force of a law of Stribeck's on an ellipse, within the errors of both discretisations."""
    law, load = ContactLaws(friction=Stribeck(0.4, 0.2, 0.05)), exact()
    forces = []
    for points in ("lattice", "fitted"):
        how = Discretisation(1e-3, bodies="half-space", points=points)  # type: ignore[arg-type]
        model = hertz_pair((RADII, (np.inf, np.inf)), (STEEL, STEEL), law, how, load=LOAD)
        motion = flowing(-2e-3, 1e-3, 0.1)
        fast = RigidMotion(
            *(replace(t, velocity=20.0 * t.velocity, rotation=20.0 * t.rotation) for t in (motion.wheel, motion.rail))
        )
        forces.append(model(hertz_pose(load.approach), fast, None).force)
    np.testing.assert_allclose(forces[0], forces[1], atol=0.005 * 0.4 * LOAD)
