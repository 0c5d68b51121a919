"""Contact on a lattice of strips: exact derivatives, Hertz, the same answer from any start, and tangents."""

from __future__ import annotations

import os
import signal
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from half_space import Cells, HalfSpaces

from wheelrail.bindings._contact import (
    MODES,
    MOMENTS,
    SLOPES,
    Evaluation,
    LatticeSolution,
    LatticeStart,
    Linearisation,
    evaluate,
    factorised,
    linearised,
    newton_step,
    renewed,
    rigid_slip,
    solve_transposed,
)
from wheelrail.contact.analytical.hertz import Hertz, hertz, modulus
from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.kinematics.frames import RigidMotion, Twist
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.laws.friction import FallingFriction, FrictionLaw
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.builders import hertz_pair, wheel_rail_pair
from wheelrail.contact.models.discretisation import Bodies, Discretisation
from wheelrail.contact.models.lattice import model as lattice_model
from wheelrail.contact.models.lattice.influence.basis import strip_basis
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.contact.models.lattice.states import LatticeState, states_of
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.solvers.options import IterationCount
from wheelrail.contact.solvers.tractions import solve_tractions
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.support.arrays import Array
from wheelrail.support.interrupts import check_interrupt, deferred_interrupts
from wheelrail.support.memory import TooLarge

STEEL = Material()
UNLIKE = Material(210e9, 0.0), Material(210e9, 0.3)
RADII, LOAD = (0.46, 0.30), 60e3
RADIUS, SPEED = 0.46, 20.0
TIGHT = 1e-8  # of the last Newton step
# windows of lateral positions m and heights m per m: tread, merging, birth of a second patch, flange
SWEEPS = {
    "tread": (-5.455e-3, -0.35296e-3, 0.012),
    "merging": (-0.480e-3, -0.2846e-3, 0.02),
    "birth": (4.790e-3, 0.1296e-3, 0.14),
    "flange": (6.430e-3, 0.602e-3, 0.4),
}


def flowing(xi: float = 0.0, eta: float = 0.0, phi: float = 0.0) -> RigidMotion:
    half, turn = 0.5 * np.array([xi, eta, 0.0]), np.array([0.0, 0.0, 0.5 * phi])
    back, origin = np.array([-1.0, 0.0, 0.0]), np.zeros(3)
    return RigidMotion(Twist(back + half, turn, origin), Twist(back - half, -turn, origin))


def exact() -> Hertz:
    return hertz(0.5 / RADII[0], 0.5 / RADII[1], modulus((STEEL.E, STEEL.nu), (STEEL.E, STEEL.nu)), force=LOAD)


def ellipse(friction: float = 0.0, **choices: Any) -> LatticeContact:
    how = Discretisation(1e-3, bodies="half-space", points="lattice", **choices)
    model = hertz_pair((RADII, (np.inf, np.inf)), (STEEL, STEEL), ContactLaws(friction=friction), how, load=LOAD)
    assert isinstance(model, LatticeContact)
    return model


@cache
def wheelset(friction: float | FrictionLaw, bodies: Bodies = "half-space") -> WheelsetContact:
    wheel, rail = named_profile("S1002"), named_profile("UIC60-benchmark")
    how = Discretisation(1e-3, bodies=bodies, points="lattice")
    laws = ContactLaws(friction=friction)
    model = replace(wheel_rail_pair((wheel, rail), RADIUS, (STEEL, STEEL), laws, how), tolerance=TIGHT)
    return WheelsetContact(model, Mounting(0.75, rail.gauge_offset(1.435, 0.014), RADIUS))


def rolling(y: float, z: float, yaw: float = 0.0, creepage: float = 0.0) -> WheelsetState:
    return WheelsetState(y=y, z=z, yaw=yaw, speed=SPEED, pitch_rate=SPEED / RADIUS * (1 + creepage))


def start(result: ContactResult) -> LatticeState:
    (state,) = states_of(result.warm_start).values()
    return state


