"""Action and reaction, mirror symmetry, and patch tests of constant stress."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from small_pairs import BRICKS, CREEP, FLAT, QUADRATIC, QUADRATIC_BRICKS, TETRAHEDRA, Block, condensed, quadrics
from small_wheelset import MOUNTING, RADIUS, SIZE, SPEED, STATE, geometry, left_pose, wheelset

from wheelrail.contact.elasticity.solid_body import ElasticBody
from wheelrail.contact.geometry.contact_operators import ContactOperators, pair_operators
from wheelrail.contact.geometry.grid_points import GridPoints, Interpolation, SurfacePair
from wheelrail.contact.geometry.quadric_pair import UPSIDE_DOWN
from wheelrail.contact.geometry.surface_grid import ContactGrid
from wheelrail.contact.kinematics.frames import MIRROR, SIDES, Pose, RigidMotion, Twist
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.full.model import FullContact, FullStart
from wheelrail.meshes.bodies.extrusion import Cell, Solid, extruded
from wheelrail.meshes.bodies.triangulation import SectionMesh
from wheelrail.support.arrays import Array, Nodes


@dataclass(frozen=True)
class Loads:
    """Forces (n, 3) N on the n points, in the rail frame, and on both bodies' nodes with the nodes' places, m."""

    points: GridPoints
    forces: Array
    wheel: tuple[Array, Array]
    rail: tuple[Array, Array]


def nodal(coupling: ContactOperators, components: Array) -> tuple[Nodes, Array]:
    """Nodes and forces (m, 3) on them by forces (n, 3) on the points, component by component: B^T of the operator."""
    forces = np.zeros((len(coupling.nodes), 3))
    forces[:, coupling.directions] = (coupling.displacement.T @ components.T.ravel()).reshape(len(coupling.nodes), -1)
    return coupling.nodes, forces


def apply(
    shapes: SurfacePair, wheel: ContactGrid, rail: ContactGrid, pose: Pose, seed: int = 0, friction: float = 0.3
) -> Loads:
    """Random pressures and tractions through the transposed operators of both bodies."""
    points, _ = shapes.contact_points(pose, 2)
    assert points is not None
    rng = np.random.default_rng(seed)
    n = len(points.node)
    pressure = rng.uniform(0.0, 1e9, n)
    components = (
        np.column_stack([*(friction * pressure * rng.uniform(-0.7, 0.7, (2, n))), -pressure]) * points.area[:, None]
    )
    above, below = pair_operators(points, 2)
    on_wheel, pushed = nodal(above, components)
    on_rail, pulled = nodal(below, -components)
    place = wheel.position.reshape(-1, 3)[on_wheel]
    if isinstance(shapes, type(geometry())):
        place = pose.origin + place @ points.wheel_rotation.T
    return Loads(
        points,
        np.einsum("nk,nkc->nc", components, points.axes),
        (place, pushed @ points.wheel_rotation.T),
        (rail.position.reshape(-1, 3)[on_rail], pulled),
    )


def moment(loads: tuple[Array, Array], about: Array) -> Array:
    place, force = loads
    return np.asarray(np.cross(place - about, force).sum(axis=0))


CENTRE = np.array([0.02, -0.75, 0.46])  # of the wheelset, arbitrary


@pytest.mark.parametrize("mesh", [TETRAHEDRA, BRICKS, QUADRATIC, QUADRATIC_BRICKS], ids=["P1", "Q1", "P2", "Q2"])
def test_hertz_pairs_cancel_to_round_off(mesh: Block) -> None:
    shapes = quadrics(mesh, (0.3, 0.46), FLAT, 1e-3)
    radius = 1.2e-3 if mesh.degree == 2 else 2.8e-3
    pose = replace(hertz_pose(radius**2 / 0.92), origin=np.array([2e-4, -3e-4, -(radius**2) / 0.92]))
    loads = apply(shapes, shapes.grid, shapes.grid, pose)
    scale = np.abs(loads.forces).sum()
    wheel, rail = loads.wheel[1].sum(axis=0), loads.rail[1].sum(axis=0)
    np.testing.assert_allclose(wheel, loads.forces.sum(axis=0), atol=1e-12 * scale)
    np.testing.assert_allclose(wheel + rail, 0.0, atol=1e-12 * scale)
    arm = np.linalg.norm(CENTRE)
    np.testing.assert_allclose(moment(loads.wheel, CENTRE) + moment(loads.rail, CENTRE), 0.0, atol=1e-12 * scale * arm)


@pytest.mark.parametrize("cell", ["tetrahedron", "hexahedron"])
@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("ahead", [0.0, 0.3 * SIZE])
def test_wheel_and_rail_cancel(cell: Cell, degree: int, ahead: float) -> None:
    shapes, pose = geometry(cell, degree), left_pose(ahead=ahead)
    loads = apply(shapes, shapes.wheel_grid, shapes.rail_grid, pose)
    n = len(loads.points.node)
    assert n > 15
    scale = np.abs(loads.forces).sum()
    wheel, rail = loads.wheel[1].sum(axis=0), loads.rail[1].sum(axis=0)
    # Forces: the rail's weights sum to one, so the total is the same to round-off wherever its nodes are.
    np.testing.assert_allclose(wheel, loads.forces.sum(axis=0), atol=1e-12 * scale)
    np.testing.assert_allclose(wheel + rail, 0.0, atol=1e-12 * scale)
    # Moments: a force acts on the wheel at a node and on the rail at the interpolated place that faces it. The moment
    # of that pair is the only remainder, to round-off; it exists in the continuous model, which neglects the gap.
    node = shapes.wheel_grid.position.reshape(-1, 3)[loads.points.node]
    own = pose.origin + node @ pose.rotation.T
    weights, nodes = loads.points.rail.weights[:n], loads.points.rail.nodes[:n]
    facing = (shapes.rail_grid.position.reshape(-1, 3)[nodes] * weights[..., None]).sum(axis=1)
    left = moment(loads.wheel, CENTRE) + moment(loads.rail, CENTRE)
    pairs = np.cross(own - facing, loads.forces).sum(axis=0)
    arm = np.linalg.norm(CENTRE - own.mean(axis=0))
    np.testing.assert_allclose(left, pairs, atol=1e-12 * scale * arm)
    # Its arm is the penetration along the normal and the chord error of flat facets, h^2 / 8 R on each body.
    # The arm of the penetration is parallel to the pressure, so that only friction has a moment.
    sagitta = 2 * SIZE**2 / 8 / 0.013
    friction = np.linalg.norm(np.einsum("nc,nkc->nk", loads.forces, loads.points.axes)[:, :2], axis=1).sum()
    bound = loads.points.penetration.max() * friction + 2 * sagitta * scale
    assert np.linalg.norm(left) < bound
    assert bound < 5e-4 * scale * arm


def test_force_and_moment_of_a_result_are_those_on_the_nodes() -> None:
    contact = condensed(TETRAHEDRA, (0.3, 0.3), size=1e-3, laws=ContactLaws.penalty())
    result = contact(hertz_pose(1.5e-5), CREEP)
    fields = result.fields
    assert fields is not None
    points, _ = contact.geometry.contact_points(hertz_pose(1.5e-5), 2)
    assert points is not None
    components = np.column_stack([fields.traction, -fields.pressure]) * fields.area[:, None]
    above, below = pair_operators(points, 2)
    scale = np.abs(result.force).sum()
    grid = contact.geometry.grid.position.reshape(-1, 3)  # type: ignore[attr-defined]
    for coupling, rotation, sign in ((above, UPSIDE_DOWN, 1.0), (below, np.eye(3), -1.0)):
        nodes, forces = nodal(coupling, sign * components)
        forces = forces @ rotation.T
        np.testing.assert_allclose(forces.sum(axis=0), sign * result.force, atol=1e-12 * scale)
        np.testing.assert_allclose(
            np.cross(grid[nodes], forces).sum(axis=0), sign * result.moment, atol=1e-12 * scale * 1e-2
        )
    moved = result.about(CENTRE)
    np.testing.assert_allclose(moved.moment, result.moment + np.cross(-CENTRE, result.force), rtol=1e-12)


@pytest.mark.parametrize("laws", [ContactLaws.penalty(0.0), ContactLaws.penalty()], ids=["frictionless", "rolling"])
def test_left_and_right_are_mirror_images(laws: ContactLaws) -> None:
    contact = wheelset(laws)
    for state in (STATE, replace(STATE, y=0.001, z=-2.3e-4, yaw=-1e-3)):
        for side, other in (SIDES, SIDES[::-1]):
            one, two = contact(state, side), contact(state.mirrored(), other)
            assert one.status == two.status
            scale = max(float(np.linalg.norm(one.force)), 1.0)
            np.testing.assert_allclose(two.force, MIRROR * one.force, atol=1e-8 * scale)
            np.testing.assert_allclose(two.moment, -MIRROR * one.moment, atol=1e-8 * scale)
            for mine, its in zip(one.patches, two.patches, strict=True):
                assert its.contact_angle == pytest.approx(-mine.contact_angle, rel=1e-8)
                assert its.wheel_s == pytest.approx(mine.wheel_s, rel=1e-8)
                np.testing.assert_allclose(its.force, MIRROR * mine.force, atol=1e-8 * scale)
    assert contact(STATE, "left").patches


def test_both_wheels_of_a_centred_wheelset_have_equal_loads() -> None:
    centred = WheelsetState(z=-2e-4, pitch_rate=SPEED / RADIUS, speed=SPEED)
    left, right = (wheelset()(centred, side) for side in SIDES)
    assert left.patches
    assert left.force[2] == pytest.approx(right.force[2], rel=1e-8)
    assert abs(left.force[1] + right.force[1]) < 1e-8 * left.force[2]
    assert abs(left.moment[0] + right.moment[0]) < 1e-8 * np.abs(left.moment).max()
    # the contact plane is inclined towards the track's centre: tension in the axle
    assert left.patches[0].contact_angle == pytest.approx(-right.patches[0].contact_angle)


def test_velocities_of_the_right_hand_pair() -> None:
    """Mirroring the state must give what a right wheel does, worked out directly in the track frame."""
    state = replace(STATE, yaw=0.05, yaw_rate=0.02)
    pose, motion = MOUNTING.left_pair(state.mirrored())
    rail = np.array([0.0, -MOUNTING.rail_y, 0.0])
    centre = np.array([0.0, state.y, RADIUS + state.z])
    cy, sy, cr, sr = np.cos(state.yaw), np.sin(state.yaw), np.cos(state.roll), np.sin(state.roll)
    axle = np.array([-sy * cr, cy * cr, sr])  # unit vector to the left along the axle
    np.testing.assert_allclose(MIRROR * pose.origin, centre - MOUNTING.wheel_y * axle - rail, atol=1e-15)
    rng = np.random.default_rng(0)
    place = rail + rng.normal(size=(5, 3)) * 0.1  # in the track frame
    spin = state.roll_rate * np.array([cy, sy, 0.0]) + [0.0, 0.0, state.yaw_rate] + state.pitch_rate * axle
    wheel = np.array([0.0, state.y_rate, state.z_rate]) + np.cross(spin, place - centre)
    ground = -(np.array([state.speed, 0.0, 0.0]) + np.cross(state.frame_rate, place))
    seen = (place - rail) * MIRROR
    np.testing.assert_allclose(motion.wheel.at(seen) * MIRROR, wheel, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(motion.rail.at(seen) * MIRROR, ground, rtol=1e-12, atol=1e-12)


def box(cells: int, cell: Cell, width: float = 1.0, depth: float = 1.0) -> Solid:
    """Cube with the strip on its whole top, clamped at its bottom."""
    line = np.linspace(-0.5 * width, 0.5 * width, cells + 1)
    down = -np.linspace(0.0, depth, 3)
    y, z = np.meshgrid(line, down)
    points = np.column_stack([y.ravel(), z.ravel()])
    corner = (np.arange(2)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    below = corner + cells + 1
    if cell == "tetrahedron":
        faces = np.concatenate(
            [np.column_stack([corner, corner + 1, below + 1]), np.column_stack([corner, below + 1, below])]
        )
    else:
        faces = np.column_stack([corner, corner + 1, below + 1, below])
    section = SectionMesh(points, faces, np.arange(cells + 1), points[:, 1] < -depth + 1e-9)
    return extruded(section, line, cells // 2)


@dataclass(frozen=True)
class Flat:
    """Two flat tops pressed together by a depth [m]; every node of the upper one is a contact point.

    The lower grid is the same, or the same moved by a part of a cell: then its points are interpolated bilinearly.
    """

    grid: ContactGrid
    shift: tuple[float, float] = (0.0, 0.0)

    def contact_points(self, pose: Pose, steps: int) -> tuple[GridPoints | None, float]:
        depth = -float(pose.origin[2])
        node = np.flatnonzero(self.grid.weight.ravel() > 0)
        n, (nx, ns) = len(node), self.grid.shape
        i, j = np.divmod(node, ns)
        ki, kj = np.minimum(i, nx - 2), np.minimum(j, ns - 2)
        ti, tj = np.clip(i + self.shift[0], 0, nx - 1) - ki, np.clip(j + self.shift[1], 0, ns - 1) - kj
        nodes = np.stack([ki * ns + kj, ki * ns + kj + 1, (ki + 1) * ns + kj, (ki + 1) * ns + kj + 1], axis=1)
        weights = np.stack([(1 - ti) * (1 - tj), (1 - ti) * tj, ti * (1 - tj), ti * tj], axis=1)
        if self.shift == (0.0, 0.0):
            nodes, weights = node[:, None], np.ones((n, 1))
        place = self.grid.position.reshape(-1, 3)[node]
        axes = np.broadcast_to(np.diag([1.0, 1.0, -1.0]), (n, 3, 3))
        return (
            GridPoints(
                node=node,
                point=place,
                axes=axes,
                area=self.grid.weight.ravel()[node],
                penetration=np.full(n, depth),
                wheel_rotation=UPSIDE_DOWN,
                upstream=node[None],
                rail=Interpolation(nodes, weights),
                circle_curvature=np.zeros((2, n)),
                slope=np.zeros(n),
                step=np.ones(n),
                wheel_place=place[:, 1:],
                rail_place=place[:, 1:],
            ),
            depth,
        )


REST = RigidMotion(*(Twist(np.zeros(3), np.zeros(3), np.zeros(3)) for _ in range(2)))


@pytest.mark.parametrize("cell", ["tetrahedron", "hexahedron"])
@pytest.mark.parametrize("degree", [1, 2])
def test_patch_test(cell: Cell, degree: int) -> None:
    """Two cubes without lateral contraction, pressed together: the same stress everywhere, on both sides."""
    steels = Material(210e9, 0.0), Material(70e9, 0.0)
    solid = box(4, cell)
    upper, lower = (ElasticBody(solid, steel, degree=degree) for steel in steels)
    K, depth = 1e12, 1e-4
    model = FullContact(Flat(upper.grid), upper, lower, ContactLaws(K, friction=0.0))
    result = model(hertz_pose(depth), REST)
    assert result.status == "converged"
    fields = result.fields
    assert fields is not None
    expected = depth / (1 / 210e9 + 1 / 70e9 + 1 / K)  # three springs in a row, 1 m each of steel and aluminium
    np.testing.assert_allclose(fields.pressure, expected, rtol=1e-8)
    assert result.force[2] == pytest.approx(expected, rel=1e-10)  # on 1 m2
    assert isinstance(result.warm_start, FullStart)
    for body, moved in zip((upper, lower), np.split(result.warm_start.displacement, 2), strict=True):
        height = body.space.tabulate_dof_coordinates()[:, 2] + 1.0
        exact = np.zeros((len(height), 3))
        exact[:, 2] = -expected / body.steel.E * height  # each in its own axes, upright
        np.testing.assert_allclose(moved.reshape(-1, 3), exact, atol=1e-8 * depth)


@pytest.mark.parametrize("cell", ["tetrahedron", "hexahedron"])
@pytest.mark.parametrize("degree", [1, 2])
def test_constant_pressure_gives_consistent_loads(cell: Cell, degree: int) -> None:
    """B^T a p is the stress of a uniformly compressed body on its top, node by node, on both bodies."""
    body = ElasticBody(box(4, cell), Material(1.0, 0.0), degree=degree)
    points, _ = Flat(body.grid).contact_points(hertz_pose(1.0), 0)
    assert points is not None
    x = body.space.tabulate_dof_coordinates()
    u, f = body.stiffness.createVecs()
    u.array[:] = np.column_stack([np.zeros((len(x), 2)), -(x[:, 2] + 1.0)]).ravel()
    body.stiffness.mult(u, f)
    stress = f.array.reshape(-1, 3)[body.nodes.ravel()]
    for coupling, sign in zip(pair_operators(points, 0), (1.0, -1.0), strict=True):
        loads = np.zeros_like(stress)
        loads[coupling.nodes[:, None], coupling.directions] = (coupling.displacement.T @ (-sign * points.area)).reshape(
            -1, len(coupling.directions)
        )
        np.testing.assert_allclose(loads, stress, atol=1e-12)


@pytest.mark.parametrize("cell", ["tetrahedron", "hexahedron"])
@pytest.mark.parametrize("shift", [(0.5, 0.5), (0.3, 0.8)])
def test_constant_pressure_between_grids_that_do_not_match(cell: Cell, shift: tuple[float, float]) -> None:
    """Rail grid of equal spacing, shifted by part of a cell: inner nodes have loads of their own area, as for the
    strips of wheel and rail. Different spacings would fail: the law is enforced at the wheel's points only.
    """
    grid = ContactGrid.on(box(8, cell), 1)
    points, _ = Flat(grid, shift).contact_points(hertz_pose(1.0), 0)
    assert points is not None
    _, below = pair_operators(points, 0)
    loads = np.zeros(grid.weight.size)
    loads[below.nodes] = below.displacement.T @ points.area
    assert loads.sum() == pytest.approx(-grid.weight.sum(), rel=1e-12)
    inner = (slice(2, -2), slice(2, -2))
    np.testing.assert_allclose(-loads.reshape(grid.shape)[inner], grid.weight[inner], rtol=1e-12)
