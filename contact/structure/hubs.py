"""Motions of a wheelset's hubs by the loads on its wheels: bending, tension and torsion of its axle, own weight."""

from __future__ import annotations

import logging
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from wheelrail.contact.laws.material import Material
from wheelrail.meshes.bodies.axle import GRADING, SPACING, AxleShape
from wheelrail.meshes.bodies.outlines import Outline
from wheelrail.support.arrays import Array
from wheelrail.support.cache import cached, digest

log = logging.getLogger(__name__)

DENSITY = 7850.0  # kg/m3, of steel
GRAVITY = 9.81  # m/s2
HALVES = ("symmetric", "antisymmetric")


@dataclass(frozen=True)
class HubCompliance:
    """Compliance of the hubs of a wheelset relative to the line through its journals' centres.

    The journals' reactions are statically determined: no suspension enters. Motions and loads of a hub are (x, y, z,
    roll, pitch, yaw) of the wheelset's frame about the hub's centre; the right hub's are those of its mirror image.
    Parameters:
        bending: (2, 2, 2), z and roll by a force and a moment: 1/N and 1/N m times m and rad; symmetric half, then
            antisymmetric half.
        axial: (2,) m/N, y by a lateral force, by half.
        twist: rad/N m, of a hub by opposite torques on the wheels; steady rolling does not depend on it.
        sag: (2,) m and rad, z and roll of the left hub by the weight of the wheelset.
        mass: of the wheelset, kg.
        places: (k,) m, y from the middle of the axle, where its bending stress is known.
        stress: (2, k, 2) 1/m2 and 1/m3, axial stress at the bottom of the axle by z force and roll moment, by half.
        stress_by_weight: (k,) Pa, the same by the weight of the wheelset.
        misfit: largest part of what the axle adds to the tread's compliance that is not a rigid motion of the hub,
            relative to its largest part.
    """

    bending: Array
    axial: Array
    twist: float
    sag: Array
    mass: float
    places: Array
    stress: Array
    stress_by_weight: Array
    misfit: float

    @property
    def matrix(self) -> Array:
        """Compliance (12, 12) of the left hub's motions and the mirrored right hub's; pitch, which does not affect
        steady rolling, is left out.
        """
        halves = []
        for (zz, zr, _, rr), y in zip(self.bending.reshape(2, 4), self.axial, strict=True):
            half = np.zeros((6, 6))
            half[np.ix_([2, 3], [2, 3])] = [[zz, zr], [zr, rr]]
            half[np.ix_([0, 5], [0, 5])] = [[zz, -zr], [-zr, rr]]  # turned by 90 degrees: x for z, yaw for -roll
            half[1, 1] = y
            halves.append(half)
        own, other = 0.5 * (halves[0] + halves[1]), 0.5 * (halves[0] - halves[1])
        return np.block([[own, other], [other, own]])

    @property
    def own_weight(self) -> Array:
        """Motions (12,) of both hubs by the weight of the wheelset, the right ones mirrored."""
        hub = np.zeros(6)
        hub[2:4] = self.sag
        return np.tile(hub, 2)

    def bending_stress(self, left: Array, right: Array) -> tuple[Array, Array]:
        """Axial stress (k,) Pa along the bottom of the axle between the wheels, by bending in the vertical plane: at
        `places` and at their mirror images on the right.

        Parameters:
            left, right: loads (6,) N and N m on the hubs, the right ones mirrored.
        """
        even, odd = 0.5 * (left + right)[2:4], 0.5 * (left - right)[2:4]
        symmetric = self.stress[0] @ even + self.stress_by_weight
        return symmetric + self.stress[1] @ odd, symmetric - self.stress[1] @ odd


