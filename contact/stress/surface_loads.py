"""Forces on the surface of a body's section, as loads for internal stresses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.support.arrays import Array, Nodes

if TYPE_CHECKING:
    from wheelrail.contact.elasticity.waveguide.section import WaveguideSection


@dataclass(frozen=True)
class CellLoads:
    """Forces on n cells of the surface.

    Parameters:
        x: (n,) m, centres along the body (on the circle of the section's radius for a body of revolution).
        line: (n,), number of their surface point.
        force: (n, 3) N in body axes, traction times area.
        step: (n,) m, or one for all, length of the cells along x.

    Raises ValueError for arrays of inconsistent shapes, and for values that are not finite.
    """

    x: Array
    line: Nodes
    force: Array
    step: Array | float

    def __post_init__(self) -> None:
        n = len(self.x)
        step = np.asarray(self.step, dtype=float)
        if n == 0 or self.line.shape != (n,) or self.force.shape != (n, 3) or step.shape not in ((), (n,)):
            raise ValueError(
                f"x, line, force and step of cells must be (n,), (n,), (n, 3), (n,), not {self.x.shape}, "
                f"{self.line.shape}, {self.force.shape}, {step.shape}"
            )
        if not (step > 0).all():
            raise ValueError(f"cells must have a positive length, not {step.min()} m")
        if not (np.isfinite(self.x).all() and np.isfinite(self.force).all()):
            raise ValueError("positions and forces of cells must be finite")

    @property
    def mean_step(self) -> float:
        """Mean length m of the cells, weighted by the forces."""
        size = np.linalg.norm(self.force, axis=1)
        return (
            float(np.broadcast_to(self.step, size.shape) @ size / size.sum())
            if size.any()
            else float(np.mean(self.step))
        )

    @classmethod
    def on(cls, shape: tuple[int, int], nodes: Nodes, force: Array, *, step: float) -> CellLoads:
        """Forces on nodes of the contact grid of the same body.

        Parameters:
            shape: (nx, ns) of the grid.
            nodes: (n,) of the flattened grid.
            force: (n, 3) N.
            step: m, between rows.
        """
        row, line = np.divmod(nodes, shape[1])
        return cls((row - shape[0] // 2) * step, line, force, step)

    @classmethod
    def over(cls, body: WaveguideSection, points: Array, force: Array, *, step: Array, width: Array) -> CellLoads:
        """Forces distributed uniformly over cells anywhere on the surface.

        Parameters:
            body: section.
            points: (n, 3) m, centres of the cells in body axes.
            force: (n, 3) N in body axes.
            step, width: (n,) m, lengths of the cells along the body and across.

        Every line receives the integral of its hat function, which preserves force and position. Raises ValueError for
        cells that extend beyond the lines of the section's surface.
        """
        along, section, metric = unrolled(body, points)
        corners = body.section.points[body.section.surface]
        at = arc_of(corners, section)
        arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))])
        low, high = at - 0.5 * width, at + 0.5 * width
        if low.min() < -0.5 * (arc[1] - arc[0]) or high.max() > arc[-1] + 0.5 * (arc[-1] - arc[-2]):
            raise ValueError("cells reach beyond the lines of the section's surface")
        lines = np.arange(len(arc))
        a, b = (np.interp(side, arc, lines)[:, None] for side in (low, high))
        fraction = (_hat_until(b - lines) - _hat_until(a - lines)) / (b - a)
        cell, line = np.nonzero(fraction > 0)
        line_force = force[cell] * fraction[cell, line][:, None]
        return cls(along[cell], line, line_force, (step / metric)[cell])


def unrolled(body: WaveguideSection, points: Array) -> tuple[Array, Array, Array]:
    """Coordinates of points: along the body (n,) m, in its section (n, 2) m, and metric factor (n,) of the former.

    The metric factor is the length at the point over that on the circle of the section's radius.

    Parameters:
        body: section.
        points: (n, 3) m in body axes.
    """
    x, y, z = np.asarray(points, dtype=float).T
    if body.radius is None:
        return x, np.column_stack([y, z]), np.ones(len(x))
    r = np.hypot(x, z)
    return np.arctan2(x, -z) * body.radius, np.column_stack([y, r]), r / body.radius


def arc_of(corners: Array, points: Array) -> Array:
    """Arc length (n,) m of the projections of points (n, 2) m on the polyline through corners (m, 2) m."""
    a, d = corners[:-1], np.diff(corners, axis=0)
    length = np.hypot(*d.T)
    t = np.clip(np.einsum("nmk,mk->nm", points[:, None] - a, d) / length**2, 0.0, 1.0)
    distance = np.linalg.norm(points[:, None] - (a + t[..., None] * d), axis=2)
    best = distance.argmin(axis=1)
    start = np.concatenate([[0.0], np.cumsum(length)])[best]
    return np.asarray(start + t[np.arange(len(best)), best] * length[best])


def _hat_until(t: Array) -> Array:
    """Integral up to t of the hat function on -1 .. 1."""
    t = np.clip(t, -1.0, 1.0)
    return np.where(t < 0, 0.5 * (1 + t) ** 2, 1 - 0.5 * (1 - t) ** 2)
