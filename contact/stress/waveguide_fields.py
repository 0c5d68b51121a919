"""Displacement and stress all over a waveguide body under a contact's tractions, for sections, cuts and strips.

The body is held where its waveguide is, at the foot of a rail, the bore of a wheel, the bottom of a block, so that
displacements are absolute there. Made where and when it is asked for, as the stress of
`wheelrail.contact.stress.subsurface`.
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
DEEP = 1.5  # patch lengths below a patch that a longitudinal cut reaches
DENSE = 12  # stations over half a patch


@dataclass(frozen=True)
class InternalFields:
    """A loaded body, its section and what was observed at its spots (m, 2) m: those of a mesh of triangles (k, 3) over
    the whole section, and straight down under every patch, where they are numbered lines (n,) from the surface on.

    patches (p, 3) m in body axes, on the surface under every patch's resultant; half m, half the longest patch.
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
        """The whole section through a patch's resultant, triangles."""
        used = len(self.spots) - sum(map(len, self.lines))
        return self._fields(self._stations([patch]), np.arange(used), self.triangles, "triangle")

    def along(self, patch: int = 0, *, reach: float = 2.5) -> BodyFields:
        """The plane along the body below a patch's resultant and along its normal, to so many half patch lengths to
        either side, quadrilaterals.
        """
        line = self.lines[patch]
        stations = self._stations([patch]) + np.linspace(-reach, reach, 8 * DENSE + 1) * self.half
        number = np.arange(len(stations) * len(line)).reshape(len(stations), len(line))
        quads = np.stack([number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]], axis=-1).reshape(-1, 4)
        return self._fields(stations, line, quads, "quadrilateral")

    def strip(self, half_length: float = 0.1) -> BodyFields:
        """The body between stations so far [m] to either side of the patches, dense there, wedges."""
        everywhere = self._stations(range(len(self.patches)))
        stations = 0.5 * (everywhere.min() + everywhere.max()) + layers(
            int(1.3 * DENSE), self.half / DENSE + float(np.ptp(everywhere)) / (2 * DENSE), half_length
        )
        used = len(self.spots) - sum(map(len, self.lines))
        ends = self.triangles + used * np.arange(len(stations))[:, None, None]
        wedges = np.concatenate([ends[:-1], ends[1:]], axis=-1).reshape(-1, 6)
        return self._fields(stations, np.arange(used), wedges, "wedge")

    def at(self, stations: Array, chosen: Nodes) -> tuple[WaveguideCoordinates, Array, Array]:
        """Places of chosen spots at stations (n,) m along the body, station by station, displacement and stress there,
        in body axes.
        """
        chart = WaveguideCoordinates.over(self.section, stations, self.spots[chosen])
        some = WavenumberResponse(self.waves.k, self.waves.samples[:, chosen], *self._phases)
        found = some.at(stations).reshape(-1, 12)
        return chart, chart.turned(found[:, 9:]), chart.turned(found[:, :9].reshape(-1, 3, 3))

    @property
    def _phases(self) -> tuple[float, float, float | None]:
        return self.waves.middle, self.waves.shift, self.waves.around

    def _stations(self, patches: list[int] | range) -> Array:
        return WaveguideCoordinates.of(self.section, self.patches[list(patches)]).along

    def _fields(self, stations: Array, chosen: Nodes, cells: Nodes, shape: Shape) -> BodyFields:
        chart, displacement, stress = self.at(stations, chosen)
        return BodyFields(chart.places, cells, shape, displacement, stress).seen_from(self.body.frame)


def look_inside(
    body: LoadedBody,
    result: ContactResult,
    *,
    across: int = ACROSS,
    tolerance: float = 1e-2,
) -> InternalFields:
    """Displacement and stress in a body by the tractions of all patches, the section's lines so many across the
    narrowest patch.

    tolerance as in `wheelrail.contact.stress.waveguide.stress`, for stress and displacement each. Raises ValueError
    without contact.
    """
    fields = result.fields
    if fields is None or not (fields.pressure > 0).any():
        raise ValueError("nothing touches: there is nothing to look at inside")
    section = body.section(fields, narrowest(fields) / across)
    top, inward = under(body, section, result)
    on = fields.pressure > 0
    half = 0.5 * max(
        float(np.ptp(np.append(x - 0.5 * step, x + 0.5 * step)))
        for x, step in (
            (fields.point[own, 0], fields.step[own]) for own in (on & (fields.patch == k) for k in range(len(top)))
        )
    )
    spots, triangles = _quartered(section)
    lines: list[Nodes] = []
    # on the smaller of length and width hangs how deep stress goes
    depth = 2 * DEEP * min(half, narrowest(fields)) * np.linspace(0.0, 1.0, 41) ** 1.5
    for place, normal in zip(top, inward, strict=True):
        line = WaveguideCoordinates.of(section, place + depth[:, None] * normal).section
        held = inside(section, line)
        line = line[: len(line) if held.all() else int(np.argmin(held))]
        lines.append(np.arange(len(line)) + len(spots))
        spots = np.concatenate([spots, line])
    gradients = Gradients(section, spots)
    λ, μ = lame(section.steel.E, section.steel.nu)

    def observe(U: Complex, k: float) -> Complex:
        stress = cauchy(gradients(U, k), λ, μ).reshape(-1, 9)
        return np.concatenate([stress, gradients.displacement(U)], axis=1)

    def scale(found: Mapping[float, Complex]) -> Array:
        parts = [integral({k: v[:, part] for k, v in found.items()}) for part in (slice(9), slice(9, 12))]
        return np.repeat(parts, (9, 3))

    waves = sampled(
        section,
        body.loads(section, fields),
        observe,
        shallowest=0.0,
        tolerance=tolerance,
        scale=scale,
    )
    return InternalFields(body, section, spots, triangles, tuple(lines), waves, top, half)


def _quartered(section: WaveguideSection) -> tuple[Array, Nodes]:
    """Points of a section's mesh with the middles of its edges, and triangles between them, four of each."""
    points, cells = section.section.points, section.section.cells
    edges = np.sort(np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    edges, number = np.unique(edges, axis=0, return_inverse=True)
    (a, b, c), (ab, bc, ca) = cells.T, (number.reshape(-1, 3) + len(points)).T
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    triangles = np.stack([np.stack(part, axis=-1) for part in parts], axis=1).reshape(-1, 3)
    return np.concatenate([points, points[edges].mean(axis=1)]), triangles
