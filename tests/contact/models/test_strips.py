"""Contact on strips: influence, convergence to Hertz, laws, error estimates, and agreement of bodies and starts."""

from __future__ import annotations

import pickle
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from half_space import Cells, HalfSpaces
from scipy.special import k0, k1

from wheelrail.bindings._contact import NN, TT, XX, lateral_ends, look_up, patch_area, stick_area, stick_lengths
from wheelrail.contact.analytical.hertz import Hertz, hertz, modulus
from wheelrail.contact.elasticity.half_space import strip_flexibility
from wheelrail.contact.kinematics.frames import RigidMotion, Twist
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose, hertz_under_load
from wheelrail.contact.models.builders import hertz_pair, wheel_rail_pair
from wheelrail.contact.models.discretisation import Bodies, Discretisation
from wheelrail.contact.models.lattice.influence.basis import rolling_marks, upstream
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.error_estimate import ErrorEstimate
from wheelrail.contact.results.result import ContactResult, LazyPatches
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.support.arrays import Array

STEEL = Material()
RADII = (0.46, 0.30)
LOAD = 60e3
STILL = np.zeros(3)
FINE = LatticeResolution(14, 16)
TIGHT = 1e-10  # of the last Newton step


def flowing(xi: float = 0.0, eta: float = 0.0, phi: float = 0.0) -> RigidMotion:
    half = 0.5 * np.array([xi, eta, 0.0])
    turn = np.array([0.0, 0.0, 0.5 * phi])
    back = np.array([-1.0, 0.0, 0.0])
    return RigidMotion(Twist(back + half, turn, STILL), Twist(back - half, -turn, STILL))


def exact() -> Hertz:
    return hertz(0.5 / RADII[0], 0.5 / RADII[1], modulus((STEEL.E, STEEL.nu), (STEEL.E, STEEL.nu)), force=LOAD)


@cache
def pair(
    friction: float = 0.0,
    bodies: Bodies = "half-space",
    resolution: LatticeResolution | None = None,
    estimate: bool = False,
) -> LatticeContact:
    how = Discretisation(1e-3, bodies=bodies)
    model = hertz_pair((RADII, (np.inf, np.inf)), (STEEL, STEEL), ContactLaws(friction=friction), how, load=LOAD)
    assert isinstance(model, LatticeContact)
    return replace(model, resolution=resolution or FINE, estimate=estimate, tolerance=TIGHT)


def loaded(model: LatticeContact) -> tuple[float, ContactResult]:
    found = hertz_under_load(model, flowing(), LOAD, expected=exact().approach, rtol=1e-6)
    return found.depth, found.results[0]