def about_hubs_line(wheel_y: float) -> Array:
    """Transformation (12, 12) of hub motions relative to any line into motions relative to the line through both hubs.

    What is taken out are x, z, roll and yaw of the line and the mean of y. Parameters: wheel_y: m, y of the left hub.
    """
    x, y, z, roll, _, yaw = range(6)
    out = np.eye(12)
    for own, other in ((0, 6), (6, 0)):
        out[own + x] = out[own + z] = 0.0
        out[own + y, other + y] = out[own + y, own + y] = 0.5  # the other one is mirrored
        out[own + roll, [own + z, other + z]] = np.array([-0.5, 0.5]) / wheel_y
        out[own + yaw, [own + x, other + x]] = np.array([0.5, -0.5]) / wheel_y
    return out


def hub_compliance(
    outline: Outline, axle: AxleShape, steel: Material, *, wheel_y: float, weight: bool = True
) -> HubCompliance:
    """Compliance of the hubs of a wheelset, from the cache or by 2.5D harmonics 0 and 1 of wheel and axle.

    Parameters:
        outline: of the wheels, alike on both sides.
        axle: its drawing.
        steel: material of wheels and axle.
        wheel_y: y of the running circle, m.
        weight: whether the wheelset's own weight bends it.

    Raises ValueError for an axle that does not fit the wheel.
    """
    names = ("bending", "axial", "twist", "sag", "mass", "places", "stress", "stress_by_weight", "misfit")
    key = digest(
        kind="hub compliance",
        wheel=outline.polygon(SPACING),
        axle=asdict(axle),
        wheel_y=wheel_y,
        E=steel.E,
        nu=steel.nu,
        density=DENSITY,
        gravity=GRAVITY,
        grading=asdict(GRADING),
    )
    stored = cached(f"hubs/{key}", lambda: _harmonics(outline, axle, steel, wheel_y), names)
    values: dict[str, Any] = {name: stored[name] if stored[name].ndim else float(stored[name]) for name in names}
    if not weight:
        values |= {"sag": np.zeros(2), "stress_by_weight": np.zeros(len(stored["places"]))}
    return HubCompliance(**values)


def _harmonics(outline: Outline, axle: AxleShape, steel: Material, wheel_y: float) -> dict[str, Array]:
    """Arrays of `HubCompliance`: compliance of the hubs' rigid motions on an elastic axle, harmonics 0 and 1."""
    from wheelrail.contact.structure.half_wheelset import HalfWheelset, rigid_modes  # imports dolfinx

    half = HalfWheelset(outline, axle, steel, wheel_y)
    log.info("compliance of a wheelset's hubs: %d unknowns in its half section", 3 * len(half.whole.points))
    loads, (y, r) = half.loads(half.whole), half.line_points().T
    bending, axial, stress, misfit = np.zeros((2, 2, 2)), np.zeros(2), [], 0.0
    for n in (0, 1):
        clamped = half.clamped(n)
        modes = rigid_modes(n, y, r).reshape(-1, 2)
        inverse = np.linalg.pinv(modes)  # its transpose: loads on the lines with unit resultants
        for index, name in enumerate(HALVES):
            solve = half.solver(n, name)  # type: ignore[arg-type]
            displacements = solve(loads)
            added = loads.T @ displacements - clamped
            compliance = inverse @ added @ inverse.T
            misfit = max(misfit, float(np.abs(added - modes @ compliance @ modes.T).max() / np.abs(added).max()))
            if n == 0:
                axial[index] = compliance[1, 1] / (2 * np.pi)
                twist = compliance[0, 0] / (2 * np.pi)  # of the last, antisymmetric half
                continue
            bending[index] = 0.5 * (compliance + compliance.T) / np.pi
            places, amplitudes = half.surface_stress(displacements @ inverse.T)
            stress.append(-amplitudes / np.pi)  # by loads upwards
            if name == "symmetric":
                by_weight = solve(half.own_weight(DENSITY, GRAVITY))
                sag = -half.seat_motion(1, by_weight)[:, 0]
                stress_by_weight = half.surface_stress(by_weight)[1][:, 0]
    return {
        "bending": bending,
        "axial": axial,
        "twist": np.array(twist),
        "sag": sag,
        "mass": np.array(half.mass(DENSITY)),
        "places": places,
        "stress": np.stack(stress),
        "stress_by_weight": stress_by_weight,
        "misfit": np.array(misfit),
    }
