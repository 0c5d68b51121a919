"""Contacts that few strips or cells must not lose, and pressure without tension on them."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from wheelrail.bindings._contact import MODES, LatticeStart, moved
from wheelrail.contact.analytical.hertz import hertz, modulus
from wheelrail.contact.geometry.strip_lattice import cells_along
from wheelrail.contact.geometry.strip_surfaces import QuadricStrips
from wheelrail.contact.kinematics.frames import RigidMotion, Twist
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.builders import hertz_pair, wheel_rail_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.meshes.profiles.named import named_profile

SPEED, RADIUS = 20.0, 0.46


@cache
def wheelset(strips: int, cells: int, friction: float) -> WheelsetContact:
    rail = named_profile("UIC60-benchmark")
    how = Discretisation(1e-3, bodies="half-space", strips=strips, cells=cells)
    profiles, steels = (named_profile("S1002"), rail), (Material(), Material())
    model = wheel_rail_pair(profiles, RADIUS, steels, ContactLaws(friction=friction), how)
    return WheelsetContact(model, Mounting(0.75, rail.gauge_offset(1.435, 0.014), RADIUS))


def at(y: float, z: float) -> WheelsetState:
    return WheelsetState(y=y, z=z, speed=SPEED, pitch_rate=SPEED / RADIUS)


def solved(contact: WheelsetContact, z: float) -> ContactResult:
    return contact(at(9.4e-3, z), "left")


def test_a_sharp_flange_contact_is_found_on_four_strips() -> None:
    """Its force falls to zero as on 14 strips; until 2026-11-26 four of these heights were separated."""
    few, many = wheelset(4, 6, 0.0), wheelset(14, 12, 0.0)
    heights = 7.94e-3 - np.array([0.0, 3e-5, 6e-5, 8e-5, 1e-4, 1.4e-4, 1.8e-4, 2.2e-4])
    forces = np.array([[solved(contact, z).force[2] for contact in (few, many)] for z in heights])
    assert np.all((forces[:, 0] > 0) == (forces[:, 1] > 0))
    assert (forces[:, 0] > 0).sum() >= 5
    np.testing.assert_allclose(*forces.T, atol=0.01 * forces.max())


def test_a_load_that_must_not_fall_to_zero() -> None:
    """Where the penetration does not vary across, a full step that makes the load negative leaves a part of it: from no
    load the next step divided by zero.
    """
    whole = np.zeros(1)
    values = np.array([[1e8, 0.0, 0.0, 0.0, -1e-3, 1e-3]])
    step = np.array([[-3e8, 0.0, 0.0, 0.0, 0.0, 0.0]])
    for _ in range(2):
        values = moved(values, step, 1.0, whole)
        assert values[0, -2 - MODES] > 0
        assert np.isfinite(values).all()


def test_tension_is_solved_on_more_cells() -> None:
    """A solution that counts as one with tension is replaced by that on twice as many cells, and is the start at the
    next pose.
    """
    usual, state = wheelset(6, 6, 0.3), at(2e-3, -1.5e-4)
    assert isinstance(usual.model, LatticeContact)
    contact = replace(usual, model=replace(usual.model))
    contact.model._setting.least_pressure = np.inf
    six, twelve = usual(state, "left"), wheelset(6, 12, 0.3)(state, "left")
    found = contact(state, "left")
    assert found.fields is not None
    assert twelve.fields is not None
    assert found.fields.pressure.min() >= 0
    np.testing.assert_allclose(found.force, twelve.force, rtol=1e-6)
    assert not np.allclose(found.force, six.force, rtol=1e-6)
    again = contact(state, "left", found)
    np.testing.assert_allclose(again.force, found.force, rtol=1e-6)
    expected = wheelset(6, 12, 0.3).tangent(state, "left", twelve)
    np.testing.assert_allclose(contact.tangent(state, "left", found), expected, atol=1e-5 * np.abs(expected).max())
    for model in contact.model._finer:
        model._setting.least_pressure = np.inf
    status = contact(state, "left").status
    assert re.fullmatch(
        r"failed: the wheel overlaps the rail \S+ mm deep at y = \S+, z = \S+ mm of its profile, "
        r"where the pressure is negative at an end of a strip, also with 12 cells, with 24 cells, on 1/2 of the width; "
        r'model = "standard" may serve',
        status,
    )


def test_tension_of_wide_contacts_is_solved_on_narrower_strips(monkeypatch: pytest.MonkeyPatch) -> None:
    """On a flange's face 0.02 to 0.13 % of the peak were tension on any number of cells."""
    contact, state = replace(wheelset(6, 6, 0.3), model=replace(wheelset(6, 6, 0.3).model)), at(2e-3, -4e-4)
    assert contact(state, "left").statistics.points > 6 * 6
    for model in (contact.model, *contact.model._finer[:-2]):
        model._setting.least_pressure = np.inf
    narrower = replace(contact, model=contact.model.on(1))(state, "left")
    monkeypatch.setattr(LatticeContact, "_check_size", lambda self, _: started.append(self.level))
    started: list[int] = []
    found = contact(state, "left")
    assert found.ok
    assert set(started) == {0}, "narrower strips start from the wider ones: those that overlap are many"
    np.testing.assert_allclose(found.force, narrower.force, rtol=1e-6)


