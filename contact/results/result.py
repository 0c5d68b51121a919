"""Result of a contact solve: forces, patches, fields and statistics."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import partial
from typing import Protocol, overload

import numpy as np

from wheelrail.contact.kinematics.copies import changed
from wheelrail.contact.kinematics.frames import MIRROR, Pose, cross
from wheelrail.contact.results.error_estimate import ErrorEstimate
from wheelrail.support.arrays import Array, Mask, Nodes

# Across a patch: with fewer its area and peak pressure err by several per cent, and its force by more than 2 % where it
# is small beside a wide one or few strips are asked for.
FEWEST_STRIPS = 5


@dataclass(frozen=True)
class Patch:
    """One connected contact patch; forces act on the wheel (the upper body).

    Parameters:
        area: m2.
        max_pressure: Pa.
        normal_force: N.
        force: (3,) N, resultant in the track's axes.
        tangential_force: N, longitudinal and lateral in the contact plane.
        semi_axes: m, along x and across, of the ellipse with the same second moments of pressure (exact for Hertz).
        contact_angle: rad, rotation of the contact plane about x, that of the deformed surfaces; forces are split by
            the undeformed wheel's normals.
        wheel_s, rail_s: m, arc length of the resultant on the profiles from the rolling circle and from the top of the
            rail, positive to the field side; of the material that touches, see
            `wheelrail.contact.results.touching_material`.
        wheel_y, rail_y: m, lateral position of the resultant on the profiles.
        wheel_band, rail_band: m, lateral extent (smallest, largest) on the profiles.
        x: m, longitudinal position of the resultant.
        stick_area: m2.
        creepage: longitudinal, lateral, and spin rad/m about the upward normal; rigid velocity of the wheel relative to
            the rail at the resultant over the rolling speed. Zero without friction and for a tangential displacement.
        frictional_power: W, which friction turns into heat in steady rolling, the limit of traction times slip over
            fine cells; zero as creepage.
        strips: number of strips of a lattice across it, or of points of a grid, across or along it where these are
            fewer; 0 for other models.
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
    strips: int = 0

    @property
    def rough(self) -> bool:
        """Whether the strips or points across are too few for its area and peak pressure."""
        return 0 < self.strips < FEWEST_STRIPS

    def mirrored(self) -> Patch:
        """The patch in the mirror y = 0."""
        longitudinal, lateral = self.tangential_force
        xi, eta, phi = self.creepage
        return changed(
            self,
            force=MIRROR * self.force,
            tangential_force=(longitudinal, -lateral),
            contact_angle=-self.contact_angle,
            creepage=(xi, -eta, -phi),
        )


class LazyPatches(Sequence[Patch]):
    """Patch resultants, computed at the first access.

    Parameters:
        compute: returns the patches. Most evaluations in a vehicle simulation need the forces only.
    """

    def __init__(self, compute: Callable[[], tuple[Patch, ...]]) -> None:
        self._compute: Callable[[], tuple[Patch, ...]] | None = compute
        self._patches: tuple[Patch, ...] = ()

    def all(self) -> tuple[Patch, ...]:
        """All patches."""
        if self._compute is not None:
            self._patches, self._compute = self._compute(), None
        return self._patches

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
    """Fields at the n candidate contact points.

    Parameters:
        node: (n,) index on the wheel's surface grid.
        patch: (n,) index of the patch, -1 outside.
        point: (n, 3) m in the rail frame.
        axes: (n, 3, 3), rows longitudinal, lateral, outward normal of the wheel.
        area: (n,) m2, times the share.
        step: (n,) m, length of the point's cell along the rolling direction.
        penetration: (n,) m of the undeformed bodies, positive where they interpenetrate; NaN where the model does not
            compute it.
        pressure: (n,) Pa.
        traction: (n, 2) Pa on the wheel, longitudinal and lateral.
        slip: (n, 2), slip over the rolling speed.
        displacement: (n, 3) m, wheel minus rail, in the local axes.
        sticks: (n,) mask; None unless the model itself distinguishes stick from slip.
        share: (n,) of the result that is that of the point's strips, where a contact lies between two widths of strips
            and fields are those of both; None: all of it.
        wheel_s, rail_s: (n,) m, arc length on the profiles, as for `Patch` but of the undeformed bodies; for a Hertz
            pair lateral positions.
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
    sticks: Mask | None = field(default_factory=lambda: None)  # no class attribute: `LazyFields`
    share: Array | None = field(default_factory=lambda: None)
    wheel_s: Array | None = field(default_factory=lambda: None)
    rail_s: Array | None = field(default_factory=lambda: None)

    @property
    def width(self) -> Array:
        """Widths (n,) m of the points' cells across the rolling direction."""
        width = self.area / self.step
        return width if self.share is None else width / self.share

    @property
    def drawn(self) -> Mask:
        """Mask (n,) of loaded points in a picture: of the strips with the larger share."""
        loaded = self.pressure > 0
        return loaded if self.share is None else loaded & (self.share == self.share.max())


