"""Rail on pads at discrete sleepers: how its compliance changes along a span, by Floquet's theorem.

Pads of stiffness s per length act on a part of every span: with the spacing d, q = 2 pi / d and the length a of a pad
along the rail, the support is s (1 + sum g_m exp(i m q x)), m not 0, g_m = sin(pi m a / d) / (pi m a / d). It couples
the wavenumbers kappa + j q. With the motions f of the foot, their compliance F(k) on the pads spread along the rail and
their amplitudes b(k) by unit loads on the rail,

    f_j + F_j S sum_l g_(j-l) f_l = b_j exp(-i k_j x),    l not j,

and what the spread pads lack is the displacement by the forces -S sum g_(j-l) f_l.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from wheelrail.contact.elasticity.waveguide.spectrum import interpolation, quadrature
from wheelrail.contact.laws.material import Material
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
    """Foot of a rail on pads spread along it, at given wavenumbers k >= 0.

    Parameters:
        k: (n,) 1/m, the first zero.
        stiffness: (m, m) N/m2, of the spread pads by motions of the foot.
        compliance: (n, m, m) m2/N, of these motions.
        by_load: (n, m, 3), amplitudes of these motions by unit loads on the rail.
        odd: (m,), -1 for motions along the rail, whose sign changes with that of k, otherwise 1.
    """

    k: Array
    stiffness: Array
    compliance: Array
    by_load: Array
    odd: Array

    def at(self, k: Array) -> tuple[Array, Array]:
        """Compliance (j, m, m) and amplitudes by loads (j, m, 3) at wavenumbers (j,) of either sign."""
        weights = interpolation(self.k, SHIFT, np.abs(k))
        compliance, by_load = (np.tensordot(weights, values, 1) for values in (self.compliance, self.by_load))
        sign = np.where(k[:, None] < 0.0, self.odd, 1.0)
        return sign[:, :, None] * compliance * sign[:, None, :], sign[:, :, None] * by_load


def span_harmonics(support: SpreadSupport, spacing: float, length: float, count: int) -> Array:
    """Harmonics (1 + count, 3, 3), m/N, of what discrete pads add to the compliance at the load: its mean over the
    span, then the amplitudes of cos(2 pi m x / spacing).

    Parameters:
        support: the same pads spread along the rail.
        spacing: of the sleepers, m.
        length: of a pad along the rail, m, at most the spacing; 0: point supports.
        count: of harmonics besides the mean.
    """
    q, largest = 2.0 * np.pi / spacing, float(support.k[-1])
    order = max(0, int(largest / q - 0.5))  # wavenumbers kappa + j q up to the largest
    j = np.arange(-order, order + 1)
    difference = j[:, None] - j[None, :]
    coupling = np.where(difference == 0, 0.0, np.sinc(difference * length / spacing))
    m, size = len(support.stiffness), len(j)
    change = np.kron(coupling, support.stiffness)  # S g_(j-l), rows and columns by wavenumber, then motion
    zone = np.append(support.k[support.k < 0.5 * q], min(0.5 * q, largest))
    harmonics = np.zeros((2 * size - 1, 3, 3))
    for kappa, weight in zip(*quadrature(zone, 0.0), strict=True):
        compliance, by_load = support.at(kappa + q * j)
        blocks = np.zeros((size, m, size, m))
        blocks[np.arange(size), :, np.arange(size)] = compliance
        system = np.eye(size * m) + blocks.reshape(size * m, size * m) @ change
        reaction = change @ np.linalg.inv(system)  # -forces by the motions on spread pads
        added = np.einsum("jma,jmln,lnb->jlab", by_load, reaction.reshape(size, m, size, m), by_load)
        np.add.at(harmonics, difference + size - 1, -weight / np.pi * added)
    even = 0.5 * (harmonics + harmonics[::-1])[size - 1 :]
    even = 0.5 * (even + even.transpose(0, 2, 1)) * np.where(np.arange(size) == 0, 1.0, 2.0)[:, None, None]
    out = np.zeros((1 + count, 3, 3))
    kept = min(len(even), 1 + count)
    out[:kept] = even[:kept]
    return out


def sleeper_compliance(outline: Outline, steel: Material, pads: RailPads, length: float = PAD_LENGTH) -> RailCompliance:
    """Compliance of the section of a rail on pads at discrete sleepers, over the distance from a sleeper.

    Parameters:
        outline: of the rail as laid.
        steel: material.
        pads: on the sleepers, at their spacing.
        length: of a pad along the rail, m.

    Raises ValueError for pads that are longer than the spacing.
    """
    if not 0.0 < length <= pads.spacing:
        raise ValueError(f"length = {length:g}: must be above 0 and at most the spacing of {pads.spacing:g} m")
    key = rail_key("sleepers", outline, steel, pads, span=(pads.spacing, length, DEGREE, HARMONICS))

    def harmonics() -> dict[str, Array]:
        return {"harmonics": span_harmonics(spread_support(outline, steel, pads), pads.spacing, length, HARMONICS)}

    mean, *others = cached(f"sleepers/{key}", harmonics, ("harmonics",))["harmonics"]
    spread = rail_compliance(outline, steel, pads)
    return replace(spread, matrix=spread.matrix + mean, harmonics=np.stack(others), spacing=pads.spacing)


def spread_support(outline: Outline, steel: Material, pads: RailPads) -> SpreadSupport:
    """Foot of a rail on pads that are spread along it, by 2.5D finite elements over wavenumbers."""
    from wheelrail.contact.structure.padded_section import PaddedSection  # imports dolfinx

    body = PaddedSection(section(outline, rail_strip(outline), grading=GRADING), steel, pads.per_length)
    modes, odd = body.foot_modes(DEGREE)
    supported = body.support @ modes
    stiffness = modes.T @ supported
    forces = supported @ np.linalg.inv(stiffness)  # on the foot, with unit amplitudes
    loads = np.concatenate([forces, body.section_loads()], axis=1)
    k, count = wavenumber_samples(), len(odd)
    displacements = np.stack([forces.T @ body.solve(float(wavenumber), loads) for wavenumber in k])
    return SpreadSupport(k, stiffness, displacements[:, :, :count], displacements[:, :, count:], odd)
