"""Displacement and stress throughout a waveguide body under a contact's tractions, on sections, cuts and segments.

The body is clamped where its waveguide is: at the foot of a rail, the bore of a wheel, the bottom of a block, so that
displacements are absolute. Computed on request, as the stress of `wheelrail.contact.stress.subsurface`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.elasticity.waveguide.coordinates import WaveguideCoordinates
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.stress.fields import BodyFields, Shape
from wheelrail.contact.stress.subsurface import LoadedBody, narrowest, under
from wheelrail.contact.stress.waveguide import Gradients, inside
from wheelrail.contact.stress.wavenumbers import WavenumberResponse, integral, sampled
from wheelrail.forms.elasticity import lame
from wheelrail.forms.stress import cauchy
from wheelrail.meshes.bodies.extrusion import layers
from wheelrail.support.arrays import Array, Complex, Nodes

if TYPE_CHECKING:
    from wheelrail.contact.elasticity.waveguide.section import WaveguideSection

ACROSS = 16  # lines of the section over the narrowest patch
DEEP = 1.5  # depth of a longitudinal cut over twice the smaller of half length and width of a patch
DENSE = 12  # stations over half a patch


@dataclass(frozen=True)
class InternalFields:
    """Internal fields of a loaded body, observed at m points of its section.

    Parameters:
        body: the loaded body.
        section: its section.
        spots: (m, 2) m, points of the section: those of a triangle mesh, then those below the patches.
        triangles: (k, 3), mesh of the whole section.
        lines: by patch, numbers (n,) of the points along its normal, from the surface on.
        waves: wavenumber response, stress and displacement.
        patches: (p, 3) m in body axes, surface points at every patch's resultant.
        half: m, half the length of the longest patch.
    """

    body: LoadedBody
    section: WaveguideSection
    spots: Array
    triangles: Nodes
    lines: tuple[Nodes, ...]
    waves: WavenumberResponse
    patches: Array
    half: float

    def across(self, patch: int = 0) -> BodyFields:
        """Fields on the whole section through a patch's resultant, triangles."""
        used = len(self.spots) - sum(map(len, self.lines))
        return self._fields(self._stations([patch]), np.arange(used), self.triangles, "triangle")

    def along(self, patch: int = 0, *, reach: float = 2.5) -> BodyFields:
        """Fields on the plane spanned by the body's direction and a patch's normal below its resultant, quadrilaterals.

        Parameters:
            patch: number.
            reach: half patch lengths to either side.
        """
        line = self.lines[patch]
        stations = self._stations([patch]) + np.linspace(-reach, reach, 8 * DENSE + 1) * self.half
        number = np.arange(len(stations) * len(line)).reshape(len(stations), len(line))
        quads = np.stack([number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]], axis=-1).reshape(-1, 4)
        return self._fields(stations, line, quads, "quadrilateral")

    def strip(self, half_length: float = 0.1) -> BodyFields:
        """Fields on the body up to half_length [m] to either side of the patches, refined there, wedges."""
        everywhere = self._stations(range(len(self.patches)))
        stations = 0.5 * (everywhere.min() + everywhere.max()) + layers(
            int(1.3 * DENSE), self.half / DENSE + float(np.ptp(everywhere)) / (2 * DENSE), half_length
        )
        used = len(self.spots) - sum(map(len, self.lines))
        ends = self.triangles + used * np.arange(len(stations))[:, None, None]
        wedges = np.concatenate([ends[:-1], ends[1:]], axis=-1).reshape(-1, 6)
        return self._fields(stations, np.arange(used), wedges, "wedge")

    def at(self, stations: Array, chosen: Nodes) -> tuple[WaveguideCoordinates, Array, Array]:
        """Coordinates, displacement and stress in body axes, station by station.

        Parameters:
            stations: (n,) m along the body.
            chosen: numbers of points of the section.
        """
        coordinates = WaveguideCoordinates.over(self.section, stations, self.spots[chosen])
        response = WavenumberResponse(self.waves.k, self.waves.samples[:, chosen], *self._phases)
        values = response.at(stations).reshape(-1, 12)
        return coordinates, coordinates.rotated(values[:, 9:]), coordinates.rotated(values[:, :9].reshape(-1, 3, 3))

    @property
    def _phases(self) -> tuple[float, float, float | None]:
        return self.waves.middle, self.waves.shift, self.waves.around

    def _stations(self, patches: list[int] | range) -> Array:
        return WaveguideCoordinates.of(self.section, self.patches[list(patches)]).along

    def _fields(self, stations: Array, chosen: Nodes, cells: Nodes, shape: Shape) -> BodyFields:
        coordinates, displacement, stress = self.at(stations, chosen)
        return BodyFields(coordinates.points, cells, shape, displacement, stress).in_frame(self.body.frame)


