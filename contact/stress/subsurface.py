"""Stress below the patches of a contact result in one of its bodies, computed on request."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.geometry.quadric_pair import UPSIDE_DOWN
from wheelrail.contact.kinematics.frames import MIRROR, Pose
from wheelrail.contact.laws.material import Material
from wheelrail.contact.results.result import ContactResult, Fields
from wheelrail.contact.stress.surface_loads import CellLoads, arc_of, unrolled
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from wheelrail.contact.elasticity.waveguide.section import WaveguideSection
    from wheelrail.meshes.bodies.outlines import Outline

ACROSS = 24  # lines of the section over the narrowest patch, and two over the smallest depth ..
FINEST = 64  # .. limited to this number over the patch
MARGIN = 8  # lines on either side of the patches
FAR = 40  # half-width of a block over the reach of the patches


@dataclass(frozen=True)
class PatchStress:
    """Stress below one patch, in the frame of the result's fields or its mirror image.

    Parameters:
        depth: (n,) m along the patch's mean normal, from the body's surface at the resultant.
        position: (n, 3) m.
        stress: (n, 3, 3) Pa.
    """

    depth: Array
    position: Array
    stress: Array

    @property
    def von_mises(self) -> Array:
        """Von Mises stress (n,) Pa."""
        from wheelrail.forms.stress import von_mises

        return von_mises(self.stress)

    def mirrored(self) -> PatchStress:
        """The stress in the mirror y = 0."""
        return replace(self, position=self.position * MIRROR, stress=self.stress * np.outer(MIRROR, MIRROR))


@dataclass(frozen=True)
class SubsurfaceStress:
    """Stress below all patches.

    Parameters:
        patches: in the result's order.
        wavenumbers: number of wavenumbers used.
        seconds: of computation.
    """

    patches: tuple[PatchStress, ...]
    wavenumbers: int
    seconds: float

    def mirrored(self) -> SubsurfaceStress:
        """The stress in the mirror y = 0."""
        return replace(self, patches=tuple(patch.mirrored() for patch in self.patches))


@dataclass(frozen=True)
class LoadedBody:
    """A body of a contact pair.

    Parameters:
        frame: the body's axes in the frame of the fields.
        upper: whether the tractions act on it as stored (upper body), or reversed.
        section: returns its section, from the fields and the spacing [m] of its surface lines.
    """

    frame: Pose
    upper: bool
    section: Callable[[Fields, float], WaveguideSection]

    @classmethod
    def wheel(cls, outline: Outline, steel: Material, pose: Pose) -> LoadedBody:
        """Wheel of a wheel-rail pair.

        Parameters:
            outline: in y and r.
            steel: material.
            pose: of the wheel.
        """
        return cls(pose, True, partial(_profiled, outline, steel, pose))

    @classmethod
    def rail(cls, outline: Outline, steel: Material) -> LoadedBody:
        """Rail of a wheel-rail pair, by outline and material."""
        frame = Pose(np.zeros(3), np.eye(3))
        return cls(frame, False, partial(_profiled, outline, steel, frame))

    @classmethod
    def block(cls, upper: bool, steel: Material) -> LoadedBody:
        """Large block of a pair with given radii, the upper or the lower one."""
        return cls(Pose(np.zeros(3), UPSIDE_DOWN if upper else np.eye(3)), upper, partial(_block, steel))

    def below(self, result: ContactResult, depths: Array, *, tolerance: float = 1e-2) -> SubsurfaceStress:
        """Stress below every patch by the tractions of all patches.

        Parameters:
            result: of the pair.
            depths: (n,) m.
            tolerance: of the interpolation between wavenumbers.

        Raises ValueError without contact, and for depths outside the body.
        """
        from wheelrail.contact.stress.waveguide import stress  # imports dolfinx

        start = perf_counter()
        fields = result.fields
        if fields is None or not (fields.pressure > 0).any():
            raise ValueError("nothing touches: the body is free of stress")
        section = self.section(fields, _size(fields, depths))
        top, inward = under(self, section, result)
        points = (top[:, None] + depths[:, None] * inward[:, None]).reshape(-1, 3)
        stresses, wavenumbers = stress(section, self.loads(section, fields), points, tolerance=tolerance)
        rotation = self.frame.rotation
        shape = (len(top), len(depths))
        position = (self.frame.origin + points @ rotation.T).reshape(*shape, 3)
        tensor = (rotation @ stresses @ rotation.T).reshape(*shape, 3, 3)
        return SubsurfaceStress(
            tuple(PatchStress(depths, *fields_of_patch) for fields_of_patch in zip(position, tensor, strict=True)),
            wavenumbers,
            perf_counter() - start,
        )

    def loads(self, section: WaveguideSection, fields: Fields) -> CellLoads:
        """Contact forces on this body: action on the upper one, reaction on the lower one.

        Parameters:
            section: of the body.
            fields: of a result.
        """
        on = fields.pressure > 0
        local = np.column_stack([fields.traction[on], -fields.pressure[on]]) * fields.area[on][:, None]
        force = np.einsum("na,nac->nc", local, fields.axes[on])
        point = (fields.point[on] - self.frame.origin) @ self.frame.rotation
        sign = 1.0 if self.upper else -1.0
        loads = sign * force @ self.frame.rotation
        return CellLoads.over(section, point, loads, step=fields.step[on], width=fields.width[on])


def under(body: LoadedBody, section: WaveguideSection, result: ContactResult) -> tuple[Array, Array]:
    """Points (p, 3) m of a body's surface at every patch's resultant, and mean inward normals (p, 3), in body axes.

    Parameters:
        body, section: the body and its section.
        result: with p patches.
    """
    fields = result.fields
    assert fields is not None
    normals, starts = [], []
    for k in range(len(result.patches)):
        own = fields.patch == k
        weight = (fields.pressure * fields.area)[own]
        normal = weight @ fields.axes[own, 2]
        inward = (-1.0 if body.upper else 1.0) * normal / np.linalg.norm(normal)
        normals.append(inward @ body.frame.rotation)
        starts.append((weight @ fields.point[own] / weight.sum() - body.frame.origin) @ body.frame.rotation)
    return _on_surface(section, np.array(starts)), np.array(normals)


def narrowest(fields: Fields) -> float:
    """Mean width m of the narrowest patch."""
    return float(
        min(
            np.sum(fields.area[own]) / np.ptp(np.append(fields.point[own, 0], fields.step[own].max()))
            for own in (fields.patch == k for k in range(fields.patch.max() + 1))
        )
    )


def _size(fields: Fields, depths: Array) -> float:
    """Spacing m of the section's lines, from the narrowest patch and the smallest depth."""
    width = narrowest(fields)
    return float(min(width / ACROSS, max(0.5 * depths.min(), width / FINEST)))


