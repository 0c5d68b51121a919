"""Rail on pads at discrete sleepers: how its compliance changes along a span, by Floquet's theorem.

Pads of stiffness s per length act on a part of every span: with the spacing d, q = 2 pi / d and the length a of a pad
along the rail, the support is s (1 + sum g_m exp(i m q x)), m not 0, g_m = sin(pi m a / d) / (pi m a / d). It couples
the wavenumbers k_j = kappa + j q. Sleepers on ballast yield: with the ballast b per length and the means over the
pads h_j = sin(k_j a / 2) / (k_j a / 2) the support is less by n h_j h_l, n = s^2 / (s + b), for the mean motion of the
foot. With the motions f of the foot, their compliance F(k) on the pads spread along the rail, their amplitudes b(k) by
unit loads on the rail, and the coupling C_jl = S (g_(j-l) - 1_jl) - n h_j h_l,

    f_j + F_j sum_l C_jl f_l = b_j exp(-i k_j x),

and what the spread pads lack is the displacement by the forces -sum_l C_jl f_l.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct
from scipy.linalg import block_diag

from wheelrail.contact.elasticity.waveguide.spectrum import interpolation, quadrature
from wheelrail.contact.laws.material import Material
from wheelrail.contact.structure.hubs import DENSITY
from wheelrail.contact.structure.pads import (
    GRADING,
    SHIFT,
    RailCompliance,
    RailPads,
    rail_compliance,
    rail_key,
    rail_strip,
    wavenumber_samples,
)
from wheelrail.meshes.bodies.outlines import Outline
from wheelrail.meshes.bodies.solids import section
from wheelrail.support.arrays import Array
from wheelrail.support.cache import cached

PAD_LENGTH = 0.18  # m, along the rail: usual width of a sleeper's rail seat
DEGREE = 2  # of the foot's motions over its width; 3 changes the compliance by less than 1e-3
HARMONICS = 12  # of the compliance over a span; the last ones are below 1e-4 of its mean


@dataclass(frozen=True)
class SpreadSupport:
    """Foot of a rail on pads spread along the rail, at given wavenumbers k >= 0.

    Parameters:
        k: (n,) 1/m, the first zero.
        stiffness: (m, m) N/m2, of the spread pads by motions of the foot.
        compliance: (n, m, m) m2/N, of these motions.
        by_load: (n, m, 3), amplitudes of these motions by unit loads on the rail.
        inertia: (n, m + 3, m + 3), integrals over the section of density and products of its displacements by forces
            on the foot, conjugate to its motions, then by unit loads on the rail.
        odd: (m,), -1 for motions along the rail, whose sign changes with that of k, otherwise 1.
        seat: (m, 2), motions of the foot with a sleeper that moves across the foot or normal to it.
    """

    k: Array
    stiffness: Array
    compliance: Array
    by_load: Array
    inertia: Array
    odd: Array
    seat: Array

    def at(self, k: Array) -> tuple[Array, Array, Array]:
        """Compliance (j, m, m), amplitudes by loads (j, m, 3) and inertia (j, m + 3, m + 3) at wavenumbers (j,) of
        either sign.
        """
        weights = interpolation(self.k, SHIFT, np.abs(k))
        compliance, by_load, inertia = (
            np.tensordot(weights, values, 1) for values in (self.compliance, self.by_load, self.inertia)
        )
        sign = np.where(k[:, None] < 0.0, self.odd, 1.0)
        signs = np.concatenate([sign, np.ones((len(k), 3))], axis=1)
        return (
            sign[:, :, None] * compliance * sign[:, None, :],
            sign[:, :, None] * by_load,
            signs[:, :, None] * inertia * signs[:, None, :],
        )


@dataclass(frozen=True)
class FloquetWaves:
    """Rail at coupled wavenumbers under unit loads at p places.

    Parameters:
        weight: 1/m, of these wavenumbers in integrals along the rail.
        phase: (p, j), exp(-i k x).
        seat: (j,), mean over a pad.
        by_load: (j, m, 3), amplitudes of the foot's motions on spread pads.
        inertia: (j, m + 3, m + 3), see `SpreadSupport`.
        motions: (p, j, m, 3), amplitudes of the foot's motions.
        forces: (p, j, m, 3), that discrete pads exert on the foot beyond spread ones.
    """

    weight: float
    phase: NDArray[np.complex128]
    seat: Array
    by_load: Array
    inertia: Array
    motions: NDArray[np.complex128]
    forces: NDArray[np.complex128]

    @property
    def central_phase(self) -> NDArray[np.complex128]:
        """exp(-i kappa x) (p,) of the wavenumber of least size."""
        return np.asarray(self.phase[:, self.phase.shape[1] // 2])


@dataclass(frozen=True)
class Span:
    """Rail on equal pads at equal distances.

    Parameters:
        support: the same pads spread along the rail.
        spacing: of the sleepers, m.
        length: of a pad along the rail, m, at most the spacing; 0: point supports.
        ballast: (2,) N/m2, stiffness per length under the sleepers, across and normal to the foot; None: at rest.
    """

    support: SpreadSupport
    spacing: float
    length: float
    ballast: Array | None = None

    @property
    def sleeper_by_foot(self) -> Array:
        """Motions (2, m) of a sleeper by mean motions of the foot over its pad."""
        assert self.ballast is not None
        on_seat = self.support.seat.T @ self.support.stiffness
        return np.asarray(np.linalg.solve(on_seat @ self.support.seat + np.diag(self.ballast), on_seat))

    def places(self, count: int) -> Array:
        """Places (count + 1,) m from a sleeper to the middle of a span."""
        return 0.5 * self.spacing * np.linspace(0.0, 1.0, count + 1)

    def compliance(self, places: Array) -> Array:
        """Compliance (p, 3, 3), m/N, added by discrete sleepers under loads at places (p,) m from a sleeper."""
        added = np.zeros((len(places), 3, 3))
        for waves in self.waves(places):
            at_load = np.einsum("pj,jma,pjmb->pab", waves.phase.conj(), waves.by_load, waves.forces).real
            added += 0.5 * waves.weight * (at_load + at_load.transpose(0, 2, 1))
        return added

    def discrete(self, count: int) -> Array:
        """Harmonics g_(j-l) (count, count) of the support by discrete pads over that by spread ones."""
        j = np.arange(count)
        return np.asarray(np.sinc((j[:, None] - j) * self.length / self.spacing))

    def waves(self, places: Array) -> Iterator[FloquetWaves]:
        """Solutions over the wavenumbers kappa from 0 to q / 2 for loads at places (p,) m from a sleeper."""
        q, largest = 2.0 * np.pi / self.spacing, float(self.support.k[-1])
        order = max(0, int(largest / q - 0.5))  # wavenumbers kappa + j q up to the largest
        j = np.arange(-order, order + 1)
        zone = np.append(self.support.k[self.support.k < 0.5 * q], min(0.5 * q, largest))
        for kappa, weight in zip(*quadrature(zone, 0.0), strict=True):
            yield self._waves(kappa + q * j, weight / np.pi, places)

    def _waves(self, k: Array, weight: float, places: Array) -> FloquetWaves:
        stiffness = self.support.stiffness
        m, size = len(stiffness), len(k)
        compliance, by_load, inertia = self.support.at(k)
        seat = np.sinc(k * self.length / (2.0 * np.pi))
        change = np.kron(
            self.discrete(size) - np.eye(size), stiffness
        )  # C, rows and columns by wavenumber, then motion
        if self.ballast is not None:
            change -= np.kron(np.outer(seat, seat), stiffness @ self.support.seat @ self.sleeper_by_foot)
        system = np.eye(size * m) + block_diag(*compliance) @ change
        by_amplitude = np.linalg.solve(system, block_diag(*by_load)).reshape(size, m, size, 3)
        phase = np.exp(-1j * np.outer(places, k))
        motions = np.einsum("jmla,pl->pjma", by_amplitude, phase)
        forces = -np.einsum("jmln,plna->pjma", change.reshape(size, m, size, m), motions)
        return FloquetWaves(weight, phase, seat, by_load, inertia, motions, forces)


def cosines(values: Array) -> Array:
    """Amplitudes (n, ...) of cos(2 pi m x / d), m = 0 .. n - 1, by values (n, ...) at the n places of `Span.places`."""
    amplitudes = np.asarray(dct(values, type=1, axis=0)) / (len(values) - 1)
    amplitudes[[0, -1]] *= 0.5
    return amplitudes


def sleeper_compliance(outline: Outline, steel: Material, pads: RailPads, length: float = PAD_LENGTH) -> RailCompliance:
    """Compliance of the section of a rail on pads at discrete sleepers, over the distance from a sleeper.

    Parameters:
        outline: of the rail as laid.
        steel: material.
        pads: on the sleepers, at their spacing.
        length: of a pad along the rail, m.

    Raises ValueError for pads that are longer than the spacing.
    """
    length = checked_length(length, pads)
    key = rail_key("sleepers", outline, steel, pads, span=(pads.spacing, length, DEGREE, HARMONICS))

    def harmonics() -> dict[str, Array]:
        span = Span(spread_support(outline, steel, pads), pads.spacing, length)
        return {"harmonics": cosines(span.compliance(span.places(HARMONICS)))}

    mean, *others = cached(f"sleepers/{key}", harmonics, ("harmonics",))["harmonics"]
    spread = rail_compliance(outline, steel, pads)
    return replace(spread, matrix=spread.matrix + mean, harmonics=np.stack(others), spacing=pads.spacing)


def checked_length(length: float, pads: RailPads) -> float:
    """Length m of a pad along the rail; raises ValueError for one that is longer than the spacing."""
    if not 0.0 < length <= pads.spacing:
        raise ValueError(f"length = {length:g}: must be above 0 and at most the spacing of {pads.spacing:g} m")
    return length


def spread_support(outline: Outline, steel: Material, pads: RailPads) -> SpreadSupport:
    """Foot of a rail on continuously spread pads, from the cache or by 2.5D finite elements over wavenumbers."""
    names = ("stiffness", "compliance", "by_load", "inertia", "odd", "seat")
    key = rail_key("foot of a rail", outline, steel, pads, degree=DEGREE, density=DENSITY)
    stored = cached(f"pads/{key}", lambda: _by_wavenumbers(outline, steel, pads), names)
    return SpreadSupport(wavenumber_samples(), **stored)


def _by_wavenumbers(outline: Outline, steel: Material, pads: RailPads) -> dict[str, Array]:
    """Arrays of `SpreadSupport`."""
    from wheelrail.contact.structure.padded_section import PaddedSection  # imports dolfinx

    body = PaddedSection(section(outline, rail_strip(outline), grading=GRADING), steel, pads.per_length)
    modes, odd = body.foot_modes(DEGREE)
    supported = body.support @ modes
    stiffness = modes.T @ supported
    forces = supported @ np.linalg.inv(stiffness)  # on the foot, with unit amplitudes
    loads = np.concatenate([forces, body.section_loads()], axis=1)
    count, mass = len(odd), DENSITY * body.mass
    compliance, by_load, inertia = [], [], []
    for k in wavenumber_samples():
        displacements = body.solve(float(k), loads)
        of_foot = forces.T @ displacements
        compliance.append(of_foot[:, :count])
        by_load.append(of_foot[:, count:])
        inertia.append(displacements.T @ (mass @ displacements))
    return {
        "stiffness": stiffness,
        "compliance": np.stack(compliance),
        "by_load": np.stack(by_load),
        "inertia": np.stack(inertia),
        "odd": odd,
        "seat": np.eye(count)[:, [DEGREE + 1, 2 * (DEGREE + 1)]],  # constant across and normal to the foot
    }
