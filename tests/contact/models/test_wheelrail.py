"""Contact map, candidates and interpolation of a wheel on a rail, against dense searches."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize
from small_pairs import BRICKS, FLAT, QUADRATIC, QUADRATIC_BRICKS, TETRAHEDRA, Block, quadrics
from small_wheelset import RADIUS, RAIL, SIZE, STATE, WHEEL, geometry, left_pose, outlines, wheelset

from wheelrail.contact.geometry.contact_operators import pair_operators
from wheelrail.contact.geometry.grid_points import GridPoints
from wheelrail.contact.geometry.quadric_pair import UPSIDE_DOWN
from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.meshes.bodies.extrusion import Cell
from wheelrail.support.arrays import Array, Mask

KINDS = [("tetrahedron", 1), ("tetrahedron", 2), ("hexahedron", 1), ("hexahedron", 2)]
POSES = {
    "tread": STATE,
    "inner tread": replace(STATE, y=0.0, z=-3.6e-4, yaw=0.0),
    "turned": replace(STATE, yaw=-4e-3),
}


def found(name: str = "tread", cell: Cell = "tetrahedron", degree: int = 1, ahead: float = 0.2 * SIZE) -> GridPoints:
    points, _ = geometry(cell, degree).contact_points(left_pose(POSES[name], ahead), 2)
    assert points is not None
    return points


@pytest.mark.parametrize("name", POSES)
def test_a_point_of_the_grid_touches_without_penetration(name: str) -> None:
    """Points above the rail's chords, up to 0.2 um below its surface, were missed: forces of a grid began with 3 N."""
    pose, grid = left_pose(POSES[name], 0.2 * SIZE), geometry("tetrahedron", 1)
    inside, outside = 0.0, 1e-3  # m, up
    for _ in range(50):
        middle = 0.5 * (inside + outside)
        points, approach = grid.contact_points(replace(pose, origin=pose.origin + np.array([0.0, 0.0, middle])), 2)
        inside, outside = (inside, middle) if points is None else (middle, outside)
        if points is not None:
            smallest = approach
    assert 0.0 < smallest < 1e-12


def rail_surface(x: Array, s: Array) -> Array:
    return np.concatenate([np.asarray(x)[..., None], RAIL.point(s)], axis=-1)


def nearest_of_a_mesh(points: Array) -> Array:
    """Nearest places on triangles between lines 20 um apart on the profile, 4 mm long: every pair of a point and a
    triangle, the projection clipped to the triangle.
    """
    s = np.arange(-0.03, 0.03, 2e-5)
    best, at = np.full(len(points), np.inf), np.zeros((len(points), 3))
    for x0 in np.arange(-0.02, 0.02, 4e-3):
        a, b = rail_surface(np.full(len(s) - 1, x0), s[:-1]), rail_surface(np.full(len(s) - 1, x0), s[1:])
        step = np.array([4e-3, 0.0, 0.0])
        for corner, u, v in ((a, b - a, step), (b + step, a - b, -step)):
            along = points[:, None] - corner
            uu, vv, uv = (u * u).sum(axis=1), v @ v, u @ v
            pu, pv = (along * u).sum(axis=2), along @ v
            det = uu * vv - uv * uv
            p, q = (pu * vv - pv * uv) / det, (pv * uu - pu * uv) / det
            inside = (p >= -1e-9) & (q >= -1e-9) & (p + q <= 1 + 1e-9)
            place = corner + p[..., None] * u + q[..., None] * v
            distance = np.where(inside, np.linalg.norm(points[:, None] - place, axis=2), np.inf)
            k = distance.argmin(axis=1)
            closer = distance[np.arange(len(points)), k] < best
            best[closer], at[closer] = (
                distance[np.arange(len(points)), k][closer],
                place[np.arange(len(points)), k][closer],
            )
    assert np.isfinite(best).all()
    return at


@pytest.mark.parametrize("name", POSES)
def test_contact_map_against_a_projection_on_a_fine_mesh(name: str) -> None:
    points = found(name)
    place = nearest_of_a_mesh(points.point)
    # chords of 20 um on a radius of 13 mm at least stand off by 4e-9 m
    np.testing.assert_allclose(rail_surface(points.point[:, 0], points.rail_place[:, 0]), place, atol=1e-6)
    overlap = ((points.point - place) * points.axes[:, 2]).sum(axis=1)
    np.testing.assert_allclose(points.penetration, overlap, atol=1e-8)


