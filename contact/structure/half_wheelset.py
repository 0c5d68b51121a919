"""Half a wheelset by 2.5D harmonics about its axle: motions of the hub by loads on the tread, symmetric or not."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Literal

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sl
import ufl

from wheelrail.contact.elasticity.waveguide.section import WaveguideSection
from wheelrail.contact.laws.material import Material
from wheelrail.forms import compat
from wheelrail.forms.compilation import compiled
from wheelrail.meshes.bodies.axle import SNAP, AxleShape, wheelset_section
from wheelrail.meshes.bodies.outlines import Outline
from wheelrail.meshes.bodies.triangulation import part_of
from wheelrail.support.arrays import Array, Nodes

Half = Literal["symmetric", "antisymmetric"]  # loads of the other half are the mirror image, or its negative
Solve = Callable[[Array], Array]

PLACES = (-0.030, -0.018, 0.0, 0.018)  # m, y of the loaded lines from the running circle


class HalfWheelset:
    """Half a wheelset in (y, r), y from its middle; amplitudes U = (along the circle, y, r) of harmonics n = 0 and 1.

    Parameters:
        outline: of the wheel.
        axle: its drawing.
        steel: material of both.
        wheel_y: y of the running circle, m.

    Of a force at the tread, amplitudes are 1 / pi for n = 1 and 1 / 2 pi for n = 0; the first line below the axle has
    the angle 0. Raises ValueError for an axle that does not fit the wheel.
    """

    def __init__(self, outline: Outline, axle: AxleShape, steel: Material, wheel_y: float) -> None:
        self.axle, self.wheel_y, radius = axle, wheel_y, outline.offset[1]
        mesh, of_wheel = wheelset_section(outline, axle, wheel_y)
        self.whole = WaveguideSection(mesh, steel, degree=2, radius=radius)
        self.wheel = WaveguideSection(part_of(mesh, of_wheel), steel, degree=2, radius=radius)
        lines = mesh.points[mesh.surface]
        self.lines = np.array([int(np.argmin(np.abs(lines[:, 0] - wheel_y - place))) for place in PLACES])

    def line_points(self) -> Array:
        """Points (lines, 2) m of the loaded lines: y from the hub's centre, and r."""
        mesh = self.whole.section
        return np.asarray(mesh.points[mesh.surface][self.lines] - (self.wheel_y, 0.0))

    def loads(self, body: WaveguideSection) -> Array:
        """Nodal loads (3 n, 3 lines) of unit loads on the lines, each uniform over its cell on the tread."""
        rows = (3 * self.lines[:, None] + np.arange(3)).ravel()
        nodes = (3 * body.surface[:, None] + np.arange(3)).ravel()
        nodal = np.zeros((3 * len(body.points), len(rows)))
        nodal[nodes] = body.cells[rows].toarray().T
        return nodal

    def clamped(self, n: int) -> Array:
        """Flexibility (3 lines, 3 lines) m/N of the lines of a wheel clamped at its bore, per unit angle."""
        loads = self.loads(self.wheel)
        fixed = (3 * self.wheel.fixed[:, None] + np.arange(3)).ravel()
        return np.asarray(loads.T @ factored(self.wheel, n, fixed, None)(loads))

    def solver(self, n: int, half: Half) -> Solve:
        """Displacements (3 n, m) m of all nodes by nodal loads (3 n, m) N per unit angle; the journals' reactions are
        uniform and displacements are relative to the line through the journals' centres.
        """
        middle = np.flatnonzero(np.abs(self.whole.points[:, 0]) < SNAP)
        held = np.array([1] if half == "symmetric" else [0, 2])
        return factored(self.whole, n, (3 * middle[:, None] + held).ravel(), self._frame(n, half))

    def _frame(self, n: int, half: Half) -> Array:
        """Distribution (3 n,) of the reaction that balances the loads; its work on the displacements vanishes."""
        border = np.zeros((len(self.whole.points), 3))
        if n == 0 and half == "symmetric":
            nodes, weights = self.seat
            border[nodes, 0] = weights / weights.sum()
            return border.ravel()
        nodes, weights = self._on_cylinder(self.axle.journal_radius, *self.axle.journal)
        weights = weights / weights.sum()
        if n == 0:
            border[nodes, 1] = weights
        else:
            border[nodes, 0], border[nodes, 2] = -weights, weights
        return border.ravel()

    @cached_property
    def seat(self) -> tuple[Nodes, Array]:
        """Nodes of the seat in order, and their integration weights m along the seat."""
        bore = self.whole.section.points[self.whole.section.clamped]
        return self._on_cylinder(float(bore[0, 1]), float(bore[:, 0].min()), float(bore[:, 0].max()))

    def seat_motion(self, n: int, displacements: Array) -> Array:
        """Mean rigid motion (2, m) of the seat: downwards m and negative roll rad (n = 1); turn rad and y m (n = 0)."""
        nodes, weights = self.seat
        y, r = self.whole.points[nodes].T - np.array([[self.wheel_y], [0.0]])
        modes = rigid_modes(n, y, r).reshape(-1, 2)
        weighted = np.repeat(weights, 3)[:, None] * modes
        own = displacements.reshape(-1, 3, displacements.shape[1])[nodes].reshape(3 * len(nodes), -1)
        return np.linalg.solve(modes.T @ weighted, weighted.T @ own)

    def own_weight(self, density: float, gravity: float) -> Array:
        """Nodal loads (3 n, 1) N per unit angle of the weight, harmonic n = 1; density kg/m3, gravity m/s2."""
        downwards = np.tile([-1.0, 0.0, 1.0], len(self.whole.points))
        return np.asarray(density * gravity * (self._volume @ downwards)[:, None])

    def mass(self, density: float) -> float:
        """Mass of the whole wheelset, kg, at a density kg/m3."""
        radial = np.tile([0.0, 0.0, 1.0], len(self.whole.points))
        return float(2 * 2 * np.pi * density * (radial @ self._volume @ radial))

    @cached_property
    def _volume(self) -> sp.csr_array:
        """Integrals of products of shape functions over the section, per unit angle, m3."""
        U, V = ufl.TrialFunction(self.whole.space), ufl.TestFunction(self.whole.space)
        r = ufl.SpatialCoordinate(self.whole.mesh)[1]
        pointer, columns, values = compat.assemble_csr(compiled(ufl.inner(U, V) * r * ufl.dx))
        size = 3 * len(self.whole.points)
        return sp.csr_array((values, columns, pointer), shape=(size, size))

    def surface_stress(self, displacements: Array) -> tuple[Array, Array]:
        """Bending stress on the axle between its middle and the wheel, harmonic n = 1.

        Returns places y (k,) m, at the middles of edges, and amplitudes (k, m) Pa of the axial stress at the bottom by
        displacements (3 n, m) m. It ends half a radius before the step, whose corner is sharp.
        """
        end, diameter = self.axle.steps[0]
        nodes, _ = self._on_cylinder(0.5 * diameter, 0.0, end)
        u = displacements.reshape(-1, 3, displacements.shape[1])[nodes]
        y = self.whole.points[nodes, 0]
        axial = (u[2::2, 1] - u[:-2:2, 1]) / (y[2::2] - y[:-2:2])[:, None]
        hoop = (u[1::2, 0] + u[1::2, 2]) / (0.5 * diameter)
        steel = self.whole.steel
        stress = steel.E / (1 - steel.nu**2) * (axial + steel.nu * hoop)
        kept = y[1::2] < end - 0.25 * diameter
        return y[1::2][kept], stress[kept]

    def _on_cylinder(self, radius: float, start: float, stop: float) -> tuple[Nodes, Array]:
        """Displacement nodes on a cylinder between two y m, in order, and their weights m in integrals along y."""
        y, r = self.whole.points.T
        nodes = np.flatnonzero((np.abs(r - radius) < SNAP) & (y > start - SNAP) & (y < stop + SNAP))
        nodes = nodes[np.argsort(y[nodes])]
        weights, length = np.zeros(len(nodes)), y[nodes][2::2] - y[nodes][:-2:2]
        for part, weight in enumerate((1 / 6, 4 / 6, 1 / 6)):  # Simpson's rule on every quadratic edge
            weights[part : part + 2 * len(length) : 2] += weight * length
        return nodes, weights


