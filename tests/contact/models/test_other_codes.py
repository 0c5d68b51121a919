"""The plane wagon on linear contact springs against Lagrange's equations by SymPy and against Exudyn."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from lagrange import Energies
from plane import in_frame, wrench_of
from scipy.integrate import solve_ivp
from track_frame import Frame, frame_at

from benchmarks.exudyn.linear_contact import LinearContact
from benchmarks.exudyn.report import EVERY, REFERENCE, initial, ours, relative, theirs
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.plane_wagon import COORDINATES, COUNT, wagon_dynamics
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.simulation.time_run import Recording
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

WAGON = Wagon()
CONTACT = LinearContact(WAGON.wheel_load)
CURVE = Track.curve(curvature=1 / 600, cant=0.1, tangent=5.0, transition=40.0, length=100.0, gradient=0.02)
V = 40.0
Lagrange = Callable[[Frame, np.ndarray, float], np.ndarray]


@pytest.fixture(scope="module")
def lagrange() -> Lagrange:
    return Energies.of(WAGON, CONTACT).accelerations(WAGON.plane.bumpstop)


@pytest.mark.parametrize("s", [2.0, 15.0, 35.0, 80.0])
def test_equations_of_motion(lagrange: Lagrange, s: float) -> None:
    """Random states with large rolls, in a curve with varying cant on a gradient; also with prescribed frames."""
    rng = np.random.default_rng(int(s))
    dynamics = wagon_dynamics(WAGON, CURVE, CONTACT, V)
    down = rng.normal(size=3)
    rates = (x * rng.normal(size=3) for x in (0.3, 1.0))
    frames = [frame_at(CURVE, s, V), Frame(V, 0.0, *rates, down / np.linalg.norm(down))]
    scale = np.tile([0.05, 0.02, 0.05, 0.02, 0.02, 0.05, 0.01, 1e-3, 0.01, 1.0], 2)
    for frame in frames:
        for _ in range(5):
            state = scale * rng.normal(size=2 * COUNT)
            wheelset = replace(
                dynamics.wheelset_states(s / V, state)["wheelset"], frame_rate=tuple(frame.rate.tolist())
            )
            contacts = {"wheelset": dynamics.solve_wheelset("wheelset", wheelset, None)}
            here, _ = in_frame(dynamics, frame, state, wrench_of(contacts))
            there = lagrange(frame, state, V / WAGON.radius)
            np.testing.assert_allclose(here, there, rtol=1e-11, atol=1e-11 * np.abs(there).max())


def test_run_through_a_transition(lagrange: Lagrange) -> None:
    """A run against an integration of order 8 of Lagrange's equations: 1e-6 of each channel's maximum."""
    end = 1.0
    dynamics, steps = wagon_dynamics(WAGON, CURVE, CONTACT, V), StepSettings("ode45", 1e-7, 1e-10)
    history = simulate(dynamics, (0.0, end), initial=0.3 * initial(), steps=steps, recording=Recording(0.1))
    nominal = V / WAGON.radius

    def rate(time: float, state: np.ndarray) -> np.ndarray:
        return np.concatenate([state[COUNT:], lagrange(frame_at(CURVE, V * time, V), state, nominal)])

    there = solve_ivp(rate, (0.0, end), 0.3 * initial(), method="DOP853", t_eval=history.time, rtol=1e-9, atol=1e-13)
    assert history.status == "completed"
    assert history.distance[-1] == pytest.approx(40.0)  # within the transition, its end at 45 m
    bumpstop = list(dynamics.vehicle.elements).index("bumpstop")
    assert np.abs(history.suspension()[1][:, bumpstop, 1]).max() > 500.0
    assert relative(history.state[:, :9], there.y[:9].T).max() < 1e-6


def test_trajectory_against_samples_of_exudyn() -> None:
    """5 s of free motion in which the bumpstop is struck from both sides; samples of Exudyn 1.13.6."""
    stored = json.loads(REFERENCE.read_text(encoding="utf-8"))
    assert stored["source"].startswith("Exudyn 1.13.6")
    assert stored["channels"] == list(COORDINATES[:9])
    samples = np.array(stored["positions"])
    np.testing.assert_allclose(stored["time"], EVERY * np.arange(len(samples)), atol=1e-12)
    assert relative(ours(rtol=1e-6), samples).max() < 1e-6
    softer = replace(WAGON, roll_bar=0.999 * WAGON.roll_bar)  # samples that would notice a wagon slightly different
    assert relative(ours(wagon=softer, end=0.5, rtol=1e-6), samples[:6]).max() > 1e-5


def test_exudyn_itself() -> None:
    """The first 0.1 s, where Exudyn is installed."""
    pytest.importorskip("exudyn")
    here, there = ours(end=0.1), theirs(2e-4, end=0.1)
    assert relative(here, there).max() < 1e-6
