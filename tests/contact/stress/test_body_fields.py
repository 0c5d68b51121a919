"""Displacement and stress in a body: Hertz below the patch, Boussinesq far from it, the displacements of the contact,
and the same on solids.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
from full_disk import files_up_to
from scipy.spatial import cKDTree
from small_pairs import AT_REST, BRICKS, CREEP, STEEL, TETRAHEDRA, Block, condensed, full, hertzian
from xdmf_values import xdmf_values

from wheelrail.contact.analytical.hertz import Hertz, axis_stress, worst
from wheelrail.contact.elasticity.waveguide.coordinates import WaveguideCoordinates
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.builders import hertz_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.stress.fields import BodyFields
from wheelrail.contact.stress.solid_fields import solid_fields
from wheelrail.contact.stress.subsurface import LoadedBody
from wheelrail.contact.stress.waveguide_fields import InternalFields, internal_fields
from wheelrail.contact.stress.xdmf_file import OVERHEAD, write_xdmf
from wheelrail.support.arrays import Array

BALL, FORCE = (0.3, 0.3), 10e3


@cache
def pressed() -> tuple[ContactResult, Hertz]:
    """A ball on a flat at Hertz's approach, half-spaces so that he is right, without friction."""
    exact = hertzian(BALL, FORCE)
    how = Discretisation(0.5e-3, bodies="half-space", points="lattice", strips=10, cells=12)
    pair = hertz_pair((BALL, (np.inf, np.inf)), (STEEL, STEEL), ContactLaws(friction=0.0), how, load=FORCE)
    return pair(hertz_pose(exact.approach), AT_REST, None), exact


@cache
def seen(upper: bool) -> InternalFields:
    return internal_fields(LoadedBody.block(upper, STEEL), pressed()[0], across=12)


@pytest.mark.parametrize("upper", [True, False])
def test_the_largest_stress_lies_below_the_patch(upper: bool) -> None:
    """Von Mises 0.62 p0 at 0.48 a, in the longitudinal cut, the section and the strip; no larger on the surface."""
    _, exact = pressed()
    radius, peak = exact.semi_axes[0], exact.peak
    depth, mises = worst(radius=radius, peak=peak, nu=0.3)
    for fields in (seen(upper).along(), seen(upper).across(), seen(upper).strip(20 * radius)):
        most = fields.points[fields.von_mises.argmax()]
        assert fields.von_mises.max() == pytest.approx(mises, rel=0.02)
        assert abs(most[2]) == pytest.approx(depth, rel=0.1)
        assert np.hypot(*most[:2]) < 0.11 * radius  # cuts pass through the middles of strips, here beside the axis
        assert (np.sign(most[2]) > 0) == upper
        top = np.abs(fields.points[:, 2]) < 1e-9
        assert fields.von_mises[top].max() < 0.8 * mises


def test_stress_in_the_longitudinal_cut_is_hertzs() -> None:
    _, exact = pressed()
    radius, peak = exact.semi_axes[0], exact.peak
    cut = seen(False).along()
    under = (np.abs(cut.points[:, 0]) < 1e-3 * radius) & (cut.points[:, 2] < -0.2 * radius)
    radial, axial = axis_stress(-cut.points[under, 2], radius=radius, peak=peak, nu=0.3)
    closed = np.einsum("am,ab->mab", [radial, radial, axial], np.eye(3))
    assert np.count_nonzero(under) > 10
    assert np.abs(cut.stress[under] - closed).max() < 0.015 * peak


def boussinesq(points: Array, places: Array, force: Array) -> Array:
    """Displacement (n, 3) m of a half-space z < 0 by forces (k,) N down on places (k, 3) of its surface (Johnson,
    Contact Mechanics, 1985, eqs. 3.18 a to c)."""
    x, y, z = np.moveaxis(points[:, None] - places, -1, 0)
    z, r = -z, np.sqrt(x**2 + y**2 + z**2)
    μ, nu = STEEL.E / (2 * (1 + STEEL.nu)), STEEL.nu
    sideways = z / r**3 - (1 - 2 * nu) / (r * (r + z))
    down = z**2 / r**3 + 2 * (1 - nu) / r
    return np.stack([x * sideways, y * sideways, -down], axis=-1).swapaxes(1, 2) @ force / (4 * np.pi * μ)


