"""Derivative of the residual by pose and motion at fixed unknowns, integrated, against changes of the residual."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
import pytest
from scipy.special import roots_legendre
from test_lattice import ellipse, exact, flowing, rolling, wheelset
from test_tangent import nudged

from wheelrail.bindings._contact import SLOPES, Evaluation, TangentPlaces, evaluate, residual_changes
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.discretisation import Bodies
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.lattice.states import states_of
from wheelrail.contact.solvers.tangent import CHANGES
from wheelrail.support.arrays import Array

PATHS = np.repeat([2e-6, 2e-6, 1e-3, 1e-3], 3)  # m, rad, m/s, rad/s, to both sides
PLACES, WEIGHTS = roots_legendre(5)
ERROR = 1e-4  # of the changes, of the largest one with the same unit


def full(evaluation: Evaluation, cells: int) -> Array:
    """Slips and moments (S, block)."""
    slip = evaluation.slip.reshape(len(evaluation.slip), -1)[:, : 2 * cells]
    return np.hstack([slip, evaluation.residual[:, 2 * cells :]])


def check(
    model: LatticeContact, pose: Pose, motion: RigidMotion, columns: tuple[int, ...] = tuple(range(CHANGES))
) -> None:
    """The derivative, integrated along a path, is the change of the residual between its ends: it bends where places
    pass from piece to piece.

    With unit slopes the residual of friction is the slip, which has no corners. It is a second difference over cells,
    with the same round-off of the displacement on all strips, and counts by the square of their lengths: as it is, last
    bits on a strip of 0.1 mm, which the kernels of OpenBLAS decide, were 1e-3 of the largest slope.
    """
    problem = model.problem(pose, motion)
    (state,) = states_of(model.solve(problem).warm_start).values()
    M = model.cells if problem.rolls else 0
    slopes = np.zeros((len(state.strips), M, SLOPES))
    slopes[..., 4] = slopes[..., 7] = 1.0

    def derivative(change: Array) -> Array:
        at = model.problem(*nudged(pose, motion, change))
        places = TangentPlaces(at.lines, at.tables.lattice, at.tables.lines)
        return residual_changes(state.values, at.of(state.strips), places, slopes)

    def residual(at: tuple[Pose, RigidMotion]) -> Evaluation:
        return evaluate(state.values, model.problem(*at).of(state.strips))

    size = np.ones((*state.values.shape, 1))
    size[:, : 2 * M] *= ((state.half / state.half.max()) ** 2)[:, None, None]
    for unit in np.reshape(np.arange(CHANGES), (4, 3)):
        if not set(unit) <= set(columns):
            continue
        changes, integrals = [], []
        for j in unit:
            path = PATHS[j] * np.eye(CHANGES)[j]
            ahead, behind = (residual(nudged(pose, motion, sign * path)) for sign in (1, -1))
            changes.append((full(ahead, M) - full(behind, M)) / (2 * PATHS[j]))
            parts = zip(PLACES, WEIGHTS, strict=True)
            integrals.append(sum(0.5 * weight * derivative(place * path)[..., j] for place, weight in parts))
        expected, found = size * np.stack(changes, axis=-1), size * np.stack(integrals, axis=-1)
        for rows in (slice(0, 2 * M), slice(2 * M, None)):
            scale = np.abs(expected[:, rows]).max(initial=1e-9)
            np.testing.assert_allclose(found[:, rows], expected[:, rows], rtol=0, atol=ERROR * scale)


@pytest.mark.parametrize("bodies", ["half-space", "waveguide"])
@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize(("y", "z"), [(-2e-3, -2.7e-4), (6.43e-3, 6.02e-4)])
def test_wheel_on_rail(y: float, z: float, friction: float, bodies: Bodies) -> None:
    """On the tread and on the flange; the places of the strips on the lower body count only of a finite one."""
    contact = wheelset(friction, bodies)
    assert isinstance(contact.model, LatticeContact)
    check(contact.model, *contact.mounting.left_pair(rolling(y, z, yaw=2e-3, creepage=5e-4)))


@pytest.mark.parametrize("tangential", ["rolling", "shift"])
def test_quadrics(tangential: Literal["rolling", "shift"]) -> None:
    """The pose of an upper body whose surface is a quadric does not rotate."""
    model = replace(ellipse(0.3), tangential=tangential)
    check(model, hertz_pose(exact().approach), flowing(4e-4, 2e-4, 0.1), (0, 1, 2, *range(6, CHANGES)))
