"""Rail compliance without the mean motion of the section, for hosts that model the track themselves.

With the motion m = D^T u of a section averaged with its mass, loads D spread likewise and rigid motions T of the
surface, the local flexibility of the surface at a wavenumber is

    H_loc = H_hh - H_hm T^T - T H_mh + T H_mm T^T,

the displacement relative to the mean motion of every slice by loads that each slice balances. It hardly depends on the
support. H_mm is the compliance of a beam.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.elasticity.waveguide.spectrum import interpolation, quadrature
from wheelrail.contact.laws.material import Material
from wheelrail.contact.structure.pads import (
    GRADING,
    SHIFT,
    RailCompliance,
    RailPads,
    rail_key,
    rail_strip,
    wavenumber_samples,
)
from wheelrail.contact.structure.rigid_section import section_modes
from wheelrail.meshes.bodies.outlines import Outline
from wheelrail.meshes.bodies.solids import Strip, section
from wheelrail.support.arrays import Array
from wheelrail.support.cache import cached

if TYPE_CHECKING:
    from wheelrail.contact.structure.padded_section import PaddedSection


@dataclass(frozen=True)
class SectionMotion:
    """Mean motion of the section of a rail on pads, about the middle of its foot.

    Parameters:
        beam: (3, 3), mean motion (y m, z m, roll rad) of the loaded section by a load (N, N, N m).
        own: (3, 3), what a rail clamped at its foot has beyond the local part, as rigid motion of its surface.
        foot: (2,) m, y and z of the foot's middle in the frame of the rail.
        misfit: largest part of it that is not a rigid motion, relative to its largest.
    """

    beam: Array
    own: Array
    foot: Array
    misfit: float

    @property
    def removed(self) -> RailCompliance:
        """Minus the compliance of the section's mean motion, to add to the compliance of a rail clamped at its foot."""
        return RailCompliance(-self.own, self.foot, self.misfit)


def section_motion(outline: Outline, steel: Material, pads: RailPads) -> SectionMotion:
    """Mean motion of the section of a rail on pads, from the cache or by 2.5D finite elements over wavenumbers.

    Parameters:
        outline: of the rail as laid.
        steel: material.
        pads: its supports, on which the local part hardly depends.
    """
    strip, key = rail_strip(outline), rail_key("section of a rail", outline, steel, pads)
    names = ("beam", "own", "foot", "misfit")
    stored = cached(f"sections/{key}", lambda: _by_wavenumbers(outline, strip, steel, pads), names)
    return SectionMotion(stored["beam"], stored["own"], stored["foot"], float(stored["misfit"]))


def _by_wavenumbers(outline: Outline, strip: Strip, steel: Material, pads: RailPads) -> dict[str, Array]:
    """Arrays of `SectionMotion`."""
    from wheelrail.contact.elasticity.waveguide.section import WaveguideSection  # imports dolfinx
    from wheelrail.contact.structure.padded_section import PaddedSection

    mesh = section(outline, strip, grading=GRADING)
    padded, clamped = PaddedSection(mesh, steel, pads.per_length), WaveguideSection(mesh, steel, degree=2)
    foot = padded.foot.mean(axis=0)
    surface = mesh.points[mesh.surface]
    modes = section_modes(surface - foot).reshape(-1, 3)
    inverse, spread = np.linalg.pinv(modes), mean_motion(padded, foot)
    wavenumbers = wavenumber_samples()
    beams, removed = [], []
    in_plane = np.arange(3 * len(surface)).reshape(-1, 3)[:, 1:].ravel()
    for k in wavenumbers:
        local, beam = local_flexibility(padded, float(k), modes, spread)
        beams.append(beam)
        removed.append(clamped.flexibility(float(k))[np.ix_(in_plane, in_plane)] - local)
    k, weight = quadrature(wavenumbers, 0.0)
    weights = weight / np.pi @ interpolation(wavenumbers, SHIFT, k)
    beam, total = (np.einsum("k,kab->ab", weights, np.stack(values)) for values in (beams, removed))
    own = inverse @ total @ inverse.T
    misfit = np.abs(total - modes @ own @ modes.T).max() / np.abs(total).max()
    return {"beam": beam, "own": 0.5 * (own + own.T), "foot": foot, "misfit": np.array(misfit)}


def mean_motion(body: PaddedSection, origin: Array) -> Array:
    """Weights (3 n, 3) of all displacements in the mean motion (y, z, roll about the origin) of the section."""
    size = 3 * len(body.points)
    rigid = np.zeros((len(body.points), 3, 3))
    rigid[:, 1:] = section_modes(body.points - origin)
    moved = body.mass @ rigid.reshape(size, 3)
    return np.asarray(moved @ np.linalg.inv(rigid.reshape(size, 3).T @ moved))


def local_flexibility(body: PaddedSection, k: float, modes: Array, spread: Array) -> tuple[Array, Array]:
    """Local flexibility (2 n, 2 n) in y and z of the surface's n corners, and that of the mean motion (3, 3), m2/N.

    Parameters:
        body: rail on its pads.
        k: wavenumber, 1/m.
        modes: (2 n, 3), rigid motions of the surface.
        spread: (3 nodes, 3), see `mean_motion`.
    """
    size = 3 * len(body.points)
    lines = body.cells[np.arange(body.cells.shape[0]).reshape(-1, 3)[:, 1:].ravel()]
    nodes = (3 * body.surface[:, None] + np.arange(3)).ravel()
    loads = np.zeros((size, lines.shape[0] + 3))
    loads[nodes, :-3], loads[:, -3:] = lines.toarray().T, spread
    flexibility = loads.T @ body.solve(k, loads)
    surface, cross, beam = flexibility[:-3, :-3], flexibility[:-3, -3:], flexibility[-3:, -3:]
    return surface - cross @ modes.T - modes @ cross.T + modes @ beam @ modes.T, beam