def internal_fields(
    body: LoadedBody,
    result: ContactResult,
    *,
    across: int = ACROSS,
    tolerance: float = 1e-2,
) -> InternalFields:
    """Displacement and stress in a body under the tractions of all patches.

    Parameters:
        body: the loaded body.
        result: of the pair.
        across: lines of the section over the narrowest patch.
        tolerance: as in `wheelrail.contact.stress.waveguide.stress`, for stress and displacement each.

    Raises ValueError without contact.
    """
    fields = result.fields
    if fields is None or not (fields.pressure > 0).any():
        raise ValueError("nothing touches: the body is free of stress")
    section = body.section(fields, narrowest(fields) / across)
    top, inward = under(body, section, result)
    on = fields.pressure > 0
    half = 0.5 * max(
        float(np.ptp(np.append(x - 0.5 * step, x + 0.5 * step)))
        for x, step in (
            (fields.point[own, 0], fields.step[own]) for own in (on & (fields.patch == k) for k in range(len(top)))
        )
    )
    spots, triangles = _subdivided(section)
    lines: list[Nodes] = []
    # the smaller of length and width determines the depth of the stress
    depth = 2 * DEEP * min(half, narrowest(fields)) * np.linspace(0.0, 1.0, 41) ** 1.5
    for point, normal in zip(top, inward, strict=True):
        line = WaveguideCoordinates.of(section, point + depth[:, None] * normal).section
        within = inside(section, line)
        line = line[: len(line) if within.all() else int(np.argmin(within))]
        lines.append(np.arange(len(line)) + len(spots))
        spots = np.concatenate([spots, line])
    gradients = Gradients(section, spots)
    λ, μ = lame(section.steel.E, section.steel.nu)

    def observe(U: Complex, k: float) -> Complex:
        stress = cauchy(gradients(U, k), λ, μ).reshape(-1, 9)
        return np.concatenate([stress, gradients.displacement(U)], axis=1)

    def scale(samples: Mapping[float, Complex]) -> Array:
        parts = [integral({k: v[:, part] for k, v in samples.items()}) for part in (slice(9), slice(9, 12))]
        return np.repeat(parts, (9, 3))

    response = sampled(
        section,
        body.loads(section, fields),
        observe,
        shallowest=0.0,
        tolerance=tolerance,
        scale=scale,
    )
    return InternalFields(body, section, spots, triangles, tuple(lines), response, top, half)


def _subdivided(section: WaveguideSection) -> tuple[Array, Nodes]:
    """Points of a section's mesh with the midpoints of its edges, and four triangles of each triangle."""
    points, cells = section.section.points, section.section.cells
    edges = np.sort(np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    edges, number = np.unique(edges, axis=0, return_inverse=True)
    (a, b, c), (ab, bc, ca) = cells.T, (number.reshape(-1, 3) + len(points)).T
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    triangles = np.stack([np.stack(part, axis=-1) for part in parts], axis=1).reshape(-1, 3)
    return np.concatenate([points, points[edges].mean(axis=1)]), triangles
