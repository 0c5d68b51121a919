"""Compliance of a wheelset's hubs against three-dimensional finite elements of another code, CalculiX.

`python -m benchmarks.hub_wedges [LAYERS]`: needs the command `ccx` (Debian package calculix-ccx). A quarter of the
wheelset, x > 0 and y > 0, in quadratic wedges (C3D15): the section turned about the axle in layers, finer below. Loads
on the wheel stand on the line at the running circle below the axle, journals carry them uniformly. The mean rigid
motion of the seat is compared with that of the harmonics, and with the motion of the hub that fits the tread.
"""

from __future__ import annotations

import subprocess
import sys
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from wheelrail.contact.laws.material import Material
from wheelrail.contact.structure.half_wheelset import PLACES, Half, HalfWheelset
from wheelrail.contact.structure.hubs import hub_compliance
from wheelrail.meshes.bodies.axle import AxleShape, wheelset_section
from wheelrail.meshes.bodies.outlines import wheel_outline
from wheelrail.meshes.bodies.triangulation import Grading
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.support.arrays import Array, Nodes

RADIUS, WHEEL_Y = 0.46, 0.75  # m
AXLE = AxleShape(bore=0.008)  # wedges need a hole, which weakens the axle by 6e-6
GRADING = Grading(first=1.0, growth=0.4, largest=20e-3)
LAYERS = 14
LOADS = {"57 kN upwards": (0.0, 57e3), "10 kN outwards": (10e3, 0.0)}  # y and z, N
SNAP = 1e-7  # m
HALVES: tuple[Half, Half] = ("symmetric", "antisymmetric")


@dataclass(frozen=True, eq=False)
class QuarterWheelset:
    """Quadratic wedges of a quarter of a wheelset.

    Parameters:
        section: (n, 2) m, corners of the triangles in (y, r), and triangles (m, 3), counter-clockwise.
        triangles: see section.
        angles: (layers + 1,) rad from straight below.
    """

    section: Array
    triangles: Nodes
    angles: Array

    @cached_property
    def edges(self) -> tuple[Nodes, Nodes]:
        """Edges (k, 2) of the section, and those of every triangle (m, 3)."""
        t = self.triangles
        pairs = np.sort(np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]]), axis=1)
        unique, inverse = np.unique(pairs, axis=0, return_inverse=True)
        return unique, inverse.reshape(3, -1).T

    @cached_property
    def station(self) -> Array:
        """Corners and midpoints of edges (n + k, 2) m of a section."""
        return np.concatenate([self.section, self.section[self.edges[0]].mean(axis=1)])

    def first(self, layer: int) -> int:
        """Number of the first node of a section between layers; those of corners between sections come last."""
        return layer * len(self.station)

    def first_between(self, layer: int) -> int:
        """Number of the first node of the corners within a layer."""
        return len(self.angles) * len(self.station) + layer * len(self.section)

    @cached_property
    def nodes(self) -> Array:
        """Nodes (n, 3) m."""
        middles = 0.5 * (self.angles[1:] + self.angles[:-1])
        turned = [_turned(self.station, angle) for angle in self.angles]
        return np.concatenate(turned + [_turned(self.section, angle) for angle in middles])

    @cached_property
    def wedges(self) -> Nodes:
        """Nodes (m, 15) of the elements in the order of C3D15."""
        t, e, parts = self.triangles, len(self.section) + self.edges[1], []
        for layer in range(len(self.angles) - 1):
            low, high, between = self.first(layer), self.first(layer + 1), self.first_between(layer)
            parts.append(np.column_stack([low + t, high + t, low + e, high + e, between + t]))
        elements = np.concatenate(parts)
        p = self.nodes[elements[0]]
        if np.dot(np.cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]) < 0.0:
            elements = elements[:, [0, 2, 1, 3, 5, 4, 8, 7, 6, 11, 10, 9, 12, 14, 13]]
        return elements

    def on_cylinder(self, radius: float, low: float, high: float) -> Array:
        """Weights (n,) of all nodes in the mean over a cylinder between two y, m."""
        y, r = self.section.T
        on = (np.abs(r - radius) < SNAP) & (y > low - SNAP) & (y < high + SNAP)
        weights = np.zeros(len(self.nodes))
        for k in np.flatnonzero(on[self.edges[0]].all(axis=1)):
            ends = self.edges[0][k]
            length = float(np.hypot(*np.diff(self.section[ends], axis=0)[0]))
            for layer, angle in enumerate(np.diff(self.angles)):
                area = length * radius * angle  # of a face with eight nodes: -1/12 at corners, 1/3 at midpoints
                for first in (self.first(layer), self.first(layer + 1)):
                    weights[first + ends] -= area / 12
                    weights[first + len(self.section) + k] += area / 3
                weights[self.first_between(layer) + ends] += area / 3
        return np.asarray(weights / weights.sum())


