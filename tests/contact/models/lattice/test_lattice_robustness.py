"""Contact on a lattice at poses, loads and radii at which Newton's method failed or strips were too wide."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Literal

import numpy as np
import pytest
from scipy.optimize import brentq

from wheelrail.bindings._contact import MODES, MOMENTS, NN, leaving, look_up, maximum, normal_table, split_shares
from wheelrail.contact.analytical.hertz import hertz, modulus
from wheelrail.contact.kinematics.frames import Pose, RigidMotion, Twist
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.laws.friction import FallingFriction, FrictionLaw
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.builders import hertz_pair, wheel_rail_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.lattice.influence.basis import Tangential, equal_cells, strip_basis
from wheelrail.contact.models.lattice.model import START_CELLS, LatticeContact
from wheelrail.contact.models.lattice.resolution import LEAST_CELLS
from wheelrail.contact.models.lattice.states import LatticeState, states_of
from wheelrail.contact.results.result import ContactResult
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.support.arrays import Array

STEEL = Material()
RADIUS, SPEED = 0.46, 20.0
FALLING = FallingFriction(0.15130081546202226, 0.6395853788932706, 0.6875131846641094)
FLAT = (np.inf, np.inf)
HARMLESS = Material(210e9, 0.28)


@cache
def pair(friction: float | FrictionLaw, bodies: Literal["half-space", "waveguide"] = "half-space") -> LatticeContact:
    profiles = named_profile("S1002"), named_profile("UIC60-benchmark")
    how = Discretisation(1e-3, bodies=bodies, points="lattice")
    model = wheel_rail_pair(profiles, RADIUS, (STEEL, STEEL), ContactLaws(friction=friction), how)
    assert isinstance(model, LatticeContact)
    return replace(model, tolerance=1e-8)


def left(state: WheelsetState, spin: float = 0.0) -> tuple[Pose, RigidMotion]:
    """Left wheel of a wheelset, with a spin 1/m beyond that of the contact angle about a vertical axis."""
    rail = named_profile("UIC60-benchmark")
    pose, motion = Mounting(0.75, rail.gauge_offset(1.435, 0.014), RADIUS).left_pair(state)
    turn, below = np.array([0.0, 0.0, spin * SPEED]), pose.origin - np.array([0.0, 0.0, RADIUS])
    wheel = motion.wheel
    velocity = wheel.velocity + np.cross(turn, wheel.reference - below)
    return pose, replace(motion, wheel=Twist(velocity, wheel.rotation + turn, wheel.reference))


def rolling(
    y: float, z: float, *, roll: float = 0.0, yaw: float = 0.0, xi: float = 0.0, eta: float = 0.0
) -> WheelsetState:
    return WheelsetState(
        y=y, z=z, roll=roll, yaw=yaw, y_rate=eta * SPEED, pitch_rate=(1 + xi) * SPEED / RADIUS, speed=SPEED
    )


@pytest.mark.parametrize(
    ("friction", "state", "spin"),
    [
        # the outermost strip of the first cells lies beside its place, and its length tends to zero
        (0.1, rolling(0.0011376531807900866, -0.00035443982109427445, xi=-0.0021606300965273896), 0.04625666225680499),
        # a strip enters beside strips that have not converged, and must not carry load in the end
        (
            FALLING,
            rolling(
                0.007290947880025564,
                0.004526713993400336,
                roll=0.003631493366328944,
                yaw=0.012618467196134138,
                eta=0.0019099176288672529,
            ),
            0.0,
        ),
    ],
)
def test_poses_with_strips_that_hinder(friction: float | FrictionLaw, state: WheelsetState, spin: float) -> None:
    """Poses that failed after 60 iterations; the same force from a pose 10 um away."""
    model = pair(friction)
    result = model(*left(state, spin))
    assert result.status == "converged"
    assert result.statistics.newton <= 30
    near = model(*left(replace(state, y=state.y + 1e-5), spin))
    assert near.status == "converged"
    again = model(*left(state, spin), near)
    np.testing.assert_allclose(again.force, result.force, rtol=0, atol=1e-6 * np.linalg.norm(result.force))


@cache
def usual(friction: float | FrictionLaw, state: WheelsetState) -> LatticeState:
    return start(pair(friction)(*left(state)))


@pytest.mark.parametrize("cells", START_CELLS)
@pytest.mark.parametrize("friction", [0.8, FallingFriction(0.5, 0.4, 0.3)])
@pytest.mark.parametrize("state", [rolling(6.5e-3, 0.62e-3, yaw=15e-3), rolling(-5e-3, -0.34e-3, xi=0.002)])
def test_every_start_leads_to_the_same_solution(
    friction: float | FrictionLaw, state: WheelsetState, cells: int
) -> None:
    problem = pair(friction).problem(*left(state))
    solution, newton = problem.newton(*problem.cold_start(equal_cells(cells, "rolling")), 25)
    assert newton <= 10
    found, expected = LatticeState.of(solution), usual(friction, state)
    np.testing.assert_array_equal(found.strips, expected.strips)
    np.testing.assert_allclose(found.ends, expected.ends, rtol=0, atol=1e-9)
    peak = expected.modes.max()
    np.testing.assert_allclose(found.tractions, expected.tractions, rtol=0, atol=1e-6 * peak)


@pytest.mark.parametrize(
    "state",
    [
        # from 8 cells the patch becomes longer than the tables; from 8, 12 and 16, strips come and go
        rolling(5.2e-3, 0.21352e-3, yaw=15e-3),
        rolling(8.0e-3, 1.25949e-3, yaw=15e-3),
    ],
)
def test_long_narrow_patches_on_finite_bodies(state: WheelsetState) -> None:
    model = pair(0.6, "waveguide")
    result = model(*left(state))
    assert result.status == "converged"
    near = model(*left(replace(state, y=state.y + 1e-6)))
    again = model(*left(state), near)
    np.testing.assert_allclose(again.force, result.force, rtol=0, atol=1e-6 * np.linalg.norm(result.force))


def test_flange_pressed_against_the_rail_of_finite_bodies() -> None:
    """3.5 mm of overlap bend the flange and the rail's head, by 240 kN only."""
    state = rolling(10.0e-3, 0.0, roll=0.45e-3)
    result = pair(0.3, "waveguide")(*left(state))
    assert result.status == "converged"
    assert result.approach > 3.3e-3
    assert np.linalg.norm(result.force) < 250e3