def test_contact_map_against_minimisation() -> None:
    points = found("turned")
    for point, s in zip(points.point[::5], points.rail_place[::5, 0], strict=True):

        def distance(at: Array, point: Array = point) -> float:
            return float(1e6 * ((rail_surface(at[:1], at[1:])[0] - point) ** 2).sum())

        found_by = min(
            (
                minimize(
                    distance, [point[0] + 1e-3, start], method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-16}
                )
                for start in (-0.02, 0.0, 0.02)
            ),
            key=lambda result: result.fun,
        )
        np.testing.assert_allclose(found_by.x, [point[0], s], atol=1e-6)


def inside_rail(points: Array) -> Mask:
    """Even-odd rule on the rail's polygon, for points (n, 3)."""
    polygon = outlines()[1].polygon(2e-5)
    y, z = points[:, 1], points[:, 2]
    inside = np.zeros(len(points), dtype=bool)
    for (y0, z0), (y1, z1) in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        if (z0 > z.max() and z1 > z.max()) or (z0 < z.min() and z1 < z.min()):
            continue
        crosses = (z0 > z) != (z1 > z)
        if z1 != z0:
            inside ^= crosses & (y < y0 + (z - z0) * (y1 - y0) / (z1 - z0))
    return inside


@pytest.mark.parametrize("name", POSES)
@pytest.mark.parametrize(("cell", "degree"), KINDS)
def test_candidates_are_the_points_inside_the_rail(name: str, cell: Cell, degree: int) -> None:
    shapes, pose = geometry(cell, degree), left_pose(POSES[name], 0.2 * SIZE)
    points, depth = shapes.contact_points(pose, 2)
    assert points is not None
    surface = pose.origin + shapes.surface[0] @ pose.rotation.T
    carries = shapes.wheel_grid.weight.ravel() > 0
    expected = np.flatnonzero(inside_rail(surface) & carries)
    np.testing.assert_array_equal(points.node, expected)
    assert (points.penetration > 0).all()
    assert depth == points.penetration.max()
    np.testing.assert_allclose(points.area, shapes.wheel_grid.weight.ravel()[points.node])


def test_points_and_axes_of_the_rotated_wheel() -> None:
    pose = left_pose(POSES["turned"])
    shapes = geometry()
    points, _ = shapes.contact_points(pose, 2)
    assert points is not None
    own = (points.point - pose.origin) @ pose.rotation
    y, z = WHEEL.point(points.wheel_place[:, 0]).T
    np.testing.assert_allclose(own[:, 1], y, atol=1e-12)
    np.testing.assert_allclose(np.hypot(own[:, 0], own[:, 2]), RADIUS + z, rtol=1e-12)
    np.testing.assert_allclose(
        points.axes @ points.axes.transpose(0, 2, 1), np.broadcast_to(np.eye(3), points.axes.shape), atol=1e-14
    )
    assert (np.linalg.det(points.axes) < 0).all()  # forward, left, outward: a left-handed triple
    assert (points.axes[:, 2, 2] < -0.9).all()  # outward from the wheel is down
    assert (points.axes[:, 0, 0] > 0.9).all()  # forward
    # the normal is that of the surface: across two neighbouring profile points and along the circle
    h = 1e-7
    ahead, behind = (WHEEL.point(points.wheel_place[:, 0] + d) for d in (h, -h))
    slope = (ahead - behind) / (2 * h)
    angle = np.arctan2(own[:, 0], -own[:, 2])
    tangent = np.column_stack([slope[:, 1] * np.sin(angle), slope[:, 0], -slope[:, 1] * np.cos(angle)])
    assert np.abs((tangent @ pose.rotation.T * points.axes[:, 2]).sum(axis=1)).max() < 1e-6
    # upstream is ahead: particles come from there
    steps = shapes.wheel_grid.position.reshape(-1, 3)[points.upstream]
    assert (np.diff(steps[..., 0], axis=0) > 0).all()
    arc = np.hypot(own[:, 0], own[:, 2]) * SIZE / RADIUS
    np.testing.assert_allclose(points.step, arc, rtol=1e-12)


