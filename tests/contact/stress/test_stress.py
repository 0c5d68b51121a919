"""Stress inside bodies under given tractions: Hertz on the axis, point loads, wheels, von Mises stress."""

from __future__ import annotations

import numpy as np
import pytest

from wheelrail.contact.analytical.hertz import axis_stress, hertz, modulus, worst
from wheelrail.contact.elasticity.waveguide.bodies import block_body
from wheelrail.contact.elasticity.waveguide.section import WaveguideSection
from wheelrail.contact.kinematics.frames import Pose, RigidMotion, Twist
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.builders import hertz_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.results.result import ContactResult, Fields
from wheelrail.contact.stress.subsurface import LoadedBody
from wheelrail.contact.stress.surface_loads import CellLoads
from wheelrail.contact.stress.waveguide import Gradients, stress
from wheelrail.forms.stress import von_mises
from wheelrail.meshes.bodies.extrusion import block_section
from wheelrail.meshes.bodies.outlines import rail_outline, wheel_outline
from wheelrail.meshes.bodies.triangulation import Grading, triangulate
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.support.arrays import Array

STEEL = Material(1.0, 0.3)
HALF = 12


@pytest.fixture(scope="module")
def body() -> WaveguideSection:
    return block_body(HALF, STEEL, size=1.0, half_width=512.0)


def cells(pressure: Array, force: tuple[float, float, float], *, middle: float = 0.0) -> CellLoads:
    """Loads on the cells of a square patch, proportional to the pressure (n, n), about the middle of the surface."""
    n = len(pressure) // 2
    i, j = np.nonzero(pressure)
    loads = pressure[i, j][:, None] * np.array(force)
    return CellLoads(middle + (i - n).astype(float), j - n + HALF, loads, 1.0)


def hertz_cells(a: float) -> Array:
    """Mean over unit cells of sqrt(1 - r^2 / a^2)."""
    g, sub = np.arange(-11, 12), (np.arange(12) + 0.5) / 12 - 0.5
    place = (g[:, None] + sub).ravel()
    fine = np.sqrt(np.maximum(1 - (place[:, None] ** 2 + place**2) / a**2, 0))
    return fine.reshape(23, 12, 23, 12).mean(axis=(1, 3))


def on_axis(s: Array, nu: float = 0.3) -> tuple[Array, Array]:
    """Radial and vertical stress over p0 at depth s a on the axis (Johnson, Contact Mechanics, 1985, eq. 3.45)."""
    return -(1 + nu) * (1 - s * np.arctan(1 / s)) + 0.5 / (1 + s * s), -1 / (1 + s * s)


def test_hertz_on_the_axis(body: WaveguideSection) -> None:
    """20 cells across: von Mises maximum 0.62 p0 and its depth 0.48 a within 2 %, all components within 0.5 % of p0."""
    a, s = 10.0, np.linspace(0.1, 1.2, 45)
    σ, _ = stress(body, cells(hertz_cells(a), (0.0, 0.0, -1.0)), np.outer(s * a, [0.0, 0.0, -1.0]))
    radial, vertical = on_axis(s)
    exact = np.einsum("am,ab->mab", [radial, radial, vertical], np.eye(3))
    assert np.abs(σ - exact).max() < 5e-3
    fine = np.linspace(0.2, 0.9, 7001)
    mises = np.abs(np.subtract(*on_axis(fine)))
    assert mises.max() == pytest.approx(0.62, abs=1e-3)
    near = np.abs(s - 0.48) < 0.15
    q = np.polyfit(s[near], von_mises(σ)[near], 3)
    top = fine[np.polyval(q, fine)[np.abs(fine - 0.48) < 0.1].argmax() + int((np.abs(fine - 0.48) < 0.1).argmax())]
    assert top == pytest.approx(fine[mises.argmax()], rel=0.02)
    assert np.polyval(q, top) == pytest.approx(mises.max(), rel=5e-3)