def test_displacement_is_boussinesqs() -> None:
    """Up to a rigid motion, by which a block clamped at its bottom differs from a half-space: between 1.5
    and 8 radii.
    """
    result, exact = pressed()
    fields, radius = result.fields, exact.semi_axes[0]
    assert fields is not None
    body = seen(False).strip(12 * radius)
    r = np.linalg.norm(body.points, axis=1)
    shell = np.flatnonzero((r > 1.5 * radius) & (r < 8 * radius))[::17]
    closed = boussinesq(body.points[shell], fields.point, fields.pressure * fields.area)
    rest = body.displacement[shell] - closed
    assert len(shell) > 300
    assert np.abs(rest - np.median(rest, axis=0)).max() < 0.01 * np.abs(closed).max()
    held = body.points[:, 2] < 0.99999 * body.points[:, 2].min()
    assert np.abs(body.displacement[held]).max() < 1e-9 * np.abs(body.displacement).max()


def test_surface_displacements_agree_with_the_contact() -> None:
    """Wheel minus rail at the contact points, up to a rigid motion, within 2 %."""
    result, _ = pressed()
    fields = result.fields
    assert fields is not None
    on = fields.pressure > 0.3 * fields.pressure.max()
    apart = np.zeros((np.count_nonzero(on), 3))
    for upper in (True, False):
        body = seen(upper)
        surface = np.arange(len(body.section.section.surface))
        y = body.spots[surface, 0]
        at = WaveguideCoordinates.of(
            body.section, (fields.point[on] - body.body.frame.origin) @ body.body.frame.rotation
        )
        for i, along in enumerate(at.along):
            _, moved, _ = body.at(np.array([along]), surface)
            local = np.array([np.interp(at.section[i, 0], y, component) for component in moved.T])
            apart[i] += (1 if upper else -1) * body.body.frame.rotation @ local
    found = np.einsum("nab,nb->na", fields.axes[on], apart)
    rest = found - fields.displacement[on]
    assert np.abs(rest - rest.mean(axis=0)).max() < 0.02 * np.abs(fields.displacement[on]).max()
    assert np.abs(rest.mean(axis=0)).max() < 0.03 * np.abs(fields.displacement[on]).max()


def test_the_mirror_image_of_fields() -> None:
    body = seen(False).across()
    assert (body.mirrored().mirrored().points == body.points).all()
    np.testing.assert_array_equal(body.mirrored().von_mises, body.von_mises)
    np.testing.assert_array_equal(body.mirrored().displacement[:, 1], -body.displacement[:, 1])


def test_solids_deform_alike_in_both_models() -> None:
    """Full and condensed to the solver's residual, for tetrahedra and hexahedra."""
    laws, size, radii = ContactLaws.penalty(), 1e-3, (0.3, 0.3)
    pose = hertz_pose((3.2 * size) ** 2 / (2 * 0.3))
    for mesh in (TETRAHEDRA, BRICKS):
        models = full(mesh, radii, size=size, laws=laws), condensed(mesh, radii, size=size, laws=laws)
        pairs = [solid_fields(model, pose, model(pose, CREEP, None)) for model in models]
        for one, other in zip(*pairs, strict=True):
            scale = np.abs(one.displacement).max()
            np.testing.assert_array_equal(one.points, other.points)
            assert np.abs(one.displacement - other.displacement).max() < 1e-3 * scale
            assert np.abs(one.stress - other.stress).max() < 1e-3 * np.abs(one.stress).max()
        wheel, rail = pairs[0]
        touching = [np.linalg.norm(body.points, axis=1).argmin() for body in (wheel, rail)]
        assert wheel.displacement[touching[0], 2] > 0 > rail.displacement[touching[1], 2]