@pytest.mark.parametrize("y", [0.0, 6e-3])
def test_wheel_inside_the_rail(y: float) -> None:
    """50 mm too deep is no separated wheel; 50 mm too high is one."""
    assert (
        pair(0.3)(*left(rolling(y, -50e-3))).status == "failed: the wheel lies inside the rail, too deep for a contact"
    )
    assert pair(0.3)(*left(rolling(y, 50e-3))).status == "separated"


@pytest.mark.parametrize(
    ("upper", "lower", "load", "size"),
    [
        *(((0.46, 0.3), (np.inf, 0.3), load, 0.5e-3) for load in (1.0, 10.0, 100.0, 300.0)),
        ((0.46, np.inf), (np.inf, 0.3), 100.0, 1e-3),
        ((0.46, np.inf), (np.inf, 0.3), 10e3, 1e-2),
        ((0.5, 30.0), FLAT, 21e3, 1e-3),
        ((5.0, 0.05), FLAT, 21e3, 1e-3),
        ((30.0, 0.05), FLAT, 21e3, 1e-3),
    ],
)
def test_patches_that_are_small_beside_the_mesh(
    upper: tuple[float, float], lower: tuple[float, float], load: float, size: float
) -> None:
    """Hertz within 0.15 %, semi-axes of 1 : 50 included: strips do not depend on the lines of the meshes."""
    how = Discretisation(size, bodies="half-space", points="lattice")
    model = hertz_pair((upper, lower), (STEEL, STEEL), ContactLaws(friction=0.3), how, load=load)
    A, B = (0.5 * (1 / one + 1 / other) for one, other in zip(upper, lower, strict=True))
    exact = hertz(A, B, modulus((STEEL.E, STEEL.nu), (STEEL.E, STEEL.nu)), force=load)
    result = model(hertz_pose(exact.approach), _flowing((1e-3, 0.0, 0.0)))
    assert result.status == "converged"
    assert result.force[2] == pytest.approx(load, rel=1.5e-3)


def test_error_estimate_at_a_light_load() -> None:
    how = Discretisation(0.5e-3, bodies="half-space", points="lattice")
    model = hertz_pair(((0.46, 0.3), (np.inf, 0.3)), (STEEL, STEEL), ContactLaws(friction=0.3), how, load=1.0)
    E_star = modulus((STEEL.E, STEEL.nu), (STEEL.E, STEEL.nu))
    exact = hertz(0.5 / 0.46, 1 / 0.3, E_star, force=1.0)
    result = replace(model, estimate=True)(hertz_pose(exact.approach), _flowing((1e-3, 0.0, 0.0)))
    assert result.error_estimate is not None
    assert abs(result.force[2] - 1.0) < result.error_estimate.force < 0.01


