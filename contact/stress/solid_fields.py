"""Displacement and stress of both bodies on their 3D meshes, for the full model and for condensed ones.

The full model contains them. A condensed model contains only the compliance of the surfaces; the internal displacements
under its tractions are solved for on request, K u = f with one right-hand side.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.elasticity.solid_compliance import SurfaceCompliance
from wheelrail.contact.geometry.contact_operators import ContactOperators, pair_operators
from wheelrail.contact.geometry.profile_pair import ProfilePair
from wheelrail.contact.geometry.quadric_pair import UPSIDE_DOWN, QuadricPair
from wheelrail.contact.kinematics.frames import Pose
from wheelrail.contact.models.condensed import CondensedContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.stress.fields import CIRCULAR_ORDER, BodyFields
from wheelrail.forms.elasticity import lame
from wheelrail.forms.stress import cauchy
from wheelrail.meshes.bodies.extrusion import Solid
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from wheelrail.contact.elasticity.solid_body import ElasticBody
    from wheelrail.contact.models.full.model import FullContact


def solid_fields(
    model: CondensedContact | FullContact, pose: Pose, result: ContactResult
) -> tuple[BodyFields, BodyFields]:
    """Fields of wheel (upper body) and rail (lower body) under the tractions of a result.

    Parameters:
        model: contact model of meshed solids.
        pose: of the wheel.
        result: of the model in this pose.

    Displacements are at the corners of cells; stress is the mean of the adjacent cells, weighted by volume. Raises
    ValueError without contact, and for a model whose bodies are not meshed solids.
    """
    if result.fields is None or not (result.fields.pressure > 0).any():
        raise ValueError("nothing touches: the bodies carry no load")
    frames = _frames(model, pose)
    if not isinstance(model, CondensedContact):
        from wheelrail.contact.models.full.model import FullStart

        assert isinstance(result.warm_start, FullStart)
        u = result.warm_start.displacement
        split = model.wheel.stiffness.getSize()[0]
        return (
            _fields(model.wheel, u[:split], 1.0, model.wheel.steel.E).in_frame(frames[0]),
            _fields(model.rail, u[split:], 1.0, model.rail.steel.E).in_frame(frames[1]),
        )
    points, _ = model.geometry.contact_points(pose, order := model.order if model.laws.frictional else 0)
    if points is None or len(points.node) != len(result.fields.node):
        raise ValueError("the result does not belong to this model and pose")
    local = np.column_stack([result.fields.traction, -result.fields.pressure]) * points.area[:, None]
    loads = local.T.ravel() if order else local[:, 2]
    fields = []
    for compliance, coupling, sign, frame in zip(
        (model.wheel, model.rail), pair_operators(points, order), (1.0, -1.0), frames, strict=True
    ):
        if not isinstance(compliance, SurfaceCompliance):
            raise ValueError(
                "the bodies of this model are not meshed solids: use wheelrail.contact.stress.waveguide_fields"
            )
        body = compliance.body()
        u = compliance.scale * _solve(body, coupling, sign * loads)
        position = model.geometry.grid.position if isinstance(model.geometry, QuadricPair) else body.grid.position
        size = float(np.ptp(position) / np.ptp(body.grid.position))
        fields.append(_fields(body, u, size, body.steel.E / (compliance.scale * size)).in_frame(frame))
    return fields[0], fields[1]


def _frames(model: CondensedContact | FullContact, pose: Pose) -> tuple[Pose, Pose]:
    """Axes of both bodies in the frame of the fields; blocks with given radii do not move with the approach."""
    if isinstance(model.geometry, ProfilePair):
        return pose, Pose(np.array([model.geometry.rail_x(pose), 0.0, 0.0]), np.eye(3))
    return Pose(np.zeros(3), UPSIDE_DOWN), Pose(np.zeros(3), np.eye(3))


def _solve(body: ElasticBody, coupling: ContactOperators, loads: Array) -> Array:
    """Displacements of all unknowns by loads at the contact points."""
    from wheelrail.contact.models.full.discrete_problem import extended

    return body.solve(np.asarray(extended(coupling, body)[0].T @ loads))


def _fields(body: ElasticBody, u: Array, size: float, modulus: float) -> BodyFields:
    """Fields on a mesh whose points are `size` metres to the unit, of a material with this modulus [Pa]."""
    from scipy.spatial import cKDTree

    solid = body.solid
    _, node = cKDTree(body.space.tabulate_dof_coordinates()).query(solid.points)
    displacement = u.reshape(-1, 3)[node]
    points = solid.points * size
    stress = cauchy(_gradients(solid, points, displacement), *lame(modulus, body.steel.nu))
    if solid.cell == "tetrahedron":
        return BodyFields(points, solid.cells, "tetrahedron", displacement, stress)
    return BodyFields(points, solid.cells[:, CIRCULAR_ORDER], "hexahedron", displacement, stress)


def _gradients(solid: Solid, points: Array, displacement: Array) -> Array:
    """Gradients (n, 3, 3) at the points of a mesh: values at the centres of cells, averaged by volume."""
    corners, corner_displacements = points[solid.cells], displacement[solid.cells]
    if solid.cell == "tetrahedron":
        slope = np.vstack([-np.ones(3), np.eye(3)])
    else:
        reference = np.array([[i, j, k] for k in (-1, 1) for j in (-1, 1) for i in (-1, 1)], dtype=float)
        slope = reference / 4
    jacobian = np.einsum("mkc,kd->mcd", corners, slope)
    gradient = np.einsum("mkc,kd->mcd", corner_displacements, slope) @ np.linalg.inv(jacobian)
    volume = np.abs(np.linalg.det(jacobian))
    total, mean = np.zeros(len(points)), np.zeros((len(points), 3, 3))
    np.add.at(total, solid.cells, volume[:, None])
    np.add.at(mean, solid.cells, (volume[:, None, None] * gradient)[:, None])
    return np.asarray(mean / total[:, None, None])
