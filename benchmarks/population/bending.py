"""Lateral displacement and tilt of a clamped rail and wheel by a load, as of beams and plates.

The head of a rail is a beam that bends and twists on its web, a plate clamped at the underside of the foot. The rim of
a wheel is rigid, on a web that is an annular plate (Kirchhoff) clamped at the hub. Ignored: shear, bending of the rim
out of its plane, dishing of the web. NumPy and SciPy only; sections are those that a scene has by default.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.integrate import quad_vec

from benchmarks.population.profiles import Shape
from wheelrail.meshes.bodies.outlines import rail_outline
from wheelrail.meshes.bodies.wheel_web import WheelShape
from wheelrail.support.arrays import Array

E, NU = 2.1e11, 0.3
PLATE = E / (12.0 * (1.0 - NU**2))  # over the cube of the thickness
WIDE = 2.0  # times the narrowest width of the web, where the head begins
LEVELS = 400  # of the section of a rail


@dataclass(frozen=True)
class Bending:
    """A section that moves by u along y and turns by a about x under a load of one point.

    Parameters:
        reference: (2,) m, y and z of its place.
        compliance: (2, 2), of u m and a rad by the force N along y and the moment N m.
    """

    reference: tuple[float, float]
    compliance: Array

    def displacement(self, force: Array, at: Array, places: Array) -> Array:
        """Displacements (n, 2) m at places (n, 2) m by a force (2,) N at a place (2,) m: y and z."""
        y, z = at - self.reference
        u, a = self.compliance @ (force[0], y * force[1] - z * force[0])
        y, z = (places - self.reference).T
        return np.column_stack([u - a * z, a * y])


@cache
def bent_rail(shape: Shape) -> Bending:
    """Rail that stands upright, from the top of its profile.

    A load with the force F at the head's centre h and the moment m about it bends the web by the curvature
    (F (h - z) - m) / (PLATE t^3) at the height z, with the thickness t there. The head has E I k^4 and G J k^2 at the
    wavenumber k, J = A^4 / 40 I_p by Saint-Venant.
    """
    outline = rail_outline(shape.profile).polygon(5e-4)
    bottom, top = outline[:, 1].min(), outline[:, 1].max()
    step = (top - bottom) / LEVELS
    z = bottom + step * (np.arange(LEVELS) + 0.5)
    left, right = np.array([_crossings(outline, level) for level in z]).T
    width = right - left
    web = int(np.argmin(width))
    head = (np.arange(LEVELS) > web) & (width > WIDE * width[web])
    area = float(width[head].sum() * step)
    y = float((0.5 * (left + right) * width)[head].sum() * step / area)
    h = float((z * width)[head].sum() * step / area)
    across = float(((right - y) ** 3 - (left - y) ** 3)[head].sum() * step / 3.0)
    upright = float((width * (z - h) ** 2)[head].sum() * step)
    torsion = E / (2.0 * (1.0 + NU)) * area**4 / (40.0 * (across + upright))
    arm, soft = (h - z)[z < h], step / (PLATE * width[z < h] ** 3)
    moments = np.array([arm, -np.ones_like(arm)])  # of a force and of a moment about x, which turns the top to -y
    web_stiffness = np.linalg.inv(np.einsum("in,jn,n->ij", moments, moments, soft))

    def harmonic(k: float) -> Array:
        return np.linalg.inv(web_stiffness + np.diag([E * across * k**4, torsion * k**2])) / np.pi

    return Bending((y, h), quad_vec(harmonic, 0.0, np.inf)[0])


def _crossings(outline: Array, level: float) -> tuple[float, float]:
    """Smallest and largest y m at which a closed polygon (n, 2) m crosses a height m."""
    y, z = np.concatenate([outline, outline[:1]]).T
    k = np.flatnonzero((z[:-1] < level) != (z[1:] < level))
    crossing = y[k] + (level - z[k]) / (z[k + 1] - z[k]) * (y[k + 1] - y[k])
    return float(crossing.min()), float(crossing.max())


@cache
def bent_wheel(radius: float) -> Bending:
    """Wheel with a rolling radius m, from its centre: translation along its axle, and tilt.

    The deflection of the web is w0(r) + w1(r) cos(angle) with w0 = 1, r^2, ln r, r^2 ln r and w1 = r, r^3, 1 / r,
    r ln r, and the energy is PLATE t^3 / 2 int (lap w)^2 - 2 (1 - nu) (w_rr (w_r / r + w_pp / r^2) - w_rp^2).
    """
    shape = WheelShape()
    inner, outer, thickness = shape.hub_radius, radius - shape.rim_thickness, float(np.mean(shape.web))
    x, weight = np.polynomial.legendre.leggauss(40)
    r, weight = 0.5 * (inner + outer) + 0.5 * (outer - inner) * x, 0.5 * (outer - inner) * weight

    def terms(r: Array, n: int) -> Array:
        """Deflection, slope and second derivative (3, 4, ...)."""
        one, log = np.ones_like(r), np.log(r)
        if n:
            return np.array(
                [[r, r**3, 1 / r, r * log], [one, 3 * r**2, -1 / r**2, log + 1], [0 * r, 6 * r, 2 / r**3, 1 / r]]
            )
        return np.array(
            [
                [one, r**2, log, r**2 * log],
                [0 * r, 2 * r, 1 / r, r * (2 * log + 1)],
                [0 * r, 2 * one, -1 / r**2, 2 * log + 3],
            ]
        )

    stiffness = np.zeros(2)
    for n, (deflection, slope) in enumerate([(1.0, 0.0), (outer, 1.0)]):
        ends = np.concatenate([terms(np.array(end), n)[:2] for end in (inner, outer)])
        f, df, ddf = np.einsum("dkr,k->dr", terms(r, n), np.linalg.solve(ends, [0.0, 0.0, deflection, slope]))
        around, twist = df / r - n * f / r**2, n * (df / r - f / r**2)
        energy = (ddf + around) ** 2 - 2.0 * (1.0 - NU) * (ddf * around - twist**2)
        stiffness[n] = PLATE * thickness**3 * np.pi * (2 - n) * float((energy * r * weight).sum())
    return Bending((0.0, 0.0), np.diag(1.0 / stiffness))
