"""Solves of a contact model at points of a table, and their reduction to its values."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from wheelrail.bindings._contact import ARM, interpolated, scale_of_creepage
from wheelrail.contact.kinematics.frames import Pose, RigidMotion, Twist
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.load_search import LoadError, Results, find_depth_for_load
from wheelrail.contact.models.table.force_table import NormalTable, TreadFrame
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array

SPEED = 10.0  # m/s; with a constant coefficient of friction forces do not depend on it
LOAD_TOLERANCE = 1e-6  # of the vertical load
EXPECTED, DEEPEST = 1e-4, 0.05  # m, approach under a load, and limit of the search

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class TableContactPoint:
    """Frictionless contact at a position, as tabulated.

    Parameters:
        position: y, z, roll, yaw of the tread.
        level: (vertical load / N)^(2/3).
        point: (3,) m of the resultant.
        force: (3,) N.
        couple: (3,) N m about the point.
    """

    position: tuple[float, float, float, float]
    level: float
    point: tuple[float, float, float]
    force: tuple[float, float, float]
    couple: tuple[float, float, float]

    @property
    def load(self) -> float:
        """Vertical load, N."""
        return float(self.level**1.5)

    @property
    def axes(self) -> Array:
        """Rows (3, 3): x, lateral tangent, normal."""
        _, y, z = np.array(self.force) / np.hypot(*self.force[1:])
        return np.array([[1.0, 0.0, 0.0], [0.0, z, -y], [0.0, y, z]])


@dataclass(frozen=True)
class TableSampler:
    """A contact model of a left-hand pair at points of a table.

    Parameters:
        model: called with pose, motion and guess; a dataclass with `laws`.
        frame: of the tread.
        coefficient: of friction.
    """

    model: Any
    frame: TreadFrame
    coefficient: float

    @cached_property
    def frictionless(self) -> Any:
        """The model without friction."""
        laws = self.model.laws
        return replace(self.model, laws=ContactLaws(laws.normal, 0.0, laws.regularisation))

    def normal_rows(self, y: float, roll: float, yaw: float, loads: Sequence[float]) -> Array:
        """Values (loads, 9) of a `NormalTable` at one position; NaN for loads that are not found.

        Parameters:
            y, roll, yaw: of the tread.
            loads: vertical, increasing, N.
        """

        def lowered(depth: float, earlier: Results | None) -> Results:
            pose = self.frame.pose(y, -depth, roll, yaw)
            return (self.frictionless(pose, self.rolling(pose), earlier[0] if earlier else None),)

        rows, guess, depth = np.full((len(loads), 9), np.nan), None, 0.0
        for row, load in zip(rows, loads, strict=True):
            try:
                solution = find_depth_for_load(
                    lowered, load, expected=EXPECTED, start=depth, rtol=LOAD_TOLERANCE, deepest=DEEPEST, guess=guess
                )
            except LoadError as error:
                log.debug("%g N at y = %g m, roll = %g rad, yaw = %g rad: %s", load, y, roll, yaw, error)
                continue
            depth, guess = solution.depth, solution.results
            row[:] = self._normal_row(self.frame.pose(y, -depth, roll, yaw), guess[0], -depth)
        return rows

    def _normal_row(self, pose: Pose, result: ContactResult, height: float) -> Array:
        assert result.fields is not None
        weight = result.fields.pressure * result.fields.area
        point = weight @ result.fields.point / weight.sum()
        couple = result.moment - np.cross(point, result.force)
        x, y, load = result.force
        return np.concatenate([[height], point - self._tread(pose), [y / load, x / load], couple / load])

    def _tread(self, pose: Pose) -> Array:
        return pose.origin - self.frame.radius * pose.rotation[:, 2]

    def rolling(self, pose: Pose) -> RigidMotion:
        """Motion of a wheel that rolls with its nominal spin."""
        wheel = Twist(np.zeros(3), SPEED / self.frame.radius * pose.rotation[:, 1], pose.origin)
        return RigidMotion(wheel, Twist(np.array([-SPEED, 0.0, 0.0]), np.zeros(3), np.zeros(3)))

    def at_level(self, table: NormalTable, y: float, roll: float, yaw: float, level: float) -> TableContactPoint:
        """Contact without friction where the table has a level of the load."""
        values = interpolated(table.grid, np.array([y, roll, yaw, level]), False)[0]
        z = float(values[0])
        load, pose = level**1.5, self.frame.pose(y, z, roll, yaw)
        point = self._tread(pose) + values[1:4]
        force = load * np.array([values[5], values[4], 1.0])
        vectors = (tuple(vector.tolist()) for vector in (point, force, load * values[6:]))
        return TableContactPoint((y, z, roll, yaw), level, *vectors)

    def motion(self, at: TableContactPoint, creepage: tuple[float, float], turn: float = 0.0) -> RigidMotion:
        """Motion with given creepages at the point of a contact.

        Parameters:
            at: contact.
            creepage: longitudinal and lateral over their scale.
            turn: further rotation rate about z over speed, 1/m.
        """
        pose = self.frame.pose(*at.position)
        scale = scale_of_creepage(at.level, self.coefficient)
        longitudinal, lateral = scale * creepage[0], scale * creepage[1]
        slip_x = SPEED * longitudinal / (1.0 + 0.5 * longitudinal)  # the rolling speed is SPEED - slip_x / 2
        slip = slip_x * at.axes[0] + (SPEED - 0.5 * slip_x) * lateral * at.axes[1]
        nominal = self.rolling(pose)
        rotation = nominal.wheel.rotation + np.array([0.0, 0.0, turn * SPEED])
        velocity = nominal.rail.velocity + slip - np.cross(rotation, np.array(at.point) - pose.origin)
        return RigidMotion(Twist(velocity, rotation, pose.origin), nominal.rail)

    def solved(self, pose: Pose, motion: RigidMotion, guess: ContactResult | None) -> ContactResult:
        """Result of the model from a guess and, where that fails, from none."""
        result: ContactResult = self.model(pose, motion, guess)
        return result if result.ok or guess is None else self.model(pose, motion, None)

    def friction_row(self, at: TableContactPoint, load: Array) -> Array:
        """Values (6,) of a `FrictionTable` of a force and moment (6,) about the rail's origin."""
        unit = self.coefficient * at.load
        change = at.axes @ (load[:3] - at.force) / unit
        couple = load[3:] - np.cross(at.point, load[:3]) - at.couple
        return np.concatenate([change, couple / (unit * ARM)])
