"""Bodies that the tractions of a scene load, for stresses and deformations inside them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from wheelrail.scenes.builders.laws import material
from wheelrail.scenes.builders.wheelset import laid_profiles
from wheelrail.scenes.schema.scene import HertzScene, WheelsetScene

if TYPE_CHECKING:
    from wheelrail.contact.kinematics.frames import Pose
    from wheelrail.contact.stress.subsurface import LoadedBody
    from wheelrail.meshes.profiles.profile import Profile


def stressed_bodies(
    scene: HertzScene | WheelsetScene, pose: Pose, profiles: tuple[Profile, Profile] | None = None
) -> dict[str, LoadedBody]:
    """The bodies inside which the scene asks for stresses, by name; pose of the upper one (of the left pair).

    profiles as for `wheelset_contact`.
    """
    return {} if scene.stress is None else loaded_bodies(scene, pose, scene.stress.bodies, profiles)


def loaded_bodies(
    scene: HertzScene | WheelsetScene, pose: Pose, names: Iterable[str], profiles: tuple[Profile, Profile] | None = None
) -> dict[str, LoadedBody]:
    """Bodies of a scene as ones that its tractions load: "upper" and "lower", or "wheel" and "rail"."""
    from wheelrail.contact.stress.subsurface import LoadedBody

    if isinstance(scene, HertzScene):
        pair = {"upper": scene.upper, "lower": scene.lower}
        return {name: LoadedBody.block(name == "upper", material(pair[name])) for name in names}
    from wheelrail.meshes.bodies.outlines import rail_outline, wheel_outline

    steel = material(scene)
    wheel, rail = profiles or laid_profiles(scene)
    made = {
        "wheel": lambda: LoadedBody.wheel(wheel_outline(wheel, scene.wheelset.radius), steel, pose),
        "rail": lambda: LoadedBody.rail(rail_outline(rail), steel),
    }
    return {name: made[name]() for name in names}