def test_modes_vanish_at_the_ends_and_carry_their_load() -> None:
    basis = strip_basis(10, "rolling")
    length = 2 * np.diff(basis.marks)
    for values in (basis.mean, basis.loads):
        np.testing.assert_allclose(length @ values, np.pi / 2 * np.eye(MODES)[0], atol=1e-12)
    np.testing.assert_allclose(basis.moments.sum(axis=1), np.eye(MOMENTS)[0], atol=1e-12)
    middle = 0.5 * (basis.row_marks[1:] + basis.row_marks[:-1])
    antiderivative = np.concatenate([[0.0], np.cumsum(middle**2 * np.diff(basis.row_marks))])
    slip = [weight @ antiderivative[k : k + 4] for k, weight in enumerate(basis.slip_edges)]
    np.testing.assert_allclose(slip, -2 * middle[:-2], atol=1e-12)


@pytest.mark.parametrize("y", SWEEPS)
@pytest.mark.parametrize("friction", [0.0, 0.6])
def test_jacobian_of_all_unknowns(y: str, friction: float) -> None:
    """Ends, modes and tractions together, away from the solution, against differences of the residual."""
    place, height, _ = SWEEPS[y]
    contact = wheelset(friction)
    assert isinstance(contact.model, LatticeContact)
    state = rolling(place, height, 5e-3)
    problem = contact.model.problem(*contact.mounting.left_pair(state))
    found = start(contact(state, "left"))
    random = np.random.default_rng(1)
    scale = np.ones(found.values.shape) * 1e6
    scale[:, -2:] = 1e-6
    at = LatticeState(found.strips, found.values + scale * random.standard_normal(scale.shape))
    linearisation = linearised(at.values, problem.of(at.strips))
    jacobian = linearisation.jacobian
    direction = (scale * random.standard_normal(scale.shape)).ravel()
    step = 1e-3
    ahead, behind = (
        evaluate(at.values + sign * step * direction.reshape(scale.shape), problem.of(at.strips)).residual.ravel()
        for sign in (1, -1)
    )
    expected = (ahead - behind) / (2 * step)
    for rows in (np.arange(len(expected)) % scale.shape[1] < scale.shape[1] - 5, slice(None)):
        if np.any(expected[rows]):
            error = np.abs((jacobian @ direction)[rows] - expected[rows]).max()
            assert error < 2e-5 * np.abs(expected[rows]).max()


def test_hertz() -> None:
    """Peak and semi-axes within 1 %, and an error of the force of high order in the width of the strips."""
    errors = []
    for strips in (8, 16, 32):
        result = ellipse(strips=strips, cells=20)(hertz_pose(exact().approach), flowing(), None)
        patch = result.patches[0]
        assert patch.max_pressure == pytest.approx(exact().peak, rel=5e-3)
        np.testing.assert_allclose(patch.semi_axes, exact().semi_axes, rtol=0.01)
        errors.append(abs(result.force[2] / LOAD - 1))
    assert errors[0] < 3e-3
    assert errors[1] < 6e-4
    assert errors[2] < 1e-4


def test_rolling_ellipse() -> None:
    """Forces within half a per cent of a lattice twice as fine."""
    for motion in (flowing(4e-4, 2e-4, 0.1), flowing(3e-3), flowing(0.0, 0.0, 1.0)):
        coarse, fine = (
            ellipse(0.3, strips=strips, cells=cells)(hertz_pose(exact().approach), motion, None)
            for strips, cells in ((16, 10), (32, 20))
        )
        np.testing.assert_allclose(coarse.force, fine.force, atol=5e-3 * 0.3 * LOAD)


