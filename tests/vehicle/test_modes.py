"""Linear modes against closed forms, Lagrange's equations and decaying runs."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from lagrange import Energies
from plane import MIRROR
from scipy.linalg import eigvals
from standin_contact import CONTACT

from benchmarks.exudyn.linear_contact import LinearContact
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.plane_wagon import COORDINATES, COUNT, wagon_dynamics
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.simulation.time_run import Recording
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.steady.modes import Mode, held_wheelset_modes, modes
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

WAGON = Wagon()
SPRINGS = LinearContact(WAGON.wheel_load)

# Derived modes of the plane model above a held wheelset, design data of this project: a linear model with the pendulum
# moment of the car body alone. Lower sway, bounce, upper sway, bounce, roll and lateral motion of the bogie.
FREQUENCY = [0.632, 1.080, 1.153, 7.43, 9.61, 12.68]
DAMPING = [0.21, 0.14, 0.38, 0.24, 0.32, 0.15]


def eigenvalues(mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray) -> np.ndarray:
    """Of the quadratic problem, those with an imaginary part that is not negative, the slowest first."""
    n, one = len(mass), np.eye(len(mass))
    values = eigvals(
        np.block([[np.zeros((n, n)), one], [-stiffness, -damping]]), np.block([[one, 0 * one], [0 * one, mass]])
    )
    values = values[values.imag >= 0.0]
    return values[np.argsort(np.abs(values))]


def textbook(*, pendulum: bool) -> np.ndarray:
    """Eigenvalues of car body and bogie on linear springs, with the moment of the car body's weight or none."""
    w = WAGON.plane
    body, bogie = w.car_body, w.bogie
    mass = np.diag([body.mass, body.mass, body.roll_inertia, bogie.mass, bogie.mass, bogie.roll_inertia])
    damping, stiffness = np.zeros((6, 6)), np.zeros((6, 6))
    for stage, upper in ((w.secondary, 1.0), (w.primary, 0.0)):
        h, sign = stage.spring_height, 2 * upper - 1.0
        aside = np.array([upper, 0, -upper * (h - body.height), -sign, 0, sign * (h - bogie.height)])
        above = np.array([0, upper, 0, 0, -sign, 0])
        turned = np.array([0, 0, upper, 0, 0, -sign])
        for row, k, c in (
            (aside, stage.lateral_stiffness, stage.lateral_damping),
            (above, stage.vertical_stiffness, stage.vertical_damping),
            (stage.spring_y * turned, stage.vertical_stiffness, stage.vertical_damping),
        ):
            stiffness += 2 * k * np.outer(row, row)
            damping += 2 * c * np.outer(row, row)
        if upper:
            stiffness += (w.roll_bar + 2 * stage.bending_stiffness) * np.outer(turned, turned)
    if pendulum:
        stiffness[2, 2] -= w.gravity * body.mass * (body.height - w.secondary.spring_height)
    return eigenvalues(mass, damping, stiffness)


@cache
def linear() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return Energies.of(WAGON, SPRINGS).linear()


def values(found: list[Mode]) -> np.ndarray:
    return np.array([m.eigenvalue for m in found])


def test_held_wheelset_without_weight_is_the_textbook_model() -> None:
    """And that model with a pendulum moment is the one that the design data give."""
    found = held_wheelset_modes(wagon_dynamics(replace(WAGON, gravity=1e-9), Track(), CONTACT, 1.0))
    np.testing.assert_allclose(values(found), textbook(pendulum=False), rtol=1e-7)
    design = textbook(pendulum=True)
    np.testing.assert_allclose(np.abs(design) / 2 / np.pi, FREQUENCY, rtol=6e-4)
    np.testing.assert_allclose(-design.real / np.abs(design), DAMPING, atol=6e-3)


def test_held_wheelset_with_the_loads_in_their_displaced_position() -> None:
    """Second derivatives of the energies; the inverted pendulum of the bogie lowers the frequency of the lower sway
    mode.
    """
    found = held_wheelset_modes(wagon_dynamics(WAGON, Track(), CONTACT, 1.0))
    np.testing.assert_allclose(values(found), eigenvalues(*(m[:6, :6] for m in linear())), rtol=1e-7)
    design = np.abs(textbook(pendulum=True)) / 2 / np.pi
    assert [m.frequency for m in found][1::2] == pytest.approx(design[[1, 3, 5]], rel=6e-3)
    assert 0.93 * design[0] < found[0].frequency < 0.96 * design[0]
    assert np.abs(found[0].shape[6:]).max() == 0.0


