"""Stress inside a body invariant along x or in angle under loads on its surface, by wavenumbers."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from wheelrail.contact.elasticity.waveguide.coordinates import WaveguideCoordinates
from wheelrail.contact.elasticity.waveguide.section import WaveguideSection
from wheelrail.contact.stress.surface_loads import CellLoads
from wheelrail.contact.stress.wavenumbers import sampled
from wheelrail.forms.elasticity import lame
from wheelrail.forms.stress import cauchy
from wheelrail.support.arrays import Array, Complex, Mask

PATCH = 20  # nodes for the cubic of the gradient at a point, at least 10


def stress(
    body: WaveguideSection,
    loads: CellLoads,
    points: Array,
    *,
    tolerance: float = 2e-3,
) -> tuple[Array, int]:
    """Cauchy stress (m, 3, 3) Pa in body axes, and the number of wavenumbers used.

    Parameters:
        body: section.
        loads: on its surface.
        points: (m, 3) m, points inside the body; a body of revolution has its axle along y through the origin, angles
            measured forward from straight below.
        tolerance: of the interpolation between wavenumbers, relative to the integral of the largest stress amplitude.

    Raises ValueError for points outside the section, and RuntimeError if 400 wavenumbers do not suffice.
    """
    coordinates = WaveguideCoordinates.of(body, points)
    section_points, number = np.unique(np.round(coordinates.section, 12), axis=0, return_inverse=True)
    outside = ~inside(body, section_points)
    if outside.any():
        raise ValueError(f"point {section_points[outside][0]} m lies outside the section")
    gradients = Gradients(body, section_points)
    λ, μ = lame(body.steel.E, body.steel.nu)
    response = sampled(
        body,
        loads,
        lambda U, k: cauchy(gradients(U, k), λ, μ),
        shallowest=float(gradients.depth.min()),
        tolerance=tolerance,
    )
    tensor = np.einsum("km,kmab->mab", response.weights(coordinates.along), response.samples[:, number]).real
    return coordinates.rotated(tensor), len(response.k)


class Gradients:
    """Gradients of a section's displacements by cubics through the nearest nodes; depth (m,) m below the surface.

    Parameters:
        body: section.
        points: (m, 2) m, points of the section.

    They are of third order at edges and corners of cells as well, whereas those of the cells' own quadratics are of
    second order and discontinuous (recovery by polynomials: Zhang and Naga, doi 10.1137/S1064827503402837).
    """

    def __init__(self, body: WaveguideSection, points: Array) -> None:
        self.radius, self.points = body.radius, points
        corners = body.section.points[body.section.surface]
        self.depth = _depth(points, corners)
        distance, self.near = cKDTree(body.points).query(points, k=min(PATCH, len(body.points)))
        scale = distance[:, -1]
        offset = (body.points[self.near] - points[:, None]) / scale[:, None, None]
        a, b = offset[..., 0], offset[..., 1]
        powers = [a**i * b**j for i, j in CUBIC]
        # rows of the pseudo-inverse: value and slopes at the point as sums over the nodes
        inverse = np.linalg.pinv(np.stack(powers, axis=-1))[:, :3]
        self.value, self.slope = inverse[:, 0], inverse[:, 1:] / scale[:, None, None]
        self.value[distance[:, 0] < 1e-9 * scale] = np.eye(1, self.near.shape[1])  # exact at a node

    def displacement(self, U: Complex) -> Complex:
        """Displacements (m, 3) times e^{-ikx} in axes (along, y, up or outward), from U (3 n,)."""
        u = np.einsum("mn,mnc->mc", self.value, U.reshape(-1, 3)[self.near])
        return np.asarray(u * [-1j, 1.0, 1.0])

    def __call__(self, U: Complex, k: float) -> Complex:
        """Gradients (m, 3, 3) of u e^{-ikx}, rows components, columns derivatives (along, y, z or r), from U (3 n,)."""
        near = U.reshape(-1, 3)[self.near]
        u = np.einsum("mn,mnc->mc", self.value, near)
        D = np.einsum("mdn,mnc->mcd", self.slope, near)
        G = np.zeros((len(u), 3, 3), dtype=complex)
        G[:, :, 1:] = D
        G[:, 0, 1:] *= -1j
        if self.radius is None:
            G[:, 0, 0], G[:, 1:, 0] = k * u[:, 0], 1j * k * u[:, 1:]
            return G
        r = self.points[:, 1]
        n = k * self.radius
        G[:, 0, 0] = (n * u[:, 0] + u[:, 2]) / r
        G[:, 1, 0] = 1j * n * u[:, 1] / r
        G[:, 2, 0] = 1j * (n * u[:, 2] + u[:, 0]) / r
        return G


CUBIC = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3))


def inside(body: WaveguideSection, points: Array) -> Mask:
    """Mask (m,) of points (m, 2) m inside the mesh, with a margin of 5 % of a cell for arcs beyond their chords."""
    a, b, c = np.moveaxis(body.section.points[body.section.cells], 1, 0)
    inverse = np.linalg.inv(np.stack([b - a, c - a], axis=-1))
    result = np.empty(len(points), dtype=bool)
    for start in range(0, len(points), 256):
        barycentric = np.einsum("nab,mnb->mna", inverse, points[start : start + 256, None] - a)
        within = (barycentric > -0.05).all(axis=-1) & (barycentric.sum(axis=-1) < 1.05)
        result[start : start + 256] = within.any(axis=1)
    return result


def _depth(points: Array, corners: Array) -> Array:
    """Distance (m,) m of points (m, 2) m from the polyline through corners (n, 2) m."""
    a, d = corners[:-1], np.diff(corners, axis=0)
    along = np.einsum("nmk,mk->nm", points[:, None] - a, d) / (d**2).sum(axis=1)
    foot = a + np.clip(along, 0.0, 1.0)[..., None] * d
    return np.asarray(np.hypot(*(points[:, None] - foot).transpose(2, 0, 1)).min(axis=1))


__all__ = ["CellLoads", "Gradients", "stress"]
