"""The Hertz pair and its family of uniformly refined meshes for solves with all nodal displacements."""

from __future__ import annotations

import numpy as np

from benchmarks.common.hertz_pairs import CIRCULAR, STEEL
from wheelrail.contact.elasticity.solid_body import ElasticBody
from wheelrail.contact.geometry.quadric_pair import QuadricPair
from wheelrail.contact.geometry.surface_grid import ContactGrid
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.full.model import FullContact
from wheelrail.contact.models.full.newton import FullOptions
from wheelrail.meshes.bodies.extrusion import Solid
from wheelrail.meshes.bodies.solids import block
from wheelrail.meshes.bodies.triangulation import Grading

PAIR = CIRCULAR
HALF_WIDTH = 20.0  # in semi-axes, and depth


def depth() -> float:
    """Depth and half width [m] of the blocks."""
    return HALF_WIDTH * PAIR.exact.semi_axes[0]


def body(across: int) -> Solid:
    """Block with a number of elements across the patch; the element growth from the surface is refined alike."""
    size = PAIR.size(across)
    half = int(np.ceil(np.sqrt(1.5 * PAIR.exact.approach * 2 * PAIR.upper[0]) / size)) + 1
    units, _ = block((half + 2, half), half_width=HALF_WIDTH * across / 2, grading=Grading(0.5, 1.0 / across))
    return units.mapped(lambda points: points * size)


def pair(across: int, laws: ContactLaws, options: FullOptions) -> FullContact:
    """Contact of two such blocks with all nodal displacements."""
    solid = body(across)
    geometry = QuadricPair(ContactGrid.on(solid, 1), PAIR.upper, PAIR.lower)
    return FullContact(geometry, ElasticBody(solid, STEEL), ElasticBody(solid, STEEL), laws, options=options)
