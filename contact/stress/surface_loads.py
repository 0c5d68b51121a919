"""Forces on the surface of a body's section, ready for stresses inside."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.support.arrays import Array, Nodes

if TYPE_CHECKING:
    from wheelrail.contact.elasticity.waveguide.section import WaveguideSection


@dataclass(frozen=True)
class CellLoads:
    """Forces [N] on cells of the surface: x (n,) m of their middles along the body (on the circle of the section's
    radius for one of revolution), line (n,) number of their surface point, force (n, 3) in body axes, traction times
    area; step (n,) m, or one for all, is the length of a cell along x. Raises ValueError when these do not go together.
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
        """Length m of a cell, the mean weighted by the forces."""
        size = np.linalg.norm(self.force, axis=1)
        return (
            float(np.broadcast_to(self.step, size.shape) @ size / size.sum())
            if size.any()
            else float(np.mean(self.step))
        )

    @classmethod
    def on(cls, shape: tuple[int, int], nodes: Nodes, force: Array, *, step: float) -> CellLoads:
        """Forces (n, 3) N on nodes (n,) of the (nx, ns) contact grid of the same body."""
        row, line = np.divmod(nodes, shape[1])
        return cls((row - shape[0] // 2) * step, line, force, step)

    @classmethod
    def over(cls, body: WaveguideSection, points: Array, force: Array, *, step: Array, width: Array) -> CellLoads:
        """Forces (n, 3) N spread evenly over cells anywhere on the surface, in body axes.

        points (n, 3) m are their middles, step (n,) and width (n,) m their lengths along the body and across. Every
        line takes the share of its hat function, which keeps force and place. Raises ValueError for cells that reach
        beyond the lines of the section's surface.
        """
        along, section, stretch = unrolled(body, points)
        corners = body.section.points[body.section.surface]
        at = arc_of(corners, section)
        arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))])
        low, high = at - 0.5 * width, at + 0.5 * width
        if low.min() < -0.5 * (arc[1] - arc[0]) or high.max() > arc[-1] + 0.5 * (arc[-1] - arc[-2]):
            raise ValueError("cells reach beyond the lines of the section's surface")
        lines = np.arange(len(arc))
        a, b = (np.interp(side, arc, lines)[:, None] for side in (low, high))
        share = (_hat_until(b - lines) - _hat_until(a - lines)) / (b - a)
        cell, line = np.nonzero(share > 0)
        part = force[cell] * share[cell, line][:, None]
        return cls(along[cell], line, part, (step / stretch)[cell])


def unrolled(body: WaveguideSection, points: Array) -> tuple[Array, Array, Array]:
    """Points (n, 3) m in body axes: lengths along the body (n,) m, places in its section (n, 2) m, and the length there
    over that on the circle of its radius (n,).
    """
    x, y, z = np.asarray(points, dtype=float).T
    if body.radius is None:
        return x, np.column_stack([y, z]), np.ones(len(x))
    r = np.hypot(x, z)
    return np.arctan2(x, -z) * body.radius, np.column_stack([y, r]), r / body.radius


def arc_of(corners: Array, places: Array) -> Array:
    """Length (n,) m along the polyline through corners (m, 2) at which it is nearest to places (n, 2) m."""
    a, d = corners[:-1], np.diff(corners, axis=0)
    length = np.hypot(*d.T)
    t = np.clip(np.einsum("nmk,mk->nm", places[:, None] - a, d) / length**2, 0.0, 1.0)
    distance = np.linalg.norm(places[:, None] - (a + t[..., None] * d), axis=2)
    best = distance.argmin(axis=1)
    start = np.concatenate([[0.0], np.cumsum(length)])[best]
    return np.asarray(start + t[np.arange(len(best)), best] * length[best])


def _hat_until(t: Array) -> Array:
    """Integral up to t of the hat function of unit width to both sides of 0."""
    t = np.clip(t, -1.0, 1.0)
    return np.where(t < 0, 0.5 * (1 + t) ** 2, 1 - 0.5 * (1 - t) ** 2)
