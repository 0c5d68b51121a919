"""The tangent of contact forces against central differences of the forces, for constant sets."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from small_pairs import AT_REST, CREEP, STEEL, TETRAHEDRA, condensed, rolling
from small_wheelset import MOUNTING, STATE, model

from wheelrail.contact.elasticity.compliance import Compliance
from wheelrail.contact.geometry.contact_operators import ContactOperators
from wheelrail.contact.kinematics.frames import SIDES, Pose, RigidMotion, Side, Twist
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.laws.friction import FallingFriction
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models import condensed as condensed_module
from wheelrail.contact.models.condensed import CondensedContact
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.solvers.options import NewtonOptions
from wheelrail.support.arrays import Array

SIZE = 1e-3
POSE = replace(hertz_pose(1.9e-5), origin=np.array([1e-4, -7e-5, -1.9e-5]))  # some 27 nodes carry pressure
SHARP = NewtonOptions(tolerance=1e-12)
ALUMINIUM = Material(70e9, 0.2)
FAST = rolling(3e-3, 1e-3, 1.0)
# of each kind of change: translation, rotation (which only moves a motion's reference), velocity, rotation rate
STEPS = np.repeat([1e-9, 1e-4, 1e-5, 1e-4], 3)
STATES = WheelsetState.coordinates


def pair(laws: ContactLaws, steel: Material = STEEL) -> CondensedContact:
    return replace(
        condensed(TETRAHEDRA, (0.3, 0.4), size=SIZE, laws=laws, steels=(STEEL, steel)),
        options=SHARP,
    )


def nudged(pose: Pose, motion: RigidMotion, change: Array) -> tuple[Pose, RigidMotion]:
    """Translated, rotated about the origin of the wheel's frame with the motion's reference, and with changed
    velocities.
    """
    turn, wheel = Rotation.from_rotvec(change[3:6]).as_matrix(), motion.wheel
    origin = pose.origin + change[:3]
    reference = origin + turn @ (wheel.reference - pose.origin)
    moved = Twist(wheel.velocity + change[6:9], wheel.rotation + change[9:], reference)
    return replace(pose, origin=origin, rotation=turn @ pose.rotation), replace(motion, wheel=moved)


def sides_of_the_laws(result: ContactResult, laws: ContactLaws) -> tuple[bytes, ...]:
    """Which nodes carry pressure, and which of them slide."""
    fields = result.fields
    assert fields is not None
    active = fields.pressure > 0
    slides = np.hypot(*fields.slip[active].T) > max(laws.regularisation, 1e-11)
    return fields.node[active].tobytes(), slides.tobytes()


def differences(solve: Callable[[Array], ContactResult], steps: Array, laws: ContactLaws) -> Array:
    """Central differences (6, m) of force and moment, with an assertion that no node changes sides of a law."""
    before = sides_of_the_laws(solve(np.zeros(len(steps))), laws)
    columns = []
    for j, step in enumerate(steps):
        ends = [solve(sign * step * np.eye(len(steps))[j]) for sign in (1, -1)]
        assert all(sides_of_the_laws(end, laws) == before for end in ends)
        there, back = (np.concatenate([end.force, end.moment]) for end in ends)
        columns.append((there - back) / (2 * step))
    return np.array(columns).T


def assert_close(found: Array, expected: Array, rtol: float, *, group: int = 3) -> None:
    """To a part of the largest entry: forces and moments, and every kind of change, by themselves."""
    for rows in (slice(0, 3), slice(3, 6)):
        for first in range(0, found.shape[1], group):
            block = rows, slice(first, first + group)
            np.testing.assert_allclose(found[block], expected[block], atol=rtol * np.abs(expected[block]).max() + 1e-30)


@pytest.mark.parametrize("steel", [STEEL, ALUMINIUM], ids=["alike", "unlike"])
@pytest.mark.parametrize(
    ("laws", "motion"),
    [
        pytest.param(ContactLaws(friction=0.0), AT_REST, id="frictionless"),
        pytest.param(ContactLaws.penalty(0.0), AT_REST, id="penalty"),
        pytest.param(ContactLaws(), CREEP, id="partial slip"),
        pytest.param(ContactLaws.penalty(), CREEP, id="paper"),
        pytest.param(ContactLaws(friction=50.0), CREEP, id="stick"),
        pytest.param(ContactLaws(), rolling(2e-2, 1e-2, 3.0), id="sliding"),
        pytest.param(ContactLaws(friction=FallingFriction(0.3, 0.4, 2.0)), FAST, id="falling"),
        pytest.param(
            ContactLaws(regularisation=3e-3, friction=FallingFriction(0.3, 0.4, 20.0)), FAST, id="falling, regularised"
        ),
    ],
)
def test_pair_of_paraboloids(laws: ContactLaws, motion: RigidMotion, steel: Material) -> None:
    contact = pair(laws, steel)
    result = contact(POSE, motion)
    expected = differences(lambda change: contact(*nudged(POSE, motion, change), result), STEPS, laws)
    assert_close(result.tangent(), expected, 1e-5)


@pytest.mark.parametrize("steel", [STEEL, ALUMINIUM], ids=["alike", "unlike"])
def test_shift(steel: Material) -> None:
    # displacements of some micrometres, most of the patch slides: by m and rad of the shift
    contact = replace(pair(ContactLaws(), steel), tangential="shift")
    still = np.zeros(3)
    motion = RigidMotion(
        Twist(np.array([2e-6, 1e-6, 0.0]), np.array([0.0, 0.0, 1e-4]), still), Twist(still, still, still)
    )
    steps = np.repeat([1e-9, 1e-3, 1e-10, 1e-7], 3)
    result = contact(POSE, motion)
    expected = differences(lambda change: contact(*nudged(POSE, motion, change), result), steps, contact.laws)
    assert_close(result.tangent(), expected, 1e-5)
    patch = result.patches[0]
    assert 0 < patch.stick_area < patch.area


@pytest.fixture
def held(monkeypatch: pytest.MonkeyPatch) -> None:
    """The compliance as of the first pose: rail points that move between coarse nodes change it by some per mille."""
    known: dict[int, tuple[Array, Array]] = {}
    original = condensed_module.condense

    def first(coupling: ContactOperators, compliance: Compliance) -> tuple[Array, Array]:
        if id(compliance) not in known:
            known[id(compliance)] = original(coupling, compliance)
        displacement, slip = known[id(compliance)]
        return displacement.copy(), slip.copy()

    monkeypatch.setattr(condensed_module, "condense", first)


WHEEL_LAWS = {
    "frictionless": ContactLaws(friction=0.0),
    "exact": ContactLaws(),
    "paper": ContactLaws.penalty(),
    "falling": ContactLaws(regularisation=1e-3, friction=FallingFriction(0.3, 0.4, 2.0)),
}


@pytest.mark.usefixtures("held")
@pytest.mark.parametrize("name", list(WHEEL_LAWS))
def test_wheel_on_rail(name: str) -> None:
    laws = WHEEL_LAWS[name]
    contact = replace(model(laws), options=SHARP)
    pose, motion = MOUNTING.left_pair(STATE)
    result = contact(pose, motion)
    expected = differences(
        lambda change: contact(*nudged(pose, motion, change), result), np.repeat([1e-9, 1e-8, 1e-4, 1e-4], 3), laws
    )
    assert_close(result.tangent(), expected, 1e-6)


def test_velocities_of_a_wheel_on_a_rail() -> None:
    # these leave the compliance as it is
    contact = replace(model(ContactLaws()), options=SHARP)
    pose, motion = MOUNTING.left_pair(STATE)
    result = contact(pose, motion)

    def solve(change: Array) -> ContactResult:
        return contact(*nudged(pose, motion, np.concatenate([np.zeros(6), change])), result)

    assert_close(result.tangent()[:, 6:], differences(solve, np.full(6, 1e-4), ContactLaws()), 1e-6)


@pytest.mark.usefixtures("held")
@pytest.mark.parametrize("side", SIDES)
def test_wheelset(side: Side) -> None:
    contact = WheelsetContact(replace(model(ContactLaws()), options=SHARP), MOUNTING)
    state = STATE if side == "left" else STATE.mirrored()  # the same nodes of the wheel

    def solve(change: Array) -> ContactResult:
        moved = {name: getattr(state, name) + float(c) for name, c in zip(STATES, change, strict=True)}
        return contact(replace(state, **moved), side)

    result = solve(np.zeros(9))
    steps = np.array([1e-9, 1e-9, 1e-8, 1e-8, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4])
    expected = differences(solve, steps, ContactLaws())
    assert_close(contact.tangent(state, side, result), expected, 2e-6, group=1)


def test_point_of_reference_and_mirror() -> None:
    result = pair(ContactLaws())(POSE, CREEP)
    centre, other = np.array([0.1, -0.7, 0.5]), np.array([-0.2, 0.4, 0.1])
    tangent, there = result.tangent(), result.about(centre).tangent()
    np.testing.assert_allclose(there[:3], tangent[:3])
    np.testing.assert_allclose(there[3:], tangent[3:] - np.cross(centre, tangent[:3], axisb=0).T)
    np.testing.assert_array_equal(result.mirrored().mirrored().tangent(), tangent)
    seen = np.array([1.0, -1.0, 1.0])
    turned_round = result.about(centre + seen * other).mirrored()
    np.testing.assert_allclose(result.about(centre).mirrored().about(other).tangent(), turned_round.tangent())
    signs = np.concatenate([seen, -seen])
    np.testing.assert_array_equal(
        result.mirrored().tangent(), signs[:, None] * tangent * np.concatenate([signs, signs])
    )


def test_only_on_request_and_kept_by_copies() -> None:
    result = pair(ContactLaws())(POSE, CREEP)
    assert result.force_tangent is not None
    assert "matrix" not in vars(result.force_tangent.of)
    copy = pickle.loads(pickle.dumps(result.about(np.ones(3))))
    np.testing.assert_array_equal(copy.tangent(), result.about(np.ones(3)).tangent())
    assert result.about(np.ones(3)).force_tangent.of is result.force_tangent.of  # solved for once
    np.testing.assert_array_equal(replace(result, approach=1.0).tangent(), result.tangent())
    assert "linearised" not in repr(result)


def test_no_contact_and_no_tangent() -> None:
    contact = WheelsetContact(model(ContactLaws()), MOUNTING)
    high = replace(STATE, z=1e-3)
    assert contact(high, "left").status == "separated"
    assert not contact.tangent(high, "left", contact(high, "left")).any()
    with pytest.raises(ValueError, match="no tangent"):
        ContactResult.failed("it slid off").tangent()
    standing = replace(STATE, pitch_rate=0.0, speed=0.0)
    with pytest.raises(ValueError, match="roll"):
        contact.tangent(standing, "left", contact(standing, "left"))
