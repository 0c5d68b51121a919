"""From tractions at contact points to forces and patches."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from scipy import ndimage

from wheelrail.contact.kinematics.contact_points import SurfacePoints
from wheelrail.contact.kinematics.creepage import shift
from wheelrail.contact.kinematics.frames import RigidMotion
from wheelrail.contact.results.result import ContactResult, Fields, LazyPatches, Patch, Statistics
from wheelrail.support.arrays import Array, Mask, Nodes


def assemble_result(
    rubbing: FrictionalWork,
    *,
    node: Nodes,
    patch: Nodes,
    pressure: Array,
    slip: Array,
    displacement: Array,
    approach: float,
    statistics: Statistics,
) -> ContactResult:
    """Converged result in the frame of the rail, moment about its origin.

    pressure (n,) Pa; slip (n, 2) over the rolling speed, which is 0 where nothing rolls or rubs; displacement (n, 3) m,
    wheel minus rail; node (n,) and patch (n,) as in `Fields`.
    """
    points, traction = rubbing.points, rubbing.traction
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
        patches=LazyPatches(partial(_summarised, rubbing, patch, forces, pressure)),
        fields=Fields(
            node,
            patch,
            points.point,
            points.axes,
            points.area,
            points.step,
            points.overlap,
            pressure,
            traction,
            slip,
            displacement,
        ),
        approach=approach,
        status="converged",
        statistics=statistics,
    )


@dataclass(frozen=True)
class FrictionalWork:
    """Places, tractions (n, 2) Pa on the wheel, where the surfaces stick (n,), the bodies' motion and rolling speed
    m/s.
    """

    points: SurfacePoints
    traction: Array
    sticks: Mask
    motion: RigidMotion
    speed: float

    @classmethod
    def below(
        cls, bound: Array, points: SurfacePoints, traction: Array, motion: RigidMotion, speed: float
    ) -> FrictionalWork:
        """Points stick where the traction stays below a bound (n,) Pa, the largest possible one."""
        return cls(points, traction, np.hypot(*traction.T) < bound * (1 - 1e-9), motion, speed)

    @cached_property
    def power(self) -> Array:
        """Power (n,) W of the tractions over the rigid slip.

        In steady rolling the patch as a whole turns this into heat: what elastic slip takes in one place it gives back
        in another. Sums of traction times slip tend to the same, but from 7 % below with 12 x 16 cells.
        """
        if self.speed == 0.0:
            return np.zeros(len(self.points.area))
        slip = shift(self.points, self.motion).reshape(2, -1)
        return np.asarray(-self.points.area * np.einsum("nk,kn->n", self.traction, slip))

    def creepage(self, point: Array, axes: Array) -> tuple[float, float, float]:
        """At a point (3,) m; axes forward, left and upward as rows (3, 3)."""
        if self.speed == 0.0:
            return 0.0, 0.0, 0.0
        wheel, rail = self.motion.wheel, self.motion.rail
        slip = axes @ (wheel.at(point) - rail.at(point)) / self.speed
        return float(slip[0]), float(slip[1]), float(axes[2] @ (wheel.rotation - rail.rotation)) / self.speed


def _summarised(rubbing: FrictionalWork, patch: Nodes, forces: Array, pressure: Array) -> tuple[Patch, ...]:
    """Every patch, by falling load."""
    return tuple(
        summarise(rubbing.points, patch == k, forces=forces, pressure=pressure, rubbing=rubbing)
        for k in range(patch.max(initial=-1) + 1)
    )


def connected(nodes: Nodes, loaded: Mask, grid: tuple[int, int]) -> Nodes:
    """Patch (n,) of each node, -1 where it is not loaded."""
    patch = np.full(len(nodes), -1)
    patch[loaded] = components(nodes[loaded], grid)
    return patch


def components(nodes: Nodes, grid: tuple[int, int]) -> Nodes:
    """Number, from 0, of the connected patch (eight neighbours on the grid) of each node."""
    if not len(nodes):
        return np.empty(0, dtype=int)
    i, j = np.divmod(nodes, grid[1])
    i, j = i - i.min(), j - j.min()
    picture = np.zeros((i.max() + 1, j.max() + 1), dtype=bool)
    picture[i, j] = True
    labels, _ = ndimage.label(picture, structure=np.ones((3, 3)))
    return np.asarray(labels[i, j] - 1)


def summarise(points: SurfacePoints, inside: Mask, *, forces: Array, pressure: Array, rubbing: FrictionalWork) -> Patch:
    """One patch: its resultant, place, angle and shape from the pressure's moments."""
    area, p = points.area[inside], pressure[inside]
    weight = p * area
    total = weight.sum()
    force = forces[inside].sum(axis=0)
    upward = -(weight[:, None] * points.axes[inside, 2]).sum(axis=0)
    upward /= np.linalg.norm(upward)
    forward = np.array([1.0, 0.0, 0.0]) - upward[0] * upward
    forward /= np.linalg.norm(forward)
    left = np.cross(upward, forward)
    x, (wheel_s, wheel_y), (rail_s, rail_y) = (
        weight @ points.point[inside, 0] / total,
        weight @ points.wheel_place[inside] / total,
        weight @ points.rail_place[inside] / total,
    )
    along = points.point[inside, 0] - x
    across = points.wheel_place[inside, 0] - wheel_s
    # a point stands for the part of the surface around it
    half = 0.5 * area / points.step[inside] * np.abs(points.axes[inside, 2, 2])
    wheel_band, rail_band = (
        (float((place[inside, 1] - half).min()), float((place[inside, 1] + half).max()))
        for place in (points.wheel_place, points.rail_place)
    )
    return Patch(
        area=float(area.sum()),
        max_pressure=float(p.max()),
        normal_force=float(force @ upward),
        force=force,
        tangential_force=(float(force @ forward), float(force @ left)),
        semi_axes=(float(np.sqrt(5 * (weight @ along**2) / total)), float(np.sqrt(5 * (weight @ across**2) / total))),
        contact_angle=float(np.arctan2(-upward[1], upward[2])),
        wheel_s=float(wheel_s),
        rail_s=float(rail_s),
        wheel_y=float(wheel_y),
        rail_y=float(rail_y),
        wheel_band=wheel_band,
        rail_band=rail_band,
        x=float(x),
        stick_area=float(area[rubbing.sticks[inside]].sum()),
        creepage=rubbing.creepage(weight @ points.point[inside] / total, np.stack([forward, left, upward])),
        frictional_power=float(rubbing.power[inside].sum()),
    )
