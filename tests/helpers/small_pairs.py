"""Pairs of small blocks; each mesh, stiffness and compliance is computed once per session."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from wheelrail.contact.analytical.hertz import Hertz, hertz, modulus
from wheelrail.contact.elasticity.solid_body import ElasticBody
from wheelrail.contact.elasticity.solid_compliance import SurfaceCompliance
from wheelrail.contact.geometry.quadric_pair import QuadricPair, curvature
from wheelrail.contact.geometry.surface_grid import ContactGrid
from wheelrail.contact.kinematics.frames import RigidMotion, Twist
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.condensed import CondensedContact
from wheelrail.contact.models.full.model import FullContact
from wheelrail.contact.models.full.newton import FullOptions
from wheelrail.meshes.bodies.extrusion import Cell, Solid
from wheelrail.meshes.bodies.solids import block
from wheelrail.meshes.bodies.triangulation import Grading
from wheelrail.support.cache import digest

STEEL = Material(210e9, 0.3)
E_STAR = modulus((210e9, 0.3), (210e9, 0.3))
FLAT = (np.inf, np.inf)


def hertzian(radii: tuple[float, float], force: float) -> Hertz:
    """Hertz's contact of a steel body on a steel plane under a force [N]."""
    A, B = curvature(radii)
    return hertz(float(A), float(B), E_STAR, force=force)


@dataclass(frozen=True)
class Block:
    """Mesh of a block, lengths in cells of its strip; see `wheelrail.meshes.bodies.solids.block`."""

    half_cells: tuple[int, int]
    half_width: float
    cell: Cell = "tetrahedron"
    degree: int = 1
    growth: float = 0.2
    first: float = 0.5


# Coarse meshes for tests that do not depend on accuracy: equations, symmetries, agreement.
TETRAHEDRA = Block((6, 4), 8.0, growth=1.0, first=1.0)
BRICKS = Block((6, 4), 8.0, "hexahedron", growth=1.0, first=1.0)
QUADRATIC = Block((4, 2), 5.0, degree=2, growth=1.0, first=1.0)
QUADRATIC_BRICKS = Block((3, 2), 4.0, "hexahedron", degree=2, growth=1.5, first=1.5)


@cache
def solid(mesh: Block) -> tuple[Solid, str]:
    """Mesh with cells of 1 m, and its key."""
    grading = Grading(mesh.first, mesh.growth)
    return block(mesh.half_cells, half_width=mesh.half_width, cell=mesh.cell, grading=grading)


@cache
def elastic(mesh: Block, steel: Material, size: float) -> ElasticBody:
    """Body with cells of a size [m]."""
    scaled = solid(mesh)[0].mapped(lambda points: points * size)
    return ElasticBody(scaled, steel, degree=mesh.degree)


def compliance(mesh: Block, steel: Material, size: float) -> SurfaceCompliance:
    """Compliance for cells of a size [m]; bodies of all sizes and moduli use the solves for unit size and modulus."""
    unit = Material(1.0, steel.nu)
    shape = ContactGrid.on(solid(mesh)[0], mesh.degree).shape
    key = digest(mesh=solid(mesh)[1], nu=steel.nu, degree=mesh.degree)
    return SurfaceCompliance(key, shape, lambda: elastic(mesh, unit, 1.0), scale=1 / (steel.E * size))


def quadrics(mesh: Block, upper: tuple[float, float], lower: tuple[float, float], size: float) -> QuadricPair:
    grid = ContactGrid.on(solid(mesh)[0], mesh.degree)
    return QuadricPair(ContactGrid(grid.position * size, grid.weight * size**2, grid.stride), upper, lower)


def condensed(
    mesh: Block,
    upper: tuple[float, float],
    lower: tuple[float, float] = FLAT,
    *,
    size: float,
    laws: ContactLaws,
    steels: tuple[Material, Material] = (STEEL, STEEL),
    order: int = 2,
) -> CondensedContact:
    first, second = (compliance(mesh, steel, size) for steel in steels)
    return CondensedContact(quadrics(mesh, upper, lower, size), first, second, laws, order=order)


def full(
    mesh: Block,
    upper: tuple[float, float],
    lower: tuple[float, float] = FLAT,
    *,
    size: float,
    laws: ContactLaws,
    steels: tuple[Material, Material] = (STEEL, STEEL),
    order: int = 2,
    options: FullOptions | None = None,
) -> FullContact:
    bodies = [elastic(mesh, steel, size) for steel in steels]
    geometry = quadrics(mesh, upper, lower, size)
    return FullContact(geometry, bodies[0], bodies[1], laws, order=order, options=options or FullOptions())


def rolling(xi: float, eta: float, spin: float, *, speed: float = 10.0) -> RigidMotion:
    """Upper on lower body, rolling in +x at a speed [m/s] with creepages and spin [1/m]."""
    flow, slip = np.array([-speed, 0.0, 0.0]), 0.5 * speed * np.array([xi, eta, 0.0])
    turn, origin = 0.5 * speed * np.array([0.0, 0.0, spin]), np.zeros(3)
    return RigidMotion(Twist(flow + slip, turn, origin), Twist(flow - slip, -turn, origin))


AT_REST = RigidMotion(*(Twist(np.zeros(3), np.zeros(3), np.zeros(3)) for _ in range(2)))
CREEP = rolling(1e-3, -5e-4, 0.3)  # partial slip