class LazyFields(Fields):
    """Fields, computed at the first access.

    Parameters:
        compute: returns the fields.
    """

    def __init__(self, compute: Callable[[], Fields]) -> None:
        object.__setattr__(self, "_compute", compute)

    @property  # type: ignore[misc]
    def __class__(self) -> type[Fields]:  # type: ignore[override]
        """`Fields`: copies with changes (`dataclasses.replace`) are computed ones."""
        return Fields

    def __getattr__(self, name: str) -> object:
        if name.startswith("__") or "_compute" not in self.__dict__:
            raise AttributeError(name)
        computed = self.__dict__.pop("_compute")()
        self.__dict__.update(vars(computed))
        return getattr(self, name)

    def __reduce__(self) -> tuple[type[Fields], tuple[object, ...]]:
        return Fields, tuple(getattr(self, part.name) for part in fields(self))


@dataclass(frozen=True)
class Statistics:
    """Solver statistics of one solve.

    Parameters:
        newton, linear: Newton and linear iterations.
        points: candidate points.
        residual: final relative residual.
        seconds: by phase.
    """

    newton: int = 0
    linear: int = 0
    points: int = 0
    residual: float = 0.0
    seconds: dict[str, float] = field(default_factory=dict)


class ForceTangent(Protocol):
    """Derivative of force and moment by the wheel's position and motion, the moment about a reference point."""

    def __call__(self) -> Array:
        """Derivative (6, 12), see `ContactResult.tangent`."""

    def about(self, centre: Array) -> ForceTangent:
        """The derivative with the moment about another point (3,) m."""

    def mirrored(self) -> ForceTangent:
        """The derivative in the mirror y = 0."""


@dataclass(frozen=True)
class ContactResult:
    """Force and moment on the wheel, patches, fields, and the outcome of the solve.

    Models return it in the frame of the rail, with the moment about the rail's origin;
    `wheelrail.contact.models.wheelset` transforms it to the track's axes and the wheelset's centre.

    Parameters:
        force: (3,) N.
        moment: (3,) N m.
        patches, fields: None of them without contact.
        approach: m, largest undeformed penetration along the normal.
        status: "converged", "separated" (no penetration) or "failed: ..." with the reason; the force of a failed result
            must not be used.
        statistics: of the solver.
        error_estimate: if requested from the model.
        force_tangent: computes `tangent`, where the model provides it.
        warm_start: all that the next solve of the same model reads from its guess, as plain data: numbers and arrays in
            dataclasses; None for models that read nothing. Other models ignore it.
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
        """Whether the force can be used."""
        return self.status in ("converged", "separated")

    @classmethod
    def guess(cls, warm_start: object) -> ContactResult:
        """A result that serves as initial guess only."""
        return cls(np.zeros(3), np.zeros(3), warm_start=warm_start)

    @classmethod
    def separated(cls, approach: float = 0.0) -> ContactResult:
        """Bodies without contact: zero force. approach: m, negative is the distance."""
        return cls(np.zeros(3), np.zeros(3), approach=approach)

    @classmethod
    def failed(cls, reason: str, approach: float = np.nan) -> ContactResult:
        """A failed solve, its reason, and its approach m where this is known."""
        return replace(cls.separated(approach), status=f"failed: {reason}")

    def tangent(self) -> Array:
        """Derivative (6, 12) of force and moment, about the present reference point; computed at the first call.

        Columns: translation [m] of the wheel's frame, rotation [rad] about its origin, velocity [m/s] and rotation rate
        [rad/s] of the wheel's motion, whose reference point moves with the frame; for a tangential displacement the
        motion's m and rad. Zero when separated. Raises ValueError for a failed result and for a model without tangent.
        """
        if self.status == "separated":
            return np.zeros((6, 12))
        if self.force_tangent is None:
            raise ValueError(f"the result has no tangent: {self.status}")
        return self.force_tangent()

    def about(self, centre: Array) -> ContactResult:
        """The result with the moment about another point (3,) m of the frame."""
        tangent = None if self.force_tangent is None else self.force_tangent.about(centre)
        return changed(self, moment=self.moment - cross(centre, self.force), force_tangent=tangent)

    def mirrored(self) -> ContactResult:
        """Force, moment, patches and tangent in the mirror y = 0; the fields stay those of the left-hand pair."""
        return changed(
            self,
            force=MIRROR * self.force,
            moment=-MIRROR * self.moment,
            patches=LazyPatches(partial(_mirrored, self.patches)),
            force_tangent=None if self.force_tangent is None else self.force_tangent.mirrored(),
        )


__all__ = ["ContactResult", "Fields", "Patch", "Pose", "Statistics"]