def test_tension_that_half_the_width_does_not_lower_is_not_sought_on_a_quarter() -> None:
    """Ten times as long a solve, in vain: six strips with 29 MPa at their ends have 2.5 on half the width."""
    contact, state = replace(wheelset(6, 6, 0.3), model=replace(wheelset(6, 6, 0.3).model)), at(2e-3, -1e-4)
    for model in (contact.model, *contact.model._finer[:-1]):
        model._setting.least_pressure = np.inf
    assert contact(state, "left").status.endswith('on 1/2 of the width; model = "standard" may serve')


def test_tension_that_is_not_sought_on_narrower_strips_may_vanish_on_more(monkeypatch: pytest.MonkeyPatch) -> None:
    contact, state = replace(wheelset(6, 6, 0.3), model=replace(wheelset(6, 6, 0.3).model)), at(2e-3, -1e-4)
    monkeypatch.setattr(LatticeContact, "_finer", ())
    contact.model._setting.least_pressure = np.inf
    assert contact(state, "left").status.endswith("at an end of a strip; more strips may serve")


def test_tension_of_cells_is_found() -> None:
    """A semi-ellipse tilted by more than its mean is negative at one end."""
    contact = wheelset(6, 6, 0.0)
    problem = contact.model.problem(*contact.mounting.left_pair(at(2e-3, -1.5e-4)))
    strips, ends = np.array([3]), [-1e-3, 1e-3]
    upright, tilted = (np.array([[1e9, tilt, 0.0, 0.0, *ends]]) for tilt in (4e8, -8e8))
    assert not problem.tensile(strips, upright)
    assert problem.tensile(strips, tilted)
    assert "negative at an end of a strip" in problem.tension(strips, tilted)
    parted = np.array([[1e9, 0.0, 2e9, 0.0, *ends]])
    assert "negative between two places of a strip, which has one" in problem.tension(strips, parted)


@pytest.mark.parametrize("ratio", [0.2, 1.0, 1.4])
def test_round_and_wide_patches_have_the_cells_asked_for(ratio: float) -> None:
    assert cells_along(patch(ratio), 14) == 14


def test_patches_along_the_track_have_more_cells() -> None:
    assert cells_along(patch(6.0), 14) == 28


def patch(ratio: float) -> QuadricStrips:
    return QuadricStrips((0.46, np.inf), (np.inf, 0.3), 1e-2, (ratio * 1e-3, 1e-3))


def test_sliding_strips_have_the_bound_of_their_pressure() -> None:
    """The pressure falls so fast at an end that a linear one in its cell is negative at its edge: the bound was that of
    a larger mean, 1.3e-4 of the sum here.
    """
    contact, friction = wheelset(6, 8, 0.3), 0.3
    state = replace(at(6.937e-3, -3.598e-5), roll=2.4436e-4, yaw=1.95584e-2)
    found = contact(state, "left")
    fields = found.fields
    assert fields is not None
    bound = friction * (fields.pressure * fields.area).sum()
    assert (np.hypot(*fields.traction.T) * fields.area).sum() <= (1.0 + 1e-9) * bound
    step = 2e-8
    ends = [contact(replace(state, z=state.z + side * step), "left", found).force for side in (-1, 1)]
    tangent = contact.tangent(state, "left", found)[:3, list(state.coordinates).index("z")]
    np.testing.assert_allclose((ends[1] - ends[0]) / (2 * step), tangent, atol=1e-3 * np.abs(tangent).max())


def test_the_peak_pressure_across_strips_is_continuous() -> None:
    """On the flange root the largest strip changes; the parabola through the three at it jumped by up to 5 %."""
    contact, found = wheelset(6, 8, 0.3), []
    own, guess = contact.of("left"), None
    for y in np.arange(6.53e-3, 6.67e-3, 2e-6):
        state = WheelsetState(y=float(y), yaw=3e-3, speed=20.0, pitch_rate=20.0 / 0.46)
        for _ in range(12):
            approach = own.model.problem(*own.mounting.left_pair(state)).approach
            state = replace(state, z=state.z + approach - 1e-4)
        guess = contact(state, "left", guess)
        (patch,) = guess.patches
        found.append(patch.max_pressure)
    change = np.abs(np.diff(np.log(found)))
    jumps = change[1:-1] - np.maximum(change[:-2], change[2:])
    assert jumps.max() < 0.003


@pytest.mark.parametrize("radius", [3.0, 0.46, 0.08, 0.014], ids=["a/b 0.3", "circle", "a/b 3", "a/b 10"])
def test_peaks_of_ellipses_on_few_strips(radius: float) -> None:
    """At five places of strips of which 3.5 are across: the curve through all of them errs by up to 6 %."""
    steel, load = Material(), 5e4
    exact = hertz(0.5 / RADIUS, 0.5 / radius, modulus(*[(steel.E, steel.nu)] * 2), force=load)
    radii, how = ((RADIUS, radius), (np.inf, np.inf)), Discretisation(1e-3, bodies="half-space", strips=4, cells=10)
    model = hertz_pair(radii, (steel, steel), ContactLaws(friction=0.0), how, load=load)
    motion = RigidMotion(*[Twist(np.array([-1.0, 0.0, 0.0]), np.zeros(3), np.zeros(3))] * 2)
    errors = []
    for offset in (0.0, 0.125, 0.25, 0.375, 0.5):
        found = replace(model, offset=offset)(hertz_pose(exact.approach), motion)
        assert isinstance(found.warm_start, LatticeStart)
        assert found.warm_start.levels == [0]
        errors.append(found.patches[0].max_pressure / exact.peak - 1.0)
    assert np.abs(errors).max() < 0.025
