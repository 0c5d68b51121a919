"""Track that moves along with a wheel: masses of rail and sleepers on pads and ballast, by Ritz's method.

Sleepers on ballast are spread along the rail, a second layer under the pads, as halves of their own under each rail or
rigid across (`Ballast.rigid`). Shapes of the rail are its displacements under unit loads at rest, those of the sleepers
their displacements under a lateral and a vertical load. With the motions q of the rail's section under the wheel (y, z,
roll) and of the sleepers there (across, normal),

    M q'' + D q' + K q = (l, 0)

has the static compliance of the whole track and the mass that its energy at low frequency demands: the receptance is
exact to the first order in its square. Displacements travel with the wheel as in a track at rest, which holds well
below the speed of bending waves, some hundred metres per second. At discrete sleepers the matrices depend on the place
(`wheelrail.contact.structure.ballasted_sleepers`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
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

HELD = 1e12  # N/m, in place of the lateral stiffness of ballast where a sleeper cannot move


@dataclass(frozen=True)
class Ballast:
    """Sleepers on ballast, half a sleeper under each rail, and the dampers of both layers.

    Defaults: a sleeper of concrete on ballast of medium stiffness. Lateral dampers have the ratio of damping to
    stiffness of the vertical ones; sleepers neither roll nor move along the track.
    Parameters:
        sleeper_mass: of half a sleeper, kg.
        vertical, lateral: stiffness of the ballast under it, N/m.
        pad_damping: of one pad, vertical, N s/m.
        damping: of the ballast under half a sleeper, vertical, N s/m.
        inertia: of the sleepers' motion normal to the foot, over their mass.

    Raises ValueError unless all are positive.
    """

    sleeper_mass: float = 150.0
    vertical: float = 80e6
    lateral: float = 40e6
    pad_damping: float = 30e3
    damping: float = 60e3
    inertia: float = 1.0

    def __post_init__(self) -> None:
        for name, value in asdict(self).items():
            if not 0.0 < value < np.inf:
                raise ValueError(f"{name} = {value}: must be positive and finite")

    def rigid(self, length: float, rail_y: float) -> tuple[Ballast, Ballast]:
        """Layers of one rail on rigid sleepers under loads of both rails to the same side, and under mirrored loads.

        Parameters:
            length: of the sleepers, m, over which mass and ballast are uniform.
            rail_y: half the distance of the rails, m.

        Under vertical loads of opposite signs a sleeper rolls, with L^2 / (12 y^2) of its mass and its ballast at the
        rails. Mirrored loads do not move it across.
        """
        roll = length**2 / (12.0 * rail_y**2)
        rolling = replace(self, vertical=roll * self.vertical, damping=roll * self.damping, inertia=roll * self.inertia)
        return rolling, replace(self, lateral=HELD)

    @property
    def masses(self) -> Array:
        """Inertia (2,) kg of half a sleeper across and normal to the foot."""
        return self.sleeper_mass * np.array([1.0, self.inertia])

    def per_length(self, pads: RailPads) -> Array:
        """Stiffness (2,) N/m2 per length of rail, across and normal to the foot, at the spacing of the pads."""
        return np.array([self.lateral, self.vertical]) / pads.spacing

    def times(self, pads: RailPads) -> tuple[float, float]:
        """Damping over stiffness of pads and of ballast, s."""
        return self.pad_damping / pads.vertical, self.damping / self.vertical


@dataclass(frozen=True)
class Layers:
    """Rail on two layers under unit loads (y, z, roll) on its section, at wavenumbers.

    Parameters:
        k: (n,) 1/m, the first zero.
        pads, ballast: (2,) N/m2, stiffness of the layers across and normal to the foot.
        sleepers: (2,) kg/m, inertia of half the sleepers across and normal to the foot.
        compliance: (n, 3, 3), motion of the section beyond that of the rail clamped at its foot.
        inertia: (n, 3, 3), integral of density and squared displacements over the section.
        strain: (n, 3, 3), integral of the squared displacements of the foot with the stiffness of the pads.
        foot: (n, 2, 3), mean displacement of the foot, across and normal to it.
    """

    k: Array
    pads: Array
    ballast: Array
    sleepers: Array
    compliance: Array
    inertia: Array
    strain: Array
    foot: Array

    def along(self, values: Array) -> Array:
        """Integral (...) of squares along the rail, or value at the load, by amplitudes (n, ...)."""
        k, weight = quadrature(self.k, 0.0)
        return np.tensordot(weight / np.pi @ interpolation(self.k, SHIFT, k), values, 1)


@dataclass(frozen=True)
class LoadedTrack:
    """Integrals along a track at rest, under unit loads (y, z, roll) on the rail's section.

    Parameters:
        compliance: (3, 3), motion of the section beyond that of the rail clamped at its foot.
        inertia: (3, 3), of density and products of the rail's displacements.
        strain: (3, 3), of products of the foot's displacements with the stiffness of the pads.
        coupling: (3, 2), of the foot's displacements and the sleepers', across and normal, with that stiffness.
        squares: (2,) m, of the sleepers' displacements across and normal to the foot; 1 under the load.
    """

    compliance: Array
    inertia: Array
    strain: Array
    coupling: Array
    squares: Array

    def reduced(self, pads: Array, ballast: Array, sleepers: Array) -> Array:
        """Matrices (4, 5, 5) of Ritz's method: mass, and stiffness of pads, of ballast, and of the rail.

        Parameters:
            pads, ballast: (2,) N/m2, stiffness of the layers per length, across and normal to the foot.
            sleepers: (2,) kg/m, inertia per length across and normal to the foot.
        """
        loads = np.linalg.inv(self.compliance)
        mass, by_pads, by_ballast, rest = out = np.zeros((4, 5, 5))
        mass[:3, :3] = loads @ self.inertia @ loads
        mass[3:, 3:] = np.diag(sleepers * self.squares)
        by_pads[:3, :3] = loads @ self.strain @ loads
        by_pads[:3, 3:] = -loads @ self.coupling
        by_pads[3:, :3] = by_pads[:3, 3:].T
        by_pads[3:, 3:] = np.diag(pads * self.squares)
        by_ballast[3:, 3:] = np.diag(ballast * self.squares)
        on_sleepers = np.linalg.solve(by_pads[3:, 3:] + by_ballast[3:, 3:], by_pads[3:, :3])
        rest[:3, :3] = loads - by_pads[:3, :3] + by_pads[:3, 3:] @ on_sleepers  # the whole has the compliance
        return out


@dataclass(frozen=True)
class CoRunningTrack:
    """Track under one wheel: y m, z m and roll rad of the rail about its foot, then motion m of the sleepers across and
    normal to the foot.

    Parameters:
        rail: static compliance of the rail, on pads and ballast.
        matrices: (4, 5, 5), mass kg, kg m and kg m2, and stiffness of pads, of ballast, and of the rail; at discrete
            sleepers their means over a span.
        pad_time, ballast_time: s, damping over stiffness of both layers.
        harmonics: (n, 4, 5, 5), amplitudes of cos(2 pi m x / spacing), m = 1 .. n, with x from a sleeper; none on
            sleepers that are spread along the rail.
    """

    rail: RailCompliance
    matrices: Array
    pad_time: float
    ballast_time: float
    harmonics: Array = field(default_factory=lambda: np.zeros((0, 4, 5, 5)))

    def at(self, x: float) -> CoRunningTrack:
        """The track under a wheel at a distance x m from a sleeper."""
        return self._with(self.matrices + np.tensordot(self.rail.cosines(x), self.harmonics, 1))

    def slope(self, x: float) -> CoRunningTrack:
        """Derivatives of the matrices of `at` by the distance, per m."""
        return self._with(np.tensordot(self.rail.cosine_slopes(x), self.harmonics, 1))

    def _with(self, matrices: Array) -> CoRunningTrack:
        return replace(self, matrices=matrices, harmonics=np.zeros((0, 4, 5, 5)))

    @property
    def mass(self) -> Array:
        """Mass (5, 5)."""
        return np.asarray(self.matrices[0])

    @property
    def pads(self) -> Array:
        """Stiffness (5, 5) of the pads."""
        return np.asarray(self.matrices[1])

    @property
    def ballast(self) -> Array:
        """Stiffness (5, 5) of the ballast."""
        return np.asarray(self.matrices[2])

    @property
    def rest(self) -> Array:
        """Stiffness (5, 5) of the rail."""
        return np.asarray(self.matrices[3])

    @property
    def stiffness(self) -> Array:
        """Stiffness (5, 5)."""
        return np.asarray(self.matrices[1:].sum(axis=0))

    @property
    def damping(self) -> Array:
        """Damping (5, 5)."""
        return self.pad_time * self.pads + self.ballast_time * self.ballast

    def receptance(self, frequency: complex) -> NDArray[np.complex128]:
        """Receptance (3, 3) of the rail for harmonic loads proportional to exp(2 pi i f t); frequency: f, Hz."""
        omega = 2.0 * np.pi * frequency
        dynamic = self.stiffness + 1j * omega * self.damping - omega**2 * self.mass
        return np.asarray(np.linalg.inv(dynamic)[:3, :3])


def of_both_sides(same: Sequence[Array], mirrored: Sequence[Array] | None) -> Array:
    """Matrix (2 n, 2 n) of both sides as left-hand ones, each (n, n).

    Parameters:
        same: of the left and the right side under loads to the same side.
        mirrored: under loads that are mirror images; None: the sides are independent.
    """
    if mirrored is None:
        return np.asarray(block_diag(*same))
    across = 0.25 * sum(s - a for s, a in zip(mirrored, same, strict=True))
    left, right = (0.5 * (s + a) for s, a in zip(mirrored, same, strict=True))
    return np.block([[left, across], [across, right]])


def co_running(layers: Layers, rail: RailCompliance, times: tuple[float, float]) -> CoRunningTrack:
    """Ritz's reduction of a rail on two layers.

    Parameters:
        layers: the rail under unit loads.
        rail: its static compliance.
        times: s, damping over stiffness of pads and ballast.
    """
    sleepers = np.stack([layers.foot[:, 0, 0], layers.foot[:, 1, 1]], axis=1)
    sleepers = sleepers * layers.pads / (layers.pads + layers.ballast)
    shape = sleepers / layers.along(sleepers)
    loaded = LoadedTrack(
        rail.matrix,
        layers.along(layers.inertia),
        layers.along(layers.strain),
        layers.along(np.einsum("nda,nd->nad", layers.foot, layers.pads * shape)),
        layers.along(shape**2),
    )
    return CoRunningTrack(rail, loaded.reduced(layers.pads, layers.ballast, layers.sleepers), *times)


def co_running_track(outline: Outline, steel: Material, pads: RailPads, ballast: Ballast) -> CoRunningTrack:
    """Track under one wheel, from the cache or by 2.5D finite elements over wavenumbers.

    Parameters:
        outline: of the rail as laid.
        steel: material.
        pads: its supports.
        ballast: under the sleepers, at the spacing of the pads.
    """
    per_length = ballast.per_length(pads)
    names = ("compliance", "inertia", "strain", "foot", "middle")
    key = rail_key("co-running track", outline, steel, pads, ballast=per_length.tolist(), density=DENSITY)
    stored = cached(f"track/{key}", lambda: _by_wavenumbers(outline, steel, pads, per_length), names)
    layers = Layers(
        wavenumber_samples(),
        np.array(pads.per_length[1:]),
        per_length,
        ballast.masses / pads.spacing,
        *(stored[name] for name in names[:4]),
    )
    matrix = layers.along(layers.compliance)
    rail = RailCompliance(0.5 * (matrix + matrix.T), stored["middle"], rail_compliance(outline, steel, pads).misfit)
    return co_running(layers, rail, ballast.times(pads))


def _by_wavenumbers(outline: Outline, steel: Material, pads: RailPads, ballast: Array) -> dict[str, Array]:
    """Arrays of `Layers` by wavenumber, and the middle of the foot.

    Sleepers on ballast B reduce the support of the pads, k on the mean motions of the foot, by k^2 / (k + B).
    """
    from wheelrail.contact.elasticity.waveguide.section import WaveguideSection  # imports dolfinx
    from wheelrail.contact.structure.padded_section import PaddedSection

    mesh = section(outline, rail_strip(outline), grading=GRADING)
    padded, clamped = PaddedSection(mesh, steel, pads.per_length), WaveguideSection(mesh, steel, degree=2)
    stiffness = np.array(pads.per_length[1:])
    modes, _ = padded.foot_modes(0)
    mean = padded.support @ modes[:, 1:] / stiffness
    loads, fit = padded.section_loads(), padded.section_fit()
    support, mass = padded.support, DENSITY * padded.mass
    in_plane = np.arange(3 * fit.shape[1] // 2).reshape(-1, 3)[:, 1:].ravel()
    out: dict[str, list[Array]] = {"compliance": [], "inertia": [], "strain": [], "foot": []}
    for k in wavenumber_samples():
        by_mean, by_load = np.split(padded.solve(float(k), np.concatenate([mean, loads], axis=1)), [2], axis=1)
        softening = np.diag(stiffness**2 / (stiffness + ballast))
        reaction = np.linalg.solve(np.eye(2) - softening @ (mean.T @ by_mean), softening @ (mean.T @ by_load))
        u = by_load + by_mean @ reaction
        rigid = fit @ clamped.flexibility(float(k))[np.ix_(in_plane, in_plane)] @ fit.T
        for name, value in (
            ("compliance", loads.T @ u - rigid),
            ("inertia", u.T @ (mass @ u)),
            ("strain", u.T @ (support @ u)),
            ("foot", mean.T @ u),
        ):
            out[name].append(np.asarray(value))
    return {**{name: np.stack(values) for name, values in out.items()}, "middle": padded.foot.mean(axis=0)}
