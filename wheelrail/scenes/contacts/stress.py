"""Requested stress below the patches of a scene: computation, and variables with units."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.builders.loaded_bodies import stressed_bodies
from wheelrail.scenes.schema.errors import SceneError

if TYPE_CHECKING:
    from wheelrail.contact.kinematics.frames import Pose
    from wheelrail.contact.results.result import ContactResult
    from wheelrail.contact.stress.subsurface import SubsurfaceStress
    from wheelrail.scenes.contacts.side_solution import SideSolution
    from wheelrail.scenes.schema.profiles import Side
    from wheelrail.scenes.schema.scene import HertzScene, WheelsetScene


def subsurface_stress(
    scene: HertzScene | WheelsetScene,
    result: ContactResult,
    pose: Pose,
    side: Side,
    report_progress: Callable[[str], None],
) -> dict[str, SubsurfaceStress]:
    """Subsurface stress by body, in the frame of the result's fields; none without contact or without a request.

    Parameters:
        scene: with the depths.
        result: of the contact.
        pose: of the upper body (of the left-hand pair).
        side: of a wheelset.
        report_progress: called with a text for every body.

    Raises SceneError for depths outside a body.
    """
    if scene.stress is None or not result.patches:
        return {}
    stress = {}
    for name, body in stressed_bodies(scene, pose, side).items():
        report_progress(f"stress in the {name}")
        try:
            stress[name] = body.below(result, np.array(scene.stress.depths))
        except ValueError as error:
            raise SceneError(f"stress.depths: {name}: {error}") from None
    return stress


def stress_values(solved: Mapping[str, SideSolution]) -> dict[str, Any]:
    """Requested stresses below the patches over side, body, patch and depth, and their cost; none without stress.

    Parameters:
        solved: solution by side.
    """
    bodies = list(dict.fromkeys(body for solution in solved.values() for body in solution.stress))
    if not bodies:
        return {}
    computed = [
        (row, bodies.index(body), stress)
        for row, solution in enumerate(solved.values())
        for body, stress in solution.stress.items()
    ]
    depth = computed[0][2].patches[0].depth
    shape = (len(solved), len(bodies), max(len(stress.patches) for _, _, stress in computed), len(depth))
    mises, tensor, position = (np.full(shape + more, np.nan) for more in ((), (3, 3), (3,)))
    seconds, wavenumbers = np.full(shape[:2], np.nan), np.zeros(shape[:2], dtype=int)
    for row, body, stress in computed:
        seconds[row, body], wavenumbers[row, body] = stress.seconds, stress.wavenumbers
        for k, patch in enumerate(stress.patches):
            mises[row, body, k], tensor[row, body, k] = patch.von_mises, patch.stress
            position[row, body, k] = patch.position
    return {
        "body": bodies,
        "depth": depth,
        "von_mises": mises,
        "stress": tensor,
        "stress_position": position,
        "stress_wavenumbers": wavenumbers,
        "stress_seconds": seconds,
    }