@pytest.mark.parametrize("middle", [0.0, 7.0])
def test_loads_in_all_directions(middle: float) -> None:
    """Tractions on horizontal planes of a half-space are radial for any force (Johnson, eqs. 3.19 and 3.76)."""
    body = block_body(HALF, STEEL, size=1.0, half_width=512.0, grading=Grading(0.5, 0.25))
    force = (0.4, -0.3, -1.0)
    loads = cells(np.outer(*2 * [np.cos(np.pi * np.arange(-4, 5) / 10) ** 2]), force, middle=middle)
    places = np.array([[0, 0, -2], [3, -2, -3], [-5, 4, -4], [1, 6, -6], [-2.3, -1.7, -1.5]], dtype=float)
    places[:, 0] += middle
    sub = (np.arange(6) + 0.5) / 6 - 0.5
    dx, dy = (v.ravel() for v in np.meshgrid(sub, sub))
    points = np.stack([loads.x[:, None] + dx, loads.line[:, None] - HALF + dy, np.zeros((len(loads.x), 36))], axis=-1)
    r = places[:, None, None] - points
    distance = np.linalg.norm(r, axis=-1)
    share = -3 * np.einsum("mnsa,na->mns", r, loads.force / 36) * r[..., 2] / (2 * np.pi * distance**5)
    exact = np.einsum("mns,mnsa->ma", share, r)
    found, _ = stress(body, loads, places)
    np.testing.assert_allclose(found, found.swapaxes(1, 2), atol=1e-14)
    assert np.abs(found[:, 2] - exact).max() < 3e-3 * np.abs(exact).max()


def test_looser_tolerance_takes_fewer_wavenumbers(body: WaveguideSection) -> None:
    loads, places = cells(hertz_cells(6.0), (0.3, 0.1, -1.0)), np.array([[0.0, 0.0, -2.0], [4.0, 1.0, -3.0]])

    (loose, few), (tight, many) = (stress(body, loads, places, tolerance=t) for t in (0.05, 1e-5))
    assert few < many
    assert np.abs(loose - tight).max() < 0.05
    # every component is a linear function of the load
    double = CellLoads(loads.x, loads.line, 2 * loads.force, loads.step)
    np.testing.assert_allclose(stress(body, double, places, tolerance=0.05)[0], 2 * loose, rtol=1e-9, atol=1e-12)


def revolved(radius: float) -> WaveguideSection:
    surface, rest, clamped = block_section(HALF, 1.0, 128.0, 128.0)
    lift = np.array([0.0, radius])
    mesh = triangulate(surface + lift, rest + lift, clamped, size=1.0, grading=Grading(1.0, 0.4, 32.0))
    return WaveguideSection(mesh, STEEL, degree=2, radius=radius)


def test_stress_in_a_wheel() -> None:
    """The stress in a drum rotates with its load; a drum of large radius approximates a block."""
    loads = cells(hertz_cells(6.0), (0.2, 0.3, 1.0))  # the wheel's contact points down, loads push up
    places = np.array([[0.0, 0.0, 3.0], [2.0, -1.0, 2.5], [-4.0, 2.0, 5.0]])
    flat = block_body(HALF, STEEL, size=1.0, half_width=128.0)
    mirror = np.diag([1.0, 1.0, -1.0])
    down = CellLoads(loads.x, loads.line, loads.force @ mirror, 1.0)
    block = mirror @ stress(flat, down, places @ mirror)[0] @ mirror
    difference = []
    for radius in (1e3, 8e3):
        drum = revolved(radius)
        at = places + np.array([0.0, 0.0, -radius])
        σ, _ = stress(drum, loads, at)
        difference.append(np.abs(σ - block).max() / np.abs(block).max())
    assert difference[0] < 0.05
    assert difference[1] < 0.01
    shift = 300.0
    c, s = np.cos(shift / radius), np.sin(shift / radius)
    T = np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])
    moved = CellLoads(loads.x + shift, loads.line, loads.force @ T.T, 1.0)
    np.testing.assert_allclose(stress(drum, moved, at @ T.T)[0], T @ σ @ T.T, atol=1e-6 * np.abs(σ).max())


def test_gradients_of_cubics_are_exact(body: WaveguideSection) -> None:
    y, z = body.points.T
    U = np.column_stack([y * z, y**3 - z**2, z**3 + y]).ravel()
    at = np.array([[0.0, -0.4], [3.3, -2.0], [-40.0, -60.0]])
    G, k = Gradients(body, at)(U.astype(complex), 0.7), 0.7
    (a, b), one = at.T, np.ones(3)
    exact = [
        [k * a * b, -1j * b, -1j * a],
        [1j * k * (a**3 - b**2), 3 * a**2, -2 * b],
        [1j * k * (b**3 + a), one, 3 * b**2],
    ]
    np.testing.assert_allclose(np.moveaxis(G, 0, -1), exact, rtol=1e-8, atol=1e-8)


