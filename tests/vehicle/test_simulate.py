"""Runs with a smooth contact: records, failures, interruption, symmetry, imports."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from plane import MIRROR
from standin_contact import CONTACT, FunctionContact

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.coordinates import PITCH
from wheelrail.vehicle.multibody.plane_wagon import COUNT, wagon_dynamics
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.simulation.time_run import Progress, Recording
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

V = 45.0
CURVE = Track.curve(curvature=1 / 600, cant=0.06, transition=20.0, length=200.0)


@dataclass
class Watched(VehicleContact):
    """Wraps the smooth contact, records guesses and results, and fails at given calls."""

    fail_at: range = range(0)
    fail_from: float = np.inf
    interrupt_at: int = -1
    calls: list[tuple[Side, ContactResult | None, ContactResult]] = field(default_factory=list)
    count: int = 0

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        self.count += 1
        if self.count == self.interrupt_at:
            raise KeyboardInterrupt
        if self.count in self.fail_at or abs(state.y) > self.fail_from:
            return replace(ContactResult.separated(), status="failed: 20 Newton steps")
        self.calls.append((side, guess, CONTACT(state, side, guess)))
        return self.calls[-1][2]


def run(  # type: ignore[no-untyped-def]
    contact=CONTACT,
    track: Track = CURVE,
    span: tuple[float, float] = (0.0, 0.15),
    *,
    interval: float | None = None,
    initial: np.ndarray | None = None,
    progress: Progress | None = None,
    **steps,
) -> History:
    return simulate(
        wagon_dynamics(Wagon(), track, contact, V),
        span,
        initial=initial,
        steps=StepSettings(**steps),
        recording=Recording(interval),
        progress=progress,
    )


@pytest.fixture(scope="module")
def plain() -> History:
    return run()


def test_rows_at_accepted_steps(plain: History) -> None:
    assert plain.status == "completed"
    assert plain.time[0] == 0.0
    assert plain.time[-1] == 0.15
    assert (np.diff(plain.time) > 0).all()
    n = len(plain)
    assert n == plain.cost.steps.accepted + 1 == len(plain.rows)
    assert plain.state.shape == (n, 2 * COUNT)
    assert plain.force[:, 0].shape == plain.moment[:, 0].shape == (n, 2, 3)
    assert plain.approach[:, 0].shape == (n, 2)
    np.testing.assert_allclose(plain.distance, V * plain.time)
    np.testing.assert_allclose(plain.force[:, 0][0, :, 2], 54546.05, rtol=1e-6)
    assert np.abs(plain.rate("wheelset")[:, PITCH]).max() < 1e-3 * V / 0.46  # in excess of nominal rolling
    assert np.abs(plain.position("wheelset")[:, PITCH]).max() < 0.05
    assert plain.state[-1, 0] < 0.0 > plain.state[-1, 6]  # to the outside of a left-hand curve


def test_costs_are_counted(plain: History) -> None:
    steps, left, right = plain.cost.steps, plain.cost.contact["left"], plain.cost.contact["right"]
    assert left.solves == right.solves >= steps.evaluations
    assert 0 < left.newton <= left.solves  # one each, none where the wheel was still in the air
    assert left.solves - steps.evaluations <= 25  # those of the equilibrium at the start
    assert steps.failed == left.failed == 0
    assert 0.0 < left.seconds < plain.cost.seconds


def test_recorded_forces_belong_to_the_recorded_states(plain: History) -> None:
    d = wagon_dynamics(Wagon(), CURVE, CONTACT, V)
    for i in (0, len(plain) // 2, -1):
        fresh = d(plain.time[i], plain.state[i])
        np.testing.assert_array_equal(plain.force[:, 0][i, 1], fresh.contacts["wheelset"]["right"].force)


def test_contact_starts_from_the_previous_results(plain: History) -> None:
    """Each guess is a result of the same side, the one of the call before but for the first stage of repeated steps."""
    watched = Watched()
    history = run(watched)
    assert len(history) == len(plain)
    for side in ("left", "right"):
        mine = [(guess, result) for s, guess, result in watched.calls if s == side]
        results = {id(result): i for i, (_, result) in enumerate(mine)}
        unused = 25  # equilibrium: guesses come from its own iterates
        jumps = 0
        for i, (guess, _) in enumerate(mine[unused:], start=unused):
            assert guess is not None
            jumps += results[id(guess)] != i - 1
        assert jumps == history.cost.steps.rejected


def test_tighter_tolerances_converge() -> None:
    span = (0.1, 0.16)
    ends = [run(span=span, rtol=tol, atol=1e-3 * tol).state[-1] for tol in (1e-3, 1e-4, 1e-5)]
    assert np.abs(ends[1] - ends[2]).max() < 0.2 * np.abs(ends[0] - ends[2]).max()
    assert np.abs(ends[0] - ends[2])[:9].max() < 1e-5
    other = run(span=span, method="ode45", rtol=1e-5, atol=1e-8).state[-1]
    np.testing.assert_allclose(other, ends[2], atol=1e-6)


def test_right_hand_curve_is_the_mirror_image(plain: History) -> None:
    """To the last bit, step by step, from any state."""
    other_track = Track.curve(curvature=-1 / 600, cant=0.06, transition=20.0, length=200.0)
    start = plain.state[len(plain) // 2]
    left = run(span=(0.2, 0.3), initial=start)
    right = run(span=(0.2, 0.3), initial=MIRROR * start, track=other_track)
    np.testing.assert_array_equal(right.time, left.time)
    np.testing.assert_allclose(right.state, left.state * MIRROR, rtol=1e-10, atol=1e-10)
    swapped = right.force[:, 0, ::-1] * [1.0, -1.0, 1.0]
    np.testing.assert_allclose(swapped, left.force[:, 0], rtol=1e-10)
    own = run(track=other_track)
    np.testing.assert_allclose(own.state[-1, :9], (plain.state * MIRROR)[-1, :9], atol=1e-6)


def test_equal_intervals(plain: History) -> None:
    even = run(interval=0.01)
    np.testing.assert_allclose(even.time, np.arange(16) * 0.01, atol=1e-15)
    assert even.cost.steps == plain.cost.steps
    for column in (1, 6, 7, 16):
        straight = np.interp(even.time, plain.time, plain.state[:, column])
        np.testing.assert_allclose(even.state[:, column], straight, atol=3e-2 * np.ptp(plain.state[:, column]) + 1e-9)
    linear = np.interp(even.time, plain.time, plain.force[:, 0, 0, 1])
    np.testing.assert_allclose(even.force[:, 0, 0, 1], linear, atol=3e-2 * np.ptp(linear))


@pytest.mark.parametrize("method", ["ode23", "rosenbrock"])
def test_outputs_between_steps_are_those_of_the_state_there(method: str) -> None:
    """Forces of one step of 0.1 s or many short ones: contacts are solved at the interpolated states."""
    even = run(interval=0.01, method=method, rtol=1e-2, atol=1e-5)
    dynamics = wagon_dynamics(Wagon(), CURVE, CONTACT, V)
    for row in range(len(even)):
        at = dynamics(float(even.time[row]), even.state[row])
        force = [at.contacts["wheelset"][side].force for side in ("left", "right")]
        np.testing.assert_allclose(even.force[:, 0][row], force, rtol=1e-9, atol=1e-6)


def test_rows_between_steps_do_not_change_the_run(plain: History) -> None:
    """A contact that fails at rows only leaves NaN there."""

    class Fragile(Watched):
        def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
            fails = side == "left" and any(abs(state.y - y) < 1e-15 for y in between)
            return ContactResult.failed("at a row") if fails else CONTACT(state, side, guess)

    even = run(interval=0.01, max_step=0.02)
    at_steps = run(max_step=0.02)
    between = even.state[5:8, 6]
    broken = run(Fragile(), interval=0.01, max_step=0.02)
    assert broken.status == "completed"
    np.testing.assert_array_equal(broken.state, even.state)
    assert np.isnan(broken.force[:, 0][5:8]).all()
    statuses = [row.contact_status[0][0] for row in broken.rows[5:8]]
    assert all(status.startswith("failed: left contact") for status in statuses)
    ok = np.r_[0:5, 8 : len(even)]
    np.testing.assert_array_equal(broken.force[:, 0][ok], even.force[:, 0][ok])
    assert broken.cost.steps == even.cost.steps == at_steps.cost.steps


def test_run_from_a_given_state(plain: History) -> None:
    half = run(span=(0.0, 0.08))
    rest = run(span=(0.08, 0.15), initial=half.state[-1])
    assert rest.time[0] == 0.08
    np.testing.assert_allclose(rest.state[-1, :9], plain.state[-1, :9], atol=2e-6)


def test_failed_contact_shortens_the_step(plain: History) -> None:
    watched = Watched(fail_at=range(100, 104))
    history = run(watched)
    assert history.status == "completed"
    assert history.cost.steps.failed == 4  # each failing left or right solve ends one try
    assert history.cost.contact["left"].failed + history.cost.contact["right"].failed == 4
    assert min(np.diff(history.time)) < 0.3 * np.median(np.diff(history.time))
    np.testing.assert_allclose(history.state[-1, :9], plain.state[-1, :9], atol=2e-6)


def test_repeated_failure_ends_the_run_with_its_history() -> None:
    history = run(Watched(fail_from=2e-5), span=(0.0, 1.0))
    assert history.status.startswith("failed: ")
    assert "20 Newton steps" in history.status
    assert history.cost.steps.failed > 3
    assert len(history) == history.cost.steps.accepted + 1 > 10
    assert np.isfinite(history.state).all()
    assert 1.9e-5 < abs(history.state[-1, 6]) <= 2e-5  # up to the interruption
    assert {status for row in history.rows for pair in row.contact_status for status in pair} == {"converged"}


def test_no_equilibrium_leaves_an_empty_history() -> None:
    history = run(Watched(fail_from=-1.0))
    assert history.status.startswith("failed: no equilibrium")
    assert len(history) == 0
    assert history.force[:, 0].shape == (0, 2, 3)
    assert history.position("wheelset").shape == (0, 6)


def test_interrupted_run_returns_its_history() -> None:
    history = run(Watched(interrupt_at=150))
    assert history.status == "interrupted"
    assert len(history) == history.cost.steps.accepted + 1 > 5
    assert 0.0 < history.time[-1] < 0.15

    def stop(fraction: float, info: Mapping[str, float]) -> None:
        if fraction > 0.5:
            raise KeyboardInterrupt

    history = run(progress=stop)
    assert history.status == "interrupted"
    assert 0.075 < history.time[-1] < 0.1
    assert run(Watched(interrupt_at=3)).status == "interrupted"  # within the equilibrium


def test_progress_is_reported() -> None:
    told: list[tuple[float, Mapping[str, float]]] = []
    history = run(progress=lambda fraction, info: told.append((fraction, info)))
    assert len(told) == history.cost.steps.accepted
    shares = [fraction for fraction, _ in told]
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    assert told[-1][1]["distance"] == pytest.approx(V * 0.15)
    assert told[-1][1]["solves"] == sum(c.solves for c in history.cost.contact.values())


def test_programming_errors_are_raised() -> None:
    @FunctionContact
    def wrong(state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        raise TypeError("a mistake in the program")

    with pytest.raises(TypeError):
        run(wrong)
    for options in ({"method": "euler"}, {"interval": 0.0}, {"span": (1.0, 1.0)}):
        with pytest.raises(ValueError):
            run(**options)


def test_the_vehicle_imports_nothing_heavy() -> None:
    """But its wear, which changes profiles and which no run imports."""
    heavy = ["dolfinx", "petsc4py", "mpi4py", "gmsh", "pyvista", "xarray", "matplotlib", "pydantic", "rich", "scipy"]
    code = (
        "import sys, pkgutil, importlib, wheelrail.vehicle as vehicle\n"
        "names = [m.name for m in pkgutil.walk_packages(vehicle.__path__, 'wheelrail.vehicle.') if not m.ispkg]\n"
        "[importlib.import_module(name) for name in names if '.wear.' not in name]\n"
        f"print(len(names), [h for h in {heavy} if h in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    count, found = done.stdout.split(" ", 1)
    assert int(count) > 10
    assert found.strip() == "[]"
