"""Contact solution as one Dataset: results, poses, shapes of the bodies, computing time."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.analytical.hertz import modulus
from wheelrail.contact.geometry.quadric_pair import curvature
from wheelrail.scenes.builders.laws import laws
from wheelrail.scenes.contacts.report import overall
from wheelrail.scenes.contacts.solve import SideSolution, model_choices
from wheelrail.scenes.datasets.contact import contact_dataset
from wheelrail.scenes.datasets.patches import means
from wheelrail.scenes.schema.scene import HertzScene, WheelsetScene
from wheelrail.support.arrays import Array
from wheelrail.support.version import commit, versions

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.meshes.profiles.profile import Profile

OUTLINE = 2e-4  # m, spacing of the stored points of a profile


def solution_dataset(
    scene: HertzScene | WheelsetScene,
    solved: Mapping[str, SideSolution],
    profiles: Sequence[Profile] = (),
    arguments: Mapping[str, Any] | None = None,
) -> Dataset:
    """Dataset of `contact_dataset` with poses, costs, stresses and profiles.

    Parameters:
        scene: that was solved.
        solved: solution by side.
        profiles: of wheel and inclined rail, for a wheelset.
        arguments: of the call, stored as text.
    """
    data = contact_dataset({side: solution.result for side, solution in solved.items()}, laws(scene))
    data = data.assign(
        **_poses(solved),
        **_cost(solved),
        **_curvatures(scene, solved, profiles),
        **_outlines(profiles),
        **_stress(solved),
    )
    bodies = (scene.upper, scene.lower) if isinstance(scene, HertzScene) else (scene, scene)
    upper, lower = ((body.E, body.nu) for body in bodies)
    sides = {side: {"status": solution.result.status} for side, solution in solved.items()}
    choices = {key: value for key, value in model_choices(scene).items() if value is not None}
    return data.assign_attrs(
        title="Wheel-rail contact" if profiles else "Contact of a Hertz pair",
        frame="rail frame of each side: x forward, y to the left, z upwards; forces act on the wheel",
        status=overall(sides),
        kind=scene.kind,
        model=scene.model,
        friction=scene.friction if isinstance(scene.friction, float | int) else scene.friction.model_dump_json(),
        contact_modulus=modulus(upper, lower),
        **({} if isinstance(scene, HertzScene) else {"nominal_radius": scene.wheelset.radius}),
        **choices,
        arguments=json.dumps(dict(arguments or {}), default=str),
        versions=", ".join(f"{name} {number}" for name, number in versions().items()),
        commit=commit(),
        created=datetime.now(UTC).isoformat(timespec="seconds"),
    )


def _poses(solved: Mapping[str, SideSolution]) -> dict[str, Any]:
    """Position of the wheelset, and pose of each wheel in the frame of its rail."""
    origin, rotation = np.full((len(solved), 3), np.nan), np.full((len(solved), 3, 3), np.nan)
    for row, solution in enumerate(solved.values()):
        if solution.pose is not None:
            origin[row], rotation[row] = solution.pose.origin, solution.pose.rotation
    axes = means("1", "axes of the wheel as columns")
    return {
        "z": ("side", [solution.z for solution in solved.values()], means("m", "height above the nominal one")),
        "roll": ("side", [solution.roll for solution in solved.values()], means("rad", "roll of the wheelset")),
        "wheel_origin": (
            ("side", "axis"),
            origin,
            means("m", "centre of the wheel in the plane of the rolling circle"),
        ),
        "wheel_rotation": (("side", "axis", "wheel_axis"), rotation, axes),
    }


def _cost(solved: Mapping[str, SideSolution]) -> dict[str, Any]:
    solves, seconds = ([getattr(solution, name) for solution in solved.values()] for name in ("solves", "seconds"))
    return {
        "contact_solves": ("side", solves, means("1", "contact problems solved")),
        "contact_seconds": ("side", seconds, means("s", "time for all contact solves")),
    }


def _curvatures(
    scene: HertzScene | WheelsetScene, solved: Mapping[str, SideSolution], profiles: Sequence[Profile]
) -> dict[str, Any]:
    """Hertz coefficients A and B of the gap A x2 + B y2 between the rigid bodies at the centre of each patch."""
    most = max([1, *(len(solution.result.patches) for solution in solved.values())])
    coefficients = np.full((len(solved), most, 2), np.nan)
    for row, side in enumerate(solved.values()):
        for k, patch in enumerate(side.result.patches):
            if isinstance(scene, HertzScene):
                coefficients[row, k] = curvature(scene.upper.radii) + curvature(scene.lower.radii)
            else:
                coefficients[row, k] = _local(scene, profiles, patch.wheel_s, patch.rail_s)
    text = "half the relative curvature of the rigid bodies at the patch centre, {}"
    return {
        f"patch_gap_curvature_{name}": (("side", "patch"), coefficients[:, :, axis], means("1/m", text.format(where)))
        for axis, (name, where) in enumerate((("x", "longitudinal"), ("y", "lateral")))
    }


def _local(scene: WheelsetScene, profiles: Sequence[Profile], wheel_s: float, rail_s: float) -> Array:
    """A and B, 1/m, of wheel and rail at arc lengths, m.

    Longitudinally only the wheel is curved, with the normal curvature of its circle of radius r (Meusnier).
    """
    wheel, rail = profiles
    if not (wheel.s_range[0] <= wheel_s <= wheel.s_range[1] and rail.s_range[0] <= rail_s <= rail.s_range[1]):
        return np.full(2, np.nan)
    across = float(wheel.curvature(wheel_s)) + float(rail.curvature(rail_s))
    along = float(wheel.normal(wheel_s)[1]) / (scene.wheelset.radius + float(wheel.point(wheel_s)[1]))
    return 0.5 * np.array([along, across])


def _outlines(profiles: Sequence[Profile]) -> dict[str, Any]:
    """Points of the profiles."""
    return {
        f"{profile.kind}_profile": (
            (f"{profile.kind}_point", "plane"),
            profile.point(profile.samples(OUTLINE)),
            means("m", f"profile of the {profile.kind} {profile.name}: y to the field side, z up"),
        )
        for profile in profiles
    }


def _stress(solved: Mapping[str, SideSolution]) -> dict[str, Any]:
    """Requested stresses below the patches, over body and depth."""
    bodies = list(dict.fromkeys(body for solution in solved.values() for body in solution.stress))
    if not bodies:
        return {}
    below = [
        (row, bodies.index(body), k, patch)
        for row, solution in enumerate(solved.values())
        for body, stresses in solution.stress.items()
        for k, patch in enumerate(stresses.patches)
    ]
    depth = below[0][3].depth
    shape = (len(solved), len(bodies), 1 + max(k for _, _, k, _ in below), len(depth))
    mises, stress, position = (np.full(shape + more, np.nan) for more in ((), (3, 3), (3,)))
    for row, body, k, patch in below:
        mises[row, body, k], stress[row, body, k], position[row, body, k] = (
            patch.von_mises,
            patch.stress,
            patch.position,
        )
    dims = ("side", "body", "patch", "depth")
    return {
        "body": ("body", bodies),
        "depth": ("depth", depth, means("m", "depth below the surface")),
        "von_mises": (dims, mises, means("Pa", "von Mises stress below the patch")),
        "stress": ((*dims, "axis", "other_axis"), stress, means("Pa", "stress below the patch")),
        "stress_position": ((*dims, "axis"), position, means("m", "position of the stress")),
    }
