"""Compliance by wavenumbers: forms, elimination, interpolation, half-space, 3D meshes, Hertz."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.spatial import cKDTree

from wheelrail.contact.analytical.hertz import hertz, modulus
from wheelrail.contact.elasticity.compliance import condense
from wheelrail.contact.elasticity.waveguide.bodies import (
    GRADING,
    TOLERANCE,
    block_waveguide,
    profile_body,
    profile_waveguide,
)
from wheelrail.contact.elasticity.waveguide.compliance import WaveguideCompliance
from wheelrail.contact.elasticity.waveguide.section import WaveguideSection
from wheelrail.contact.elasticity.waveguide.spectrum import ComplianceSpectrum, pairs, sample
from wheelrail.contact.geometry.contact_operators import ContactOperators
from wheelrail.contact.geometry.quadric_pair import UPSIDE_DOWN, QuadricPair
from wheelrail.contact.kinematics.frames import Pose, RigidMotion, Twist
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.load_search import find_depth_for_load
from wheelrail.contact.models.condensed import CondensedContact
from wheelrail.meshes.bodies.extrusion import block_section, extruded, layers, revolved
from wheelrail.meshes.bodies.outlines import Outline, rail_outline, rim_outline, wheel_outline
from wheelrail.meshes.bodies.solids import Strip, profiled, section
from wheelrail.meshes.bodies.triangulation import Grading, SectionMesh, triangulate
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.support.arrays import Array

UNIT = Material(1.0, 0.3)


@pytest.fixture(scope="module", autouse=True)
def cache(tmp_path_factory: pytest.TempPathFactory) -> object:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("WHEELRAIL_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


def block_mesh(half: int, width: float, *, offset: float = 0.0, grading: Grading | None = None) -> SectionMesh:
    surface, rest, clamped = block_section(half, 1.0, width, width)
    shift = np.array([0.0, offset])
    return triangulate(
        surface + shift, rest + shift, clamped, size=1.0, grading=grading or Grading(1.0, 0.4, width / 4)
    )


def energy(body: WaveguideSection, values: Array, U: Array) -> float:
    """U^T K U from values in the common sparsity; U (n, 3)."""
    import scipy.sparse as sp

    pointer, columns, _ = body.matrices
    return float(U.ravel() @ (sp.csr_array((values, columns, pointer)) @ U.ravel()))


@pytest.mark.parametrize("degree", [1, 2])
def test_prismatic_energy_of_linear_amplitudes(degree: int) -> None:
    """(U_x, U_y, U_z) = (a y, b, c z) has the strains k a y, 0, c; gamma_xy = a - k b, gamma_xz = -k c z."""
    body = WaveguideSection(block_mesh(2, 6.0), UNIT, degree=degree)
    y, z = body.points.T
    a, b, c, k, nu = 0.7, -0.4, 0.3, 0.9, 0.3
    lam, mu = nu / (1 + nu) / (1 - 2 * nu), 0.5 / (1 + nu)
    area, y2, z2 = 72.0, 72 * 12**2 / 12, 72 * 6**2 / 3
    xx, cross = k * k * a * a * y2, 0.0  # the mean of y is zero
    exact = (lam + 2 * mu) * (xx + c * c * area) + 2 * lam * cross + mu * ((a - k * b) ** 2 * area + k * k * c * c * z2)
    found = energy(body, body.stiffness(k), np.column_stack([a * y, np.full_like(y, b), c * z]))
    assert found == pytest.approx(exact, rel=1e-12)
    A0, A1, A2 = body.matrices[2]
    np.testing.assert_allclose(body.stiffness(k), A0 + k * A1 + k * k * A2, atol=1e-14)


def test_bodies_of_revolution_move_rigidly_without_energy() -> None:
    body = WaveguideSection(block_mesh(2, 6.0, offset=10.0), UNIT, degree=1, radius=1.0)
    r = body.points[:, 1]
    one, none = np.ones_like(r), np.zeros_like(r)
    y = body.points[:, 0]
    stiff = energy(body, body.stiffness(0.0), np.column_stack([none, none, r]))
    for n, U in (
        (0, [r, none, none]),  # turns about the axle
        (0, [none, one, none]),  # moves along the axle
        (1, [one, none, -one]),  # moves across it
        (1, [y, r, -y]),  # turns about a line across it
    ):
        assert abs(energy(body, body.stiffness(float(n)), np.column_stack(U))) < 1e-12 * stiff


def test_far_from_the_axle_a_wheel_is_prismatic() -> None:
    H = []
    for radius in (1e3, 1e4):
        wheel_like = WaveguideSection(block_mesh(3, 12.0, offset=radius), UNIT, degree=1, radius=radius)
        flat = WaveguideSection(block_mesh(3, 12.0), UNIT, degree=1)
        exact = flat.flexibility(0.4)
        H.append(np.abs(wheel_like.flexibility(0.4) - exact).max() / np.abs(exact).max())
    assert H[0] < 2e-2
    assert H[1] == pytest.approx(H[0] / 10, rel=0.1)


@pytest.mark.parametrize("degree", [1, 2])
def test_elimination_agrees_with_a_direct_solve(degree: int) -> None:
    import scipy.sparse as sp
    from scipy.sparse.linalg import spsolve

    body = WaveguideSection(block_mesh(6, 60.0), UNIT, degree=degree)
    pointer, columns, _ = body.matrices
    A = sp.csc_array((body.stiffness(0.3), columns, pointer))
    free = np.setdiff1d(np.arange(A.shape[0]), 3 * body.fixed[:, None] + np.arange(3))
    loaded = (3 * body.surface[:, None] + np.arange(3)).ravel()
    loads = (free[:, None] == loaded).astype(float)
    direct = loads.T @ spsolve(A[free][:, free], sp.csc_array(loads)).toarray()
    np.testing.assert_allclose(
        body.dissection.flexibility(body.stiffness(0.3)), direct, atol=1e-11 * np.abs(direct).max()
    )


def test_unclamped_body_is_rejected() -> None:
    mesh = block_mesh(2, 6.0)
    loose = WaveguideSection(SectionMesh(mesh.points, mesh.cells, mesh.surface, np.zeros_like(mesh.clamped)), UNIT)
    with pytest.raises(np.linalg.LinAlgError):
        loose.flexibility(0.0)


@pytest.mark.parametrize("name", ["rail", "wheel"])
def test_interpolation_error_bounds_the_true_one(name: str) -> None:
    """Of all compliances up to 20 steps, against three times as many wavenumbers; and not by more than 50 times."""
    size = 6e-3
    if name == "rail":
        outline = rail_outline(named_profile("UIC60-benchmark"), chord_error=5e-4)
        body, around = profile_body(outline, UNIT, size=size), None
    else:
        outline = wheel_outline(named_profile("S1002"), 0.46)
        body, around = profile_body(outline, UNIT, size=size), 2 * np.pi * 0.46
    shift = 1 / float(np.ptp(outline.polygon(1e-2), axis=0).max())

    def spectrum(tolerance: float) -> tuple[ComplianceSpectrum, Array]:
        found = sample(
            body.flexibility, shift=shift, largest=2 * np.pi / size, step=size, tolerance=tolerance, around=around
        )
        both = found.weights(np.arange(20) * size, size)
        return found, np.stack([np.einsum("xk,kpab->xpab", w, found.values) for w in both])

    coarse, found = spectrum(TOLERANCE)
    fine, exact = spectrum(1e-5 if name == "rail" else 1e-6)
    assert len(fine.k) > 3 * len(coarse.k) - 20
    first, second = pairs(fine.lines)
    over = np.einsum("k,kpab->pab", fine.weights(np.zeros(1), 16 * size)[0][0], fine.values)[first == second]
    true = np.abs(found - exact).max() / np.einsum("paa->pa", over).min()
    assert true < coarse.error < TOLERANCE
    assert coarse.error < 50 * true


def test_harmonics_of_a_wheel_are_integers() -> None:
    """The compliance of a ring is the sum over integer harmonics, sampled exactly; the integral differs by 3 % and
    more.
    """
    outline, size = wheel_outline(named_profile("S1002"), 0.46), 8e-3
    body = profile_body(outline, UNIT, size=size)
    around = 2 * np.pi * 0.46
    kept = sample(body.flexibility, shift=2.5, largest=100.0, step=size, tolerance=1e-5, around=around)
    whole = kept.k * around / (2 * np.pi)
    np.testing.assert_allclose(whole, whole.round(), atol=1e-9)
    x = np.array([0.0, 2 * size, around / 2])
    n = np.arange(round(float(whole[-1])) + 1)
    line = 4
    H = np.array([body.flexibility(float(k))[3 * line : 3 * line + 3, 3 * line : 3 * line + 3] for k in n / 0.46])
    load = np.where(n > 0, 2, 1) * np.sinc(n / 0.46 * size / (2 * np.pi)) ** 2 / around
    exact = np.einsum("xn,nab->xab", np.cos(np.outer(x, n / 0.46)) * load, H)
    place = np.flatnonzero((np.array(pairs(kept.lines)) == line).all(axis=0))[0]
    found = np.einsum("xk,kab->xab", kept.weights(x, size)[0], kept.values[:, place])
    np.testing.assert_allclose(found, exact, atol=1e-4 * exact[0, 0, 0])
    continuous = np.einsum("xk,kab->xab", replace(kept, round=None).weights(x, size)[0], kept.values[:, place])
    assert abs(continuous[0, 0, 0] / exact[0, 0, 0] - 1) > 0.03


def test_wheel_is_more_compliant_than_its_rim() -> None:
    """Web and hub add to the rim's compliance, sideways most, and change what is near the contact by little."""
    outlines = rim_outline(named_profile("S1002"), 0.46), wheel_outline(named_profile("S1002"), 0.46)
    own, relative = [], []
    for outline in outlines:
        compliance, _, _ = profile_waveguide(outline, Material(), size=4e-3, half_length=0.02)
        nx, ns = compliance.shape
        node = (nx // 2) * ns + ns // 2
        block = compliance.block(np.array([node, node + ns, node + 2 * ns])).reshape(3, 3, 3, 3)
        own.append(np.diag(block[0, :, 0]))
        relative.append(np.diag(block[0, :, 0] - block[0, :, 1]))
    assert (own[1] > own[0]).all()
    assert own[1][1] > 3 * own[0][1]
    np.testing.assert_allclose(relative[1], relative[0], rtol=0.05)


def test_elimination_recovers_internal_displacements() -> None:
    body = WaveguideSection(block_mesh(6, 60.0), UNIT, degree=2)
    values = body.stiffness(0.3)
    load = np.random.default_rng(2).normal(size=(3 * len(body.surface), 2))
    found = body.dissection.solve(values, load, 3 * len(body.points))
    import scipy.sparse as sp

    pointer, columns, _ = body.matrices
    rest = sp.csr_array((values, columns, pointer)) @ found
    rows = (3 * body.surface[:, None] + np.arange(3)).ravel()
    np.testing.assert_allclose(rest[rows], load, atol=1e-10)
    held = (3 * body.fixed[:, None] + np.arange(3)).ravel()
    assert (found[held] == 0).all()
    rest[rows] = rest[held] = 0.0
    assert np.abs(rest).max() < 1e-10


def test_interpolation_error_estimate_is_reliable() -> None:
    body = WaveguideSection(block_mesh(4, 200.0, grading=Grading(1.0, 0.4, 50.0)), UNIT, degree=1)
    x, step = np.arange(9.0), 1.0

    def spectra(tolerance: float) -> tuple[float, Array]:
        found = sample(body.flexibility, shift=1 / 200, largest=4 * np.pi, step=step, tolerance=tolerance)
        even, odd = found.weights(x, step)
        return found.error, np.stack([np.einsum("xk,kpab->xpab", w, found.values) for w in (even, odd)])

    _, exact = spectra(1e-6)
    # the error counts relative to the compliance of loads over 16 steps, of the order of a sixth of a cell's own
    own = exact[0][0].max() / 4
    for tolerance in (3e-2, 3e-3, 3e-4):
        error, found = spectra(tolerance)
        true = np.abs(found - exact).max() / own
        assert error <= tolerance
        assert true < error


def test_truncation_at_the_largest_wavenumber() -> None:
    body = WaveguideSection(block_mesh(4, 200.0, grading=Grading(1.0, 0.4, 50.0)), UNIT, degree=1)
    own = []
    for reach in (4 * np.pi, 16 * np.pi):
        found = sample(body.flexibility, shift=1 / 200, largest=reach, step=1.0, tolerance=1e-5)
        own.append(np.einsum("xk,kpab->xpab", found.weights(np.arange(4.0), 1.0)[0], found.values))
    assert np.abs(own[1] - own[0]).max() < 2e-3 * own[0].max()


def on_half_space(x: float, y: float, nu: float = 0.3) -> Array:
    """Surface displacement (3, 3) at (x, y) by unit forces at the origin, E = 1, z out of the body (Boussinesq and
    Cerruti; Johnson, Contact Mechanics, 1985, eqs. 3.19 and 3.75)."""
    r, f = np.hypot(x, y), (1 + nu) / (2 * np.pi)
    C = 2 * (1 - nu) / r * np.eye(3)
    C[:2, :2] += 2 * nu / r**3 * np.outer([x, y], [x, y])
    C[2, :2] = -(1 - 2 * nu) / r**2 * np.array([x, y])
    C[:2, 2] = -C[2, :2]
    return f * C


def bump(compliance: WaveguideCompliance, radius: int) -> tuple[Array, Array]:
    """Displacement (3, 3) at a far point by smooth unit loads around the grid's middle, and the load's offsets."""
    nx, ns = compliance.shape
    i, j = np.meshgrid(np.arange(-radius, radius + 1), np.arange(-radius, radius + 1), indexing="ij")
    load = (np.cos(np.pi / 2 * i / (radius + 1)) * np.cos(np.pi / 2 * j / (radius + 1))).ravel() ** 2
    load /= load.sum()
    nodes = ((nx // 2 + i) * ns + ns // 2 + j).ravel()
    far = (nx // 2 + 3 * radius) * ns + ns // 2 + 2 * radius
    block = compliance.block(np.append(nodes, far)).reshape(len(nodes) + 1, 3, len(nodes) + 1, 3)
    offsets = np.column_stack([3 * radius - i.ravel(), 2 * radius - j.ravel()])
    return np.einsum("anb,n->ab", block[-1, :, :-1], load), np.column_stack([offsets, load])


@pytest.mark.parametrize("degree", [1, 2])
def test_a_large_block_tends_to_the_half_space(degree: int) -> None:
    """All nine components, signs included, for a smooth load on a finer and finer grid."""
    errors, sizes = [], (2, 4, 8) if degree == 1 else (2, 4)
    for radius in sizes:
        compliance, _ = block_waveguide(
            (3 * radius, 3 * radius),
            UNIT,
            size=1.0,
            half_width=8192.0 * radius,
            degree=degree,
            grading=Grading(0.5 * degree, 0.8 / radius),
        )
        found, loads = bump(compliance, radius)
        exact = np.einsum("n,nab->ab", loads[:, 2], [on_half_space(x, y) for x, y in loads[:, :2]])
        errors.append(np.abs(found - exact).max() / exact[2, 2])
    assert errors[-1] < (5e-3 if degree == 1 else 2e-3)
    slope = np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    assert slope < (-0.8 if degree == 1 else -1.2), errors


def bodies(size: float, **options: object) -> dict[str, tuple[WaveguideCompliance, Array]]:
    made = {}
    rail_part = rail_outline(named_profile("UIC60-benchmark"), chord_error=5e-4)
    wheel_part = wheel_outline(named_profile("S1002"), 0.46)
    for name, outline in (("rail", rail_part), ("wheel", wheel_part)):
        compliance, grid, _ = profile_waveguide(outline, Material(), size=size, **options)  # type: ignore[operator]
        made[name] = compliance, grid.position
    return made


def test_reciprocity() -> None:
    random = np.random.default_rng(1)
    for compliance, _ in bodies(4e-3, half_length=0.02).values():
        nx, ns = compliance.shape
        for directions in ((0, 1, 2), (1, 2), (2,)):
            nodes = random.choice(nx * ns, 40, replace=False)
            matrix = compliance.block(nodes, directions)
            assert matrix.shape == (40 * len(directions),) * 2
            assert np.abs(matrix - matrix.T).max() < 1e-14 * matrix.max()
            assert np.linalg.eigvalsh(matrix)[0] > 0
            whole = compliance.block(nodes).reshape(40, 3, 40, 3)[:, directions][..., directions]
            np.testing.assert_array_equal(matrix, whole.reshape(matrix.shape))
        row = (nx // 2) * ns + np.arange(ns)  # every line with every other: adjacent and far tiles
        assert np.linalg.eigvalsh(compliance.block(row))[0] > 0


def test_forces_of_a_turned_wheel_are_condensed_in_few_matrices() -> None:
    """At 1400 points of a grid of 1 mm each matrix has 160 MB."""
    compliance, _ = bodies(4e-3, half_length=0.02)["wheel"]
    nx, ns = compliance.shape
    nodes = np.arange(nx * ns)[: 10 * ns]
    coupling = ContactOperators(nodes, (0, 1, 2), sp.eye(3 * len(nodes), format="csr"), None)
    expected = compliance.block(nodes)
    tracemalloc.start()
    displacement, _ = condense(coupling, compliance)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    np.testing.assert_allclose(displacement, expected, atol=1e-14 * expected.max())
    assert peak < 3.0 * expected.nbytes, f"{peak / expected.nbytes:.2f}"


@pytest.mark.parametrize("name", ["rail", "wheel"])
def test_three_dimensional_meshes_converge_to_the_waveguide(name: str) -> None:
    """Tetrahedra on the same sections approach the compliance by wavenumbers, axes and signs included."""
    from wheelrail.contact.elasticity.solid_body import ElasticBody

    if name == "rail":
        outline = rail_outline(named_profile("UIC60-benchmark"), chord_error=5e-4)
        # clamped all round below its running surface, as linear tetrahedra are too stiff for a web
        outline = replace(outline, clamped=(0, len(outline.boundary) - 1))
        reference, grid, _ = profile_waveguide(outline, Material(), size=2e-3, half_length=0.024)
    else:
        outline = rim_outline(named_profile("S1002"), 0.46)
        reference, grid, _ = profile_waveguide(outline, Material(), size=2e-3, half_length=0.024)
    place = grid.position
    errors, sizes = [], (8e-3, 4e-3)
    for size in sizes:
        solid = profiled(outline, size=size, half_length=0.25, grading=Grading(0.7, 0.4, 2 * size))[0]
        body = ElasticBody(solid, Material())
        nx, ns = body.grid.shape
        first, last = np.round(np.array([0.4, 0.8]) * 7).astype(int) * round(8e-3 / size)
        own = (nx // 2 + np.array([-1, 1]) * round(8e-3 / size)) * ns + np.array([first, last])
        # displacements (i, a) by loads (j, b) elsewhere: i != j
        found = np.stack([body.respond(own[1:], direction)[0, own[0]] for direction in range(3)], axis=1)
        here = body.grid.position.reshape(-1, 3)[own]
        distance = np.linalg.norm(place.reshape(-1, 1, 3) - here, axis=2)
        assert distance.min(axis=0).max() < 1e-9
        exact = reference.block(distance.argmin(axis=0))[:3, 3:]
        errors.append(np.abs(found - exact).max() / np.abs(exact).max())
    assert errors[1] < 0.7 * errors[0], errors
    assert errors[1] < 0.1, errors


def lengthened(half_length: float, degree: int) -> tuple[Array, Array]:
    """Compliance (3, 3) of a rail clamped at its foot, at a distance of 16 mm along and across, from 8 mm meshes in 3D
    of half length m, and by wavenumbers.
    """
    from wheelrail.contact.elasticity.solid_body import ElasticBody

    size, outline = 8e-3, rail_outline(named_profile("UIC60-benchmark"), chord_error=2e-3)
    strip = Strip.on(outline, half_length=2 * size, size=size)
    x = layers(strip.half_cells, size, half_length, growth=1.8, largest=80e-3)
    solid = extruded(section(outline, strip, grading=Grading(1.0, 1.0, 40e-3)), x, strip.half_cells)
    body = ElasticBody(solid, Material(), degree=degree)
    nx, ns = body.grid.shape
    line = (ns // 2) // degree * degree
    own = np.array([(nx // 2) * ns + line, (nx // 2 + 2 * degree) * ns + line + 2 * degree])
    found = np.stack([body.respond(own[:1], direction)[0, own[1]] for direction in range(3)], axis=1)
    reference, grid, _ = profile_waveguide(outline, Material(), size=0.5 * size, half_length=0.02)
    distance, place = cKDTree(grid.position.reshape(-1, 3)).query(body.grid.position.reshape(-1, 3)[own])
    assert distance.max() < 1e-9
    return found, reference.block(place)[3:, :3]


def test_the_real_rail_in_three_dimensions() -> None:
    """Complete section clamped at its foot: quadratic elements over +-1 m are within 1 %. Half the length is not
    sufficient, and linear elements are far too stiff laterally.
    """
    (short, exact), (long, _) = lengthened(0.5, 2), lengthened(1.0, 2)
    errors = [np.diag(found) / np.diag(exact) - 1 for found in (short, long)]
    assert np.abs(errors[1]).max() < 0.01, errors
    assert np.abs(long - exact).max() < 0.01 * np.abs(exact).max()
    assert errors[0][1] > 5 * abs(errors[1][1])
    assert lengthened(1.0, 1)[0][1, 1] < 0.6 * exact[1, 1]


def test_the_whole_wheel_in_three_dimensions() -> None:
    """Complete wheel clamped at its bore: near the load, and half a turn away, where only the lowest harmonics
    contribute. Quadratic elements converge.
    """
    radius, size = 0.46, 8e-3
    outline, half = wheel_outline(named_profile("S1002"), radius), np.pi * radius
    step = half / round(half / (0.5 * size))
    reference, grid, _ = profile_waveguide(outline, Material(), size=0.5 * size, step=step, half_length=half)
    found = [
        turned_wheel(outline, size, largest=largest, section_size=inner)
        for largest, inner in ((0.2, 0.06), (0.12, 0.04))
    ]
    errors = []
    for places, displacement in found:
        distance, place = cKDTree(grid.position.reshape(-1, 3)).query(places)
        assert distance.max() < 0.2 * size
        exact = reference.block(place).reshape(3, 3, 3, 3)[1:, :, 0]
        errors.append(np.abs(displacement - exact).max(axis=(1, 2)) / np.abs(exact).max(axis=(1, 2)))
        diagonal = np.diagonal(displacement / exact, axis1=1, axis2=2)
    assert errors[1].max() < 0.035, errors
    assert (errors[1] < 0.85 * errors[0]).all(), errors
    np.testing.assert_allclose(diagonal, 1, atol=0.035)
    np.testing.assert_allclose(diagonal[0, [0, 2]], 1, atol=0.01)


def turned_wheel(outline: Outline, size: float, *, largest: float, section_size: float) -> tuple[Array, Array]:
    """Mesh of a complete wheel: a loaded point, one 16 mm away and one on the opposite side (3, 3) m, and displacements
    (2, 3, 3) of the latter two by unit forces on the first, axis by axis.
    """
    from wheelrail.contact.elasticity.solid_body import ElasticBody

    radius = outline.offset[1]
    half = np.pi * radius
    strip = Strip.on(outline, half_length=2 * size, size=size)
    mesh = section(outline, strip, grading=Grading(1.0, 1.0, section_size))
    x = layers(strip.half_cells, size, half, growth=1.6, largest=largest)
    whole = extruded(mesh, x, strip.half_cells)
    count = (len(x) - 1) * len(mesh.points)  # the last layer is the first one
    ring = replace(
        whole,
        points=whole.points[:count],
        cells=np.where(whole.cells >= count, whole.cells - count, whole.cells),
        clamped=whole.clamped[:count],
    )
    body = ElasticBody(ring.mapped(revolved(radius)), Material(), degree=2)
    nx, ns = body.grid.shape
    points = body.grid.position
    line = (ns // 2) // 2 * 2
    loaded, near = points[nx // 2, line], points[nx // 2 + 4, line + 4]
    places = np.array([loaded, near, [0.0, loaded[1], -loaded[2]]])
    distance, nodes = cKDTree(body.space.tabulate_dof_coordinates()).query(places)
    assert distance.max() < 1e-9
    force, moved = body.stiffness.createVecRight(), body.stiffness.createVecRight()
    found = np.empty((2, 3, 3))
    for axis in range(3):
        force.set(0.0)
        force.setValue(3 * int(nodes[0]) + axis, 1.0)
        force.assemble()
        body.factor.solve(force, moved)
        found[:, :, axis] = moved.getArray().reshape(-1, 3)[nodes[1:]]
    return places, found


def test_spectra_are_cached_and_damaged_ones_rebuilt(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WHEELRAIL_CACHE", str(tmp_path))
    sampled: list[float] = []
    flexibility = WaveguideSection.flexibility

    def counted(section: WaveguideSection, k: float) -> Array:
        sampled.append(k)
        return flexibility(section, k)

    monkeypatch.setattr(WaveguideSection, "flexibility", counted)

    def fresh() -> WaveguideCompliance:
        return block_waveguide((2, 2), UNIT, size=1.0, half_width=50.0)[0]

    nodes = np.arange(4)
    first = fresh().block(nodes)
    count = len(sampled)
    assert count > 10
    np.testing.assert_array_equal(fresh().block(nodes), first)
    assert len(sampled) == count
    (file,) = tmp_path.glob("spectrum/*.npz")
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    np.testing.assert_array_equal(fresh().block(nodes), first)
    assert len(sampled) == 2 * count


def test_grid_weights_measure_the_surface() -> None:
    outline = wheel_outline(named_profile("S1002"), 0.46)
    _, grid, strip = profile_waveguide(outline, Material(), size=2e-3, step=1e-3, half_length=0.01)
    points = outline.surface(strip.arc)
    ring = np.hypot(*np.diff(points, axis=0).T) @ (points[1:, 1] + points[:-1, 1]) / 2
    assert grid.weight[0].sum() == pytest.approx(ring * 1e-3 / 0.46, rel=1e-12)
    assert grid.position[grid.shape[0] // 2, :, 2] == pytest.approx(-points[:, 1])


def test_hertz_with_exact_laws() -> None:
    """57 kN, R = 0.1 and 0.3 m, 20 points across: peak pressure within 0.5 %, semi-axes within 1 %."""
    steel, load, radii = Material(2.1e11, 0.3), 57e3, (0.1, 0.3)
    exact = hertz(0.5 / radii[0], 0.5 / radii[1], modulus((2.1e11, 0.3), (2.1e11, 0.3)), force=load)
    step, size = (2 * a / 20 for a in exact.semi_axes)
    compliance, grid = block_waveguide((17, 17), steel, size=size, step=step, half_width=4096.0, grading=GRADING)
    geometry = QuadricPair(grid, radii, (np.inf, np.inf))
    model = CondensedContact(geometry, compliance, compliance, ContactLaws(np.inf, friction=0.0))
    still = Twist(np.zeros(3), np.zeros(3), np.zeros(3))

    def at(depth: float, guess: tuple | None) -> tuple:
        pose = Pose(np.array([0.0, 0.0, -depth]), UPSIDE_DOWN)
        return (model(pose, RigidMotion(still, still), guess[0] if guess else None),)

    found = find_depth_for_load(at, load, expected=exact.approach)
    patch = found.results[0].patches[0]
    assert patch.max_pressure == pytest.approx(exact.peak, rel=5e-3)
    assert patch.semi_axes == pytest.approx(exact.semi_axes, rel=1e-2)
    assert found.depth == pytest.approx(exact.approach, rel=1e-2)