@pytest.mark.parametrize("resolution", [(6, 12), (4, 10), (16, 10)])
def test_friction_on_a_harmless_ellipse(resolution: tuple[int, int]) -> None:
    """A case at which Newton's method on fitted strips ended with a residual of 0.07."""
    strips, cells = resolution
    how = Discretisation(1e-3, bodies="half-space", points="lattice", strips=strips, cells=cells)
    radii = (0.5029, 1.80738), FLAT
    model = hertz_pair(radii, (HARMLESS, HARMLESS), ContactLaws(friction=0.274), how, load=65.4e3)
    E_star = modulus((HARMLESS.E, HARMLESS.nu), (HARMLESS.E, HARMLESS.nu))
    exact = hertz(0.5 / radii[0][0], 0.5 / radii[0][1], E_star, force=65.4e3)
    creepage = (-8.366394186966909e-05, -7.140635733186122e-05, 0.13184876649252922)
    result = model(hertz_pose(exact.approach), _flowing(creepage))
    assert result.status == "converged"
    assert result.force[2] == pytest.approx(65.4e3, rel=0.02)


def _flowing(creepage: tuple[float, float, float]) -> RigidMotion:
    xi, eta, phi = creepage
    half, turn = 0.5 * np.array([xi, eta, 0.0]), np.array([0.0, 0.0, 0.5 * phi])
    back, origin = np.array([-1.0, 0.0, 0.0]), np.zeros(3)
    return RigidMotion(
        Twist(SPEED * (back + half), SPEED * turn, origin), Twist(SPEED * (back - half), -SPEED * turn, origin)
    )


@pytest.mark.parametrize(("y", "z", "yaw"), [(4.5e-3, 0.12e-3, 15e-3), (4.4e-3, 0.107e-3, 5e-3)])
def test_friction_closes_a_gap(y: float, z: float, yaw: float) -> None:
    """Friction on the tread moves the flange of finite bodies towards the rail: strips are loaded that would not
    penetrate the undeformed rail, and no unloaded one penetrates the deformed one.
    """
    model = pair(0.6, "waveguide")
    place = left(rolling(y, z, yaw=yaw))
    result, problem = model(*place), model.problem(*place)
    assert result.status == "converged"
    state = start(result)
    assert (problem.depth[state.strips] < -1e-6).any()
    free = np.setdiff1d(np.flatnonzero(problem.lines.near), state.strips)
    x, own = problem.lines.x[free], (state.strips, state.values, free.tolist())
    rest = problem.remaining_penetration(*own, (x - 8e-3).tolist(), (x + 8e-3).tolist(), equal_cells(32))
    assert rest.max() < 1e-5 * result.approach


def test_strips_on_both_sides_of_the_undeformed_rail() -> None:
    """Steps of 0.2 um through the pose at which the outer loaded strip of the flange ceases to penetrate the undeformed
    rail: the force bends by less than 1e-5 of the load.
    """
    model, state = pair(0.6, "waveguide"), rolling(4.77e-3, 0.15e-3, yaw=5e-3)
    outer = int(start(model(*left(state))).strips[0])

    def depth(z: float) -> float:
        return float(model.problem(*left(replace(state, z=z))).depth[outer])

    z = brentq(depth, state.z - 5e-5, state.z + 5e-5, xtol=1e-12)
    forces = [model(*left(replace(state, z=z + k * 2e-7))).force for k in (-1, 0, 1)]
    assert np.abs(np.diff(forces, 2, axis=0)).max() < 1e-5 * np.linalg.norm(forces[1])


def test_a_narrow_maximum_at_the_end_of_the_next_strip() -> None:
    """16 nm of penetration over 0.2 mm beside a strip of 20 mm, from none as from the pose before."""
    model = pair(0.6)
    poses = (7.750e-3, 3.90026536e-3), (7.755e-3, 3.9136994e-3)
    before, here = (model.problem(*left(rolling(y, z, yaw=15e-3))) for y, z in poses)  # on ordinary strips
    result, again = model.solve(here), model.solve(here, model.solve(before))
    np.testing.assert_array_equal(start(again).strips, start(result).strips)
    np.testing.assert_allclose(again.force, result.force, rtol=0, atol=1e-7 * np.linalg.norm(result.force))