def unlike(
    friction: float, radii: tuple[float, float], cells: int = 10, bodies: Bodies = "half-space", *, swapped: bool
) -> tuple[LatticeContact, Hertz]:
    """Contact of bodies of different Poisson's ratio, and Hertz's solution."""
    materials = UNLIKE[::-1] if swapped else UNLIKE
    (E1, E2), (nu1, nu2) = ([m.E for m in materials], [m.nu for m in materials])
    expected = hertz(0.5 / radii[0], 0.5 / radii[1], modulus((E1, nu1), (E2, nu2)), force=LOAD)
    how = Discretisation(1e-3, bodies=bodies, points="lattice", strips=16, cells=cells)
    model = hertz_pair((radii, (np.inf, np.inf)), materials, ContactLaws(friction=friction), how, load=LOAD)
    assert isinstance(model, LatticeContact)
    return model, expected


def contraction_slip(x: Array, y: Array, strain: float, radius: float) -> Array:
    """Slip (S, 2, M) by Hertz's pressure on a circle whose surface contracts by the strain where it is largest.

    u_r = -strain a^2 / (3 r) (1 - (1 - r^2 / a^2)^1.5) (Johnson 1985, eq. 3.42b), the slip is -du/dx.
    """
    q = np.minimum((x**2 + y**2) / radius**2, 1.0)
    root = np.sqrt(1 - q)
    ratio, slope = (1 - root**3) / (3 * q), 0.5 * root / q - (1 - root**3) / (3 * q**2)
    return strain * np.stack([ratio + 2 * slope * (x / radius) ** 2, 2 * slope * x * y / radius**2], axis=1)


@pytest.mark.parametrize("swapped", [False, True])
def test_slip_by_pressure_on_unlike_spheres(swapped: bool) -> None:
    """Pressure contracts both surfaces by different amounts: the mean slip errs by second order in the cell length."""
    errors = []
    for M in (20, 40):
        model, expected = unlike(1e-7, (0.4, 0.4), M, swapped=swapped)
        pose = hertz_pose(expected.approach)
        problem, state = model.problem(pose, flowing()), start(model(pose, flowing(), None))
        data = problem.of(state.strips)
        evaluation, places = evaluate(state.values, data), data.places
        slip = evaluation.slip - rigid_slip(state.values, problem.of(state.strips))[0]
        length = np.diff(state.ends) * np.diff(problem.basis.marks)
        weight = evaluation.pressure * length * places.width[:, None]
        weight /= weight.sum()
        first, second = ((1 - 2 * m.nu) * (1 + m.nu) / m.E for m in (UNLIKE[::-1] if swapped else UNLIKE))
        strain = (first - second) * expected.peak
        x = state.ends[:, :1] + np.diff(state.ends) * 0.5 * (problem.basis.marks[1:] + problem.basis.marks[:-1])
        y = np.broadcast_to(places.middle[:, None], x.shape)
        exact = contraction_slip(x, y, strain, expected.semi_axes[0])
        rms = np.sqrt((weight[:, None] * (slip - exact) ** 2).sum(axis=(0, 2)))
        assert rms.max() < 0.02 * abs(strain)
        errors.append((weight * slip[:, 0]).sum() / (3 / 8 * strain) - 1)
    assert abs(errors[0]) < 0.015
    assert abs(errors[1]) < 0.3 * abs(errors[0])


@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize("creepage", [(0.0, 0.0, 0.0), (2e-4, 2e-4, 0.1)])
def test_rolling_of_unlike_half_spaces(creepage: tuple[float, float, float], swapped: bool) -> None:
    """Pressure causes slip and tractions pressure: against Boussinesq's and Cerruti's integrals on a grid."""
    model, expected = unlike(0.3, RADII, swapped=swapped)
    model = replace(model, resolution=LatticeResolution(24, 16))
    materials = UNLIKE[::-1] if swapped else UNLIKE
    a, b = expected.semi_axes
    cells = Cells.inside_ellipse(1.06 * a, 1.06 * b, 28, 28)
    depth = expected.approach - 0.5 / RADII[0] * cells.x**2 - 0.5 / RADII[1] * cells.y**2
    xi, eta, phi = creepage
    rigid = np.concatenate([xi - phi * cells.y, eta + phi * cells.x])
    operator = HalfSpaces(cells, *materials).operator(2)
    tractions = solve_tractions(
        operator, depth, rigid, laws=ContactLaws(friction=0.3), speed=1.0, count=IterationCount()
    )
    result = model(hertz_pose(expected.approach), flowing(*creepage), None)
    normal = tractions.pressure.sum() * cells.area
    assert abs(result.force[0]) > 0.1 * 0.3 * LOAD
    assert result.force[2] == pytest.approx(normal, rel=5e-4)
    assert abs(normal / LOAD - 1) > 2e-3
    np.testing.assert_allclose(result.force[:2], tractions.tangential.sum(axis=0) * cells.area, atol=0.01 * 0.3 * LOAD)


