"""Bodies loaded by the contact tractions of a scene, for internal stress and displacement."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from wheelrail.scenes.builders.laws import material
from wheelrail.scenes.builders.wheelset import inclined_profiles
from wheelrail.scenes.schema.scene import HertzScene, WheelsetScene

if TYPE_CHECKING:
    from wheelrail.contact.kinematics.frames import Pose
    from wheelrail.contact.stress.subsurface import LoadedBody
    from wheelrail.meshes.profiles.profile import Profile


def stressed_bodies(
    scene: HertzScene | WheelsetScene, pose: Pose, profiles: tuple[Profile, Profile] | None = None
) -> dict[str, LoadedBody]:
    """Bodies with requested subsurface stress, by name; parameters as for `loaded_bodies`."""
    return {} if scene.stress is None else loaded_bodies(scene, pose, scene.stress.bodies, profiles)


def loaded_bodies(
    scene: HertzScene | WheelsetScene, pose: Pose, names: Iterable[str], profiles: tuple[Profile, Profile] | None = None
) -> dict[str, LoadedBody]:
    """Loaded bodies of a scene by name.

    Parameters:
        scene: materials and profiles.
        pose: of the upper body (of the left-hand pair).
        names: "upper" and "lower", or "wheel" and "rail".
        profiles: of wheel and inclined rail; those of the scene by default.
    """
    from wheelrail.contact.stress.subsurface import LoadedBody

    if isinstance(scene, HertzScene):
        pair = {"upper": scene.upper, "lower": scene.lower}
        return {name: LoadedBody.block(name == "upper", material(pair[name])) for name in names}
    from wheelrail.meshes.bodies.outlines import rail_outline, wheel_outline

    steel = material(scene)
    wheel, rail = profiles or inclined_profiles(scene)
    builders = {
        "wheel": lambda: LoadedBody.wheel(wheel_outline(wheel, scene.wheelset.radius), steel, pose),
        "rail": lambda: LoadedBody.rail(rail_outline(rail), steel),
    }
    return {name: builders[name]() for name in names}