def rigid_modes(n: int, y: Array, r: Array) -> Array:
    """Displacements (k, 3, 2) of points at y m from the hub's centre and radius r m by rigid motions of a harmonic.

    n = 1: downwards, and negative roll about the hub's centre; n = 0: turn about the axle, and along y.
    """
    zero, unit = np.zeros_like(y), np.ones_like(y)
    if n == 1:
        return np.stack([np.stack([-unit, zero, unit], axis=1), np.stack([-y, -r, y], axis=1)], axis=2)
    return np.stack([np.stack([r, zero, zero], axis=1), np.stack([zero, unit, zero], axis=1)], axis=2)


def factored(body: WaveguideSection, n: int, fixed: Nodes, border: Array | None) -> Solve:
    """Solver of K(n) u + B l = f, B^T u = 0, with unknowns held; f and u (3 n, m)."""
    pointer, columns, _ = body.matrices
    size = 3 * len(body.points)
    assert body.radius is not None
    K = sp.csr_array((body.stiffness(n / body.radius), columns, pointer), shape=(size, size))
    free = np.setdiff1d(np.arange(size), fixed)
    system = sp.csc_array(K[free][:, free])
    if border is not None:
        column = sp.csc_array(border[free][:, None] * body.steel.E)  # of the order of the stiffness
        system = sp.csc_array(sp.bmat([[system, column], [column.T, None]]))
    factors = sl.splu(sp.csc_matrix(system), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})

    def solve(loads: Array) -> Array:
        right = np.zeros((system.shape[0], loads.shape[1]))
        right[: len(free)] = loads[free]
        displacements = np.zeros((size, loads.shape[1]))
        displacements[free] = factors.solve(right)[: len(free)]
        return displacements

    return solve