@pytest.mark.parametrize("swapped", [False, True])
def test_unlike_blocks_are_unlike_half_spaces(swapped: bool) -> None:
    """Blocks by finite elements, the half-spaces' part in closed form: the rest is small."""
    half_space, expected = unlike(0.3, RADII, swapped=swapped)
    blocks, _ = unlike(0.3, RADII, bodies="waveguide", swapped=swapped)
    pose = hertz_pose(expected.approach)
    exact, computed = (model(pose, flowing(), None).force for model in (half_space, blocks))
    assert exact[0] * (-1 if swapped else 1) < -0.2 * 0.3 * LOAD
    assert computed[0] / computed[2] == pytest.approx(exact[0] / exact[2], rel=3e-3)
    assert abs(computed[1]) < 1e-4 * computed[2]


@pytest.mark.parametrize(("friction", "yaw"), [(0.0, 0.0), (0.3, 15e-3), (0.6, 5e-3)])
@pytest.mark.parametrize("sweep", SWEEPS)
def test_force_is_a_function_of_the_pose(sweep: str, friction: float, yaw: float) -> None:
    """From the neighbour in a sweep of 5 um as from none, a pose 0.3 mm away and without friction: 1e-6 of the load."""
    y, z, slope = SWEEPS[sweep]
    contact = wheelset(friction)
    earlier = contact(rolling(y, z, yaw), "left")
    far = contact(rolling(y - 3e-4, z - 3e-4 * slope, yaw), "left")
    smooth = contact.changed(lambda own: own.frictionless)(rolling(y + 15e-6, z + 15e-6 * slope, yaw), "left")  # type: ignore[attr-defined]
    for k, guess in enumerate((None, far, smooth), start=1):
        state = rolling(y + 5e-6 * k, z + 5e-6 * k * slope, yaw)
        earlier, other = contact(state, "left", earlier), contact(state, "left", guess)
        assert earlier.status == "converged"
        np.testing.assert_allclose(other.force, earlier.force, atol=1e-6 * np.linalg.norm(earlier.force))
        np.testing.assert_array_equal(start(other).strips, start(earlier).strips)


@pytest.mark.parametrize(
    ("friction", "y", "z", "yaw"),
    [
        (0.8, 8.0e-3, 3.398e-3, 15e-3),  # a long strip enters beside loaded ones
        (0.8, 0.0, -0.482e-3, 0.0),  # coupled friction of the cold start's cells does not converge
    ],
)
def test_loads_up_to_a_meganewton(friction: float, y: float, z: float, yaw: float) -> None:
    """Approaches of 0.3 and 0.5 mm, with the same force from a pose 0.3 mm away."""
    contact = wheelset(friction)
    state = rolling(y, z, yaw)
    result, near = contact(state, "left"), contact(rolling(y - 3e-4, z, yaw), "left")
    assert result.status == near.status == "converged"
    assert np.linalg.norm(result.force) > 6e5
    np.testing.assert_allclose(contact(state, "left", near).force, result.force, rtol=0, atol=1e-6 * 6e5)


def test_strips_come_and_go_without_a_jump() -> None:
    """Second differences of the force over the birth of strips, over steps of 5 um."""
    y, z, slope = SWEEPS["birth"]
    contact = wheelset(0.0)
    forces, counts, result = [], [], None
    for k in range(16):
        result = contact(rolling(y + 5e-6 * k, z + 5e-6 * k * slope), "left", result)
        forces.append(result.force[2])
        counts.append(len(start(result).strips))
    assert len(set(counts)) > 1
    assert np.abs(np.diff(forces, 2)).max() < 2e-4 * forces[-1]


