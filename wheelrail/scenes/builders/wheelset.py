"""Contact model of a wheelset on the scene's track. Heavy packages are imported only when a model is built."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wheelrail.scenes.builders.laws import laws, material, standard_contact
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene, WheelsetScene

if TYPE_CHECKING:
    from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
    from wheelrail.contact.models.wheelset import WheelsetContact
    from wheelrail.meshes.profiles.profile import Profile


def wheelset_contact(
    scene: WheelsetScene | RunScene, profiles: tuple[Profile, Profile] | None = None
) -> WheelsetContact:
    """Contact model of both wheels of a wheelset on the track of the scene; one model serves both sides.

    Parameters:
        scene: of a wheelset or a run.
        profiles: of wheel and inclined rail; those of the scene by default.

    Raises SceneError for a profile that cannot be read, or a rail that does not extend to the gauge height.
    """
    from wheelrail.contact.models.wheelset import WheelsetContact

    pair = profiles or inclined_profiles(scene)
    mounting, radius = mounted(scene, pair[1]), scene.wheelset.radius
    if scene.model == "standard":
        from wheelrail.contact.geometry.rigid_surfaces import MERGE, RigidWheelRail

        merge = MERGE if scene.merge_distance is None else scene.merge_distance
        rigid = RigidWheelRail(*pair, radius, merge)
        return WheelsetContact(standard_contact(scene, rigid, scene, scene), mounting)
    from wheelrail.contact.models.builders import wheel_rail_pair

    materials = material(scene), material(scene)
    model = wheel_rail_pair(pair, radius, materials, laws(scene), scene.discretisation)
    return WheelsetContact(model, mounting)


def mounted(scene: WheelsetScene | RunScene, rail: Profile) -> Mounting:
    """Positions of wheels on the axle and of the inclined rails in the track.

    Raises SceneError for a rail that does not extend to the gauge height.
    """
    from wheelrail.contact.kinematics.wheelset_state import Mounting

    axle, track = scene.wheelset, scene.track
    try:
        rail_y = rail.gauge_offset(track.gauge, track.gauge_height)
    except ValueError as error:
        raise SceneError(f"profiles: {error}") from error
    return Mounting(0.5 * axle.flange_back_distance - axle.flange_back, rail_y, axle.radius)


def inclined_profiles(scene: WheelsetScene | RunScene) -> tuple[Profile, Profile]:
    """Profiles of wheel and inclined rail. Raises SceneError for one that cannot be read."""
    from wheelrail.meshes.profiles.library import load_profile

    try:
        wheel = load_profile(scene.profiles.wheel, "wheel")
        return wheel, load_profile(scene.profiles.rail, "rail").inclined(scene.profiles.laying_angle)
    except ValueError as error:
        raise SceneError(f"profiles: {error}") from error


def wheel_scale(scene: WheelsetScene, load: float) -> float:
    """Initial guess of the approach for a wheel load N, m: that of a sphere of rail-head radius, R = 0.3 m."""
    from wheelrail.contact.loading.hertz import sphere_approach

    return sphere_approach(load, radius=0.3, modulus=0.5 * scene.E / (1.0 - scene.nu**2))


def wheelset_state(scene: WheelsetScene) -> WheelsetState:
    """Position and velocities of the wheelset; height and roll to be solved for are zero."""
    from wheelrail.contact.kinematics.wheelset_state import WheelsetState

    position = scene.wheelset
    return WheelsetState(
        y=position.y,
        z=position.z or 0.0,
        roll=0.0 if position.roll == "solve" else position.roll,
        yaw=position.yaw,
        y_rate=position.y_rate,
        z_rate=position.z_rate,
        roll_rate=position.roll_rate,
        yaw_rate=position.yaw_rate,
        pitch_rate=position.pitch_rate or 0.0,
        speed=position.speed or 0.0,
        frame_rate=(0.0, 0.0, (position.speed or 0.0) * scene.track.curvature),
    )