@pytest.mark.parametrize(("cell", "degree"), KINDS)
def test_interpolation_on_the_rail(cell: Cell, degree: int) -> None:
    shapes = geometry(cell, degree)
    points = found(cell=cell, degree=degree)
    nodes, weights = points.rail.nodes, points.rail.weights
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, atol=1e-14)
    assert nodes.shape == (3 * len(points.node), (degree + 1) ** 2)
    rows, lines = shapes.rail_grid.shape
    spacing = SIZE / degree
    x = (np.arange(rows) - rows // 2)[:, None] * spacing
    s = shapes.rail_strip.start + np.arange(lines) * spacing
    own = points.upstream.ravel()
    pose = left_pose(POSES["tread"], 0.2 * SIZE)
    at = pose.origin + shapes.surface[0][own] @ pose.rotation.T
    foot = RAIL.closest(at[:, 1:]).s
    for power in range(degree + 1):
        for other in range(degree + 1):  # degree 1: 1, x, s, x s; degree 2: up to x2 s2
            field = (x**power * s**other).ravel()
            expected = at[:, 0] ** power * foot**other
            np.testing.assert_allclose((field[nodes] * weights).sum(axis=1), expected, atol=1e-13)
    # interpolated nodes of the rail are on the rail's profile
    if degree == 1:
        facing = (shapes.rail_grid.position.reshape(-1, 3)[nodes] * weights[..., None]).sum(axis=1)
        np.testing.assert_allclose(facing, rail_surface(at[:, 0], foot), atol=SIZE**2 / 8 / 0.013)


def test_every_wheel_position_has_candidates_or_a_distance() -> None:
    shapes = geometry()
    for y in np.linspace(-0.004, 0.004, 9):
        approaches = []
        for z in np.linspace(1e-3, -1e-4, 12):
            points, approach = shapes.contact_points(left_pose(WheelsetState(y=float(y), z=float(z))), 0)
            approaches.append(approach)
            assert (points is None) == (approach < 0)
        # lowering the wheel closes the gap by as much, times the cosine of its angle
        assert (np.diff(approaches) > 0).all()
        free = np.array(approaches)[np.array(approaches) < 0]
        assert (np.diff(free) <= 1e-4 * (1 + 1e-9)).all()
        assert (np.diff(free) > 0.95e-4).all()


@pytest.mark.parametrize(("y", "z"), [(0.03, -2e-3), (-0.04, -2e-3), (0.002, -4e-3)])
def test_penetration_beyond_the_strip_is_rejected(y: float, z: float) -> None:
    state = replace(STATE, y=y, z=z, yaw=0.0, roll=0.0)
    with pytest.raises(OutsideSurface, match="beyond the part of its surface"):
        geometry().contact_points(left_pose(state), 2)
    result = wheelset()(state, "left")
    assert result.status.startswith("failed: the wheel ")
    assert not result.ok
    assert not result.force.any()


def test_gap_of_hertz_pairs_is_that_of_the_parabolas() -> None:
    shapes = quadrics(TETRAHEDRA, (0.4, 0.3), (np.inf, -0.9), 1e-3)
    pose = replace(hertz_pose(1e-5), origin=np.array([3e-4, -2e-4, -1e-5]))
    points, approach = shapes.contact_points(pose, 1)
    assert points is not None
    assert approach == pytest.approx(1e-5)
    x, y = points.point[:, 0], points.point[:, 1]
    upper = -1e-5 + (x - 3e-4) ** 2 / 0.8 + (y + 2e-4) ** 2 / 0.6
    lower = y**2 / 1.8
    np.testing.assert_allclose(points.penetration, lower - upper, atol=1e-18)
    assert points.upstream.shape == (2, len(points.node))


@pytest.mark.parametrize("mesh", [TETRAHEDRA, BRICKS, QUADRATIC, QUADRATIC_BRICKS], ids=["P1", "Q1", "P2", "Q2"])
@pytest.mark.parametrize("order", [1, 2])
def test_upstream_slip_is_exact_for_polynomials_of_its_order(mesh: Block, order: int) -> None:
    shapes = quadrics(mesh, (0.3, 0.3), FLAT, 1e-3)
    radius = 1.2e-3 if mesh.degree == 2 else 2.8e-3
    points, _ = shapes.contact_points(hertz_pose(radius**2 / 0.6), order)
    assert points is not None
    grid = shapes.grid.position.reshape(-1, 3)
    wheel, rail = pair_operators(points, order)
    rng = np.random.default_rng(0)
    n = len(points.node)
    powers = np.arange(4)
    for degree in range(order + 2):
        c = rng.normal(size=(4, 4, 3)) * (powers <= degree)[:, None, None]  # of x^i y^j, for each component

        def field(place: Array, c: Array = c) -> Array:
            x, y = place[:, :1] / 1e-3, place[:, 1:2] / 1e-3
            return np.asarray(np.einsum("ni,nj,ijk->nk", x**powers, y**powers, c))

        def slope(place: Array, c: Array = c) -> Array:
            x, y = place[:, :1] / 1e-3, place[:, 1:2] / 1e-3
            slopes = powers * x ** np.maximum(powers - 1, 0) / 1e-3
            return np.asarray(np.einsum("ni,nj,ijk->nk", slopes, y**powers, c))

        expected = -slope(points.point)[:, :2].T.ravel()
        exact = degree <= order
        for coupling, rotation in ((wheel, UPSIDE_DOWN), (rail, np.eye(3))):
            # each body's nodes move in its own axes
            nodal = (field(grid[coupling.nodes]) @ rotation)[:, coupling.directions]
            assert coupling.slip is not None
            error = np.abs(coupling.slip @ nodal.ravel() - expected).max() / max(np.abs(expected).max(), 1.0)
            assert error < 1e-10 if exact else error > 1e-3
            moved = coupling.displacement @ nodal.ravel()
            local = np.einsum("nkc,nc->kn", points.axes, field(points.point))
            np.testing.assert_allclose(moved.reshape(3, n), local, atol=1e-10)


def test_upstream_slip_of_wheel_and_rail() -> None:
    points = found()
    wheel, rail = pair_operators(points, 2)
    assert wheel.slip is not None
    assert rail.slip is not None
    # rigid motion causes no slip, but brings material of another rolling radius r(s - u_t) to a place s on the wheel
    s, near = points.wheel_place[:, 0], 1e-6
    radius = RADIUS + WHEEL.point(s)[:, 1]
    growth = (WHEEL.point(s + near)[:, 1] - WHEEL.point(s - near)[:, 1]) / (2 * near)
    lateral_axes = points.axes[:, 1] @ points.wheel_rotation
    for coupling, slope in ((wheel, growth / radius), (rail, np.zeros(len(s)))):
        for direction in np.eye(3):
            moved = np.tile(direction[list(coupling.directions)], len(coupling.nodes))
            slip = (coupling.slip @ moved).reshape(2, -1)
            expected = np.stack([slope * (lateral_axes @ direction), np.zeros(len(s))])
            assert np.abs(slip - expected).max() < 1e-6
            assert np.abs(slope).max() == 0 or np.abs(slope).max() > 0.02
    # quadratic displacement of the rail along x, at points between its nodes
    shapes = geometry()
    x = shapes.rail_grid.position.reshape(-1, 3)[rail.nodes, 0]
    for power, exact in ((1, 1e-9), (2, 0.3)):  # interpolation error of P1 for x^2: h^2 / 8
        stretch = np.zeros((len(x), 3))
        stretch[:, 0] = x**power
        at = points.point[:, 0]
        expected = -power * at ** (power - 1) * points.axes[:, 0, 0]
        slip = (rail.slip @ stretch[:, rail.directions].ravel())[: len(at)]
        # a step along the wheel's circle is a little shorter along the rail
        assert np.abs(slip - expected).max() < max(exact * SIZE, 2e-3 * np.abs(expected).max())


def test_frictionless_pairs_build_no_slip_operator() -> None:
    points, _ = geometry().contact_points(left_pose(), 0)
    assert points is not None
    for coupling in pair_operators(points, 0):
        assert coupling.slip is None
        assert coupling.displacement.shape[0] == len(points.node)


@pytest.mark.parametrize("cells", [11, -11])
def test_the_rail_is_the_same_along_the_track(cells: int) -> None:
    """Yaw moves a wheel along its rail, beyond the part that is meshed finely."""
    pose, grid = left_pose(POSES["turned"], 0.2 * SIZE), geometry("tetrahedron", 1)
    away = np.array([cells * grid.rail_strip.size, 0.0, 0.0])
    at = replace(pose, origin=pose.origin + away)
    (here, approach), (there, same) = grid.contact_points(pose, 2), grid.contact_points(at, 2)
    assert here is not None
    assert there is not None
    assert same == approach
    np.testing.assert_allclose(there.point - away, here.point, atol=1e-15)
    np.testing.assert_array_equal(there.rail.nodes, here.rail.nodes)
    np.testing.assert_allclose(there.rail.weights, here.rail.weights, atol=1e-9)