@pytest.mark.parametrize(
    ("friction", "poses"),
    [
        (0.3, [(7.300e-3, 2.3855727e-3), (7.305e-3, 2.3990443e-3)]),
        (0.6, [(7.155e-3, 2.0503207e-3), (7.160e-3, 2.0639762e-3)]),
        (0.6, [(7.455e-3, 2.8714006e-3), (7.460e-3, 2.8849236e-3)]),
    ],
)
def test_the_outermost_strip_has_one_place(friction: float, poses: list[tuple[float, float]]) -> None:
    """Next to strips of 27 mm, 0.5 mm away: it sees no cells of their pressure."""
    model = pair(friction)
    before, here = (left(rolling(y, z, yaw=5e-3)) for y, z in poses)
    result, again = model(*here), model(*here, model(*before))
    np.testing.assert_allclose(again.force, result.force, rtol=0, atol=1e-6 * np.linalg.norm(result.force))


def test_an_outermost_strip_that_came_and_went() -> None:
    state = rolling(6.97e-3, 0.639254e-3, yaw=15e-3)
    assert pair(0.3, "waveguide")(*left(state)).status == "converged"


def test_a_short_strip_beside_long_ones() -> None:
    """A strip of 0.2 mm enters beside one of 8 mm, from none as from the pose before."""
    model, state = pair(0.6, "waveguide"), rolling(5.5546e-3, 0.324e-3, yaw=15e-3)
    result = model(*left(state))
    outer = start(result)
    assert outer.half[0] < 1.5e-4 < 4e-3 < outer.half[1]
    before = model(*left(rolling(5.5546e-3, 0.3245e-3, yaw=15e-3)))
    assert len(start(before).strips) == len(outer.strips) - 1
    again = model(*left(state), before)
    np.testing.assert_allclose(again.force, result.force, rtol=0, atol=1e-8 * np.linalg.norm(result.force))


@pytest.mark.parametrize(("friction", "y", "z"), [(0.3, 7.065e-3, 0.6495287656e-3), (0.0, 7.995e-3, 0.6863851278e-3)])
def test_short_strips_at_a_small_tolerance(friction: float, y: float, z: float) -> None:
    """Strips of 0.04 mm and more enter on a surface without steps."""
    model = replace(pair(friction, "waveguide"), tolerance=1e-9)
    assert model(*left(rolling(y, z, yaw=15e-3))).status == "converged"


@pytest.mark.parametrize(
    ("friction", "y", "z", "above"),
    [(0.0, 7.994e-3, 0.6863222875e-3, 0.0), (0.0, 7.9945e-3, 0.6863525843e-3, 0.0), (0.6, 7.7775e-3, 0.0, 0.3e-3)],
)
def test_an_outermost_strip_beside_one_thirty_times_as_long_as_wide(
    friction: float, y: float, z: float, above: float
) -> None:
    """With three pressure modes the gap left on that one gives the outermost strip two places, and none to stay at."""
    model = replace(pair(friction, "waveguide"), tolerance=1e-9)
    here, before = left(rolling(y, z, yaw=15e-3)), left(rolling(y - 1e-6, z, yaw=15e-3))
    result = model(*here, model(*left(rolling(y, z + above, yaw=15e-3))))  # without, the last one takes 12 s
    again = model(*here, model(*before, result))
    np.testing.assert_array_equal(start(again).strips, start(result).strips)
    np.testing.assert_allclose(again.force, result.force, rtol=0, atol=1e-8 * np.linalg.norm(result.force))


def test_a_strip_that_cannot_stay_with_little_load() -> None:
    """The remaining penetration beside a strip of 12 mm is flat, with waves of 0.2 nm by its cells."""
    model = replace(pair(0.3), tolerance=1e-9)
    results = [model(*left(rolling(8.09e-3, z, yaw=15e-3))) for z in np.linspace(4.7330e-3, 4.7345e-3, 13)]
    assert all(result.ok for result in results)
    force = np.array([result.force for result in results])
    assert np.abs(np.diff(force, 2, axis=0)).max() < 2e-6 * np.linalg.norm(force[0])


