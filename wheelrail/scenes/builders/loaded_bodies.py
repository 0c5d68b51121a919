"""Bodies loaded by the contact tractions of a scene, for internal stress and displacement."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from wheelrail.scenes.builders.laws import material
from wheelrail.scenes.builders.wheelset import inclined_profiles
from wheelrail.scenes.schema.profiles import Side
from wheelrail.scenes.schema.scene import HertzScene, WheelsetScene

if TYPE_CHECKING:
    from wheelrail.contact.kinematics.frames import Pose
    from wheelrail.contact.stress.subsurface import LoadedBody


def stressed_bodies(scene: HertzScene | WheelsetScene, pose: Pose, side: Side = "left") -> dict[str, LoadedBody]:
    """Bodies with requested subsurface stress, by name; parameters as for `loaded_bodies`."""
    return {} if scene.stress is None else loaded_bodies(scene, pose, scene.stress.bodies, side)


def loaded_bodies(
    scene: HertzScene | WheelsetScene, pose: Pose, names: Iterable[str], side: Side = "left"
) -> dict[str, LoadedBody]:
    """Loaded bodies of a scene by name.

    Parameters:
        scene: materials and profiles.
        pose: of the upper body (of the left-hand pair).
        names: "upper" and "lower", or "wheel" and "rail".
        side: of a wheelset.
    """
    from wheelrail.contact.stress.subsurface import LoadedBody

    if isinstance(scene, HertzScene):
        pair = {"upper": scene.upper, "lower": scene.lower}
        return {name: LoadedBody.block(name == "upper", material(pair[name])) for name in names}
    from wheelrail.meshes.bodies.outlines import rail_outline, wheel_outline

    steel, radius = material(scene), scene.side(side).radius
    assert radius is not None
    wheel, rail = inclined_profiles(scene, side)
    builders = {
        "wheel": lambda: LoadedBody.wheel(wheel_outline(wheel, radius), steel, pose),
        "rail": lambda: LoadedBody.rail(rail_outline(rail), steel),
    }
    return {name: builders[name]() for name in names}