def pressed(points: str) -> tuple[ContactResult, tuple[float, float]]:
    """A ball of 0.3 m on a flat at Hertz's approach for 10 kN, without friction; radius m and peak Pa of its patch."""
    steel, ball = Material(), (0.3, 0.3)
    exact = hertz(0.5 / 0.3, 0.5 / 0.3, modulus((steel.E, steel.nu), (steel.E, steel.nu)), force=10e3)
    strips, cells = (10, 12) if points == "lattice" else (None, None)
    how = Discretisation(0.5e-3, bodies="waveguide", points=points, strips=strips, cells=cells)  # type: ignore[arg-type]
    pair = hertz_pair((ball, (np.inf, np.inf)), (steel, steel), ContactLaws(friction=0.0), how, load=10e3)
    still = Twist(np.zeros(3), np.zeros(3), np.zeros(3))
    result = pair(hertz_pose(exact.approach), RigidMotion(still, still), None)
    # the blocks are not half-spaces: the force is a little less than Hertz's at his approach
    own = hertz(0.5 / 0.3, 0.5 / 0.3, modulus((steel.E, steel.nu), (steel.E, steel.nu)), force=float(result.force[2]))
    return result, (own.semi_axes[0], own.peak)


@pytest.mark.parametrize("points", ["lattice", "grid"])
def test_below_a_hertz_contact(points: str) -> None:
    """Largest von Mises stress and its depth within 2 % of the closed form, from the solved pressures, both bodies."""
    result, (radius, peak) = pressed(points)
    depths = np.linspace(0.3, 1.0, 15) * radius
    depth, mises = worst(radius=radius, peak=peak, nu=0.3)
    both = {upper: LoadedBody.block(upper, Material()).below(result, depths) for upper in (True, False)}
    for upper, found in both.items():
        (below,) = found.patches
        np.testing.assert_allclose(below.position[:, 2], depths if upper else -depths, rtol=1e-9)
        smooth = np.polynomial.Polynomial.fit(depths, below.von_mises, 5)  # the maximum is flat
        fine = np.linspace(depths[0], depths[-1], 1000)
        assert fine[smooth(fine).argmax()] == pytest.approx(depth, rel=0.02)
        assert below.von_mises.max() == pytest.approx(mises, rel=0.01)
        radial, axial = axis_stress(depths, radius=radius, peak=peak, nu=0.3)
        exact = np.einsum("am,ab->mab", [radial, radial, axial], np.eye(3))
        assert np.abs(below.stress - exact).max() < 0.01 * peak
        assert found.wavenumbers < 80
    np.testing.assert_allclose(both[True].patches[0].von_mises, both[False].patches[0].von_mises, rtol=1e-6)


def strips(centre: float, lean: float) -> Fields:
    """Synthetic patch of 3 strips of 4 cells on a wheel's tread, with traction, in the frame of the rail."""
    x, y = (v.ravel() for v in np.meshgrid(np.array([-3, -1, 1.5, 4.5]) * 1e-3, centre + np.arange(-1, 2) * 2e-3))
    step = np.tile(np.array([2, 2, 3, 3]) * 1e-3, 3)
    normal = np.array([0.0, np.sin(lean), -np.cos(lean)])
    axes = np.tile(np.stack([[1.0, 0.0, 0.0], np.cross([1.0, 0.0, 0.0], normal), normal]), (12, 1, 1))
    p = 1e8 * (1.5 - (x / 5e-3) ** 2)
    point = np.column_stack([x, y, np.zeros(12)])
    traction = np.outer(p, [-0.1, 0.05])
    none = np.zeros(12)
    return Fields(
        np.arange(12), np.zeros(12, dtype=int), point, axes, step * 2e-3, step, none, p, traction, traction, none
    )


