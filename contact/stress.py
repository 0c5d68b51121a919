"""Stress inside a body invariant along x or in angle, for given loads on its surface, by wavenumbers.

One factorisation and one (complex) right-hand side per wavenumber, where and when stresses are asked for. In the phases
of `forms.waveguide` the loads (i F_x, F_y, F_z) and amplitudes U of u = (-i U_0, U_1, U_2) e^{ikx} are complex and the
stiffness stays real.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import trapezoid
from scipy.spatial import cKDTree

from contact.cell_loads import CellLoads
from contact.pose import Array, Mask
from contact.section import Section
from contact.spectrum import Axis, interpolation, refine, rule
from forms.elasticity import lame
from forms.stress import cauchy

Complex = NDArray[np.complex128]

REACH = 2 * np.pi  # largest wavenumber times the cells' mean length: there a cell's load has its first zero
DECAY = 6.0  # largest wavenumber times the shallowest depth: beyond, e^-6 is left of what a smooth load has there
PATCH = 20  # nodes of the displacement whose cubic gives the gradient at a place, which takes at least 10


def stress(
    body: Section,
    loads: CellLoads,
    places: Array,
    *,
    tolerance: float = 2e-3,
    progress: Callable[[int, int], None] | None = None,
) -> Array:
    """Cauchy stress (m, 3, 3) Pa in body axes at places (m, 3) m inside the body.

    tolerance: of the interpolation between wavenumbers, relative to the largest stress amplitude's integral. Bodies of
    revolution have their axle along y through the origin, angles counted forward from straight below. Raises
    ValueError for places outside the section, and RuntimeError when 400 wavenumbers do not do.
    """
    chart = _Chart.of(body, places)
    spots, number = np.unique(np.round(chart.section, 12), axis=0, return_inverse=True)
    gradients = Gradients(body, spots)
    middle = 0.5 * (loads.x.min() + loads.x.max())
    half = float((np.abs(loads.x - middle) + 0.5 * loads.step).max())
    around = None if body.radius is None else 2 * np.pi * body.radius
    λ, μ = lame(body.steel.E, body.steel.nu)
    force = _local(body, loads)
    found: dict[float, Complex] = {}

    def take(wavenumbers: list[float]) -> None:
        for i, k in enumerate(wavenumbers):
            cell = force * (np.sinc(k * loads.step / (2 * np.pi)) * np.exp(-1j * k * (loads.x - middle)))[:, None]
            F = np.zeros((len(body.section.surface), 3), dtype=complex)
            np.add.at(F, loads.line, cell)
            F[:, 0] *= 1j
            U = body.displacement(k, np.column_stack([F.real.ravel(), F.imag.ravel()]))
            found[k] = cauchy(gradients(U[:, 0] + 1j * U[:, 1], k), λ, μ)
            if progress is not None:
                progress(len(found), len(found) + len(wavenumbers) - 1 - i)

    size = float(np.ptp(body.section.points, axis=0).max())
    depth = float(gradients.depth.min())
    largest = min(REACH / loads.mean_step, DECAY / depth if depth > 0 else np.inf)
    axis = Axis(1 / size, None if around is None else 2 * np.pi / around)
    first = axis.spaced(largest, 8)
    # the load's phases turn by k half: no interval may skip a turn
    take(axis.no_longer(first, 2.5 / half))
    scale = _integral(found)

    refine(found, take, axis, lambda low, high: (high - low) / scale, tolerance)
    known = np.array(sorted(found))
    samples = np.stack([found[k] for k in known])[:, number]
    x = chart.along - middle
    k, w = rule(known, float(np.abs(x).max()), around)
    back = (interpolation(known, axis.shift, k) * w[:, None]).T @ np.exp(1j * np.outer(k, x))
    return chart.turned(np.einsum("km,kmab->mab", back, samples).real)


class Gradients:
    """Gradients of a section's displacements at places (m, 2) m: cubics through the nodes around each.

    They are of third order at edges and corners of cells, too, where those of the cells' own quadratics are of second
    and jump (recovery by polynomials: Zhang and Naga, doi 10.1137/S1064827503402837).
    depth (m,) m below the contact surface.
    """

    def __init__(self, body: Section, places: Array) -> None:
        self.radius, self.places = body.radius, places
        inside = _inside(body, places)
        if not inside.all():
            raise ValueError(f"place {places[~inside][0]} m lies outside the section")
        corners = body.section.points[body.section.surface]
        self.depth = _depth(places, corners)
        distance, self.near = cKDTree(body.points).query(places, k=min(PATCH, len(body.points)))
        scale = distance[:, -1]
        offset = (body.points[self.near] - places[:, None]) / scale[:, None, None]
        a, b = offset[..., 0], offset[..., 1]
        powers = [a**i * b**j for i, j in CUBIC]
        # rows of the pseudo-inverse: value and slopes at the place as sums over the nodes
        inverse = np.linalg.pinv(np.stack(powers, axis=-1))[:, :3]
        self.value, self.slope = inverse[:, 0], inverse[:, 1:] / scale[:, None, None]

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
        r = self.places[:, 1]
        n = k * self.radius
        G[:, 0, 0] = (n * u[:, 0] + u[:, 2]) / r
        G[:, 1, 0] = 1j * n * u[:, 1] / r
        G[:, 2, 0] = 1j * (n * u[:, 2] + u[:, 0]) / r
        return G


CUBIC = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3))


@dataclass(frozen=True)
class _Chart:
    """Where places lie along a body, along (m,) m, and in its section (m, 2) m; angle (m,) rad about the axle."""

    along: Array
    section: Array
    angle: Array | None

    @classmethod
    def of(cls, body: Section, places: Array) -> _Chart:
        x, y, z = np.asarray(places, dtype=float).T
        if body.radius is None:
            return cls(x, np.column_stack([y, z]), None)
        angle = np.arctan2(x, -z)
        return cls(angle * body.radius, np.column_stack([y, np.hypot(x, z)]), angle)

    def turned(self, σ: Array) -> Array:
        """Stresses from axes (along, y, up or outward) to body axes."""
        if self.angle is None:
            return σ
        T = _axes(self.angle)
        return np.asarray(T @ σ @ T.swapaxes(-1, -2))


def _axes(angle: Array) -> Array:
    """Body axes' components (m, 3, 3) of the directions (along the circle, y, outward), a column each."""
    c, s, none = np.cos(angle), np.sin(angle), np.zeros_like(angle)
    return np.asarray(np.stack([c, none, s, none, none + 1, none, s, none, -c], axis=-1).reshape(-1, 3, 3))


