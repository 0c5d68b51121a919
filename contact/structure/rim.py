"""Motion of a wheel's rim as a whole by its web: what a host with flexible wheels adds to the contact by itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.contact.laws.material import Material
from wheelrail.contact.structure.pads import GRADING, SIZE
from wheelrail.meshes.bodies.outlines import Outline
from wheelrail.meshes.bodies.solids import Strip, body_key
from wheelrail.support.arrays import Array
from wheelrail.support.cache import cached, digest


@dataclass(frozen=True)
class RimCompliance:
    """Compliance of a rim's rigid motion relative to the bore of its wheel.

    Parameters:
        rim: (6, 6), motion (x, y, z, roll, pitch, yaw) m and rad about the wheel's centre by force N and moment N m
            there; pitch, which does not affect steady rolling, is left out.
        misfit: largest part of the compliance of the tread in harmonics 0 and 1 that is not a rigid motion, relative to
            its largest.
    """

    rim: Array
    misfit: float

    @property
    def matrix(self) -> Array:
        """Minus the compliance (12, 12) of the rims' rigid motions: added where the host models flexible wheels."""
        return -np.kron(np.eye(2), self.rim)

    @property
    def own_weight(self) -> Array:
        """Motions (12,) by the weight of the wheelset: those of the host."""
        return np.zeros(12)


def rim_compliance(outline: Outline, steel: Material) -> RimCompliance:
    """Compliance of the rim of a wheel clamped at its bore, from the cache or by its harmonics 0 and 1.

    Parameters:
        outline: of the wheel.
        steel: material.
    """
    strip = Strip.on(outline, half_length=SIZE, size=SIZE)
    section = body_key("wheel section", outline, strip, 0.0, "tetrahedron", GRADING)
    key = digest(kind="rim of a wheel", section=section, E=steel.E, nu=steel.nu)
    stored = cached(f"rims/{key}", lambda: _harmonics(outline, strip, steel), ("rim", "misfit"))
    return RimCompliance(stored["rim"], float(stored["misfit"]))


def _harmonics(outline: Outline, strip: Strip, steel: Material) -> dict[str, Array]:
    """Arrays of `RimCompliance`."""
    from wheelrail.contact.elasticity.waveguide.section import WaveguideSection  # imports dolfinx
    from wheelrail.contact.structure.half_wheelset import rigid_modes
    from wheelrail.meshes.bodies.solids import section

    mesh, radius = section(outline, strip, grading=GRADING), outline.offset[1]
    body, rim, misfit = WaveguideSection(mesh, steel, degree=2, radius=radius), np.zeros((6, 6)), 0.0
    y, r = mesh.points[mesh.surface].T
    for n in (0, 1):
        modes = rigid_modes(n, y, r).reshape(-1, 2)
        inverse = np.linalg.pinv(modes)
        flexibility = body.flexibility(n / radius)
        fit = inverse @ flexibility @ inverse.T
        misfit = max(misfit, float(np.abs(flexibility - modes @ fit @ modes.T).max() / np.abs(flexibility).max()))
        if n == 0:
            rim[1, 1] = fit[1, 1] / (2 * np.pi * radius)
            continue
        (zz, zr), (_, rr) = 0.5 * (fit + fit.T) / (np.pi * radius)
        rim[np.ix_([2, 3], [2, 3])] = [[zz, zr], [zr, rr]]
        rim[np.ix_([0, 5], [0, 5])] = [[zz, -zr], [-zr, rr]]  # turned by 90 degrees: x for z, yaw for -roll
    return {"rim": rim, "misfit": np.array(misfit)}
