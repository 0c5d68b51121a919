"""Contact on strips of a lattice fixed on the upper body: the force is a function of the pose alone."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal, TypeVar
from weakref import ref

import numpy as np

from wheelrail.bindings._contact import LatticeContact as LatticeLevels
from wheelrail.bindings._contact import (
    LatticeProblem,
    LatticeSetting,
    LatticeStart,
    LatticeTables,
    LevelModel,
    ResidualCode,
    StripBasis,
    SurfaceData,
)
from wheelrail.contact.geometry.strip_lattice import cells_along, lattice_sides
from wheelrail.contact.geometry.strip_surfaces import ProfileStrips
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.lattice.influence.basis import Tangential, equal_cells, strip_basis
from wheelrail.contact.models.lattice.influence.strip_operators import StripOperators
from wheelrail.contact.models.lattice.resolution import LatticeResolution, strips_apart
from wheelrail.contact.models.lattice.results import contact_result
from wheelrail.contact.models.lattice.system.surface import motion_data, surface_data
from wheelrail.contact.results.extrapolation import estimate
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array
from wheelrail.support.interrupts import check_interrupt
from wheelrail.support.memory import check_memory, dense_seconds

log = logging.getLogger(__name__)

Result = TypeVar("Result")

MATRICES = 2.0  # of the size of the Jacobian: itself, its factors and slips in single precision
LONG = 2.0  # s per Newton step, from which on the time is logged
START_CELLS = 8, 12, 16, 24  # along a strip, at a start without an earlier result
PROBES = 6, 12  # along an unloaded strip, to find where its penetration is largest, and around there
FINER, MOST_CELLS, NARROWER = (
    (2, 4),
    48,
    (1, 2),
)  # cells along a strip, in search of a pressure without tension: more, at most so many, and halvings of its width
GAP = 3e-4  # m, largest gap that displacements may close on ordinary strips
SAMPLES = 400  # of the rail's profile


def _residual_code(laws: ContactLaws) -> ResidualCode:
    """Residual F (2, n) Pa of the law of friction in the cells, and its slopes, for the core.

    F is the mean of q - b y / max(|y|, b rho + eps), y = rho q - s, b = mu(|s| V, p) p, over a pressure p that varies
    linearly in the cell (`wheelrail.forms.traction.mean_projected`). Slips s are over the rolling speed V. Pressures of
    a trial state may be negative: their bound is zero.
    """
    if not laws.frictional:
        return ResidualCode(None, np.zeros(0), 0.0)
    functions = laws.pointwise_friction
    return ResidualCode(functions.code, functions.parameters, laws.regularisation)


@dataclass(frozen=True)
class LatticeContact:
    """Contact model on a lattice of strips: pose and velocities in, `ContactResult` out. The core solves it.

    Parameters:
        operators: compliance and surfaces of both bodies.
        laws: of the interface.
        resolution: strips over a usual patch, cells along a strip.
        tangential: steady "rolling", or "shift", one step of tangential loading from none (Cattaneo, Mindlin): the
            motion's velocities are displacements in m and rad.
        tolerance: of the last step, relative to the largest pressure and length; it is taken. With a new Jacobian the
            error is about its square, with a kept one up to 0.3 of it, that of forces some 1e-7 at the default.
        estimate: results carry an error estimate, from two lattices of half the resolution.
        offset: of the lattice, in strips.
        level: halvings of the strips' width, see `contact/models/lattice/core/levels.hpp`. Level 0, the model itself,
            solves narrow contacts on its finer levels.

    The guess is an initial guess only: results do not depend on it. Raises ValueError for a penalty, whose pressure has
    no sharp ends, and for a friction law that depends on the slip velocity together with tangential = "shift".
    """

    operators: StripOperators
    laws: ContactLaws
    resolution: LatticeResolution = field(default_factory=LatticeResolution)
    tangential: Literal["rolling", "shift"] = "rolling"
    tolerance: float = 1e-5
    estimate: bool = False
    offset: float = 0.0
    level: int = 0

    def __post_init__(self) -> None:
        if not self.laws.exact_normal:
            raise ValueError(f"a lattice needs the exact normal law, got {self.laws}")
        if self.tangential == "shift" and self.laws.depend_on_slip:
            raise ValueError("friction that depends on the slip velocity needs rolling, not a tangential displacement")

    def __call__(self, pose: Pose, motion: RigidMotion, guess: ContactResult | None = None) -> ContactResult:
        """Result of a pose and motion; the guess changes the number of iterations only."""
        if self.level > 0:
            return self.solve(self.problem(pose, motion), guess)
        result = contact_result(self._levels.solve(motion_data(pose, motion, 1.0), _start(guess)))
        if not (self.estimate and result.patches):
            return result
        return replace(result, error_estimate=estimate(result, [model(pose, motion) for model in self.coarse]))

    def problem(self, pose: Pose, motion: RigidMotion) -> LatticeProblem:
        """Equations of a pose and motion on the strips of this level."""
        return self.own_level.problem(motion_data(pose, motion, 1.0))

    def solve(self, problem: LatticeProblem, guess: ContactResult | None = None) -> ContactResult:
        """Contact result on the strips of this level, for any number of loaded strips."""
        return contact_result(self.own_level.solve(problem, _start(guess)))

    def on(self, level: int) -> LatticeContact:
        """The model on one level of its lattice alone, stored."""
        if level == self.level:
            return self
        if level not in self._on:
            self._on[level] = self._sharing(replace(self, level=level, estimate=False))
        return self._on[level]

    @cached_property
    def _on(self) -> dict[int, LatticeContact]:
        return {}

    def _sharing(self, model: LatticeContact) -> LatticeContact:
        """A model with the tables of this one."""
        model.__dict__.update(_tables=self._tables, surface=self.surface)
        return model

    def with_laws(self, laws: ContactLaws) -> LatticeContact:
        """The model with other laws on the same bodies and strips."""
        return self._sharing(replace(self, laws=laws))

    @cached_property
    def coarse(self) -> tuple[LatticeContact, LatticeContact]:
        """Models of half the resolution, one on strips that are offset by half their width: errors scatter with it."""
        one = replace(self, resolution=self.resolution.coarsened(), estimate=False)
        return one, replace(one, offset=0.5)

    @cached_property
    def frictionless(self) -> LatticeContact:
        """The model without friction on the same strips, a fifth of the unknowns; itself if it has none."""
        if not self.laws.frictional:
            return self
        return self._sharing(replace(self, laws=ContactLaws(friction=0.0), estimate=False))

    @cached_property
    def _finer(self) -> tuple[LatticeContact, ...]:
        """The model with more cells along the same strips, then on narrower ones; without finer ones of their own."""
        cells = [replace(self.resolution, cells=n * self.resolution.cells) for n in self.finer_cells]
        models = [replace(self, resolution=resolution, estimate=False) for resolution in cells]
        models += [replace(self, level=self.level + n, estimate=False) for n in NARROWER]
        for model in models:
            self._sharing(model).__dict__.update(_finer=())
        return tuple(models)

    @property
    def finer_cells(self) -> list[int]:
        """Refinement factors of the finer models for the cells along strips."""
        return [n for n in FINER if n * self.cells <= MOST_CELLS]

    @cached_property
    def _levels(self) -> LatticeLevels:
        """The model on ordinary strips, or on finer levels."""
        return LatticeLevels(self.own_level, _without_cycle(self, lambda own, level: own.on(level).own_level))

    @cached_property
    def own_level(self) -> LevelModel:
        """The model on the strips of its level."""
        return LevelModel(
            self._setting,
            self.resolution.strips,
            self.level,
            _without_cycle(self, lambda own: [model.own_level for model in own._finer]),
            _without_cycle(self, lambda own, strips: own._check_size(strips)),
            check_interrupt,
        )

    @cached_property
    def _setting(self) -> LatticeSetting:
        law = _residual_code(self.laws)  # which may lack a compiler, before the bodies' compliance takes its time
        lines, outline = None, np.zeros((2, 0))
        if isinstance(surfaces := self.operators.surfaces, ProfileStrips):
            lines, outline = surfaces.rigid.lines, rail_outline(surfaces)
        return LatticeSetting(
            self.surface,
            lines,
            outline,
            self.tables,
            self.basis,
            equal_cells(PROBES[0]),
            equal_cells(PROBES[1]),
            [equal_cells(cells, self._problem) for cells in START_CELLS],
            law,
            margin(self.level),
            self.apart(self.level),
            self.tolerance,
        )

    @property
    def tables(self) -> LatticeTables:
        """Compliance of pairs of strips of the lattice."""
        if self.level not in self._tables:
            self._tables[self.level] = self.operators.tables(self.sides(self.level), self.tangential == "rolling")
        return self._tables[self.level]

    def sides(self, level: int) -> Array:
        """Lateral bounds (K + 1,) m of the strips on a level."""
        strips = self.resolution.strips * 2**level
        return lattice_sides(self.operators.surfaces, self.operators.upper.arc, strips, self.offset)

    def apart(self, level: int) -> int:
        """Distance, in strips of a level, between the first estimates of penetration."""
        return strips_apart(self.resolution.strips * 2**level)

    @cached_property
    def _tables(self) -> dict[int, LatticeTables]:
        """Tables of the levels used so far."""
        return {}

    @cached_property
    def surface(self) -> SurfaceData:
        """Surfaces of both bodies."""
        return surface_data(self.operators.surfaces)

    @cached_property
    def basis(self) -> StripBasis:
        return strip_basis(self.cells, self._problem)

    @cached_property
    def cells(self) -> int:
        """Cells along a strip."""
        return cells_along(self.operators.surfaces, self.resolution.cells)

    @property
    def _problem(self) -> Tangential:
        """Kind of the tangential problem."""
        return self.tangential if self.laws.frictional else "none"

    def _check_size(self, strips: int) -> None:
        """Log memory and time of Newton's method on a number of strips if large. Raises TooLarge."""
        unknowns = strips * ((2 * self.cells if self.laws.frictional else 0) + len(self.basis.moments))
        gigabytes, seconds = MATRICES * 8e-9 * unknowns**2, dense_seconds(unknowns)
        name = f"{strips} strips, {self.cells} cells along each: {unknowns} unknowns"
        check_memory(name, gigabytes)
        if seconds > LONG:
            log.info("%s: %.2g GB, about %.2g s per Newton step", name, gigabytes, seconds)


def rail_outline(surfaces: ProfileStrips) -> Array:
    """Places across, ascending, and heights (2, n) m of the rail's surface."""
    rail = surfaces.rail.point(np.linspace(*surfaces.rail.s_range, SAMPLES))
    return np.ascontiguousarray(rail[np.argsort(rail[:, 0])].T)


def margin(level: int) -> float:
    """Largest gap m that displacements may close on a level: the approach falls with the square of the width or, of
    long patches, less.
    """
    return float(GAP / 2**level)


def _start(guess: ContactResult | None) -> LatticeStart | None:
    """Warm start from an earlier result, if any."""
    start = None if guess is None else guess.warm_start
    return start if isinstance(start, LatticeStart) else None


def _without_cycle(model: LatticeContact, function: Callable[..., Result]) -> Callable[..., Result]:
    """Function of a model with a weak reference: the model owns the core's objects that call the function."""
    own = ref(model)

    def called(*arguments: object) -> Result:
        known = own()
        assert known is not None
        return function(known, *arguments)

    return called
