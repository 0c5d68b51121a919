"""Hub compliance of a wheelset: against a 3D finite-element code, beams in closed form, and statics."""

from __future__ import annotations

import numpy as np
import pytest

from wheelrail.contact.elasticity.waveguide.section import WaveguideSection
from wheelrail.contact.laws.material import Material
from wheelrail.contact.structure.half_wheelset import PLACES, Half, HalfWheelset, factored, rigid_modes
from wheelrail.contact.structure.hubs import GRAVITY, HubCompliance, hub_compliance
from wheelrail.meshes.bodies.axle import AXIS, AxleShape
from wheelrail.meshes.bodies.outlines import wheel_outline
from wheelrail.meshes.bodies.triangulation import Grading, triangulate
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.support.arrays import Array

STEEL, WHEEL_Y, LOAD = Material(), 0.75, 57e3
HALVES: tuple[Half, Half] = ("symmetric", "antisymmetric")
OUTLINE = wheel_outline(named_profile("S1002"), 0.46)
# Mean rigid motion (z mm, roll mrad) of the seat of a 160 mm axle by 57 kN upwards at the rolling circle and by 10 kN
# outwards at the tread: CalculiX, a quarter of the wheelset in 20 398 quadratic wedges (178 000 unknowns).
WEDGES = {
    ("symmetric", "up"): (0.3944, -1.4421),
    ("symmetric", "outwards"): (-0.1166, 0.4650),
    ("antisymmetric", "up"): (0.0767, -0.2053),
    ("antisymmetric", "outwards"): (-0.0166, 0.0758),
}
LOADS = {"up": [LOAD, 0.0], "outwards": [0.0, 10e3 * 0.46]}  # z N and roll N m about the hub's centre


@pytest.fixture(scope="module")
def hubs() -> HubCompliance:
    return hub_compliance(OUTLINE, AxleShape(), STEEL, wheel_y=WHEEL_Y)


def wrench(z: float = 0.0, roll: float = 0.0) -> Array:
    return np.array([0.0, 0.0, z, roll, 0.0, 0.0])


@pytest.mark.parametrize(("half", "load"), WEDGES)
def test_agrees_with_3d_finite_elements(hubs: HubCompliance, half: str, load: str) -> None:
    z, roll = hubs.bending[int(half == "antisymmetric")] @ LOADS[load]
    tolerance = 0.01 if half == "symmetric" and load == "up" else 0.03
    assert (1e3 * z, 1e3 * roll) == pytest.approx(WEDGES[half, load], rel=tolerance)


def test_mean_motion_of_the_seat_is_that_of_3d_finite_elements() -> None:
    # The hub between seat and tread deforms: the fit to the tread differs from the seat by up to 2.5 %, this does not.
    half = HalfWheelset(OUTLINE, AxleShape(), STEEL, WHEEL_Y)
    tread = half.loads(half.whole)
    line = 3 * PLACES.index(0.0)
    for name, solve in ((name, half.solver(1, name)) for name in HALVES):
        for load, force in (("up", -LOAD * tread[:, line + 2]), ("outwards", 10e3 * tread[:, line + 1])):
            motion = -half.seat_motion(1, solve(force[:, None] / np.pi))[:, 0]
            assert 1e3 * motion == pytest.approx(WEDGES[name, load], rel=0.01)


def test_seat_moves_as_the_rigid_hub_of_the_fit(hubs: HubCompliance) -> None:
    # The seat's mean by loads on the tread is symmetric as far as the hub between them is rigid: 1.4e-4 and, in the
    # antisymmetric half, whose loads bend it more, 1.4e-3, both the same within 1e-5 on meshes of 20 to 5 mm.
    half = HalfWheelset(OUTLINE, AxleShape(), STEEL, WHEEL_Y)
    y, r = half.line_points().T
    inverse = np.linalg.pinv(rigid_modes(1, y, r).reshape(-1, 2))
    unit_loads = half.loads(half.whole) @ inverse.T
    even, odd = (half.seat_motion(1, half.solver(1, name)(unit_loads)) / np.pi for name in HALVES)
    for motion in (even, 0.5 * (even + odd), 0.5 * (even - odd)):  # of one half, own and of the other wheel
        assert motion[0, 1] == pytest.approx(motion[1, 0], rel=1e-3)
    np.testing.assert_allclose(even, hubs.bending[0], rtol=5e-3)
    assert hubs.misfit < 3e-3