def _profiled(outline: Outline, steel: Material, frame: Pose, fields: Fields, size: float) -> WaveguideSection:
    from wheelrail.contact.elasticity.waveguide.bodies import profile_body

    on = fields.pressure > 0
    x, y, z = ((fields.point[on] - frame.origin) @ frame.rotation).T
    section = np.column_stack([y, z if outline.radius is None else np.hypot(x, z)]) - outline.offset
    arc = outline.profile.closest(section).s
    half = 0.5 * fields.width[on] + MARGIN * size
    ends = float((arc - half).min()), float((arc + half).max())
    return profile_body(outline, steel, size=size, ends=ends)


def _block(steel: Material, fields: Fields, size: float) -> WaveguideSection:
    from wheelrail.contact.elasticity.waveguide.bodies import block_body

    on = fields.pressure > 0
    y = np.abs(fields.point[on, 1]) + 0.5 * fields.width[on]
    reach = max(float(y.max()), float(np.abs(fields.point[on, 0]).max()))
    half_width = 2.0 ** np.ceil(np.log2(FAR * reach / size))
    return block_body(int(np.ceil(y.max() / size)) + MARGIN, steel, size=size, half_width=float(half_width))


def _on_surface(body: WaveguideSection, points: Array) -> Array:
    """Projections (n, 3) m of points in body axes on the surface, in their cross-section."""
    along, section, _ = unrolled(body, points)
    corners = body.section.points[body.section.surface]
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))])
    at = arc_of(corners, section)
    y, r = (np.interp(at, arc, corner) for corner in corners.T)
    if body.radius is None:
        return np.column_stack([along, y, r])
    angle = along / body.radius
    return np.column_stack([r * np.sin(angle), y, -r * np.cos(angle)])
