"""Resultant forces and patches from tractions at contact points."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy import ndimage

from wheelrail.bindings._contact import (
    PATCH_NUMBERS,
    BodyDisplacements,
    PatchPoints,
    on_material,
    patch_sums,
    store_patch,
)
from wheelrail.contact.geometry.grid_points import GridPoints
from wheelrail.contact.kinematics.frames import RigidMotion
from wheelrail.contact.kinematics.left_pair import velocities_of
from wheelrail.contact.results.patch_sums import patches_of
from wheelrail.contact.results.result import ContactResult, Fields, LazyPatches, Patch, Statistics
from wheelrail.support.arrays import Array, Mask, Nodes


def assemble_result(
    work: FrictionalWork,
    *,
    node: Nodes,
    patch: Nodes,
    pressure: Array,
    slip: Array,
    displacement: Array,
    approach: float,
    statistics: Statistics,
    bodies: Callable[[], Array] | None = None,
) -> ContactResult:
    """Converged result in the frame of the rail, moment about its origin.

    Parameters:
        work: points, tangential tractions and the bodies' motion.
        node, patch: (n,), as in `Fields`.
        pressure: (n,) Pa.
        slip: (n, 2) over the rolling speed; zero without rolling or friction.
        displacement: (n, 3) m, wheel minus rail.
        approach: largest undeformed penetration, m.
        statistics: of the solve.
        bodies: returns the displacements (2, 3, n) m of wheel and rail in the points' axes, by which patches lie on the
            material that touches; None: on that of the undeformed bodies.
    """
    points, traction = work.points, work.traction
    local = np.column_stack([traction, -pressure]) * points.area[:, None]
    forces = (local[:, None, :] @ points.axes)[:, 0]
    load = np.bincount(patch + 1, local[:, 2], patch.max(initial=-1) + 2)[1:]
    order = np.argsort(load, kind="stable")[: np.count_nonzero(load)]
    rank = np.full(len(load) + 1, -1)
    rank[order] = np.arange(len(order))
    patch = rank[patch]
    return ContactResult(
        force=forces.sum(axis=0),
        moment=np.cross(points.point, forces).sum(axis=0),
        patches=LazyPatches(partial(work.patches, patch, pressure, bodies)),
        fields=Fields(
            node,
            patch,
            points.point,
            points.axes,
            points.area,
            points.step,
            points.penetration,
            pressure,
            traction,
            slip,
            displacement,
            wheel_s=points.wheel_place[:, 0],
            rail_s=points.rail_place[:, 0],
        ),
        approach=approach,
        status="converged",
        statistics=statistics,
    )


@dataclass(frozen=True)
class FrictionalWork:
    """Tractions and rigid motion, for frictional power and stick.

    Parameters:
        points: n contact points.
        traction: (n, 2) Pa, on the wheel.
        sticks: (n,), whether the surfaces stick.
        motion: of the bodies.
        speed: rolling speed, m/s.
    """

    points: GridPoints
    traction: Array
    sticks: Mask
    motion: RigidMotion
    speed: float

    @classmethod
    def below(
        cls, bound: Array, points: GridPoints, traction: Array, motion: RigidMotion, speed: float
    ) -> FrictionalWork:
        """Points stick where the traction (n, 2) Pa is below a bound (n,) Pa, the largest possible one."""
        return cls(points, traction, np.hypot(*traction.T) < bound * (1 - 1e-9), motion, speed)

    def patches(self, patch: Nodes, pressure: Array, bodies: Callable[[], Array] | None) -> tuple[Patch, ...]:
        """All patches (n,), by decreasing load, from pressures (n,) Pa; bodies: as for `assemble_result`."""
        points, velocities = self.points, velocities_of(self.motion)
        fixed = np.ascontiguousarray  # as the core takes them
        moved = None if bodies is None else bodies()
        cells = PatchPoints(
            fixed(points.point),
            fixed(points.axes),
            fixed(points.axes[:, 0]),
            fixed(points.area),
            fixed(points.step),
            fixed(points.wheel_place),
            fixed(points.rail_place),
            fixed(pressure),
            fixed(self.traction),
            np.zeros(len(patch)) if moved is None else self._elastic_work(pressure, *moved),
            fixed(self.sticks),
        )
        rows = np.empty((patch.max(initial=-1) + 1, PATCH_NUMBERS))
        for k, row in enumerate(rows):
            inside = patch == k
            sums = patch_sums(inside, cells, velocities, self.speed)
            if moved is not None:
                own = BodyDisplacements(*(part[inside] for part in (moved[0][1], moved[1][1], moved[0][2])))
                sums = on_material(sums, own, points.wheel_place[inside, 0], (pressure * points.area)[inside])
            store_patch(sums, sums.peak, row)
            row[-1] = rows_of_points(points.wheel_place[inside, 0])
        return patches_of(rows)

    def _elastic_work(self, pressure: Array, wheel: Array, rail: Array) -> Array:
        """Work (n,) Pa on the displacements (3, n) m of both bodies, per length of travel.

        Upstream differences lose much of that of the tractions. By Betti's theorem it is also that of the pressure
        (n,) Pa, whose displacements follow the penetration: along the wheel's normals, while the rail remains straight.
        """
        turn = self.points.circle_curvature[1]
        return np.asarray(pressure * (self.points.slope - turn * rail[0]) - self.traction[:, 0] * turn * wheel[2])


def rows_of_points(place: Array) -> int:
    """Number of rows of a grid across a patch, or of points in the longest row if smaller.

    place: (n,) m, lateral places of its points on the wheel, the same within a row.
    """
    _, counts = np.unique(np.round(place, 9), return_counts=True)
    return int(min(len(counts), counts.max()))


def connected(nodes: Nodes, loaded: Mask, grid: tuple[int, int]) -> Nodes:
    """Patch number (n,) of nodes (n,) on a grid of a shape, -1 where unloaded."""
    patch = np.full(len(nodes), -1)
    patch[loaded] = components(nodes[loaded], grid)
    return patch


def components(nodes: Nodes, grid: tuple[int, int]) -> Nodes:
    """Number, from 0, of the connected patch (eight neighbours on a grid of a shape) of each node (n,)."""
    if not len(nodes):
        return np.empty(0, dtype=int)
    i, j = np.divmod(nodes, grid[1])
    i, j = i - i.min(), j - j.min()
    occupied = np.zeros((i.max() + 1, j.max() + 1), dtype=bool)
    occupied[i, j] = True
    labels, _ = ndimage.label(occupied, structure=np.ones((3, 3)))
    return np.asarray(labels[i, j] - 1)