@pytest.mark.parametrize("name", HALVES)
def test_seat_and_tread_are_reciprocal(name: Half) -> None:
    # Betti: the seat's mean by unit loads on the tread is the tread's fit by unit loads spread over the seat.
    half = HalfWheelset(OUTLINE, AxleShape(), STEEL, WHEEL_Y)
    solve, inverse = half.solver(1, name), np.linalg.pinv(rigid_modes(1, *half.line_points().T).reshape(-1, 2))
    on_tread = half.loads(half.whole) @ inverse.T
    nodes, weights = half.seat
    modes = rigid_modes(1, half.whole.points[nodes, 0] - WHEEL_Y, half.whole.points[nodes, 1])
    weighted = weights[:, None, None] * modes
    on_seat = np.zeros((len(half.whole.points), 3, 2))
    on_seat[nodes] = weighted @ np.linalg.inv(np.einsum("nca,ncb->ab", weighted, modes))
    by_seat = solve(on_seat.reshape(-1, 2))
    np.testing.assert_allclose(half.seat_motion(1, solve(on_tread)), (on_tread.T @ by_seat).T, rtol=1e-8)
    own = half.seat_motion(1, by_seat)
    np.testing.assert_allclose(own, own.T, rtol=1e-8)


@pytest.mark.parametrize("diameter", [0.160, 0.180])
def test_bare_axle_bends_as_a_beam(diameter: float) -> None:
    # Closed form: slope P a L / 2 E I; deflection P a^2 L / 2 E I + P a^3 / 3 E I + P a / kappa G A.
    radius, a, L = 0.5 * diameter, 0.25, 1.5
    corners = np.array([(0.0, AXIS), (0.0, radius), (0.92, radius), (1.08, radius), (1.08, AXIS)])
    mesh = triangulate(corners[:2], corners[2:], np.zeros(4, bool), size=0.08, grading=Grading(0.1, 0.0, 8e-3))
    shaft = WaveguideSection(mesh, STEEL, degree=2, radius=0.46)
    y, r = shaft.points.T
    cylinder = np.abs(r - radius) < 1e-9
    vertical = np.array([-1.0, 0.0, 1.0])

    def ring(start: float, stop: float) -> Array:
        nodes = cylinder & (y > start - 1e-9) & (y < stop + 1e-9)
        return np.where(nodes, 1.0 / nodes.sum(), 0.0)[:, None] * vertical

    middle = np.flatnonzero(np.abs(y) < 1e-9)
    load, journal = ring(0.70, 0.80).reshape(-1, 1), ring(0.92, 1.08).ravel()
    u = factored(shaft, 1, 3 * middle + 1, journal)(LOAD / (2 * np.pi) * load).reshape(-1, 3)
    seat = np.flatnonzero(cylinder & (y > 0.70) & (y < 0.80))
    modes = rigid_modes(1, y[seat] - WHEEL_Y, r[seat])
    z, roll = np.linalg.lstsq(modes.reshape(-1, 2), u[seat].ravel(), rcond=None)[0]
    inertia, area = np.pi * diameter**4 / 64, np.pi * diameter**2 / 4
    shear = 6 * (1 + STEEL.nu) / (7 + 6 * STEEL.nu) * STEEL.E / (2 * (1 + STEEL.nu)) * area  # kappa after Cowper
    assert roll == pytest.approx(-LOAD * a * L / 2 / STEEL.E / inertia, rel=0.01)
    bending = LOAD / STEEL.E / inertia * (a**2 * L / 2 + a**3 / 3)
    assert z == pytest.approx(bending + LOAD * a / shear, rel=0.01)


def test_bending_stress_is_that_of_a_beam(hubs: HubCompliance) -> None:
    # Statics: M = P a between the wheels; opposite loads: M falls linearly to zero at the middle.
    modulus = np.pi * 0.160**3 / 32
    light = hub_compliance(OUTLINE, AxleShape(), STEEL, wheel_y=WHEEL_Y, weight=False)
    left, right = light.bending_stress(wrench(LOAD), wrench(LOAD))
    np.testing.assert_allclose(left, -LOAD * 0.25 / modulus, rtol=2e-2)
    np.testing.assert_allclose(left[light.places < 0.45], -LOAD * 0.25 / modulus, rtol=1e-3)
    np.testing.assert_array_equal(left, right)
    left, right = light.bending_stress(wrench(LOAD), wrench(-LOAD))
    inner = light.places < 0.45
    np.testing.assert_allclose(left[inner], -LOAD * 0.25 * light.places[inner] / modulus, rtol=1e-2, atol=1e4)
    np.testing.assert_allclose(right, -left, rtol=1e-12)
    # Own weight: wheels by the overhang of 0.25 m, the axle by its distributed mass, less than all of it at the wheels.
    by_weight = hubs.bending_stress(wrench(), wrench())[0][0] * modulus
    wheels = 2 * 355.0
    assert 0.25 * GRAVITY * 0.5 * wheels < by_weight < 0.25 * GRAVITY * 0.5 * hubs.mass + 0.5 * 343 * GRAVITY * 0.5


