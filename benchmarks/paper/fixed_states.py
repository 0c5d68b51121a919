"""Error of the contact force over the tolerance of Newton's method, at fixed states of a run.

Every state is solved without initial guess and from the converged solution one step earlier, as in a run, where a loose
tolerance accepts the old solution for the new state.
"""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter

import numpy as np

from benchmarks.paper.segment import TIGHT_NEWTON, TrackSegment
from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.vehicle.multibody.plane_wagon import WHEELSET
from wheelrail.vehicle.simulation.history import History

TOLERANCES = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10)
PAPER_TOL = 1e-8  # m, Tol of Eq. (15) as read from the scan


@dataclass(frozen=True)
class Accuracy:
    """At one tolerance, cold or warm: RMS and largest error of the tangential force over its bound mu F_n and of the
    total force over the load, Newton steps and seconds per solve, failed solves.
    """

    tolerance: float
    warm: bool
    creep: float
    worst: float
    force: float
    newton: float
    seconds: float
    failed: int


@dataclass(frozen=True)
class State:
    """A state, the side, and the tightly converged solutions there and one step earlier."""

    state: WheelsetState
    side: Side
    exact: ContactResult
    before: ContactResult


def states(part: TrackSegment, run: History, count: int) -> list[State]:
    """States at accepted steps along a run, with the step before each. Raises RuntimeError without contact."""
    contact = part.tuned({"tolerance": TIGHT_NEWTON})
    dynamics = part.dynamics(contact)
    solved_states = []
    for i in np.unique(np.linspace(1, len(run) - 1, count).astype(int)):
        wheelset_states = [dynamics.wheelset_states(float(run.time[k]), run.state[k])[WHEELSET] for k in (i - 1, i)]
        for side in SIDES:
            before, exact = (contact(wheelset_state, side) for wheelset_state in wheelset_states)
            if not (before.ok and exact.ok and exact.force[2] > 0):
                raise RuntimeError(f"no contact at {run.time[i]:.3f} s, {side}: {exact.status}")
            solved_states.append(State(wheelset_states[1], side, exact, before))
    return solved_states


def accuracies(part: TrackSegment, chosen: list[State]) -> list[Accuracy]:
    """All tolerances, cold and warm."""
    return [
        at_tolerance(part.tuned({"tolerance": tolerance}), chosen, tolerance, warm, part.scene.friction)
        for warm in (False, True)
        for tolerance in TOLERANCES
    ]


def at_tolerance(
    contact: WheelsetContact, chosen: list[State], tolerance: float, warm: bool, friction: float
) -> Accuracy:
    """Errors at one tolerance."""
    creep, force, newton, failed = [], [], 0, 0
    began = perf_counter()
    for sample in chosen:
        result = contact(sample.state, sample.side, sample.before if warm else None)
        newton += result.statistics.newton
        if not result.ok:
            failed += 1
            continue
        load, deviation = float(sample.exact.force[2]), result.force - sample.exact.force
        creep.append(float(np.hypot(deviation[0], deviation[1])) / (friction * load))
        force.append(float(np.linalg.norm(deviation)) / load)
    seconds = (perf_counter() - began) / len(chosen)
    rms, force_rms = (float(np.sqrt(np.mean(np.square(x)))) if x else np.nan for x in (creep, force))
    return Accuracy(tolerance, warm, rms, max(creep, default=np.nan), force_rms, newton / len(chosen), seconds, failed)


def equivalent(chosen: list[State], stiffness: float) -> float:
    """The paper's tolerance of displacements [m] as a relative residual of the pressures: Tol K over their norm."""
    norms = [
        float(np.linalg.norm(sample.exact.fields.pressure)) for sample in chosen if sample.exact.fields is not None
    ]
    return PAPER_TOL * stiffness / float(np.mean(norms))
