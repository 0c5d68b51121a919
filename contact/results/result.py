"""What a contact solve returns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Protocol, overload

import numpy as np

from wheelrail.contact.kinematics.frames import MIRROR, Pose
from wheelrail.contact.results.error_estimate import ErrorEstimate
from wheelrail.support.arrays import Array, Mask, Nodes


@dataclass(frozen=True)
class Patch:
    """One connected contact patch. Forces act on the wheel (the upper body).

    area m2; max_pressure Pa; normal_force N; force (3,) N, resultant in the track's axes; tangential_force N
    (longitudinal, lateral in the contact plane); semi_axes m (along x, across) of the ellipse with the pressure's
    second moments (exact for Hertz); contact_angle rad, turn of the contact plane about x; wheel_s and rail_s m, arc
    length of the resultant on the profiles from the rolling circle and from the top of the rail, positive to the
    field side; wheel_y and rail_y m, the same laterally; wheel_band and rail_band m, lateral extent (smallest,
    largest) on the profiles; x m; stick_area m2. creepage: longitudinal and lateral one, and spin rad/m about the
    upward normal, rigid velocity of wheel against rail at the resultant over the rolling speed; frictional_power W, of
    the tractions over the rigid slip, which steady rolling turns into heat; both zero without friction and in a shift.
    """

    area: float
    max_pressure: float
    normal_force: float
    force: Array
    tangential_force: tuple[float, float]
    semi_axes: tuple[float, float]
    contact_angle: float
    wheel_s: float
    rail_s: float
    wheel_y: float
    rail_y: float
    wheel_band: tuple[float, float]
    rail_band: tuple[float, float]
    x: float
    stick_area: float
    creepage: tuple[float, float, float] = (0.0, 0.0, 0.0)
    frictional_power: float = 0.0

    def mirrored(self) -> Patch:
        longitudinal, lateral = self.tangential_force
        xi, eta, phi = self.creepage
        return replace(
            self,
            force=MIRROR * self.force,
            tangential_force=(longitudinal, -lateral),
            contact_angle=-self.contact_angle,
            creepage=(xi, -eta, -phi),
        )


class LazyPatches(Sequence[Patch]):
    """Patches that are summed up when they are first looked at: a vehicle asks for forces alone most of the time."""

    def __init__(self, made: Callable[[], tuple[Patch, ...]]) -> None:
        self._made: Callable[[], tuple[Patch, ...]] | None = made
        self._known: tuple[Patch, ...] = ()

    def all(self) -> tuple[Patch, ...]:
        if self._made is not None:
            self._known, self._made = self._made(), None
        return self._known

    @overload
    def __getitem__(self, index: int) -> Patch: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Patch, ...]: ...
    def __getitem__(self, index: int | slice) -> Patch | tuple[Patch, ...]:
        return self.all()[index]

    def __len__(self) -> int:
        return len(self.all())

    def __repr__(self) -> str:
        return repr(self.all())

    def __reduce__(self) -> tuple[type[tuple[Patch, ...]], tuple[tuple[Patch, ...]]]:
        return tuple, (self.all(),)


def _mirrored(patches: Sequence[Patch]) -> tuple[Patch, ...]:
    return tuple(patch.mirrored() for patch in patches)


@dataclass(frozen=True)
class Fields:
    """Values at the n contact points that were candidates.

    node (n,) index on the wheel's surface grid; patch (n,) index of the patch, -1 outside; point (n, 3) m in the rail
    frame; axes (n, 3, 3) rows longitudinal, lateral, outward normal of the wheel; area (n,) m2; step (n,) m, the
    length along the rolling direction that a point stands for; penetration (n,) of the undeformed bodies m, NaN where
    the model does not know it, positive where they overlap; pressure (n,) Pa; traction (n, 2) Pa on the wheel; slip (n,
    2) slip over rolling speed; displacement (n, 3) m, wheel minus rail, in the local axes; sticks (n,) where the model
    itself knows it.
    """

    node: Nodes
    patch: Nodes
    point: Array
    axes: Array
    area: Array
    step: Array
    penetration: Array
    pressure: Array
    traction: Array
    slip: Array
    displacement: Array
    sticks: Mask | None = None


@dataclass(frozen=True)
class Statistics:
    """Cost of one solve: Newton and linear iterations, candidate points, final relative residual, seconds by phase.

    settled: whether the ends of fitted cells came to rest; if not, the laws hold on cells that end a little aside.
    """

    newton: int = 0
    linear: int = 0
    points: int = 0
    residual: float = 0.0
    seconds: dict[str, float] = field(default_factory=dict)
    settled: bool = True


class ForceTangent(Protocol):
    """Derivative of a result's force and moment by the wheel's position and motion, about the result's own point."""

    def __call__(self) -> Array:
        """Change (6, 12) as `ContactResult.tangent` returns it."""

    def about(self, centre: Array) -> ForceTangent:
        """With the moment about another point (3,) m."""

    def mirrored(self) -> ForceTangent:
        """In the mirror y = 0."""


