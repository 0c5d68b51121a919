"""What a user sees of one solved side, as numbers, in the frame of a left-hand rail."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from benchmarks.population.draw import Situation, with_profiles
from wheelrail.contact.kinematics.frames import MIRROR, Side
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.api.solution import Solution

FLAT = np.array([1.0, -1.0])  # mirror image of tangential components


@dataclass(frozen=True)
class SideResult:
    """Solved contact of one side, that of a right-hand one as its mirror image.

    Parameters:
        status: of the solve.
        force, moment: (3,) N and N m on the wheel, moment about the wheelset's centre.
        approach: m.
        z, roll: of the wheelset, m and rad.
        origin, rotation: (3,) m and (3, 3), pose of the wheel.
        patch_force, bands: (p, 3) N and (p, 2) m, force and lateral extent on the wheel of every patch.
        normal_force, peak: (p,) N and Pa, of the patches.
        strips: (p,), across the patches.
        unsolved: m, overlap that the standard contact says it leaves; 0 of other models.
        position, axes: (n, 3) m and (n, 3, 3), of the contact points; axes are turned by the roll of a rail on pads.
        area, pressure: (n,) m2 and Pa.
        traction, slip: (n, 2) Pa on the wheel, and over the rolling speed.
    """

    status: str
    force: Array
    moment: Array
    approach: float
    z: float
    roll: float
    origin: Array
    rotation: Array
    patch_force: Array
    bands: Array
    normal_force: Array
    peak: Array
    strips: Array
    unsolved: float
    position: Array
    axes: Array
    area: Array
    pressure: Array
    traction: Array
    slip: Array

    @property
    def load(self) -> float:
        """Magnitude N of the force."""
        return float(np.linalg.norm(self.force))


def solved(situation: Situation) -> Solution:
    """Solution of a situation by the public classes. Raises what they raise."""
    import wheelrail as wr

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return wr.Wheelset(**with_profiles(situation.wheelset)).solve(**situation.solve)


def side_result(data: Dataset, side: Side) -> SideResult:
    """Result of one side of a solution's data."""
    own, mirror = data.sel(side=side), side == "right"
    vector, flat = (MIRROR, FLAT) if mirror else (np.ones(3), np.ones(2))
    points = data.isel(point=np.flatnonzero(data["point_side"].values == side))
    count = int(own["patches"])

    roll = float(own["rail_motion"][2]) * flat[1] if "rail_motion" in own else 0.0
    turn = np.array([[1.0, 0.0, 0.0], [0.0, np.cos(roll), np.sin(roll)], [0.0, -np.sin(roll), np.cos(roll)]])

    def wrench(kinds: tuple[str, str, str], name: str) -> Array:
        return np.array([float(own[f"{kind}_{name}"]) for kind in kinds])

    def of_patches(name: str) -> Array:
        return np.asarray(own[name].values[:count])

    values: dict[str, Any] = {
        "status": str(own["status"].values),
        "force": vector * wrench(("longitudinal", "lateral", "vertical"), "force"),
        "moment": vector * vector.prod() * wrench(("roll", "spin", "yaw"), "moment"),
        "approach": float(own["approach"]),
        "z": float(own["z"]),
        "roll": float(own["roll"]) * (-1.0 if mirror else 1.0),
        "origin": vector * own["wheel_origin"].values,
        "rotation": own["wheel_rotation"].values * np.outer(vector, vector),
        "patch_force": vector * of_patches("patch_force"),
        "bands": of_patches("wheel_band"),
        "normal_force": of_patches("patch_normal_force"),
        "peak": of_patches("patch_max_pressure"),
        "strips": of_patches("patch_strips"),
        "unsolved": float(np.nan_to_num(own["unsolved_overlap"])) if "unsolved_overlap" in own else 0.0,
        "position": points["position"].values * vector,
        "axes": points["axes"].values * vector * np.array([1.0, vector[1], 1.0])[:, None] @ turn,
        "area": points["area"].values,
        "pressure": points["pressure"].values,
        "traction": points["traction"].values * flat,
        "slip": points["slip"].values * flat,
    }
    return SideResult(**values)