def _turned(points: Array, angle: float) -> Array:
    """Points (n, 3) m of a section at an angle from straight below."""
    y, r = points.T
    return np.column_stack([r * np.sin(angle), y, -r * np.cos(angle)])


def quarter(layers: int) -> QuarterWheelset:
    """A quarter of the typical wheelset."""
    mesh, _ = wheelset_section(wheel_outline(named_profile("S1002"), RADIUS), AXLE, WHEEL_Y, GRADING)
    triangles, p = mesh.cells.copy(), mesh.points[mesh.cells]
    clockwise = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]) < 0.0
    triangles[clockwise] = triangles[clockwise][:, [0, 2, 1]]
    fraction = np.linspace(0.0, 1.0, layers + 1)
    return QuarterWheelset(mesh.points, triangles, np.pi * (0.15 * fraction + 0.85 * fraction**2))


def forces(body: QuarterWheelset, load: tuple[float, float], half: str) -> Array:
    """Nodal forces (n, 3) N of half a load y, z at the running circle and of the journal's reaction."""
    bottom = int(np.argmin(np.hypot(body.section[:, 0] - WHEEL_Y, body.section[:, 1] - RADIUS)))
    out, journal = np.zeros_like(body.nodes), body.on_cylinder(AXLE.journal_radius, *AXLE.journal)
    out[bottom, 1:] = 0.5 * np.array(load)
    y, z = body.nodes[:, 1], body.nodes[:, 2]
    vertical = out[:, 2].sum()
    if half == "antisymmetric":
        out[:, 1] -= journal * out[:, 1].sum()
        vertical = (y * out[:, 2] - z * out[:, 1]).sum() / (journal @ y)
    out[:, 2] -= journal * vertical
    return out


def deck(body: QuarterWheelset, half: str, loads: list[Array]) -> str:
    """Input of CalculiX in mm, N and MPa: fixed planes x = 0 and y = 0, and what is left of the rigid motions."""
    x, y, z = body.nodes.T
    longitudinal, middle = np.flatnonzero(np.abs(x) < SNAP), np.flatnonzero(np.abs(y) < SNAP)
    inner = int(middle[np.argmin(np.hypot(x[middle], z[middle]))])
    fixed = {(int(i), 1) for i in longitudinal}
    if half == "symmetric":
        fixed |= {(int(i), 2) for i in middle} | {(inner, 3)}
    else:
        outer = int(longitudinal[np.argmax(y[longitudinal] - 10 * np.abs(z[longitudinal]))])
        fixed |= {(int(i), k) for i in middle for k in (1, 3)} | {(outer, 3), (inner, 2)}
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{i}, {px:.9g}, {py:.9g}, {pz:.9g}" for i, (px, py, pz) in enumerate(1e3 * body.nodes, start=1)]
    lines += ["*ELEMENT, TYPE=C3D15, ELSET=BODY"]
    lines += [f"{i}, " + ", ".join(map(str, nodes)) for i, nodes in enumerate((body.wedges + 1).tolist(), start=1)]
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", "210000., 0.3", "*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL"]
    lines += ["*BOUNDARY", *(f"{i + 1}, {k}, {k}" for i, k in sorted(fixed))]
    for load in loads:
        lines += ["*STEP", "*STATIC, SOLVER=SPOOLES", "*CLOAD, OP=NEW"]
        lines += [f"{i + 1}, {k + 1}, {load[i, k]:.12g}" for i, k in np.argwhere(load != 0.0)]
        lines += ["*NODE FILE", "U", "*END STEP"]
    return "\n".join(lines) + "\n"