@pytest.mark.parametrize(
    ("friction", "bodies", "place"),
    [
        (0.0, "half-space", (-5e-3, -0.34e-3, 5e-3)),
        (0.3, "half-space", (-5e-3, -0.34e-3, 5e-3)),
        (0.3, "half-space", (4.93e-3, 0.132e-3, 2e-3)),
        (0.6, "half-space", (6.5e-3, 0.62e-3, 15e-3)),
        (0.3, "waveguide", (4.93e-3, 0.132e-3, 2e-3)),
        (0.3, "waveguide", (6.5e-3, 0.62e-3, 15e-3)),
        (0.3, "waveguide", (8.0e-3, 0.4e-3, 15e-3)),  # on the flange, 15 mm ahead of the axle
    ],
)
def test_tangent(friction: float, bodies: Bodies, place: tuple[float, float, float]) -> None:
    """Central differences over 0.2 um to 1e-4 of the largest entry of a row, moving ends included."""
    contact = wheelset(friction, bodies)
    state = replace(rolling(*place), y_rate=0.01, frame_rate=(0.0, 0.0, SPEED / 600))
    result = contact(state, "left", contact(replace(state, z=state.z + 1e-4), "left"))  # cold, the last one takes 6 s
    found = contact.tangent(state, "left", result)
    expected = np.zeros((6, len(state.coordinates)))
    for k, key in enumerate(state.coordinates):
        step = 2e-7 if k < 4 else 2e-5
        ahead, behind = (
            contact(replace(state, **{key: getattr(state, key) + sign * step}), "left", result) for sign in (1, -1)
        )
        expected[:, k] = np.concatenate([ahead.force - behind.force, ahead.moment - behind.moment]) / (2 * step)
    rows = slice(1, None) if friction == 0 else slice(None)  # no longitudinal force without friction
    error = np.abs(found - expected)[rows] / np.abs(expected[rows]).max(axis=1, keepdims=True)
    assert error.max() < 1e-4
    if friction:
        rates = np.abs(found - expected)[:, 4:] / np.abs(expected[:, 4:]).max(axis=1, keepdims=True)
        assert rates.max() < 1e-3