@dataclass(frozen=True)
class ContactResult:
    """Force (3,) N and moment (3,) N m on the wheel, patches, fields and how the solve went.

    In the frame of the rail, moment about the rail's origin, when a model returns it;
    `wheelrail.contact.models.wheelset` moves it to the track's axes and the wheelset's centre. approach m: largest
    undeformed overlap along the normal. status is "converged", "separated" (no overlap) or "failed: ..." with the
    reason; a failed result carries no force to be used. error_estimate: when the model was asked for it.
    force_tangent: what `tangent` is computed by, where the model keeps it. warm_start: what the same model starts the
    next solve from (strips of cells, or displacements of all unknowns, m, under `mpirun` this rank's); another model
    ignores it.
    """

    force: Array
    moment: Array
    patches: Sequence[Patch] = ()
    fields: Fields | None = None
    approach: float = 0.0
    status: str = "separated"
    statistics: Statistics = Statistics()
    error_estimate: ErrorEstimate | None = None
    force_tangent: ForceTangent | None = field(default=None, repr=False, compare=False)
    warm_start: object = field(default=None, repr=False, compare=False)

    @property
    def ok(self) -> bool:
        return self.status in ("converged", "separated")

    @classmethod
    def separated(cls, approach: float = 0.0) -> ContactResult:
        """No overlap: no force."""
        return cls(np.zeros(3), np.zeros(3), approach=approach)

    @classmethod
    def failed(cls, reason: str, approach: float = 0.0) -> ContactResult:
        """No answer, and why."""
        return replace(cls.separated(approach), status=f"failed: {reason}")

    def tangent(self) -> Array:
        """Change (6, 12) of force and moment, about the point that it is about now, to first order; solved for when
        asked, and then known.

        By translation [m] of the wheel's frame, rotation [rad] about its origin, velocity [m/s] and rotation rate
        [rad/s] of the wheel's motion, whose reference point moves with the frame; in a shift by the motion's m and rad.
        Zero when separated. Raises ValueError for a failed result and for one whose model keeps no linearisation.
        """
        if self.status == "separated":
            return np.zeros((6, 12))
        if self.force_tangent is None:
            raise ValueError(f"the result has no tangent: {self.status}")
        return self.force_tangent()

    def about(self, centre: Array) -> ContactResult:
        """The same with the moment about another point (3,) m of the frame."""
        seen = None if self.force_tangent is None else self.force_tangent.about(centre)
        return replace(self, moment=self.moment - np.cross(centre, self.force), force_tangent=seen)

    def mirrored(self) -> ContactResult:
        """Force, moment, patches and tangent in the mirror y = 0; the fields stay those of the left-hand pair."""
        return replace(
            self,
            force=MIRROR * self.force,
            moment=-MIRROR * self.moment,
            patches=LazyPatches(partial(_mirrored, self.patches)),
            force_tangent=None if self.force_tangent is None else self.force_tangent.mirrored(),
        )


__all__ = ["ContactResult", "Fields", "Patch", "Pose", "Statistics"]
