"""Rail on pads at discrete sleepers on ballast: a track that moves along with a wheel, with matrices of the place.

Shapes are displacements under unit loads at rest, as in `wheelrail.contact.structure.ballast`, by Floquet's theorem
(`wheelrail.contact.structure.sleepers`), with a load at the place x. The sleepers' coordinates are their motions across
and normal to the foot, interpolated at the wheel by sinc functions: that of a sleeper when the wheel is over it. Masses
and stiffness M(x), K(x) are those of Ritz's method at every place, periodic in x. As the shapes follow the wheel, the
equations are those of Lagrange with the place as a parameter,

    d/dt (M(x) q') + D(x) q' + K(x) q = (l, 0).

Limits: pads and sleepers without gaps are spread layers, stiff ballast leaves pads on sleepers at rest.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wheelrail.contact.laws.material import Material
from wheelrail.contact.structure.ballast import Ballast, CoRunningTrack, LoadedTrack
from wheelrail.contact.structure.pads import RailPads, rail_compliance, rail_key
from wheelrail.contact.structure.sleepers import (
    DEGREE,
    HARMONICS,
    PAD_LENGTH,
    FloquetWaves,
    Span,
    checked_length,
    cosines,
    spread_support,
)
from wheelrail.meshes.bodies.outlines import Outline
from wheelrail.support.arrays import Array
from wheelrail.support.cache import cached


def sleeper_track(
    outline: Outline, steel: Material, pads: RailPads, ballast: Ballast, length: float = PAD_LENGTH
) -> CoRunningTrack:
    """Track under one wheel, from the cache or by 2.5D finite elements over wavenumbers.

    Parameters:
        outline: of the rail as laid.
        steel: material.
        pads: on the sleepers, at their spacing.
        ballast: under the sleepers.
        length: of a pad along the rail, m.

    Raises ValueError for pads that are longer than the spacing.
    """
    per_length, length = ballast.per_length(pads), checked_length(length, pads)
    inputs = {"span": (pads.spacing, length, DEGREE, HARMONICS), "ballast": per_length.tolist()}
    key = rail_key("sleepers on ballast", outline, steel, pads, mass=ballast.masses.tolist(), **inputs)
    spread = rail_compliance(outline, steel, pads)

    def harmonics() -> dict[str, Array]:
        span = Span(spread_support(outline, steel, pads), pads.spacing, length, per_length)
        loaded = loaded_tracks(span, span.places(HARMONICS), spread.matrix)
        layers = np.array(pads.per_length[1:]), per_length, ballast.masses / pads.spacing
        return {
            "compliance": cosines(np.stack([track.compliance for track in loaded])),
            "matrices": cosines(np.stack([track.reduced(*layers) for track in loaded])),
        }

    stored = cached(f"track/{key}", harmonics, ("compliance", "matrices"))
    (matrix, *varying), (matrices, *others) = stored["compliance"], stored["matrices"]
    rail = replace(spread, matrix=matrix, harmonics=np.stack(varying), spacing=pads.spacing)
    return CoRunningTrack(rail, matrices, *ballast.times(pads), np.stack(others))


def loaded_tracks(span: Span, places: Array, spread: Array) -> list[LoadedTrack]:
    """Integrals along the track under unit loads at places (p,) m from a sleeper.

    Parameters:
        span: with ballast.
        places: of the loads.
        spread: (3, 3), compliance of the rail on pads that are spread along it, on sleepers at rest.
    """
    count = len(places)
    inertia, strain, coupling = np.zeros((count, 3, 3)), np.zeros((count, 3, 3)), np.zeros((count, 3, 2))
    squares, under_load = np.zeros((count, 2)), np.zeros((count, 2))
    on_seat = span.support.stiffness @ span.support.seat
    for waves in span.waves(places):
        inertia += waves.weight * rail_inertia(waves)
        strain += waves.weight * pad_strain(span, waves)
        foot = np.einsum("j,pjma->pma", waves.seat, waves.motions)  # mean over the pads
        sleepers = np.einsum("sm,pms->ps", span.sleeper_by_foot, foot[:, :, :2])  # by a lateral, a vertical load
        coupling += waves.weight * np.einsum("pma,ms,ps->pas", foot.conj(), on_seat, sleepers).real
        squares += waves.weight * np.abs(sleepers) ** 2
        under_load += waves.weight * (waves.central_phase.conj()[:, None] * sleepers).real
    compliance = spread + span.compliance(places)
    coupling, squares = coupling / under_load[:, None, :], squares / under_load**2
    return [LoadedTrack(*values) for values in zip(compliance, inertia, strain, coupling, squares, strict=True)]


def rail_inertia(waves: FloquetWaves) -> Array:
    """Section integrals (p, 3, 3) of density times products of the rail's displacements, summed over wavenumbers."""
    loads = np.einsum("pj,ab->pjab", waves.phase, np.eye(3))
    amplitudes = np.concatenate([waves.forces, loads], axis=2)
    return np.asarray(np.einsum("pjma,jmn,pjnb->pab", amplitudes.conj(), waves.inertia, amplitudes).real)


def pad_strain(span: Span, waves: FloquetWaves) -> Array:
    """Products (p, 3, 3) of the foot's displacements with the stiffness of discrete pads, summed over wavenumbers."""
    discrete = span.discrete(waves.phase.shape[1])
    forces = np.einsum("jl,mn,plnb->pjmb", discrete, span.support.stiffness, waves.motions)
    return np.asarray(np.einsum("pjma,pjmb->pab", waves.motions.conj(), forces).real)
