"""S1002 on UIC60 on coarse meshes, computed once per session, for tests that do not depend on accuracy."""

from __future__ import annotations

from functools import cache

import numpy as np

from wheelrail.contact.elasticity.solid_compliance import solid_compliance
from wheelrail.contact.geometry.profile_pair import ProfilePair
from wheelrail.contact.geometry.surface_grid import ContactGrid
from wheelrail.contact.kinematics.frames import Pose
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.condensed import CondensedContact
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.meshes.bodies.extrusion import Cell
from wheelrail.meshes.bodies.outlines import Outline, rail_outline, rim_outline
from wheelrail.meshes.bodies.solids import profiled
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.support.arrays import Array

SIZE, RADIUS, SPEED = 3e-3, 0.46, 45.0
SOLVED = 4e-3  # m, as SIZE, of pairs that are solved: their compliance takes seconds
WHEEL, RAIL = named_profile("S1002"), named_profile("UIC60-benchmark")
MOUNTING = Mounting(0.5 * 1.360 + 0.070, RAIL.gauge_offset(1.435, 0.014), RADIUS)
# Rolling to the left of the track's centre on a curve to the left, with yaw, roll and velocities of all kinds
STATE = WheelsetState(
    y=0.002,
    z=-1.8e-4,
    roll=4e-5,
    yaw=2e-3,
    y_rate=0.01,
    z_rate=0.002,
    roll_rate=-0.003,
    pitch_rate=SPEED / RADIUS,
    speed=SPEED,
    frame_rate=(1e-3, -2e-4, SPEED / 1200),
)


def outlines() -> tuple[Outline, Outline]:
    return rim_outline(WHEEL, RADIUS), rail_outline(RAIL, chord_error=5e-4)


@cache
def geometry(cell: Cell = "tetrahedron", degree: int = 1, size: float = SIZE) -> ProfilePair:
    (wheel_section, rail_section) = outlines()
    wheel_solid, wheel_strip, _ = profiled(wheel_section, size=size, half_length=0.1, cell=cell)
    rail_solid, rail_strip, _ = profiled(rail_section, size=size, half_length=0.2, cell=cell)
    grids = ContactGrid.on(wheel_solid, degree), ContactGrid.on(rail_solid, degree)
    return ProfilePair(WHEEL, RAIL, RADIUS, wheel_strip, rail_strip, *grids, degree)


@cache
def model(laws: ContactLaws) -> CondensedContact:
    (wheel_section, rail_section) = outlines()
    wheel_solid, _, wheel_key = profiled(wheel_section, size=SOLVED, half_length=0.1)
    rail_solid, _, rail_key = profiled(rail_section, size=SOLVED, half_length=0.2)
    above, below = (
        solid_compliance(wheel_solid, wheel_key, Material(), 1),
        solid_compliance(rail_solid, rail_key, Material(), 1),
    )
    return CondensedContact(geometry(size=SOLVED), above, below, laws)


def wheelset(laws: ContactLaws | None = None) -> WheelsetContact:
    return WheelsetContact(model(laws or ContactLaws.penalty()), MOUNTING)


def left_pose(state: WheelsetState = STATE, ahead: float = 0.0) -> Pose:
    """Pose of the left wheel on a straight rail, shifted along it so that its points are between the rail's nodes."""
    pose = MOUNTING.left_pair(state)[0]
    origin: Array = pose.origin + np.array([ahead, 0.0, 0.0])
    return Pose(origin, pose.rotation)