def test_loads_are_action_and_reaction() -> None:
    """Resultants on wheel and rail are equal and opposite; those of a yawed wheel agree in its axes."""
    from wheelrail.contact.elasticity.waveguide.bodies import profile_body

    fields = strips(0.0, 0.02)
    local = np.column_stack([fields.traction, -fields.pressure]) * fields.area[:, None]
    force = np.einsum("na,nac->nc", local, fields.axes).sum(axis=0)
    steel, size, ends = Material(), 1.5e-3, (-12e-3, 12e-3)
    rail, wheel = rail_outline(named_profile("UIC60-benchmark")), wheel_outline(named_profile("S1002"), 0.46)
    made = LoadedBody.rail(rail, steel)
    below = made.loads(profile_body(rail, steel, size=size, ends=ends), fields)
    np.testing.assert_allclose(below.force.sum(axis=0), -force, rtol=1e-12)
    size_of = below.force[:, 2] / below.force[:, 2].sum()
    assert size_of @ below.x == pytest.approx(local[:, 2] @ fields.point[:, 0] / local[:, 2].sum(), abs=2e-5)
    yaw = 0.02
    turn = np.array([[np.cos(yaw), -np.sin(yaw), 0.0], [np.sin(yaw), np.cos(yaw), 0.0], [0.0, 0.0, 1.0]])
    section = profile_body(wheel, steel, size=size, ends=ends)
    on_wheel = LoadedBody.wheel(wheel, steel, Pose(np.array([0.0, 0.0, 0.46]), turn)).loads(section, fields)
    np.testing.assert_allclose(turn @ on_wheel.force.sum(axis=0), force, rtol=1e-12)
    y = section.section.points[section.section.surface][:, 0]
    share = on_wheel.force[:, 2] / on_wheel.force[:, 2].sum()
    middle = local[:, 2] @ fields.point / local[:, 2].sum() @ turn
    assert share @ y[on_wheel.line] == pytest.approx(middle[1], abs=2e-5)
    assert share @ on_wheel.x == pytest.approx(middle[0], abs=2e-5)


def test_cells_are_spread_over_the_lines_they_cover(body: WaveguideSection) -> None:
    """Force and position are conserved for any cell boundaries; a cell as wide as several lines loads them
    uniformly.
    """
    force = np.array([[0.3, -0.2, -1.0]])
    for y, width in ((0.0, 1.0), (0.37, 0.6), (-2.71, 5.3), (4.4, 0.01)):
        point = np.array([[2.5, y, 0.0]])
        loads = CellLoads.over(body, point, force, step=np.ones(1), width=np.array([width]))
        np.testing.assert_allclose(loads.force.sum(axis=0), force[0], rtol=1e-12)
        assert loads.force[:, 2] @ (loads.line - HALF) == pytest.approx(-y, abs=1e-12)
    wide = CellLoads.over(body, np.zeros((1, 3)), force, step=np.ones(1), width=np.array([8.0]))
    inner = np.abs(wide.line - HALF) < 3.5
    np.testing.assert_allclose(wide.force[inner], force / 8 * np.ones((7, 1)))
    with pytest.raises(ValueError, match="beyond the lines"):
        CellLoads.over(body, np.array([[0.0, HALF + 0.0, 0.0]]), force, step=np.ones(1), width=np.array([2.0]))


def test_without_contact_there_is_no_stress() -> None:
    with pytest.raises(ValueError, match="nothing touches"):
        LoadedBody.block(True, Material()).below(ContactResult.separated(), np.ones(1))


def test_scalars() -> None:
    turn, _ = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))
    σ = turn @ np.diag([3.0, -1.0, 1.0]) @ turn.T
    assert von_mises(σ) == pytest.approx(np.sqrt(0.5 * (16 + 4 + 4)))
    assert von_mises(np.array([[0, 2.0, 0], [2.0, 0, 0], [0, 0, 0]])) == pytest.approx(2 * np.sqrt(3))
    assert von_mises(np.eye(3)) == pytest.approx(0.0)


def test_invalid_input_is_rejected(body: WaveguideSection) -> None:
    loads = cells(np.ones((1, 1)), (0.0, 0.0, 1.0))
    with pytest.raises(ValueError, match="outside"):
        stress(body, loads, np.array([[0.0, 0.0, 1.0]]))
    with pytest.raises(ValueError, match="must be"):
        CellLoads(np.zeros(2), np.zeros(2, dtype=int), np.zeros((3, 3)), 1.0)
    with pytest.raises(ValueError, match="finite"):
        CellLoads(np.zeros(1), np.zeros(1, dtype=int), np.full((1, 3), np.nan), 1.0)
