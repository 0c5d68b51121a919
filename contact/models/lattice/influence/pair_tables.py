"""Tables of the compliance between pairs of strips of a lattice, both bodies together, in the strips' own axes.

With G'' = C the compliance along x, the mean displacement of cells by forces on cells is a second difference of G. Near
its load a body is a half-space, whose part of G depends on the strips' widths and distances on the upper body alone and
is tabulated once for all poses; the deviation of finite bodies from half-spaces is smooth.

Cells of the tables: z = 1 + |x| / start, `CELLS` equal ones in every octave of z, polynomials of degree `DEGREE` in
each; means over contact cells err by 1e-7. Axes are longitudinal x, lateral t and outward normal n of the upper body
on either strip. Displacement by force is symmetric up to TN_TURN, ROLL and XN, which change their sign when the pair
is taken in the other order: C_tn = TN + TN_TURN, C_nt = TN - TN_TURN, C_xt = C_tx = XT, and C_xn = -C_nx = XN. The
coupling of normal with tangential directions, (1 + nu)(1 - 2 nu)/(2 pi E) times x/r^2 and y/r^2, has opposite signs in
both bodies: half-spaces of equal material have none. Parts with the other symmetry are neglected: (C_xt - C_tx)/2, up
to 1 % of XX at 5 mm and of the elastic slip, and (C_xn + C_nx)/2, about 0.1 %. The first five components are even
functions of x, the others odd. ROLL is added to C_xn alone: the radial component of u_n by pressure over R, integrated
along x. On a wheel the slip is -du_x/dx - u_r/R, for a compressed wheel rolls on a smaller radius. The rigid slip at s
has the radius there, but the material at s comes from s - u_t (`core/body_displacement.hpp`),
where the radius differs by as much as u_t adds to u_r: u_n alone remains.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wheelrail.bindings._contact import (
    COMPONENTS,
    DEGREE,
    START,
    BodyTables,
    BulkCompliance,
    Deviation,
    HalfSpaces,
    Lattice,
    LatticeStrips,
    PairTables,
    PoseMeans,
    complete_means,
    count_of,
    fill,
    start_of,
    strips_on_lines,
)
from wheelrail.contact.elasticity.waveguide.influence import ElementInfluence, HalfSpaceInfluence
from wheelrail.contact.geometry.strip_lattice import slenderness
from wheelrail.contact.geometry.strip_surfaces import QuadricStrips
from wheelrail.contact.models.lattice.influence.body_correction import (
    NO_MEANS,
    OUTWARD,
    BodyCorrection,
)
from wheelrail.contact.models.lattice.influence.pair_grid import RULE, PairGrid
from wheelrail.contact.models.lattice.influence.strip_operators import StripOperators
from wheelrail.support.arrays import Array, Mask, Nodes, aligned

GROWTH = 1.5  # of the storage
NO_LINES = np.zeros(0)
STORED = 16  # sets of strips whose deviations of each body are kept


@dataclass
class LatticeTables:
    """Tables of half-spaces under the strips of a lattice, computed when a pair is first needed.

    Parameters:
        operators: bodies and surfaces.
        sides: (K + 1,) m, lateral bounds of the strips on the upper body.
        rolls: whether displacements along x count by their slip, which contains u_r / R.
    """

    operators: StripOperators
    sides: Array
    rolls: bool = True
    _values: Array = field(init=False, repr=False)
    _used: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        self._values = aligned((4096, DEGREE + 1, COMPONENTS))
        self.middle = 0.5 * (self.sides[1:] + self.sides[:-1])
        self.width = np.diff(self.sides)
        tangent = self.operators.upper._tangents(self.middle)
        self.stretch = self.operators.surfaces.along(self.middle)
        angle = np.unwrap(np.arctan2(tangent[:, 1], tangent[:, 0]))
        self.strips = LatticeStrips(self.sides, angle, self.stretch)
        K = len(self.middle)
        # zeros take no memory until they are written: a lattice of narrow strips has thousands
        self._pair = np.zeros((K, K), dtype=np.int32)
        self._first, self._count, self._inverse = np.zeros(1, dtype=int), np.zeros(1, dtype=int), np.zeros(1)
        self._complete: set[bytes] = set()  # strips all of whose pairs have tables

    @cached_property
    def _corrections(self) -> tuple[BodyCorrection | None, BodyCorrection | None]:
        """Deviations of both bodies from half-spaces."""
        bodies = self.operators.upper, self.operators.lower
        upper, lower = (
            BodyCorrection(body, outward) if isinstance(body, ElementInfluence) else None
            for body, outward in zip(bodies, OUTWARD, strict=True)
        )
        return upper, lower

    @cached_property
    def modulus(self) -> float:
        """Contact modulus E* Pa of both bodies."""
        bodies = self.operators.upper, self.operators.lower
        return 1 / sum((1 - body.nu**2) * half_space_scale(body) for body in bodies)

    @property
    def bodies(self) -> tuple[tuple[int, BodyCorrection], ...]:
        """Finite bodies, each with its number: 0 upper, 1 lower."""
        return tuple((k, body) for k, body in enumerate(self._corrections) if body is not None)

    @cached_property
    def bulk(self) -> tuple[BulkCompliance, ...]:
        """Compliance of the finite bodies between their lines."""
        return tuple(body.bulk_compliance(which == 1 and self.moves) for which, body in self.bodies)

    @property
    def moves(self) -> bool:
        """Whether the compliance depends on where the strips lie on the lower body."""
        return self._corrections[1] is not None and not isinstance(self.operators.surfaces, QuadricStrips)

    @property
    def lines(self) -> Array:
        """Arc length (ns,) m of the lower body's lines; none where the compliance does not depend on places there."""
        lower = self._corrections[1]
        return lower.body.arc if lower is not None and self.moves else NO_LINES

    def of(self, strips: Nodes, at: PoseMeans) -> PairTables:
        """Tables of all pairs of some strips (C,) at a pose; later ones are not in them, see `holds`."""
        self.complete(strips)
        return PairTables(self._values, self._pair, self._first, self._count, self._inverse, at.place, at.smooth)

    def complete(self, strips: Nodes) -> None:
        """Add the tables that pairs of some strips (C,) lack."""
        key = strips.tobytes()
        if key not in self._complete:
            self._add(strips)
            self._complete.add(key)

    def holds(self, tables: PairTables) -> bool:
        """Whether these tables contain all pairs that have been added."""
        return tables.first is self._first

    def at(self, near: Mask, feet: Array, reach: float) -> PoseMeans:
        """What the tables of some strips take from a pose.

        Parameters:
            near: (K,) the strips.
            feet: (K,) m, arc length of their middles on the lower body.
            reach: m, longest distance along x.
        """
        if not self.moves:
            return self._no_means
        lower = self._corrections[1]
        assert lower is not None
        place, middle, width, part = strips_on_lines(self.lattice, near, feet)
        return PoseMeans(place, lower.means(middle, width, part, lower.grid.cells_up_to(reach)))

    @cached_property
    def slenderness(self) -> Array:
        """See `wheelrail.contact.geometry.strip_lattice.slenderness`, of all strips (K,)."""
        return slenderness(self.operators.surfaces, self.middle)

    @cached_property
    def lattice(self) -> Lattice:
        """The strips for compiled code."""
        carried, bounds = np.ones(len(self.middle), dtype=bool), np.array([-np.inf, np.inf])
        for which, body in self.bodies:
            ends = body.body.bounds[[0, -1]]
            if which == 1 and self.moves:
                bounds = ends
            else:
                half = 0.5 * self.width
                carried &= (self.middle - half >= ends[0]) & (self.middle + half <= ends[1])
        return Lattice(self.middle, self.width, self.stretch, carried, bounds)

    def body_tables(self, strips: Nodes, at: PoseMeans, reach: float) -> BodyTables:
        """Tables of each body of some loaded strips (S,); at: as for `of`; reach: as for `at`."""
        upper, lower = (self._of_means(self._deviation_means(which, strips, at, reach)) for which in (0, 1))
        return BodyTables(upper, lower, self._compliance_shares)

    def _deviation_means(self, which: int, strips: Nodes, at: PoseMeans, reach: float) -> PoseMeans:
        """Deviation of the upper (0) or lower (1) body; stored where it does not depend on the pose."""
        body = self._corrections[which]
        if body is None:
            return self._no_means
        if which == 1 and self.moves:
            return at
        key, cells = (which, strips.tobytes()), body.grid.cells_up_to(reach)
        known = self._stored_means.get(key)
        if known is None or known.smooth.values.shape[1] < cells:
            if len(self._stored_means) >= STORED:
                self._stored_means.clear()
            middle, width = self.middle[strips], self.width[strips]
            means = body.means(middle, width, covered_part(middle, width), cells)
            known = PoseMeans(self._places(strips), means)
            complete_means(known.smooth)
            self._stored_means[key] = known
        return known

    @cached_property
    def _stored_means(self) -> dict[tuple[int, bytes], PoseMeans]:
        return {}

    @cached_property
    def _no_means(self) -> PoseMeans:
        return PoseMeans(np.zeros(len(self.middle), dtype=int), NO_MEANS)

    @cached_property
    def _compliance_shares(self) -> Array:
        bodies = self.operators.upper, self.operators.lower
        compliance = np.array([(1 + body.nu) * half_space_scale(body) for body in bodies])
        return np.asarray(compliance / compliance.sum())

    def _of_means(self, means: PoseMeans) -> PairTables:
        """Tables that contain nothing but the coefficients of a deviation."""
        return PairTables(*self._zero_tables, means.place, means.smooth)

    @cached_property
    def _zero_tables(self) -> tuple[Array, NDArray[np.int32], Nodes, Nodes, Array]:
        """Values, numbers, first cells, numbers of cells and inverse starts of tables of zeros for all pairs."""
        K, cells = len(self.middle), len(PairGrid.over(START).lower)
        none, alike = np.zeros((cells, DEGREE + 1, COMPONENTS)), np.zeros((K, K), dtype=np.int32)
        return none, alike, np.zeros(1, dtype=int), np.array([cells]), np.array([1 / START])

    def _places(self, strips: Nodes) -> Nodes:
        """`PairTables.place` of some strips (C,)."""
        place = np.zeros(len(self.middle), dtype=int)
        place[strips] = np.arange(len(strips))
        return place

    def _add(self, strips: Nodes) -> None:
        """Add the tables that pairs of some strips (C,) lack."""
        first, second = np.triu_indices(len(strips))
        pairs = np.column_stack([strips[first], strips[second]])
        pairs = pairs[self._pair[pairs[:, 0], pairs[:, 1]] == 0]
        if not len(pairs):
            return
        start = np.array([start_of(self.strips, i, j) for i, j in pairs.tolist()])
        count = np.array([count_of(length) for length in start.tolist()])
        bounds = self._used + np.concatenate([[0], np.cumsum(count)])
        if bounds[-1] > len(self._values):
            larger = aligned((int(GROWTH * bounds[-1]), DEGREE + 1, COMPONENTS))
            larger[: self._used] = self._values[: self._used]
            self._values = larger
        fill(self.strips, pairs, self._half_spaces, *self._deviations(strips), RULE, bounds, self._values)
        i, j = pairs.T
        self._pair[i, j] = len(self._first) + np.arange(len(pairs))
        self._first = np.concatenate([self._first, bounds[:-1]])
        self._count = np.concatenate([self._count, count])
        self._inverse = np.concatenate([self._inverse, 1 / start])
        self._used = int(bounds[-1])

    @cached_property
    def _half_spaces(self) -> HalfSpaces:
        upper, lower = self.operators.upper, self.operators.lower
        scale = np.array([half_space_scale(body) for body in (upper, lower)])
        radius = upper.radius if self.rolls and self._corrections[0] is not None else None
        return HalfSpaces(np.array([upper.nu, lower.nu]), scale, np.array(OUTWARD), radius or 0.0)

    def _deviations(self, strips: Nodes) -> tuple[Deviation, Deviation]:
        """Deviations of both bodies that do not depend on the pose, for some strips (C,)."""
        upper, lower = self._corrections
        return self._deviation(upper, strips), self._deviation(None if self.moves else lower, strips)

    def _deviation(self, body: BodyCorrection | None, strips: Nodes) -> Deviation:
        if body is None:
            return Deviation(NO_MEANS.lines, 0, NO_MEANS.share)
        middle, width = self.middle[strips], self.width[strips]
        lines, between = body.between_lines(*covered_part(middle, width))
        share = np.zeros((len(self.middle), lines.stop - lines.start))
        share[strips] = body.shares(lines, middle, width)
        return Deviation(between, lines.start, share)


def covered_part(middle: Array, width: Array) -> tuple[float, float]:
    """Ends m of the part of a body that strips with middles and widths (C,) m cover."""
    return float((middle - 0.5 * width).min()), float((middle + 0.5 * width).max())


def half_space_scale(body: HalfSpaceInfluence) -> float:
    """Compliance 1/N m of the body's tables over that of unit modulus with lengths in m."""
    return body.scale * body.unit