def test_own_weight_bends_the_axle_as_a_stepped_beam(hubs: HubCompliance) -> None:
    y = np.linspace(0.0, 1.0, 401)
    d = np.select([y < 0.65, y < 0.83, y < 0.92], [0.160, 0.185, 0.160], 0.130)
    mass = 7850.0 * np.pi * d**2 / 4 * (y[1] - y[0])
    wheel = 355.0 * GRAVITY  # at the hub's centre; its own centre of mass lies 3 mm from there
    beyond = [(mass[i:] * (y[i:] - y[i])).sum() * GRAVITY for i in range(len(y))]
    reaction = mass.sum() * GRAVITY + wheel
    moment = reaction * (1.0 - y) - beyond - wheel * np.maximum(0.75 - y, 0.0)
    curvature = moment / (STEEL.E * np.pi * d**4 / 64)
    slope = np.cumsum(curvature) * (y[1] - y[0])
    assert hubs.sag[1] == pytest.approx(slope[300], rel=0.05)
    assert hubs.sag[0] < 0.0
    assert hubs.own_weight[3] == hubs.own_weight[9] == hubs.sag[1]


def test_opposite_torques_twist_the_axle_as_a_bar(hubs: HubCompliance) -> None:
    # Closed form: from the middle to the inner end of the hub at least, to its centre at most.
    stiffness = STEEL.E / (2 * (1 + STEEL.nu)) * np.pi * 0.160**4 / 32
    assert 0.65 / stiffness < hubs.twist < 0.75 / stiffness


def test_compliance_of_both_hubs(hubs: HubCompliance) -> None:
    C = hubs.matrix
    np.testing.assert_array_equal(C, C.T)
    steady = np.setdiff1d(np.arange(12), [4, 10])
    assert np.linalg.eigvalsh(C[np.ix_(steady, steady)]).min() > 0.0
    assert not C[[4, 10]].any()
    assert C[3, 9] / C[3, 3] == pytest.approx(0.71, abs=0.01)  # one side depends on the other's load
    both = C @ np.concatenate([wrench(LOAD), wrench(LOAD)])
    np.testing.assert_allclose(both[:6], both[6:])
    np.testing.assert_allclose(both[2:4], hubs.bending[0] @ [LOAD, 0.0])
    forwards = C @ np.tile([LOAD, 0, 0, 0, 0, 0], 2)  # turned by 90 degrees: x for z, yaw for -roll
    assert forwards[0] == pytest.approx(both[2])
    assert forwards[5] == pytest.approx(-both[3])


def test_thicker_axles_bend_less() -> None:
    # Another implementation with its own mesh: c_zz 1e-9 m/N, c_zr 1e-8 rad/N, c_rr 1e-8 rad/N m.
    thick = hub_compliance(OUTLINE, AxleShape.typical(0.180), STEEL, wheel_y=WHEEL_Y)
    assert thick.bending[0].ravel()[[0, 1, 3]] * [1e9, 1e8, 1e8] == pytest.approx([4.513, -1.594, 6.381], rel=2e-3)
    assert thick.bending[1].ravel()[[0, 1, 3]] * [1e9, 1e8, 1e8] == pytest.approx([0.948, -0.220, 1.094], rel=5e-3)


def test_hollow_axle_has_less_inertia(hubs: HubCompliance) -> None:
    hollow = hub_compliance(OUTLINE, AxleShape(bore=0.06), STEEL, wheel_y=WHEEL_Y)
    inertia = 1 - (0.06 / 0.16) ** 4
    middle = hubs.stress[0, 0, 0], hollow.stress[0, 0, 0]
    assert middle[1] / middle[0] == pytest.approx(1 / inertia, rel=1e-4)
    assert 1 / inertia < hollow.bending[0, 1, 1] / hubs.bending[0, 1, 1] < 1.5 / inertia - 0.5  # and a softer seat
    assert hubs.mass - hollow.mass == pytest.approx(7850 * np.pi * (0.03**2 - AXIS**2) * 2.16, rel=1e-9)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"steps": ((0.65, 0.16), (0.6, 0.185))}, "increase from 0"),
        ({"journal": (0.90, 1.0)}, "one step"),
        ({"bore": 0.13}, "bore"),
    ],
)
def test_refuses_drawings_that_are_no_axle(change: dict[str, object], reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        AxleShape(**change)  # type: ignore[arg-type]


def test_refuses_an_axle_without_a_seat_for_the_hub() -> None:
    with pytest.raises(ValueError, match="ends of the hub"):
        hub_compliance(OUTLINE, AxleShape.typical(wheel_y=0.70), STEEL, wheel_y=WHEEL_Y)
