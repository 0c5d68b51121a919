"""3D meshes of blocks, rails and wheels, and the grid of contact points on them."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.integrate import trapezoid
from scipy.spatial import cKDTree

from wheelrail.contact.geometry.surface_grid import ContactGrid
from wheelrail.meshes.bodies.extrusion import Cell, Solid, bulged, layers
from wheelrail.meshes.bodies.outlines import Outline, rail_outline, rim_outline
from wheelrail.meshes.bodies.solids import Strip, block, profiled
from wheelrail.meshes.bodies.triangulation import Grading
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.support.arrays import Array

CELLS: tuple[Cell, Cell] = ("tetrahedron", "hexahedron")
KINDS = [(cell, degree) for cell in CELLS for degree in (1, 2)]
SIZE, RADIUS = 4e-3, 0.46


@cache
def flat(cell: Cell) -> Solid:
    """Block of half width 2 m, strip of 8 x 8 cells."""
    return block((4, 4), size=0.1, half_width=2.0, cell=cell, grading=Grading(1.0, 0.5))[0]


@cache
def outlines() -> tuple[Outline, Outline]:
    return rail_outline(named_profile("UIC60-benchmark")), rim_outline(named_profile("S1002"), RADIUS)


@cache
def rail_of(cell: Cell) -> tuple[Solid, Strip, str]:
    return profiled(outlines()[0], size=SIZE, half_length=0.15, cell=cell)


@cache
def wheel_of(cell: Cell) -> tuple[Solid, Strip, str]:
    return profiled(outlines()[1], size=SIZE, half_length=0.1, cell=cell)


def solids(cell: Cell) -> dict[str, Solid]:
    sphere = flat(cell).mapped(bulged((5.0, 5.0), 2.0))
    return {"block": flat(cell), "sphere": sphere, "rail": rail_of(cell)[0], "wheel": wheel_of(cell)[0]}


def corner_jacobians(solid: Solid) -> Array:
    """Determinants (m, k) at the corners of each cell, over the lengths of the three edges that meet there."""
    corners = solid.points[solid.cells]
    if solid.cell == "tetrahedron":
        edges = (corners[:, 1:] - corners[:, :1])[:, None]
    else:
        at = np.arange(8)
        edges = np.stack([corners[:, at | bit] - corners[:, at & ~bit] for bit in (1, 2, 4)], axis=2)
    return np.asarray(np.linalg.det(edges) / np.linalg.norm(edges, axis=3).prod(axis=2))


def test_layers_are_uniform_on_the_strip_and_grow_outside() -> None:
    x = layers(5, 0.5, 20.0, growth=1.35, largest=3.0)
    np.testing.assert_allclose(x, -x[::-1], atol=1e-14)
    assert x[0] == pytest.approx(-20.0)
    steps = np.diff(x)
    inside = np.abs(0.5 * (x[1:] + x[:-1])) < 2.5
    np.testing.assert_allclose(steps[inside], 0.5, rtol=1e-12)
    outer = steps[x[:-1] >= 2.5 - 1e-9]
    assert (np.diff(outer) > -1e-12).all()
    assert outer.max() <= 3.0 + 1e-12
    assert (outer[1:] / outer[:-1]).max() <= 1.35 + 1e-9


@pytest.mark.parametrize("cell", CELLS)
@pytest.mark.parametrize("name", ["block", "sphere", "rail", "wheel"])
def test_all_cells_have_positive_volume(cell: Cell, name: str) -> None:
    solid = solids(cell)[name]
    jacobian = corner_jacobians(solid)
    # slivers only in the rounded corners of a rail's foot, 2 mm small in layers of 40 mm
    assert np.abs(jacobian).min() > (1e-4 if cell == "tetrahedron" else 0.05)
    assert (np.sign(jacobian) == np.sign(jacobian[:, :1])).all()
    used = np.zeros(len(solid.points), dtype=bool)
    used[solid.cells] = True
    assert used.all()


@pytest.mark.parametrize("cell", CELLS)
def test_mesh_is_conforming(cell: Cell) -> None:
    solid = rail_of(cell)[0]
    local = (
        [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]]
        if cell == "tetrahedron"
        else [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 4, 5], [2, 3, 6, 7], [0, 2, 4, 6], [1, 3, 5, 7]]
    )
    faces = np.sort(solid.cells[:, local].reshape(-1, len(local[0])), axis=1)
    faces, count = np.unique(faces, axis=0, return_counts=True)
    assert count.max() == 2
    free = {tuple(face) for face in faces[count == 1]}
    # the surface is closed: every edge of it belongs to two free faces, and the strip is part of it
    assert {tuple(sorted(face)) for face in solid.faces} <= free
    if cell == "tetrahedron":
        triangles = np.array(sorted(free))
        edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [0, 2]]])
        assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()


@pytest.mark.parametrize("cell", CELLS)
def test_volume(cell: Cell) -> None:
    assert flat(cell).volume() == pytest.approx(4.0 * 4.0 * 2.0, rel=1e-12)
    bulge = flat(cell).mapped(bulged((5.0, 5.0), 2.0)).volume()
    # the sag of the cap at the top fades linearly to the bottom: half of it is lost over the height
    x = np.linspace(-2, 2, 401)
    sag = 5.0 - np.sqrt(25.0 - x[:, None] ** 2 - x**2)
    lost = trapezoid(trapezoid(sag, x), x)
    assert bulge == pytest.approx(32.0 - lost * 2.0 / 2, rel=5e-3)
    section, _ = outlines()
    polygon = section.polygon(1e-4)
    y, z = polygon.T
    area = 0.5 * abs(float((y * np.roll(z, -1) - z * np.roll(y, -1)).sum()))
    assert rail_of(cell)[0].volume() == pytest.approx(area * 0.3, rel=2e-3)
    polygon = outlines()[1].polygon(1e-4)
    (y, r), (u, s) = polygon.T, np.roll(polygon, -1, axis=0).T
    moment = abs(float(((y * s - u * r) * (r + s)).sum())) / 6  # area times the centroid's radius, Pappus
    assert wheel_of(cell)[0].volume() == pytest.approx(moment * 0.2 / RADIUS, rel=3e-3)


@pytest.mark.parametrize("cell", CELLS)
def test_block_strip_is_uniform_and_flat_and_the_bottom_clamped(cell: Cell) -> None:
    solid = flat(cell)
    grid = solid.points[solid.grid]
    line = 0.1 * np.arange(-4, 5)
    np.testing.assert_allclose(grid[..., 0], np.broadcast_to(line[:, None], (9, 9)), atol=1e-14)
    np.testing.assert_allclose(grid[..., 1], np.broadcast_to(line, (9, 9)), atol=1e-14)
    assert not grid[..., 2].any()
    np.testing.assert_array_equal(solid.clamped, solid.points[:, 2] < -2.0 + 1e-9)
    assert solid.clamped.any()


@pytest.mark.parametrize("cell", CELLS)
def test_mesh_grows_with_the_distance_from_the_strip(cell: Cell) -> None:
    solid = flat(cell)
    corners = solid.points[solid.cells]
    extent = np.ptp(corners[..., 1], axis=1)
    depth = -corners[..., 2].mean(axis=1)
    beside = np.abs(corners[..., 1].mean(axis=1)) < 0.4
    near, far = extent[beside & (depth < 0.1)], extent[beside & (depth > 1.0)]
    assert near.max() < 0.2
    assert far.mean() > 1.5 * near.mean()


def test_bulged_tops() -> None:
    solid = flat("tetrahedron")
    x, y, z = solid.points[solid.grid].reshape(-1, 3).T
    top = solid.grid.ravel()

    def heights(radii: tuple[float, float]) -> Array:
        moved = solid.mapped(bulged(radii, 2.0))
        np.testing.assert_array_equal(moved.points[moved.clamped, 2], -2.0)
        np.testing.assert_array_equal(moved.points[:, :2], solid.points[:, :2])
        return np.asarray(moved.points[top, 2])

    np.testing.assert_allclose(x**2 + y**2 + (heights((5.0, 5.0)) + 5.0) ** 2, 25.0, rtol=1e-14)
    np.testing.assert_allclose(x**2 + y**2 + (heights((-5.0, -5.0)) - 5.0) ** 2, 25.0, rtol=1e-14)
    np.testing.assert_allclose(y**2 + (heights((np.inf, 3.0)) + 3.0) ** 2, 9.0, rtol=1e-14)  # cylinder
    # ellipsoid: the principal curvatures at the apex are the ones asked for
    z = heights((4.0, 6.0))
    for along, across, radius in ((x, y, 4.0), (y, x, 6.0)):
        line = np.abs(across) < 1e-12
        np.testing.assert_allclose(np.polyfit(along[line], z[line], 4)[2], -0.5 / radius, rtol=1e-4)
    assert not heights((np.inf, np.inf)).any()
    with pytest.raises(ValueError, match="half width 2 m cannot carry the radii"):
        solid.mapped(bulged((2.5, 2.5), 2.0))


@pytest.mark.parametrize("cell", CELLS)
def test_rail_strip_lies_on_the_profile(cell: Cell) -> None:
    solid, strip, _ = rail_of(cell)
    outline = outlines()[0]
    grid = solid.points[solid.grid]
    assert grid.shape == (2 * strip.half_cells + 1, strip.cells + 1, 3)
    on_profile = outline.surface(strip.arc)
    np.testing.assert_allclose(grid[..., 1:], np.broadcast_to(on_profile, grid[..., 1:].shape), atol=1e-14)
    np.testing.assert_allclose(grid[:, 0, 0], SIZE * np.arange(-strip.half_cells, strip.half_cells + 1), atol=1e-14)
    np.testing.assert_allclose(np.diff(strip.arc), SIZE, rtol=1e-12)
    held = outline.is_clamped(solid.points[:, 1:])
    np.testing.assert_array_equal(solid.clamped, held)
    foot = outline.boundary[outline.clamped[0] : outline.clamped[1] + 1]
    np.testing.assert_allclose(np.ptp(solid.points[solid.clamped, 1]), np.ptp(foot[:, 0]), rtol=1e-9)


@pytest.mark.parametrize("cell", CELLS)
def test_wheel_strip_lies_on_the_surface_of_revolution(cell: Cell) -> None:
    solid, strip, _ = wheel_of(cell)
    profile = outlines()[1].profile
    grid = solid.points[solid.grid]
    y, z = profile.point(strip.arc).T
    np.testing.assert_allclose(
        np.hypot(grid[..., 0], grid[..., 2]) - RADIUS, np.broadcast_to(z, grid.shape[:2]), atol=1e-12
    )
    np.testing.assert_allclose(grid[..., 1], np.broadcast_to(y, grid.shape[:2]), atol=1e-12)
    angle = np.arctan2(grid[..., 0], -grid[..., 2])
    np.testing.assert_allclose(np.diff(angle, axis=0), SIZE / RADIUS, rtol=1e-9)
    assert angle[strip.half_cells] == pytest.approx(0.0, abs=1e-15)
    radius = np.hypot(solid.points[:, 0], solid.points[:, 2])
    np.testing.assert_array_equal(solid.clamped, radius < RADIUS - 0.065 + 1e-9)


def test_too_large_strip_is_rejected() -> None:
    with pytest.raises(ValueError, match="does not fit on a block"):
        block((40, 4), size=0.1, half_width=2.0)


def face_areas(solid: Solid) -> float:
    corners = solid.points[solid.faces]
    if corners.shape[1] == 3:
        return float(
            0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
        )
    return float(
        0.5 * np.linalg.norm(np.cross(corners[:, 3] - corners[:, 0], corners[:, 2] - corners[:, 1]), axis=1).sum()
    )


@pytest.mark.parametrize(("cell", "degree"), KINDS)
@pytest.mark.parametrize("name", ["block", "sphere", "rail", "wheel"])
def test_weights_sum_to_the_area_of_the_strip(name: str, cell: Cell, degree: int) -> None:
    solid = solids(cell)[name]
    grid = ContactGrid.on(solid, degree)
    # quadrilaterals on a sphere are not quite plane
    assert grid.weight.sum() == pytest.approx(face_areas(solid), rel=1e-8 if name == "sphere" else 1e-12)
    assert grid.weight.min() >= 0
    assert grid.shape == tuple(degree * (n - 1) + 1 for n in solid.grid.shape)
    assert grid.stride == (2 if (cell, degree) == ("tetrahedron", 2) else 1)
    if grid.stride == 2:  # no contact points at the vertices of quadratic triangles
        assert not grid.weight[::2, ::2].any()
        assert (grid.weight > 0).sum() == grid.weight.size - solid.grid.size
    else:
        assert grid.weight.min() > 0
    np.testing.assert_array_equal(grid.position[::degree, ::degree], solid.points[solid.grid])


def integrals_by_dolfinx(solid: Solid, degree: int) -> tuple[Array, Array]:
    """Nodes (n, 3) of the strip and the integral (n,) of each node's shape function, assembled on the strip's faces."""
    import ufl
    from dolfinx import fem
    from dolfinx.fem.petsc import assemble_vector
    from mpi4py import MPI
    from petsc4py import PETSc

    from wheelrail.forms import compat

    used, faces = np.unique(solid.faces, return_inverse=True)
    cell = "triangle" if solid.cell == "tetrahedron" else "quadrilateral"
    mesh = compat.mesh_from_arrays(MPI.COMM_SELF, cell, faces.reshape(solid.faces.shape), solid.points[used])
    space = compat.space(mesh, degree, 1)
    one = fem.Constant(mesh, PETSc.ScalarType(1.0))
    vector = assemble_vector(fem.form(one * ufl.TestFunction(space) * ufl.dx(metadata={"quadrature_degree": 6})))
    return space.tabulate_dof_coordinates(), vector.array.copy()


@pytest.mark.parametrize(("cell", "degree"), KINDS)
@pytest.mark.parametrize("name", ["block", "rail", "wheel"])
def test_weights_are_the_integrals_of_the_shape_functions(name: str, cell: Cell, degree: int) -> None:
    solid = solids(cell)[name]
    grid = ContactGrid.on(solid, degree)
    place, expected = integrals_by_dolfinx(solid, degree)
    distance, node = cKDTree(place).query(grid.position.reshape(-1, 3))
    assert distance.max() < 1e-12
    # quadrilaterals of a wheel are trapezia, narrower towards the smaller radius: 4 mm over 0.46 m on the flange
    rtol = 1e-9 if name != "wheel" or cell == "tetrahedron" else 4e-3
    np.testing.assert_allclose(grid.weight.ravel(), expected[node], rtol=rtol, atol=1e-12 * expected.max())
