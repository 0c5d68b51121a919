"""Rail on pads: motion of its section by the load of a wheel, on top of the rail clamped at its foot."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from wheelrail.contact.elasticity.waveguide.spectrum import interpolation, quadrature
from wheelrail.contact.laws.material import Material
from wheelrail.contact.structure.rigid_section import section_modes
from wheelrail.meshes.bodies.outlines import Outline
from wheelrail.meshes.bodies.solids import Strip, body_key, section
from wheelrail.meshes.bodies.triangulation import Grading
from wheelrail.support.arrays import Array
from wheelrail.support.cache import cached, digest

SIZE = 2e-3  # m, of the surface's lines, over which the rigid motion is fitted
GRADING = Grading(first=1.0, growth=0.4, largest=8e-3)
LARGEST = 80.0  # 1/m, wavenumber; what the pads add decays as exp(-2 k h) over the height h = 0.17 m
SHIFT = 1.0  # 1/m, of the order of the wavenumber 1.6 /m of a rail on its pads
SMALLEST, SAMPLES = 0.03, 32  # 1/m, number; three times as many change the compliance by less than 1e-5


@dataclass(frozen=True)
class RailPads:
    """Stiffness of the rail's supports, linear and without uplift.

    Defaults: of medium stiffness. Spread along the rail as over the spacing of the sleepers.
    Parameters:
        vertical, lateral: N/m, of one pad with its fastening, normal to the foot and across.
        longitudinal: N/m, along the rail; None: as lateral.
        spacing: of the sleepers, m.

    Raises ValueError unless all are positive.
    """

    vertical: float = 100e6
    lateral: float = 40e6
    longitudinal: float | None = None
    spacing: float = 0.6

    def __post_init__(self) -> None:
        for name, value in asdict(self).items():
            if value is not None and not 0.0 < value < np.inf:
                raise ValueError(f"{name} = {value}: must be positive and finite")

    @property
    def per_length(self) -> tuple[float, float, float]:
        """Stiffness along the rail, across and normal to its foot, N/m2."""
        along = self.lateral if self.longitudinal is None else self.longitudinal
        return along / self.spacing, self.lateral / self.spacing, self.vertical / self.spacing


@dataclass(frozen=True)
class RailCompliance:
    """Compliance of a rail's section as a whole, relative to the rail clamped at its foot.

    It is what the pads add to the compliance of the running surface, by rigid motions of the section: it depends on
    the clamped line, and is not a beam's.
    Parameters:
        matrix: (3, 3), motion (y m, z m, roll rad) of the section at the foot's middle by a load (N, N, N m) about it;
            on discrete sleepers its mean over a span.
        foot: (2,) m, y and z of the foot's middle in the frame of the rail.
        misfit: largest part of what the pads add to the compliance that is not a rigid motion, relative to its largest.
        harmonics: (n, 3, 3), amplitudes of cos(2 pi m x / spacing), m = 1 .. n, with x from a sleeper; none on pads
            that are spread along the rail.
        spacing: of discrete sleepers, m.
    """

    matrix: Array
    foot: Array
    misfit: float
    harmonics: Array = field(default_factory=lambda: np.zeros((0, 3, 3)))
    spacing: float = np.inf

    def at(self, x: float) -> Array:
        """Compliance (3, 3) under a load at a distance x m from a sleeper."""
        return np.asarray(self.matrix + np.tensordot(self.cosines(x), self.harmonics, 1))

    def slope(self, x: float) -> Array:
        """Derivative (3, 3) of `at` by the distance, per m."""
        return np.asarray(np.tensordot(self.cosine_slopes(x), self.harmonics, 1))

    def cosines(self, x: float) -> Array:
        """cos(2 pi m x / spacing), m = 1 .. n, at a distance x m from a sleeper."""
        return np.asarray(np.cos(self._wavenumbers * x))

    def cosine_slopes(self, x: float) -> Array:
        """Derivatives (n,) 1/m of `cosines` by the distance."""
        return np.asarray(-self._wavenumbers * np.sin(self._wavenumbers * x))

    @property
    def _wavenumbers(self) -> Array:
        return 2.0 * np.pi / self.spacing * np.arange(1, len(self.harmonics) + 1)


def rail_compliance(outline: Outline, steel: Material, pads: RailPads) -> RailCompliance:
    """Compliance of the section of a rail on pads, from the cache or by 2.5D finite elements over wavenumbers.

    Parameters:
        outline: of the rail as laid.
        steel: material.
        pads: its supports.
    """
    strip, names = rail_strip(outline), ("matrix", "foot", "misfit")
    key = rail_key("rail on pads", outline, steel, pads)
    stored = cached(f"pads/{key}", lambda: _by_wavenumbers(outline, strip, steel, pads), names)
    return RailCompliance(stored["matrix"], stored["foot"], float(stored["misfit"]))


def rail_strip(outline: Outline) -> Strip:
    """Running surface of a rail, over which rigid motions of its section are fitted."""
    return Strip.on(outline, half_length=SIZE, size=SIZE)


def rail_key(kind: str, outline: Outline, steel: Material, pads: RailPads, **further: Any) -> str:
    """Cache key of a wavenumber computation on the section of a rail on pads; further: other inputs by name."""
    return digest(
        kind=kind,
        section=body_key("rail section", outline, rail_strip(outline), 0.0, "tetrahedron", GRADING),
        E=steel.E,
        nu=steel.nu,
        pads=pads.per_length,
        sampling=(LARGEST, SHIFT, SMALLEST, SAMPLES),
        **further,
    )


def wavenumber_samples() -> Array:
    """Wavenumbers (n,) 1/m at which sections on pads are solved."""
    return np.concatenate([[0.0], np.geomspace(SMALLEST, LARGEST, SAMPLES)])


def _by_wavenumbers(outline: Outline, strip: Strip, steel: Material, pads: RailPads) -> dict[str, Array]:
    """Arrays of `RailCompliance`: compliance at x = 0 of the surface on pads less that of the clamped rail."""
    from wheelrail.contact.elasticity.waveguide.section import WaveguideSection  # imports dolfinx
    from wheelrail.contact.structure.padded_section import PaddedSection

    mesh = section(outline, strip, grading=GRADING)
    padded, clamped = PaddedSection(mesh, steel, pads.per_length), WaveguideSection(mesh, steel, degree=2)
    foot = padded.foot.mean(axis=0)
    modes = section_modes(mesh.points[mesh.surface] - foot).reshape(-1, 3)
    inverse = np.linalg.pinv(modes)

    wavenumbers = wavenumber_samples()
    added = [_plane(padded.flexibility(k) - clamped.flexibility(k)) for k in wavenumbers]
    k, weight = quadrature(wavenumbers, 0.0)
    total = np.einsum("k,kab->ab", weight / np.pi @ interpolation(wavenumbers, SHIFT, k), np.stack(added))
    matrix = inverse @ total @ inverse.T
    misfit = np.abs(total - modes @ matrix @ modes.T).max() / np.abs(total).max()
    return {"matrix": 0.5 * (matrix + matrix.T), "foot": foot, "misfit": np.array(misfit)}


def _plane(H: Array) -> Array:
    """Rows and columns (2 n, 2 n) in y and z of a flexibility (3 n, 3 n)."""
    n = len(H) // 3
    return np.asarray(H.reshape(n, 3, n, 3)[:, 1:, :, 1:].reshape(2 * n, 2 * n))