def test_contact_springs() -> None:
    """All nine against the energies; the three vertical ones are those of a chain of masses, springs and dampers."""
    found = modes(wagon_dynamics(WAGON, Track(), SPRINGS, 30.0))
    np.testing.assert_allclose(values(found), eigenvalues(*linear()), rtol=2e-8)
    w = WAGON.plane
    ends = np.array([[1.0, -1.0, 0.0], [0.0, 1.0, -1.0], [0.0, 0.0, 1.0]])
    pairs = ((w.secondary.vertical_stiffness, w.secondary.vertical_damping),)
    pairs += ((w.primary.vertical_stiffness, w.primary.vertical_damping), SPRINGS.vertical)
    stiffness, damping = (2 * ends.T @ np.diag(v) @ ends for v in zip(*pairs, strict=True))
    chain = eigenvalues(np.diag([w.car_body.mass, w.bogie.mass, w.wheelset.mass]), damping, stiffness)
    vertical = [m for m in found if m.energy_fraction[[1, 4, 7]].sum() > 1 - 1e-9]
    np.testing.assert_allclose(values(vertical), chain, rtol=1e-8)
    # The wheelset is nearly decoupled: sqrt(k / m) on springs of contact and primary suspension.
    alone = np.sqrt(2 * (SPRINGS.vertical[0] + w.primary.vertical_stiffness) / w.wheelset.mass) / 2 / np.pi
    assert vertical[2].frequency == pytest.approx(alone, rel=2e-4)
    assert vertical[2].main_coordinates.startswith("wheelset_z")


@pytest.mark.parametrize(
    ("contact", "moving"), [(SPRINGS, "car_body_y"), (SPRINGS, "bogie_z"), (CONTACT, "bogie_z"), (CONTACT, "bogie_y")]
)
def test_a_small_motion_decays_as_its_mode(contact, moving: str) -> None:  # type: ignore[no-untyped-def]
    """Logarithmic decrement and frequency of a run from a mode's shape, by a recurrence over three rows."""
    dynamics = wagon_dynamics(WAGON, Track(), contact, 30.0)
    rest = equilibrium(dynamics, tolerance=1e-10)
    mode = next(m for m in modes(dynamics, rest) if m.oscillates and m.main_coordinates.startswith(moving))
    start = rest.state + 1e-5 * np.concatenate([mode.shape, mode.eigenvalue * mode.shape]).real
    every = 0.08 / mode.frequency
    settings = StepSettings("ode45", 1e-7, 1e-11)
    history = simulate(dynamics, (0.0, 8 * every), initial=start, steps=settings, recording=Recording(every))
    signal = history.state[:, COORDINATES.index(moving)] - rest.state[COORDINATES.index(moving)]
    a, b = np.linalg.lstsq(np.stack([signal[1:-1], signal[:-2]], axis=1), signal[2:], rcond=None)[0]
    measured = np.log(max(np.roots([1.0, -a, -b]), key=np.imag)) / every
    assert measured == pytest.approx(mode.eigenvalue, rel=1e-4)


@pytest.mark.parametrize("speed", [10.0, 30.0, 45.0])
def test_creep_damps_the_wheelset(speed: float) -> None:
    """Spin: J w' = -2 f r^2 w / V. Lateral motion with stiff creep: nearly decoupled from the other bodies."""
    found = modes(wagon_dynamics(WAGON, Track(), CONTACT, speed))
    assert len(found) == 7 + 4
    spin = next(m for m in found if m.main_coordinates.startswith("wheelset_pitch"))
    creep = CONTACT.model.creep  # type: ignore[attr-defined]
    assert not spin.oscillates
    assert spin.damping == 1.0
    assert spin.eigenvalue.real == pytest.approx(-2 * creep * 0.46**2 / (112.0 * speed), rel=2e-3)
    fast = next(m for m in found if not m.oscillates and m.main_coordinates.startswith("wheelset_y"))
    assert fast.eigenvalue.real == pytest.approx(-2 * creep / (1813.0 * speed), rel=0.25)
    slow = found[0]
    assert not slow.oscillates
    assert "wheelset_y" in slow.main_coordinates
    assert all(m.eigenvalue.real < 0.0 for m in found)


def test_mode_shapes_are_eigenvectors_with_symmetry() -> None:
    mass, damping, stiffness = linear()
    for mode in modes(wagon_dynamics(WAGON, Track(), SPRINGS, 30.0)):
        x, v = mode.shape[:9], mode.eigenvalue
        left = v * v * mass @ x + v * damping @ x + stiffness @ x
        assert np.abs(left).max() < 2e-7 * max(np.abs(stiffness @ x).max(), np.abs(v * v * mass @ x).max())
        assert np.abs(mode.shape).max() == pytest.approx(1.0)
        assert mode.energy_fraction.sum() == pytest.approx(1.0)
        even = MIRROR[:COUNT] > 0
        assert min(mode.energy_fraction[even].sum(), mode.energy_fraction[~even].sum()) < 1e-12


def test_text_of_a_mode() -> None:
    found = held_wheelset_modes(wagon_dynamics(WAGON, Track(), CONTACT, 1.0))
    assert str(found[1]) == "     1.08 Hz  damping  0.1345  car_body_z 100%"
