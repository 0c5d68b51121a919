"""Axle of a wheelset by its drawing: diameters over its length, journals, and the section joined to a wheel's."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from wheelrail.meshes.bodies.outlines import Outline
from wheelrail.meshes.bodies.triangulation import Grading, SectionMesh, triangulate_parts
from wheelrail.support.arrays import Array, Mask

SPACING = 4e-3  # m, of the lines on the running surface, over which loads are distributed
GRADING = Grading(first=1.0, growth=0.4, largest=8e-3)  # 12 and 5 mm change the hubs' roll by 2e-4 and 3e-4
AXIS = 1e-3  # m, radius of the hole of a solid axle: so small a one acts as the axis without conditions on it
SNAP = 1e-9  # m


@dataclass(frozen=True)
class AxleShape:
    """Half an axle, y from its middle outwards; the other half is its mirror image.

    Defaults: a wagon axle of 160 mm with seats of 185 mm for the hubs of `WheelShape` on running circles 1.5 m apart,
    and journals of 130 mm with centres 2 m apart; typical dimensions (EN 13103-1), not those of one drawing.
    Parameters:
        steps: (end y m, diameter m) of every cylinder, in order from the middle.
        journal: y of both ends of the bearing, m.
        bore: diameter of the hole of a hollow axle, m; 0: solid.

    Raises ValueError for inconsistent values.
    """

    steps: tuple[tuple[float, float], ...] = ((0.65, 0.160), (0.83, 0.185), (0.92, 0.160), (1.08, 0.130))
    journal: tuple[float, float] = (0.92, 1.08)
    bore: float = 0.0

    def __post_init__(self) -> None:
        ends = [0.0, *(end for end, _ in self.steps)]
        if not self.steps or any(not low < high for low, high in pairwise(ends)):
            raise ValueError(f"ends of an axle's steps must increase from 0, not {ends[1:]} m")
        if not 0.0 <= self.bore < min(diameter for _, diameter in self.steps) - 4 * AXIS:
            raise ValueError(f"a bore of {self.bore} m leaves less than {2e3 * AXIS:g} mm of an axle with {self.steps}")
        inner, outer = self.journal
        if not 0.0 < inner < outer <= ends[-1] + SNAP or self.diameter(inner, outer) is None:
            raise ValueError(f"the journal {self.journal} m must lie on one step of {self.steps}")

    @classmethod
    def typical(cls, diameter: float = 0.160, wheel_y: float = 0.75) -> AxleShape:
        """The default axle with another diameter m between the wheels, and running circles at +-wheel_y m."""
        collar = min(0.170, max(diameter, 0.160))
        ends = (wheel_y - 0.10, wheel_y + 0.08, wheel_y + 0.17, wheel_y + 0.33)
        return cls(tuple(zip(ends, (diameter, 0.185, collar, 0.130), strict=True)), ends[2:])

    def diameter(self, start: float, stop: float) -> float | None:
        """Diameter m of the step that contains an interval m; None if it lies on more than one."""
        low = 0.0
        for high, diameter in self.steps:
            if low - SNAP <= start and stop <= high + SNAP:
                return diameter
            low = high
        return None

    @property
    def journal_radius(self) -> float:
        """Radius of the journal, m."""
        diameter = self.diameter(*self.journal)
        assert diameter is not None
        return 0.5 * diameter

    def polygon(self, seat: tuple[float, float]) -> Array:
        """Corners (n, 2) m of the half section in (y, r), including the ends of seat and journal (m)."""
        hole = max(0.5 * self.bore, AXIS)
        corners, low = [(0.0, hole)], 0.0
        for high, diameter in self.steps:
            inside = [y for y in (*seat, *self.journal) if low + SNAP < y < high - SNAP]
            corners += [(y, 0.5 * diameter) for y in (low, *sorted(inside), high)]
            low = high
        corners.append((low, hole))
        distinct = [True, *(np.hypot(a[0] - b[0], a[1] - b[1]) > SNAP for a, b in pairwise(corners))]
        return np.array(corners)[distinct]


def wheelset_section(
    outline: Outline, axle: AxleShape, wheel_y: float, grading: Grading = GRADING
) -> tuple[SectionMesh, Mask]:
    """Half section of a wheelset in (y, r), wheel and axle joined along the seat, and which cells are the wheel's.

    Parameters:
        outline: of the wheel, y from its running circle.
        axle: its seat must cover the hub.
        wheel_y: y of the running circle, m.
        grading: of the mesh.

    The running surface has a node every 4 mm; the bore of the wheel is marked as clamped. Raises ValueError for an axle
    whose seat does not fit the hub.
    """
    arc = outline.profile.samples(SPACING, *outline.surface_range)
    wheel = np.vstack([outline.surface(arc), outline.boundary[1:-1]]) + np.array([wheel_y, 0.0])
    bore = outline.boundary[list(outline.clamped)] + np.array([wheel_y, 0.0])
    seat, radius = (float(bore[:, 0].min()), float(bore[:, 0].max())), float(bore[0, 1])
    diameter = axle.diameter(*seat)
    if diameter is None or abs(diameter - 2 * radius) > SNAP:
        raise ValueError(
            f"the axle must have the bore's diameter of {2 * radius:g} m from {seat[0]:g} to {seat[1]:g} m, "
            f"the ends of the hub; its steps are {axle.steps}"
        )
    mesh, part = triangulate_parts((wheel, axle.polygon(seat)), len(arc), size=SPACING, grading=grading)
    y, r = mesh.points.T
    on_bore = (np.abs(r - radius) < SNAP) & (y > seat[0] - SNAP) & (y < seat[1] + SNAP)
    return SectionMesh(mesh.points, mesh.cells, mesh.surface, on_bore), part == 0