@pytest.mark.parametrize(
    ("friction", "y", "z"),
    [
        # the remaining penetration has two maxima along the strip that enters
        (0.3, 6.906018402572566e-3, 0.96875e-3),
        (0.6, 7.349531979029068e-3, 2.2167968750000005e-3),
        (0.3, 7.36e-3, 2e-3),
        # it is flat over 20 mm
        (0.0, 7.6692979861152245e-3, 2.9375e-3),
        (0.0, 8.031108019356397e-3, 3.9921875e-3),
    ],
)
def test_a_long_strip_enters_on_a_small_part_of_its_width(friction: float, y: float, z: float) -> None:
    """Under 120 to 180 kN of vertical force, from the length that it has under the small load on this part."""
    result = pair(friction)(*left(rolling(y, z)))
    assert result.status == "converged"
    assert 100e3 < result.force[2] < 200e3


def test_an_outermost_strip_between_the_cells_of_a_longer_one() -> None:
    """A strip of 20 mm beside one of 30, both 0.4 mm wide: its end does not pass the cells of the other in jerks."""
    y = np.arange(7.385e-3, 7.3976e-3, 2.5e-6)
    z = np.polyval([323.53926808297413, 2.7553104981217253, 2.51629433031898e-3], y - 7.38e-3)
    model = replace(pair(0.3), tolerance=1e-9)
    force = np.array([model(*left(rolling(*place))).force for place in zip(y, z, strict=True)])
    assert np.abs(np.diff(force, 2, axis=0)).max() < 8e-5 * force[0, 2]


@pytest.mark.parametrize("tangential", ["none", "rolling", "shift"])
def test_means_over_the_fewest_cells_determine_all_moments(tangential: Tangential) -> None:
    """Fewer means than moments of the gap leave the ends undetermined."""
    basis = strip_basis(LEAST_CELLS, tangential)
    assert np.linalg.matrix_rank(basis.moments) == MOMENTS == len(basis.moments)


def test_penetration_far_from_the_largest_one() -> None:
    """0.3 um over 6 mm, 16 mm from where the undeformed surfaces penetrate most: that falls unlike a parabola there."""
    model, deeper, here = pair(0.3), rolling(7.305e-3, 2.386e-3, yaw=5e-3), rolling(7.305e-3, 2.391e-3, yaw=5e-3)
    result, again = model(*left(here)), model(*left(here), model(*left(deeper)))
    np.testing.assert_array_equal(start(again).strips, start(result).strips)
    np.testing.assert_allclose(again.force, result.force, rtol=0, atol=1e-7 * np.linalg.norm(result.force))


def test_split_cells_displace_like_the_modes() -> None:
    """Beside a strip of 27 mm: means over 0.25 mm scatter the less around those of 96 cells, the more parts cells are
    split into, and jumps have no load.
    """
    basis, fine = strip_basis(12, "rolling"), strip_basis(96, "rolling")
    np.testing.assert_allclose(basis.split_edges.sum(axis=1), 0.0, atol=1e-12)
    np.testing.assert_allclose(basis.split_marks @ basis.split_edges, 0.0, atol=1e-12)
    model = pair(0.0)
    width = model.tables.width
    strips = np.flatnonzero(np.isclose(width, width.min()))[:2]
    length, rows = 27e-3, np.linspace(8e-3, 14e-3, 25)
    near = np.isin(np.arange(len(width)), strips)
    tables = model.tables.of(strips, near, model.tables.middle, length)

    def displacement(edges: Array, jumps: Array) -> Array:
        G = np.empty((len(rows), len(edges)))
        assert normal_table(tables, int(strips[0]), int(strips[1]), rows, length * edges, G, None)
        return np.asarray(np.diff(G @ jumps))

    exact = displacement(fine.marks, fine.load_edges[:, 0])
    found, errors = displacement(basis.marks, basis.load_edges[:, 0]), []
    for edges in (np.zeros_like(basis.split_edges[0]), *basis.split_edges):
        found = found + displacement(basis.split_marks, edges[:, 0])
        errors.append(float(np.abs(found - exact).max()))
    assert errors[1] < 0.2 * errors[0]
    assert errors[2] < 0.1 * errors[0]


def test_every_other_boundary_is_enough_for_fewer_parts() -> None:
    basis = strip_basis(12, "rolling")
    assert not basis.split_edges[0, 1::2].any()
    assert np.abs(basis.split_edges[0, ::2, 0]).min() > 0
    assert np.abs(basis.split_edges[1, :, 0]).min() > 0


