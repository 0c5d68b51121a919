"""The contact of multibody codes: a rigid search for points, Hertz or virtual penetration, FASTSIM or Polach's formula.

Half-space elasticity, independent contacts, no meshes: well under a millisecond per force evaluation.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

import numpy as np

from wheelrail.bindings._contact import (
    FASTSIM,
    NO_FRICTION,
    POLACH,
    PairElasticity,
    Parameters,
    RigidVelocities,
    StandardData,
    StripFrames,
    StripFriction,
    StripPressures,
    hertzian,
    slip_velocities,
    standard_failure,
    strip_forces,
    virtual_penetration,
)
from wheelrail.contact.analytical.hertz import modulus
from wheelrail.contact.analytical.kalker import RATIO, TABLE, kalker
from wheelrail.contact.geometry.rigid_surfaces import RigidPair, RigidWheelRail
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.kinematics.left_pair import motion_of, pose_of, velocities_of
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.laws.pointwise import FrictionFunctions
from wheelrail.contact.models.standard.patches import StripContacts
from wheelrail.contact.models.standard.wheel_rail import SolvedWheels
from wheelrail.contact.results.result import ContactResult, Fields, LazyFields, LazyPatches, Patch, Statistics
from wheelrail.support.arrays import Array

Normal = Literal["hertz", "kik-piotrowski"]
Tangential = Literal["fastsim", "polach"]
CELLS = 16  # along each strip


def pair_elasticity(upper: Material, lower: Material) -> PairElasticity:
    """Combined constants: 1/G and nu/G are means over both bodies. Raises ValueError for a mean Poisson's ratio
    below 0.
    """
    compliance = [2.0 * (1.0 + material.nu) / material.E for material in (upper, lower)]
    nu = (compliance[0] * upper.nu + compliance[1] * lower.nu) / (compliance[0] + compliance[1])
    rows = [[[kalker(name, ratio, nu) for name in TABLE] for ratio in ratios] for ratios in (RATIO, 1.0 / RATIO)]
    return PairElasticity(modulus((upper.E, upper.nu), (lower.E, lower.nu)), 2.0 / sum(compliance), np.array(rows))


@dataclass(frozen=True)
class StandardContact:
    """Contact model of multibody codes: pose and velocities in, `ContactResult` out. The guess is not used.

    Parameters:
        surfaces: the rigid pair.
        laws: of the interface; only friction is used, as a function of the rigid slip velocity.
        upper, lower: materials of wheel and rail.
        normal: "hertz", the ellipse of the penetration's curvatures in the tangent plane; or "kik-piotrowski", strips
            on the curved surface.
        tangential: "fastsim" on those strips; or "polach", whose resultant is distributed like the pressure and carries
            no spin moment, so that its power may be negative under large spin.
        reduction: factors (k_A, k_S) of Polach's formula, 0 < k_S <= k_A <= 1.
        cells: along each of the 16 strips of a contact, at least 2.

    Raises ValueError for other names, numbers out of range, and friction that depends on the pressure.
    """

    surfaces: RigidPair
    laws: ContactLaws
    upper: Material = field(default_factory=Material)
    lower: Material = field(default_factory=Material)
    normal: Normal = "kik-piotrowski"
    tangential: Tangential = "fastsim"
    reduction: tuple[float, float] = (1.0, 1.0)
    cells: int = CELLS

    def __post_init__(self) -> None:
        if self.normal not in ("hertz", "kik-piotrowski"):
            raise ValueError(f'normal must be "hertz" or "kik-piotrowski", got {self.normal!r}')
        if self.tangential not in ("fastsim", "polach"):
            raise ValueError(f'tangential must be "fastsim" or "polach", got {self.tangential!r}')
        if not all(0.0 < k <= 1.0 for k in self.reduction) or self.reduction[1] > self.reduction[0]:
            raise ValueError(f"reduction factors must be 0 < k_S <= k_A <= 1, got k_A, k_S = {self.reduction}")
        if self.cells < 2:
            raise ValueError(f"cells must be at least 2, got {self.cells}")
        if self.laws.frictional and self.laws.pointwise_friction.depends_on_pressure:
            raise ValueError(
                f"the standard contact needs friction independent of the pressure, got {self.laws.friction}"
            )

    def with_laws(self, laws: ContactLaws) -> StandardContact:
        """The model with other laws on the same bodies."""
        model = replace(self, laws=laws)
        model.__dict__["elasticity"] = self.elasticity
        return model

    @cached_property
    def elasticity(self) -> PairElasticity:
        return pair_elasticity(self.upper, self.lower)

    @cached_property
    def method(self) -> int:
        """Tangential method for the core."""
        if not self.laws.frictional:
            return NO_FRICTION
        return FASTSIM if self.tangential == "fastsim" else POLACH

    @cached_property
    def factors(self) -> tuple[float, float]:
        """Reduction factors for the core."""
        return float(self.reduction[0]), float(self.reduction[1])

    @cached_property
    def friction_law(self) -> FrictionFunctions:
        return self.laws.pointwise_friction

    @cached_property
    def constant_friction(self) -> float | None:
        """Friction coefficient; None where it depends on the slip velocity."""
        if self.method == NO_FRICTION:
            return 0.0
        if self.friction_law.depends_on_speed:
            return None
        return float(self.friction_law.coefficient(np.zeros(1), np.zeros(1))[0])

    def friction(
        self, strips: StripPressures, middles: StripFrames, peaks: StripFrames, velocities: RigidVelocities
    ) -> StripFriction:
        """Friction coefficients at the rigid slip of cells (FASTSIM) or contacts (Polach)."""
        mu, n, k = self.constant_friction, self.cells * len(strips.s), len(peaks.point)
        if mu is not None:
            return StripFriction(self.method, np.full(n, mu), np.full(k, mu), self.factors)
        slips = slip_velocities(strips, middles, peaks, velocities, self.cells)
        cells, contacts = (self.friction_law.coefficient(w, np.zeros(len(w))) for w in slips)
        return StripFriction(self.method, cells, contacts, self.factors)

    @cached_property
    def together(self) -> Parameters | None:
        """Parameters for the batched solve of several wheels: Kik-Piotrowski pressures, profiles and constant friction;
        None for other models.
        """
        pair, mu = self.surfaces, self.constant_friction
        if not isinstance(pair, RigidWheelRail) or mu is None or self.normal != "kik-piotrowski":
            return None
        return Parameters(
            pair.wheel.shape,
            pair.rail.shape,
            float(pair.radius),
            pair.lines,
            float(pair.merge_distance),
            self.elasticity,
            self.method,
            float(mu),
            self.factors,
            self.cells,
        )

    def __call__(self, pose: Pose, motion: RigidMotion, guess: ContactResult | None = None) -> ContactResult:
        if self.together is not None:
            return self.results(SolvedWheels.at_pair(self.together, pose, motion))[0]
        try:
            contacts, approach = self.strip_contacts(pose, motion)
        except ValueError as error:
            return ContactResult.failed(str(error))
        if contacts is None:
            return ContactResult.separated(approach)
        cells, strips = contacts.cells, contacts.strips
        extent, pressure = (strips.along.max(), strips.across.max()), (strips.scale * strips.half).max()
        failure = self._failure(np.array([approach, 0.0, 0.0, 0.0, *extent, cells.speed.min(), pressure]))
        if failure:
            return ContactResult.failed(failure, approach)
        return ContactResult(
            force=cells.force,
            moment=cells.moment,
            patches=LazyPatches(contacts.patches),
            fields=LazyFields(contacts.fields),
            approach=approach,
            status="converged",
            statistics=Statistics(points=len(cells.area)),
        )

    def strip_contacts(self, pose: Pose, motion: RigidMotion) -> tuple[StripContacts | None, float]:
        """Contacts, None where the bodies do not touch, and the largest penetration m. Raises ValueError."""
        zones, approach = self.surfaces.regions(pose)
        if zones is None:
            return None, approach
        strips = (virtual_penetration if self.normal == "kik-piotrowski" else hertzian)(zones, self.elasticity.E_star)
        n = len(strips.s)
        point, axes = self.surfaces.at(
            pose, np.concatenate([strips.s, zones.peak]), np.concatenate([strips.x, zones.peak_x])
        )
        peak, peak_axes = point[n:], axes[n:]
        if self.normal == "hertz":  # in the common tangent plane
            away = (strips.s - zones.peak[strips.contact])[:, None]
            point, axes = peak[strips.contact] + away * peak_axes[strips.contact, 1], peak_axes[strips.contact]
        else:
            point, axes = point[:n], axes[:n]
        velocities = velocities_of(motion)
        middles, peaks = StripFrames(point, axes), StripFrames(peak, peak_axes)
        friction = self.friction(strips, middles, peaks, velocities)
        cells = strip_forces(strips, zones.weight, middles, peaks, velocities, self.elasticity, friction, self.cells)
        return StripContacts(zones, strips, cells, point, axes, pose, motion, self.surfaces), approach

    @cached_property
    def _extent(self) -> tuple[float, float]:
        along, across = self.surfaces.extent
        return float(along), float(across)

    @cached_property
    def data(self) -> StandardData | None:
        """Model data for the native library; None as for `together`."""
        if self.together is None or not isinstance(self.surfaces, RigidWheelRail):
            return None
        method = FASTSIM if self.tangential == "fastsim" else POLACH
        return StandardData(self.together, self._extent, self.surfaces.wheel.name, self.surfaces.rail.name, method)

    def _failure(self, values: Array) -> str:
        """Why a result with values (8,), see `WheelForces`, is none; empty if it is one."""
        return standard_failure(self._extent, self.elasticity.E_star, self.method, values)

    def results(self, solved: SolvedWheels) -> list[ContactResult]:
        """Results of wheels that were solved together, with patches and fields on demand."""
        wrenches = zip(solved.forces.wrench[:, :3], solved.forces.wrench[:, 3:], strict=True)
        values = zip(solved.forces.values.tolist(), wrenches, strict=True)
        return [self._result(solved, i, own, *wrench) for i, (own, wrench) in enumerate(values)]

    def _result(self, solved: SolvedWheels, i: int, values: list[float], force: Array, moment: Array) -> ContactResult:
        """Result of wheel i."""
        approach, beyond, contacts, points = values[:4]
        if beyond:
            assert isinstance(self.surfaces, RigidWheelRail)
            return ContactResult.failed(
                self.surfaces.overlap(pose_of(solved.pairs, i)), approach if approach > 0.0 else np.nan
            )
        if not contacts:
            return ContactResult.separated(approach)
        failure = self._failure(solved.forces.values[i])
        if failure:
            return ContactResult.failed(failure, approach)
        details = _Details(self, solved, i)
        return ContactResult(
            force=force,
            moment=moment,
            patches=LazyPatches(details.patches),
            fields=LazyFields(details.fields),
            approach=approach,
            status="converged",
            statistics=Statistics(points=int(points)),
            force_tangent=None if self.method == POLACH else solved.tangent(i),
        )


@dataclass(frozen=True, eq=False)
class _Details:
    """Patches and fields of one wheel of a batched solve, evaluated on demand."""

    model: StandardContact
    solved: SolvedWheels
    wheel: int

    def patches(self) -> tuple[Patch, ...]:
        return self.solved.patches(self.wheel)

    def fields(self) -> Fields:
        pairs = self.solved.pairs
        contacts, _ = self.model.strip_contacts(pose_of(pairs, self.wheel), motion_of(pairs, self.wheel))
        assert contacts is not None
        return contacts.fields()