def test_memory_and_time_are_told_before_or_refused(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    contact = replace(ellipse(0.3), resolution=LatticeResolution(16, 64))
    caplog.set_level("INFO")
    contact._check_size(4)
    assert not caplog.messages
    contact._check_size(64)
    (message,) = caplog.messages
    assert message.startswith("64 strips, 64 cells along each: 8576 unknowns: 1.2 GB, about ")
    monkeypatch.setattr("os.sysconf", lambda name: 1)  # a machine of one byte
    with pytest.raises(TooLarge, match="strips, 64 cells along each"):
        contact(hertz_pose(exact().approach), flowing(1e-3), None)


def test_ctrl_c_ends_newtons_method_at_its_next_step(monkeypatch: pytest.MonkeyPatch) -> None:
    steps = []

    def interrupted() -> None:
        steps.append(1)
        os.kill(os.getpid(), signal.SIGINT)
        check_interrupt()

    contact = replace(ellipse(0.3), resolution=LatticeResolution(16, 20))
    monkeypatch.setattr(lattice_model, "check_interrupt", interrupted)
    with pytest.raises(KeyboardInterrupt), deferred_interrupts():
        contact(hertz_pose(exact().approach), flowing(1e-3), None)
    assert len(steps) == 1


def test_finite_bodies_from_any_start() -> None:
    contact = wheelset(0.3, "waveguide")
    y, z, slope = SWEEPS["birth"]
    earlier = contact(rolling(y, z, 5e-3), "left")
    state = rolling(y + 5e-6, z + 5e-6 * slope, 5e-3)
    from_earlier, from_none = contact(state, "left", earlier), contact(state, "left")
    np.testing.assert_allclose(from_earlier.force, from_none.force, atol=1e-6 * np.linalg.norm(from_none.force))


def test_frictional_power_is_what_the_bodies_lose() -> None:
    """Of rigid motion in the steady state, as elastic energy does not change; slips are measured along both surfaces,
    so that tractions of cells inclined along x do not act on a part of the rolling velocity. Unlike the heat, what
    forces lose has the error of the pressure's place, 60 kN times some um over R, which falls with second order.
    """
    apart = []
    for cells in (20, 40):
        pair = replace(wheelset(0.3), model=finer(wheelset(0.3).model, cells))
        place, motion = pair.mounting.left_pair(rolling(2e-3, -0.2e-3))
        result = pair.model(place, motion, None)
        relative = motion.wheel.at(np.zeros((1, 3)))[0] - motion.rail.at(np.zeros((1, 3)))[0]
        lost = -(result.force @ relative + result.moment @ (motion.wheel.rotation - motion.rail.rotation))
        fields = result.fields
        assert fields is not None
        inclined = SPEED * (fields.area * fields.traction[:, 0] * (1.0 - fields.axes[:, 0, 0])).sum()
        apart.append(sum(patch.frictional_power for patch in result.patches) / (lost - inclined) - 1.0)
    assert 0.0 < apart[1] < 0.01
    assert apart[1] < 0.35 * apart[0]


def test_tangents_do_not_jump_where_cells_begin_to_slide() -> None:
    """Over creepages at which some 15 cells begin to slide: halved steps halve the largest change of the slope."""
    contact, place = replace(ellipse(0.3), tolerance=1e-10), hertz_pose(exact().approach)
    changes = []
    for count in (41, 81):
        slopes = [contact(place, flowing(xi)).tangent()[0, 6] for xi in np.linspace(3e-4, 1.5e-3, count)]
        changes.append(np.abs(np.diff(slopes)).max())
    assert changes[1] < 0.65 * changes[0]


def finer(model: Any, cells: int) -> LatticeContact:
    assert isinstance(model, LatticeContact)
    return replace(model, resolution=LatticeResolution(14, cells))


@pytest.mark.parametrize("damaged", ["pivots", "lu", "rows", "slips", "slopes", "gather", "double"])
def test_damaged_factors_are_refused(damaged: str) -> None:
    """As from a file that somebody has changed: the core reads within arrays of lengths that it has checked."""
    factors = warm_start().factors
    changes = {
        "pivots": factors.pivots + np.int32(10**6),
        "lu": factors.lu[:5, :5].copy(),
        "rows": factors.rows[:1],
        "slips": factors.slips[:, 1:].copy(),
        "slopes": factors.slopes[:1],
        "gather": np.zeros((2, 5), dtype=np.float32),
        "double": factors.lu.astype(float),
    }
    name = "lu" if damaged == "double" else damaged
    with pytest.raises(TypeError if damaged == "double" else ValueError, match="Factors"):
        factors._replace(**{name: changes[damaged]})


def test_a_warm_start_of_another_resolution_is_not_used() -> None:
    contact, earlier = ellipse(0.3), warm_start()
    place, motion = hertz_pose(exact().approach), flowing(1e-3)
    cold = contact(place, motion, None)
    parts = (earlier.strips, earlier.values[:, 1:].copy()), (earlier.strips[1:], earlier.values[1:])
    for part in (*parts, (earlier.strips + 10**6, earlier.values)):
        guess = LatticeStart([0], [LatticeSolution(*part, earlier.factors)], None)
        result = contact(place, motion, ContactResult.guess(guess))
        assert result.ok
        np.testing.assert_allclose(result.force, cold.force, atol=1e-6 * LOAD)


def warm_start() -> LatticeSolution:
    earlier = ellipse(0.3)(hertz_pose(exact().approach), flowing(1e-3), None).warm_start
    assert isinstance(earlier, LatticeStart)
    (solution,) = earlier.solutions
    assert solution is not None
    return solution


@pytest.mark.parametrize("smallest", [1e-3, 1e-9])
def test_solutions_are_refined_to_double_precision(smallest: float) -> None:
    """Factors are in single precision, and solve nothing where the condition exceeds it."""
    strips, block, cells = 3, 25, 10
    n, random = strips * block, np.random.default_rng(1)
    left, right = (np.linalg.qr(random.standard_normal((n, n)))[0] for _ in range(2))
    scaled = left @ np.diag(np.geomspace(1.0, smallest, n)) @ right
    slips, slopes = np.zeros((strips, 2 * cells, n), dtype=np.float32), np.zeros((strips, cells, SLOPES))
    nothing = *(np.zeros((0, 2, 0)),) * 2, np.zeros((0, 0))
    evaluation = Evaluation(False, np.zeros((0, 0)), np.zeros((0, 0, 3)), np.zeros((0, 0)), *nothing)
    at = Linearisation(evaluation, np.eye(n), slips, slopes)
    empty = factorised(at)[1]
    jacobian = scaled / (empty.rows[:, None] * empty.columns)
    factors = factorised(at._replace(jacobian=jacobian))[1]
    expected = empty.rows[:, None] * random.standard_normal((n, 4))
    found = solve_transposed(factors, jacobian, (jacobian.T @ expected).T.copy()).T
    size = np.abs(expected / empty.rows[:, None]).max()
    assert np.abs((found - expected) / empty.rows[:, None]).max() < max(1e-14 / smallest, 1e-6) * size


def with_friction(at: Linearisation, slopes: Array) -> Array:
    """Jacobian (n, n) with other slopes (S, M, SLOPES) of the friction residual."""
    change, slips, jacobian = slopes - at.slopes, at.slips, at.jacobian.copy()
    strips, cells = change.shape[:2]
    for i, r in np.argwhere(np.abs(change).max(axis=2) > 0):
        first, own = i * len(jacobian) // strips, change[i, r]
        rows, modes = first + r + np.array([0, cells]), first + 2 * cells + np.arange(MODES)
        jacobian[rows] += own[4:8].reshape(2, 2) @ slips[i, [r, cells + r]]
        jacobian[np.ix_(rows, rows)] += own[:4].reshape(2, 2)
        jacobian[np.ix_(rows, modes)] += own[10:].reshape(MODES, 2).T
    return np.asarray(jacobian)


@pytest.mark.parametrize("friction", [0.3, FallingFriction(0.3, 0.4, 0.3)])
def test_renewed_factors_are_those_of_cells_that_slip_or_stick(friction: float | FrictionLaw) -> None:
    """Against the Jacobian with the friction of these cells, twice in succession."""
    contact = wheelset(friction)
    assert isinstance(contact.model, LatticeContact)
    place = rolling(-5e-3, -0.34e-3, creepage=5e-4)
    at, problem = start(contact(place, "left")), contact.model.problem(*contact.mounting.left_pair(place))
    linearisation = linearised(at.values, problem.of(at.strips))
    factors = factorised(linearisation)[1]
    assert not renewed(factors, linearisation.slopes, problem.rho)[0]
    by_pressure = np.abs(linearisation.slopes[..., 10:12]).max(axis=-1)
    sticks, slides = by_pressure < 1e-6, by_pressure > 0.5 * by_pressure.max()
    assert sticks.any()
    assert slides.any()
    few = np.zeros_like(sticks)
    few[sticks] = np.arange(sticks.sum()) < 3
    few[slides] = np.arange(slides.sum()) < 2
    others = np.argwhere(sticks)[-1], np.argwhere(slides)[-1]
    for cells in (few, few & sticks):
        slopes = linearisation.slopes.copy()
        slopes[cells & sticks], slopes[cells & slides] = (slopes[*other] for other in reversed(others))
        changed, present = renewed(factors, slopes, problem.rho)
        assert changed
        assert len(present.gather) == 2 * cells.sum()
        jacobian = with_friction(linearisation, slopes)
        residual = np.random.default_rng(2).standard_normal(at.values.shape)
        residual /= factors.rows.reshape(residual.shape)
        scaled = factors.rows[:, None] * jacobian * factors.columns  # without, 1 % of the steps may be lost
        expected = np.linalg.solve(scaled, -factors.rows * residual.ravel())
        found, old = (newton_step(used, residual).ravel() / factors.columns for used in (present, factors))
        assert np.abs(found - expected).max() < 1e-4 * np.abs(expected).max() < np.abs(old - expected).max()
        factors = present
    few[:] = True
    slopes[few & sticks], slopes[few & slides] = (slopes[*other] for other in reversed(others))
    assert not renewed(factors, slopes, problem.rho)[0]


def test_cells_that_begin_to_slip_need_no_jacobian() -> None:
    contact = wheelset(0.3)
    states = [rolling(-5e-3, -0.34e-3, creepage=creepage) for creepage in (3e-4, 4e-4)]
    first = contact(states[0], "left")
    warm, cold = contact(states[1], "left", first), contact(states[1], "left")
    np.testing.assert_array_equal(start(warm).strips, start(cold).strips)
    assert warm.statistics.newton == 0
    np.testing.assert_allclose(warm.force, cold.force, atol=1e-6 * LOAD)
    again = contact(states[1], "left", warm)  # from renewed factors
    assert again.statistics.newton == 0
    assert again.statistics.linear <= 2
    np.testing.assert_allclose(again.force, cold.force, atol=1e-6 * LOAD)


def test_falling_friction_reduces_the_force() -> None:
    falling = wheelset(FallingFriction(0.3, 0.4, 0.3))
    state = rolling(-5e-3, -0.34e-3, creepage=0.02)
    less, more = (contact(state, "left") for contact in (falling, wheelset(0.3)))
    limit = 0.3 * ((1 - 0.4) * np.exp(-0.3 * 0.02 * SPEED) + 0.4)
    assert np.hypot(*less.force[:2]) < np.hypot(*more.force[:2])
    assert np.hypot(*less.force[:2]) / less.force[2] == pytest.approx(limit, rel=0.02)


def test_right_wheel_is_the_mirror_image() -> None:
    contact = wheelset(0.3)
    state = rolling(4.8e-3, 0.131e-3, 2e-3)
    left, right = contact(state, "left"), contact(state.mirrored(), "right")
    np.testing.assert_allclose(right.force, left.force * [1, -1, 1], rtol=1e-12)


def test_no_contact_and_laws_that_do_not_fit() -> None:
    assert wheelset(0.3)(rolling(0.0, 1e-3), "left").status == "separated"
    with pytest.raises(ValueError, match="exact normal law"):
        replace(ellipse(), laws=ContactLaws.penalty())
    with pytest.raises(ValueError, match="at least 4"):
        ellipse(strips=3)


def test_unloaded_strips_may_lie_beyond_the_meshed_rail() -> None:
    """On the gauge face the undeformed wheel overlaps more of the rail than it touches."""
    contact = wheelset(0.3, "waveguide")
    assert isinstance(contact.model, LatticeContact)
    lines = contact.model.operators.lower.bounds
    y = 8.4e-3 + 0.1e-3 * np.arange(10)
    beyond, forces = [], []
    for place in y:
        state = rolling(float(place), 1e-3)
        problem = contact.model.problem(*contact.mounting.left_pair(state))
        beyond.append(problem.lines.foot[problem.candidates].min() < lines[0])
        result = contact(state, "left")
        assert result.ok
        forces.append(result.force)
    assert beyond[-1]
    assert not beyond[0]
    # no step where the first strip passes the end of the lines
    jumps = np.abs(np.diff(forces, n=3, axis=0)).max(axis=0)
    assert (jumps < 2e-3 * np.abs(forces[-1])).all()
    with pytest.raises(OutsideSurface, match="beyond the part"):
        problem.check_loaded(problem.candidates)