def test_strips_of_a_half_space_by_quadrature() -> None:
    k, nu = np.array([0.3, 2.0, 9.0]), 0.3
    rows, columns = np.array([[0.0, 1.0], [1.2, 1.5]]), np.array([[2.0, 2.5], [3.0, 5.0]])
    found = strip_flexibility(k, rows, columns, nu, 0.0)
    node, weight = np.polynomial.legendre.leggauss(40)
    for i, (a, b) in enumerate(rows):
        for j, (c, d) in enumerate(columns):
            y = 0.5 * (a + b) + 0.5 * (b - a) * node
            eta = 0.5 * (c + d) + 0.5 * (d - c) * node
            z = k[:, None, None] * np.abs(y[:, None] - eta)
            turned = nu * np.sign(y[:, None] - eta) * z * k0(z)
            parts = np.stack([k0(z) - nu * z * k1(z), (1 - nu) * k0(z) + nu * z * k1(z), (1 - nu) * k0(z), turned], -1)
            mean = np.einsum("kyec,y,e->kc", parts, weight, weight) / 4 * 2 * (1 + nu) / np.pi
            np.testing.assert_allclose(found[:, i, j, :4], mean, rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize("bodies", ["half-space", "waveguide"])
@pytest.mark.parametrize("place", [0.0, 0.37])
def test_cells_of_any_size_and_position(bodies: Bodies, place: float) -> None:
    # a cell and its neighbours, against Boussinesq's and Cerruti's closed forms at 8 x 8 points of each
    fine, width, length = 8, 1.5e-3, 0.4e-3
    edges = length * np.arange(4)
    pairs = pair(bodies=bodies).operators.tables(1e-3 * place + width * np.arange(4))
    tables = pairs.of(np.arange(2), np.arange(3) < 2, np.zeros(3), 5e-3)
    found = np.empty((2, 2, 8, 3, 3))
    for i, j in ((0, 0), (0, 1), (1, 1)):
        G, slope = np.empty((4, 4, 8)), np.empty((4, 4, 8))
        assert look_up(tables, i, j, edges, edges, G, slope)
        found[i, j] = -np.diff(np.diff(G, axis=0), axis=1).transpose(2, 0, 1) / length**2
    found[1, 0] = found[0, 1].swapaxes(-1, -2)  # reciprocity
    x, y = np.meshgrid(
        (np.arange(3 * fine) + 0.5) * length / fine, (np.arange(2 * fine) + 0.5) * width / fine, indexing="ij"
    )
    spaces = HalfSpaces(Cells(x.ravel(), y.ravel(), length / fine, width / fine), STEEL, STEEL)
    C = spaces.compliance().reshape(3, 3, 3, fine, 2, fine, 3, fine, 2, fine)
    mean = C.mean(axis=(3, 5, 7, 9)) / (length * width / fine**2)  # a, b, m, i, n, j
    for a, component in enumerate((XX, TT, NN)):
        mine = found[:, :, component].transpose(2, 0, 3, 1)
        # blocks are clamped 40 axes below: a constant is missing
        np.testing.assert_allclose(
            mine - mine[0, 0, 2, 1], mean[a, a] - mean[a, a, 0, 0, 2, 1], atol=0.012 * mean[a, a].max()
        )


def test_upstream_slip_is_exact_for_parabolas() -> None:
    x = np.array([[0.0, 0.3, 0.5, 0.6, 0.9]])
    u = 2 - 3 * x + 0.7 * x**2
    w = upstream(x)
    found = sum(weight * u[:, k : k + 3] for k, weight in enumerate(w))
    np.testing.assert_allclose(found, 3 - 1.4 * x[:, :3], atol=1e-12)


def test_stick_ends_within_a_cell() -> None:
    # means over cells of half an ellipse that ends anywhere
    edges = rolling_marks(12)
    ends = np.linspace(0.05, 0.75, 281)
    t = np.clip((edges - ends[:, None]) / (1 - ends[:, None]) * 2 - 1, -1.0, 1.0)
    integral = t * np.sqrt(1 - t**2) + np.arcsin(t)
    margins = (1 - ends)[:, None] * np.diff(integral) / np.diff(edges)
    lengths = stick_lengths(margins, np.tile(np.diff(edges), (len(ends), 1)))
    assert lengths == pytest.approx(1 - ends, abs=0.02)
    assert np.abs(np.diff(lengths)).max() < 4 * 2.5e-3  # no jump by a cell
    assert (stick_lengths(np.array([[0.0, 0.0], [1.0, 1.0]]), np.ones((2, 2))) == [0.0, 2.0]).all()


def test_stick_area_of_separate_zones() -> None:
    bounds = np.arange(12.0)
    ellipse = np.diff(bounds[:6] ** 2 / 2 * 5 - bounds[:6] ** 3 / 3)
    one = stick_area(ellipse, bounds[:6])
    assert one == pytest.approx(patch_area(ellipse, bounds[:6]))
    assert stick_area(np.concatenate([ellipse, [0.0], ellipse]), bounds) == pytest.approx(2 * one)
    assert stick_area(np.zeros(4), bounds[:5]) == 0.0


@pytest.mark.parametrize("creepage", [(1e-3, 0.0, 0.0), (3e-4, 5e-4, 0.0), (0.0, 2e-4, 0.6)])
def test_stick_area_hardly_depends_on_cells(creepage: tuple[float, float, float]) -> None:
    depth = loaded(pair())[0]
    fractions = [
        patch.stick_area / patch.area
        for fineness in (LatticeResolution(), LatticeResolution(28, 24))
        for patch in pair(0.3, resolution=fineness)(hertz_pose(depth), flowing(*creepage), None).patches
    ]
    assert 0.1 < fractions[1] < 0.9
    assert fractions[0] == pytest.approx(fractions[1], abs=0.01)


@pytest.mark.parametrize("ratio", [0.4, 1.0, 3.0])
def test_area_of_an_ellipse_by_strips(ratio: float) -> None:
    """Squares of lengths that are means of the ellipse's, wherever it ends in an outer strip."""
    for end in np.linspace(-0.4, 0.45, 6):
        bounds = np.arange(9.0) - end  # the ellipse begins at 0
        wide = bounds[-1] + 0.3 - end / 4  # and ends in the last strip or the next
        inner = bounds**2 / 2 * wide - bounds**3 / 3
        square = 4 * ratio**2 * np.diff(inner)
        assert patch_area(square, bounds) == pytest.approx(ratio * np.pi * wide**2 / 4, rel=2e-3)
    assert patch_area(np.array([4.0, 9.0]), np.array([0.0, 1.0, 2.0])) == 5.0


@pytest.mark.parametrize("shift", np.linspace(0.0, 0.9, 7))
def test_the_contact_ends_within_its_outer_strips(shift: float) -> None:
    """Wherever strips of 0.4 lie on an ellipse of semi-axis 1; outer ones are loaded on a part of their width."""
    bounds = 0.4 * (np.arange(-4.0, 4.0) + shift)
    bounds = bounds[(bounds > -1.3) & (bounds < 1.3)]
    square = np.array(
        [4.0 * (1.0 - (a * a + a * b + b * b) / 3.0) for a, b in pairwise(bounds)]
    )  # means of 4 (1 - y^2)
    loaded = [k for k, (a, b) in enumerate(pairwise(bounds)) if b > -1.0 and a < 1.0 and square[k] > 0.0]
    own = slice(loaded[0], loaded[-1] + 1)
    assert lateral_ends(square[own], bounds[loaded[0] : loaded[-1] + 2]) == pytest.approx((-1.0, 1.0), abs=1e-12)


def test_bands_end_with_the_contact() -> None:
    """Lateral ends over the load against Hertz; by whole strips they were off by up to half a strip, 7 %."""
    depth = loaded(pair())[0]
    for part in np.linspace(0.5, 1.5, 6):
        (patch,) = pair()(hertz_pose(part * depth), flowing(), None).patches
        modulus_of_both = modulus((STEEL.E, STEEL.nu), (STEEL.E, STEEL.nu))
        b = hertz(0.5 / RADII[0], 0.5 / RADII[1], modulus_of_both, force=patch.normal_force).semi_axes[1]
        assert np.array(patch.wheel_band) / b == pytest.approx([-1.0, 1.0], abs=0.02)
        assert np.array(patch.rail_band) / b == pytest.approx([-1.0, 1.0], abs=0.02)


def errors(resolution: LatticeResolution) -> Array:
    _, result = loaded(pair(resolution=resolution))
    (patch,) = result.patches
    ellipse = np.pi * np.prod(exact().semi_axes)
    return np.array(
        [
            *(np.array(patch.semi_axes) / exact().semi_axes - 1),
            patch.area / ellipse - 1,
            patch.max_pressure / exact().peak - 1,
        ]
    )


def test_patches_say_when_their_strips_are_too_few() -> None:
    model = pair(resolution=LatticeResolution())
    for share, rough in ((1.0, False), (0.3, False), (0.05, True), (0.005, True)):
        depth = share * exact().approach
        result = model.solve(model.problem(hertz_pose(depth), flowing()))  # on ordinary strips
        (patch,) = result.patches
        assert patch.strips == result.statistics.points / model.resolution.cells
        assert patch.rough == rough
        if not rough:
            assert result.force[2] == pytest.approx(LOAD * share**1.5, rel=0.02)


def test_hertz_converges_smoothly() -> None:
    counts = np.array([6, 8, 11, 16, 22])
    e = np.array([errors(LatticeResolution(int(n), int(n))) for n in counts])
    assert np.abs(e[3]).max() < 6e-3
    assert np.abs(e[1:, 2]).max() < 4e-3  # the area depends on where the patch ends within a strip
    total = np.sqrt((e[:, [0, 1, 3]] ** 2).mean(axis=1))
    slope, rest = np.polyfit(np.log(counts), np.log(total), 1)
    assert slope < -1.5
    # no staircase: the error decreases smoothly
    assert np.abs(np.log(total) - slope * np.log(counts) - rest).max() < 0.35


def test_approach_on_half_spaces() -> None:
    depth, _ = loaded(pair())
    assert depth == pytest.approx(exact().approach, rel=1.5e-3)


def test_elements_and_half_spaces_agree() -> None:
    creep = (4e-4, 2e-4, 0.1)
    found = []
    for bodies in ("half-space", "waveguide"):
        depth, _ = loaded(pair(bodies=bodies))
        found.append(pair(0.3, bodies)(hertz_pose(depth), flowing(*creep), None))
    one, other = found
    # an endless block is a little stiffer along x than a half-space
    assert np.abs(one.force - other.force).max() < 5e-3 * 0.3 * LOAD
    assert one.patches[0].max_pressure == pytest.approx(other.patches[0].max_pressure, rel=1e-3)
    assert one.patches[0].area == pytest.approx(other.patches[0].area, rel=3e-3)


def test_result_fulfils_the_laws_and_balances() -> None:
    depth, _ = loaded(pair())
    result = pair(0.3)(hertz_pose(depth), flowing(5e-4, -3e-4, 0.2), None)
    fields = result.fields
    assert fields is not None
    q, p = np.hypot(*fields.traction.T), fields.pressure
    assert (p >= 0).all()
    assert (q <= 0.3 * p * (1 + 1e-9)).all()
    assert (fields.traction * fields.slip).sum() < 0
    assert result.statistics.residual < 1e-8
    assert result.statistics.points <= FINE.strips * FINE.cells
    local = np.column_stack([fields.traction, -p]) * fields.area[:, None]
    np.testing.assert_allclose((local[:, None] @ fields.axes)[:, 0].sum(axis=0), result.force, rtol=1e-12)


def test_results_are_independent_of_the_guess() -> None:
    model, pose = pair(0.3), hertz_pose(exact().approach)
    first = model(pose, flowing(1e-3), None)
    again = model(pose, flowing(1e-3), model(hertz_pose(0.7 * exact().approach), flowing(), None))
    np.testing.assert_allclose(first.force, again.force, atol=1e-6 * LOAD)


def test_error_estimate_covers_the_error() -> None:
    depth, _ = loaded(pair())
    pose, motion = hertz_pose(depth), flowing(3e-4, 1e-4, 0.1)
    plain = pair(0.3)(pose, motion, None)
    assert plain.error_estimate is None
    told = pair(0.3, estimate=True)(pose, motion, None)
    np.testing.assert_array_equal(told.force, plain.force)
    fine = pair(0.3, resolution=LatticeResolution(28, 24))(pose, motion, None)
    estimate = told.error_estimate
    assert isinstance(estimate, ErrorEstimate)
    wrong = np.linalg.norm(plain.force - fine.force)
    assert 0.5 * wrong < estimate.force < 10 * wrong
    assert abs(plain.patches[0].area - fine.patches[0].area) < 2 * estimate.area
    assert abs(plain.patches[0].max_pressure - fine.patches[0].max_pressure) < 2 * estimate.max_pressure


def test_incompatible_options_are_rejected() -> None:
    with pytest.raises(ValueError, match="exact normal law"):
        replace(pair(), laws=ContactLaws.penalty())
    with pytest.raises(ValueError, match="lattice"):
        hertz_pair(
            (RADII, RADII),
            (STEEL, STEEL),
            ContactLaws(),
            Discretisation(1e-3, bodies="solid", points="lattice"),
            load=1e3,
        )
    for few in ((3, 8), (8, 5)):
        with pytest.raises(ValueError, match="at least 4 and 6"):
            LatticeResolution(*few)


@cache
def wheelset(friction: float) -> WheelsetContact:
    rail = named_profile("UIC60-benchmark")
    profiles, how = (named_profile("S1002"), rail), Discretisation(1e-3, bodies="half-space")
    model = wheel_rail_pair(profiles, 0.46, (STEEL, STEEL), ContactLaws(friction=friction), how)
    return WheelsetContact(model, Mounting(0.75, rail.gauge_offset(1.435, 0.014), 0.46))


def test_forces_are_continuous_as_a_second_patch_appears() -> None:
    # the left wheel lowered by the same amount while the wheelset moves to the flange: first one patch, then two
    contact = wheelset(0.0)
    y = np.arange(4.7e-3, 5.02e-3, 0.04e-3)
    results = [contact(WheelsetState(y=float(at), z=1.3e-4), "left") for at in y]
    assert all(result.ok for result in results)
    assert {len(result.patches) for result in results} >= {1, 2}
    forces = np.array([result.force for result in results])
    bends = np.abs(np.diff(forces, 2, axis=0)).max(axis=0)
    # of some 110 kN, which grow by 5 % from one position to the next
    assert (bends < 0.01 * 110e3).all()


def test_yaw_moves_the_patch_but_not_its_load() -> None:
    contact = wheelset(0.0)
    straight, turned = (contact(WheelsetState(y=-2e-3, z=-2.7e-4, yaw=yaw), "left") for yaw in (0.0, 5e-3))
    assert turned.patches[0].x - straight.patches[0].x == pytest.approx(-0.75 * 5e-3, abs=1e-4)
    assert turned.force[2] == pytest.approx(straight.force[2], rel=0.01)
    assert abs(turned.force[0]) < 1e-4 * turned.force[2]


def test_left_and_right_are_mirror_images() -> None:
    contact = wheelset(0.3)
    left = contact(WheelsetState(y=1e-3, z=-2e-4, yaw=2e-3, speed=10.0, pitch_rate=10 / 0.459), "left")
    right = contact(WheelsetState(y=-1e-3, z=-2e-4, yaw=-2e-3, speed=10.0, pitch_rate=10 / 0.459), "right")
    np.testing.assert_array_equal(left.force, [1, -1, 1] * right.force)


CROSSING = [  # of a wheelset that moves across the rail
    WheelsetState(y=-2e-3 + 5e-6 * k, z=-2.7e-4 - 4e-7 * k, speed=10.0, pitch_rate=10 / 0.46) for k in range(12)
]


def test_warm_start_tracks_the_contact() -> None:
    # 12 poses, each with the previous result as guess
    contact = wheelset(0.3)
    guess: ContactResult | None = None
    fewer = 0
    for state in CROSSING:
        cold, found = contact(state, "left"), contact(state, "left", guess)
        assert found.ok
        np.testing.assert_allclose(found.force, cold.force, atol=1e-6 * cold.force[2])
        np.testing.assert_allclose(found.moment, cold.moment, atol=1e-6 * np.linalg.norm(cold.moment))
        # where a strip comes or goes, a warm solve may need a Jacobian, too
        assert found.statistics.newton <= cold.statistics.newton
        fewer += cold.statistics.newton - found.statistics.newton
        guess = found
    assert fewer >= len(CROSSING)


def test_warm_and_cold_solves_have_the_same_area() -> None:
    """Strips at the end of a patch have a thousandth of its load: their length needs a small tolerance."""
    contact = wheelset(0.3)
    model = contact.model
    assert isinstance(model, LatticeContact)
    contact = replace(contact, model=replace(model, tolerance=1e-9))
    guess: ContactResult | None = None
    for state in CROSSING:
        cold, found = contact(state, "left"), contact(state, "left", guess)
        assert found.patches[0].area == pytest.approx(cold.patches[0].area, rel=1e-6)
        guess = found


def test_distant_warm_start_converges() -> None:
    contact = wheelset(0.3)
    rolls = {"speed": 10.0, "pitch_rate": 10 / 0.46}
    there = contact(WheelsetState(y=4e-3, z=-1e-4, **rolls), "left")
    here = WheelsetState(y=-2e-3, z=-2.7e-4, **rolls)
    assert there.ok
    cold = contact(here, "left").force
    np.testing.assert_allclose(contact(here, "left", there).force, cold, atol=1e-6 * cold[2])
    assert contact(WheelsetState(z=5e-3, **rolls), "left", there).status == "separated"


def test_equal_steels_share_one_compliance() -> None:
    bodies = pair().operators
    assert bodies.lower is bodies.upper
    steels, how = (STEEL, Material(2.1e11, 0.3 + 1e-12)), Discretisation(1e-3, bodies="half-space")
    other = hertz_pair((RADII, (np.inf, np.inf)), steels, ContactLaws(friction=0.3), how, load=LOAD)
    assert isinstance(other, LatticeContact)
    other = replace(other, resolution=FINE, tolerance=TIGHT)
    assert other.operators.lower is not other.operators.upper
    pose = hertz_pose(exact().approach)
    one, two = (model(pose, flowing(5e-4, 2e-4, 0.3), None) for model in (pair(0.3), other))
    np.testing.assert_allclose(one.force, two.force, rtol=1e-6, atol=1e-3)


def test_patches_are_computed_on_request() -> None:
    result = pair()(hertz_pose(exact().approach), flowing(), None)
    assert isinstance(result.patches, LazyPatches)
    (patch,) = result.patches
    (sent,) = pickle.loads(pickle.dumps(result.patches))
    assert (sent.area, sent.max_pressure) == (patch.area, patch.max_pressure)
    assert patch.normal_force == pytest.approx(result.force[2], rel=1e-12)
    (seen,) = result.mirrored().patches
    assert seen.wheel_y == patch.wheel_y
    np.testing.assert_array_equal(seen.force, [1, -1, 1] * patch.force)