def displacements(file: Path, count: int) -> list[Array]:
    """Displacements (n, 3) m of every step in a result file of CalculiX."""
    steps: list[Array] = []
    reading = False
    for line in file.read_text().splitlines():
        if line.startswith(" -4  DISP"):
            steps.append(np.zeros((count, 3)))
            reading = True
        elif reading and line.startswith(" -1"):
            steps[-1][int(line[3:13]) - 1] = [1e-3 * float(line[13 + 12 * k : 25 + 12 * k]) for k in range(3)]
        elif line.startswith(" -3"):
            reading = False
    return steps


def seat_motion(body: QuarterWheelset, u: Array, half: str) -> tuple[float, float]:
    """Mean height m and roll rad of the seat relative to the line through the journals."""
    journal, (_, y, z) = body.on_cylinder(AXLE.journal_radius, *AXLE.journal), body.nodes.T
    v, height = u.copy(), float(journal @ u[:, 2])
    if half == "symmetric":
        v[:, 2] -= height
    else:
        turn = height / float(journal @ y)
        v[:, 2] -= turn * y
        v[:, 1] += turn * z
        v[:, 1] -= journal @ v[:, 1]
    low, high = AXLE.steps[0][0], AXLE.steps[1][0]
    weights = body.on_cylinder(0.5 * AXLE.steps[1][1], low, high)
    modes = np.zeros((len(v), 3, 3))  # height, roll and y
    modes[:, 2, 0], modes[:, 1, 1], modes[:, 2, 1], modes[:, 1, 2] = 1.0, -z, y - WHEEL_Y, 1.0
    weighted = weights[:, None, None] * modes
    matrix = np.einsum("nca,ncb->ab", weighted, modes)
    motion = np.linalg.solve(matrix, np.einsum("nca,nc->a", weighted, v))
    return float(motion[0]), float(motion[1])


def seat_by_harmonics(wheelset: HalfWheelset, half: Half, lateral: float, vertical: float) -> Array:
    """Mean height m and roll rad (2,) of the seat by a force N at the running circle, from the harmonic n = 1."""
    line = 3 * PLACES.index(0.0)
    load = (
        lateral * wheelset.loads(wheelset.whole)[:, line + 1] - vertical * wheelset.loads(wheelset.whole)[:, line + 2]
    )
    return -wheelset.seat_motion(1, wheelset.solver(1, half)(load[:, None] / np.pi))[:, 0]


def main(arguments: list[str]) -> None:
    """Print height and roll of the hub by both, and their differences."""
    body = quarter(int(arguments[0]) if arguments else LAYERS)
    print(f"{len(body.wedges)} wedges, {3 * len(body.nodes)} unknowns", flush=True)
    hubs = hub_compliance(
        wheel_outline(named_profile("S1002"), RADIUS), AXLE, Material(), wheel_y=WHEEL_Y, weight=False
    )
    harmonics = HalfWheelset(wheel_outline(named_profile("S1002"), RADIUS), AXLE, Material(), WHEEL_Y)
    print("| half | load | seat, wedges: z mm, roll mrad | seat, harmonics | hub by the tread | roll: seat, hub |")
    print(f"|{'---|' * 6}")
    for index, half in enumerate(HALVES):
        with TemporaryDirectory() as folder:
            file = Path(folder, "quarter.inp")
            file.write_text(deck(body, half, [forces(body, load, half) for load in LOADS.values()]))
            subprocess.run(["ccx", "quarter"], cwd=folder, check=True, capture_output=True)
            steps = displacements(file.with_suffix(".frd"), len(body.nodes))
        for (name, (lateral, vertical)), u in zip(LOADS.items(), steps, strict=True):
            z, roll = 1e3 * np.array(seat_motion(body, u, half))
            seat = 1e3 * seat_by_harmonics(harmonics, half, lateral, vertical)
            hub = 1e3 * hubs.bending[index] @ [vertical, lateral * RADIUS]
            motions = " | ".join(f"{own[0]:.4f}, {own[1]:.4f}" for own in ((z, roll), seat, hub))
            differences = ", ".join(f"{100 * (own[1] / roll - 1):.2f} %" for own in (seat, hub))
            print(f"| {half} | {name} | {motions} | {differences} |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
