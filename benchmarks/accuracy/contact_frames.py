"""Conversion between CONTACT's track frame (x forward, y right, z down; forces on the rail; mm, N, MPa) and ours."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array

ROTATION = np.array([1.0, -1.0, -1.0])  # half a turn about x: the same for forces, moments, positions and rotations


def state(case: dict[str, Any], *, speed: float, pitch_rate: float, yaw: float = 0.0) -> WheelsetState:
    """Wheelset state of a case: y mm to the right, roll rad, speed mm/s, pitch rate negative when rolling forward."""
    return WheelsetState(
        y=-1e-3 * case["y"],
        roll=case["roll"],
        yaw=-yaw,
        pitch_rate=-pitch_rate,
        speed=1e-3 * speed,
    )


def wheel_force(rail_force: list[float]) -> Array:
    """Force on the wheel in our axes, from CONTACT's on the rail."""
    return np.asarray(-ROTATION * np.asarray(rail_force, dtype=float))


def rail_position(y: float, side: Side) -> float:
    """Lateral position on the rail's profile, m to the field side, from CONTACT's, mm to the right."""
    return 1e-3 * (-y if side == "left" else y)


@dataclass(frozen=True)
class FrameDifference:
    """Ours minus CONTACT's: place m (of the patch that differs most, each of CONTACT's compared with the nearest of
    ours), patches (ours, CONTACT's), area and peak as ratios - 1, forces (longitudinal, lateral in the track's axes) N,
    fraction of the normal force in the most heavily loaded patch.
    """

    position: float
    patches: tuple[int, int]
    area: float
    peak: float
    forces: tuple[float, float]
    load_fraction: float

    @property
    def same_patches(self) -> bool:
        return self.patches[0] == self.patches[1]


def difference(result: ContactResult, contact_case: dict[str, Any], side: Side) -> FrameDifference:
    """Difference of a result, in the track's axes, from one side of a case."""
    islands = contact_case["islands"]
    ours = np.array([patch.rail_y for patch in result.patches])
    positions = np.array([rail_position(island["y_rail"], side) for island in islands])
    nearest = np.abs(ours - positions[:, None]).argmin(axis=1)
    deviation = ours[nearest] - positions
    force = result.force - wheel_force(contact_case["force"])
    normal = np.array([patch.normal_force for patch in result.patches])
    return FrameDifference(
        position=float(deviation[np.abs(deviation).argmax()]),
        patches=(len(result.patches), len(islands)),
        area=1e6 * sum(p.area for p in result.patches) / sum(i["area"] for i in islands) - 1,
        peak=1e-6 * max(p.max_pressure for p in result.patches) / max(i["pmax"] for i in islands) - 1,
        forces=(float(force[0]), float(force[1])),
        load_fraction=float(normal[nearest[0]] / normal.sum() - islands[0]["fn"] / sum(i["fn"] for i in islands)),
    )