@pytest.mark.parametrize("mesh", [TETRAHEDRA, BRICKS], ids=["tetrahedra", "hexahedra"])
def test_fields_of_solids_are_read_again_from_xdmf(mesh: Block, tmp_path: Path) -> None:
    """Values at every point of the mesh, in mm and MPa, and cells that fill the body."""
    size, pose = 1e-3, hertz_pose((3.2e-3) ** 2 / (2 * 0.3))
    model = condensed(mesh, BALL, size=size, laws=ContactLaws.penalty())
    fields = solid_fields(model, pose, model(pose, CREEP, None))[1]
    file, values = write_xdmf(fields, tmp_path / "rail.xdmf")
    assert {file, values} == set(tmp_path.iterdir())
    points = xdmf_values(file, ".//Geometry")
    distance, point = cKDTree(points).query(1e3 * fields.points)
    assert distance.max() < 1e-9  # mm
    for name, expected in (
        ("displacement", 1e3 * fields.displacement),
        ("stress", 1e-6 * fields.stress.reshape(-1, 9)),
        ("von Mises stress", 1e-6 * fields.von_mises),
    ):
        written = xdmf_values(file, f".//Attribute[@Name='{name}']").squeeze()
        np.testing.assert_allclose(written[point], expected, rtol=1e-6, atol=1e-6 * np.abs(expected).max())
    cells = xdmf_values(file, ".//Topology")
    kind = pv.CellType.TETRA if cells.shape[1] == 4 else pv.CellType.HEXAHEDRON
    sizes = pv.UnstructuredGrid({kind: cells}, points).compute_cell_sizes()
    assert np.abs(sizes["Volume"]).sum() == pytest.approx(1e9 * np.prod(np.ptp(fields.points, axis=0)), rel=1e-5)
    (tmp_path / "wheel.h5").mkdir()
    with pytest.raises(OSError, match="cannot be written"):
        write_xdmf(fields, tmp_path / "wheel.xdmf")
    size = values.stat().st_size
    with files_up_to(size // 2), pytest.raises(OSError, match=r"File too large: .*full\.xdmf"):
        write_xdmf(fields, tmp_path / "full.xdmf")
    assert not (tmp_path / "full.h5").exists()
    with files_up_to(size + OVERHEAD):
        assert write_xdmf(fields, tmp_path / "full.xdmf")[1].stat().st_size == size


def test_stress_in_solids_is_that_of_hertz() -> None:
    """On a mesh of moderate size: largest von Mises stress within 12 %, below the surface."""
    mesh, radii = Block((9, 9), 40.0, growth=0.3), (0.3, 0.3)
    exact = hertzian(radii, FORCE)
    model = full(mesh, radii, size=exact.semi_axes[0] / 6, laws=ContactLaws(1e15, friction=0.0))
    pose = hertz_pose(exact.approach)
    _, rail = solid_fields(model, pose, model(pose, AT_REST, None))
    depth, mises = worst(radius=exact.semi_axes[0], peak=exact.peak, nu=0.3)
    most = rail.points[rail.von_mises.argmax()]
    assert rail.von_mises.max() == pytest.approx(mises, rel=0.12)
    assert -most[2] == pytest.approx(depth, abs=0.25 * exact.semi_axes[0])


def test_invalid_input_is_rejected() -> None:
    flat, tensors = np.zeros((4, 3)), np.zeros((4, 3, 3))
    with pytest.raises(ValueError, match="must be"):
        BodyFields(flat, np.zeros((1, 3), dtype=int), "tetrahedron", flat, tensors)
    with pytest.raises(ValueError, match="point numbers from 0 to 3"):
        BodyFields(flat, np.full((1, 4), 4), "tetrahedron", flat, tensors)
    with pytest.raises(ValueError, match="nothing touches"):
        internal_fields(LoadedBody.block(True, STEEL), ContactResult.separated())