@pytest.mark.parametrize("bodies", ["half-space", "waveguide"])
def test_normal_component_of_tables(bodies: Literal["half-space", "waveguide"]) -> None:
    """That of all components, and its slope, for strips in either order."""
    model = pair(0.0, bodies)
    carried, length = np.flatnonzero(model.tables.lattice.carried), 9e-3
    strips = carried[len(carried) // 2 - 1 :][:3]  # on the lines of both bodies
    first, last = int(strips[0]), int(strips[-1])
    near = np.isin(np.arange(len(model.tables.width)), strips)
    tables = model.tables.of(strips, near, model.tables.middle, length)
    for values in (tables.values, tables.smooth.values):
        assert values.size == 0 or values.ctypes.data % 64 == 0  # a line of the cache
    rows, columns = np.linspace(-4e-3, 4e-3, 9), np.linspace(-3e-3, 4.5e-3, 12)
    every, slopes = np.empty((9, 12, 8)), np.empty((9, 12, 8))
    assert look_up(tables, first, last, rows, columns, every, slopes)
    for order in ((first, last), (last, first)):
        G, H = np.empty((9, 12)), np.empty((9, 12))
        assert normal_table(tables, *order, rows, columns, G, H)
        np.testing.assert_allclose(G, every[..., NN], rtol=1e-13)
        np.testing.assert_allclose(H, slopes[..., NN], rtol=1e-12)


def test_shares_of_split_cells_have_exact_slopes() -> None:
    basis, h = strip_basis(12, "rolling"), 1e-7

    def of(length: float, loaded: float, distance: float) -> Array:
        count, found = split_shares(length, loaded, distance, basis)
        assert (found[0, :count] > 0).all()
        assert not found[:, count:].any()
        return found

    for length, loaded, distance in ((2e-3, 12e-3, 1e-3), (6e-3, 27e-3, 0.5e-3), (9e-3, 10e-3, 0.8e-3)):
        part, *slopes = of(length, loaded, distance)
        by_length = (of(length + h, loaded, distance) - of(length - h, loaded, distance))[0] / (2 * h)
        by_loaded = (of(length, loaded + h, distance) - of(length, loaded - h, distance))[0] / (2 * h)
        assert 0 < part[0] < 1
        np.testing.assert_allclose(slopes, [by_length, by_loaded], rtol=1e-5, atol=1e-3)
    assert (of(0.0, 27e-3, 0.5e-3)[0] == 1.0).all()  # cells of 3.1 mm
    assert 0 < of(0.0, 27e-3, 1e-3)[0, 1] < 1
    assert not of(27e-3, 27e-3, 0.5e-3).any()
    assert not of(0.0, 5e-3, 1e-3).any()


def test_largest_remaining_penetration_by_means_over_cells() -> None:
    """Exact for a parabola, wherever its maximum lies."""
    cells, low, high = 12, -3.0, 9.0
    x = np.linspace(low, high, cells + 1)
    for place in (0.0, 0.3, 4.5):
        means = np.diff(2.0 * x - (x - place) ** 3 / 6) / np.diff(x)
        np.testing.assert_allclose(maximum(means, low, high), [2.0, place, 1.0], rtol=0, atol=1e-12)


def start(result: ContactResult) -> LatticeState:
    (state,) = states_of(result.warm_start).values()
    return state


def test_strips_leave_by_the_prediction_of_a_moderate_step() -> None:
    values = np.zeros((3, MODES + 2))
    values[:, 0], values[:, -2], values[:, -1] = (1e9, 3e8, 3e8), (-5e-3, -1e-3, -1e-3), (5e-3, 1e-3, 1e-3)
    step = np.zeros_like(values)
    step[1, -2:] = 6e-4, -6e-4  # squared half length 1 - 2 * 0.6 of what it was
    step[2, -2:] = 4e-4, -4e-4  # 1 - 2 * 0.4
    whole = np.zeros(3)
    assert leaving(values, step, 0.1, whole).tolist() == [False, True, False]
    step[2, 0] = -4e8  # the load per width falls by 4/3 of what it was
    assert leaving(values, step, 0.1, whole).tolist() == [False, True, True]
    assert not leaving(values, step, 0.9, whole).any()
    whole[:] = 0.25 * 3e5  # from a quarter of that on strips touch on the whole width, above minus a quarter on a part
    assert leaving(values, step, 0.1, whole).tolist() == [False, False, True]
    whole[:] = 0.9 * 3e5
    assert leaving(values, step, 0.1, whole).tolist() == [False, False, False]
    whole[:] = 2 * 3e5  # on a part: the amplitude falls below zero, the length does not
    assert leaving(values, step, 0.1, whole).tolist() == [False, False, True]