def _local(body: Section, loads: CellLoads) -> Array:
    """Forces (n, 3) in axes (along, y, up or outward)."""
    if body.radius is None:
        return loads.force
    return np.asarray(np.einsum("nab,na->nb", _axes(loads.x / body.radius), loads.force))


def _integral(found: dict[float, Complex]) -> float:
    """Integral of the largest amplitude of stress over the wavenumbers, Pa: no stress is larger than its third."""
    known = sorted(found)
    return float(trapezoid([np.abs(found[k]).max() for k in known], known))


def _inside(body: Section, places: Array) -> Mask:
    """Which places (m, 2) m lie in a cell, or out of it by less than a twentieth: arcs stand off their chords."""
    a, b, c = np.moveaxis(body.section.points[body.section.cells], 1, 0)
    inverse = np.linalg.inv(np.stack([b - a, c - a], axis=-1))
    inside = np.empty(len(places), dtype=bool)
    for start in range(0, len(places), 256):
        share = np.einsum("nab,mnb->mna", inverse, places[start : start + 256, None] - a)
        within = (share > -0.05).all(axis=-1) & (share.sum(axis=-1) < 1.05)
        inside[start : start + 256] = within.any(axis=1)
    return inside


def _depth(places: Array, corners: Array) -> Array:
    """Distance (m,) m of places (m, 2) from the polyline through corners (n, 2)."""
    a, d = corners[:-1], np.diff(corners, axis=0)
    along = np.einsum("nmk,mk->nm", places[:, None] - a, d) / (d**2).sum(axis=1)
    foot = a + np.clip(along, 0.0, 1.0)[..., None] * d
    return np.asarray(np.hypot(*(places[:, None] - foot).transpose(2, 0, 1)).min(axis=1))


__all__ = ["CellLoads", "Gradients", "stress"]
