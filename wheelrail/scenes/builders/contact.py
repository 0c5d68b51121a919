"""Contact models that a scene asks for. Everything heavy is imported when a model is built, not before."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Protocol

from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import HertzScene, RunScene, WheelsetScene

if TYPE_CHECKING:
    from wheelrail.contact.geometry.rigid_surfaces import RigidPair
    from wheelrail.contact.kinematics.frames import Pose, RigidMotion
    from wheelrail.contact.kinematics.wheelset_state import Mounting
    from wheelrail.contact.laws.parameters import ContactLaws
    from wheelrail.contact.models.fitted.resolution import Resolution
    from wheelrail.contact.models.wheelset import ContactModel, WheelsetContact
    from wheelrail.contact.stress.subsurface import LoadedBody
    from wheelrail.meshes.profiles.profile import Profile


class Material(Protocol):
    """What has Young's modulus Pa and Poisson's ratio."""

    @property
    def E(self) -> float: ...
    @property
    def nu(self) -> float: ...


def laws(scene: HertzScene | WheelsetScene | RunScene) -> ContactLaws:
    """Penalty pressure and regularised Coulomb friction with the scene's constants, or the exact laws; of these the
    standard contact takes the friction.
    """
    from wheelrail.contact.laws.parameters import ContactLaws, FallingFriction

    falling = None if scene.falling is None else FallingFriction(scene.falling.share, scene.falling.rate)
    if scene.laws == "exact" or scene.model == "standard":
        return ContactLaws(friction=scene.friction, falling=falling)
    return ContactLaws(scene.stiffness_per_area, scene.friction, scene.regularisation, falling)


def hertz_model(scene: HertzScene) -> ContactModel:
    """The pair of bodies of a Hertz scene."""
    from wheelrail.contact.laws.material import Material

    if scene.model == "standard":
        from wheelrail.contact.geometry.rigid_surfaces import RigidQuadrics

        return _standard(scene, RigidQuadrics(scene.upper.radii, scene.lower.radii), scene.upper, scene.lower)
    from wheelrail.contact.models.builders import hertz_pair

    assert scene.surface_size is not None
    return hertz_pair(
        scene.upper.radii,
        scene.lower.radii,
        upper_steel=Material(scene.upper.E, scene.upper.nu),
        lower_steel=Material(scene.lower.E, scene.lower.nu),
        load=scene.load,
        approach=scene.approach,
        surface_size=scene.surface_size,
        laws=laws(scene),
        model=scene.model,
        bodies=scene.meshes,
        cell=scene.cell,
        degree=scene.degree,
        order=scene.slip_order,
        points=scene.placing,
        **({} if scene.shift is None else {"tangential": "shift"}),
        **_fineness(scene),
    )


def hertz_motion(scene: HertzScene) -> RigidMotion:
    """Material of both bodies flows backwards through the contact at the speed, the upper one's creepage faster.

    The creepage is shared, so that the mean of both velocities is the speed itself. Zero for a frictionless scene that
    gives no motion; for a shift, both bodies' displacements instead.
    """
    import numpy as np

    from wheelrail.contact.kinematics.frames import RigidMotion, Twist

    if scene.shift is not None:
        push, still = 0.5 * np.array([*scene.shift, 0.0]), np.zeros(3)
        return RigidMotion(Twist(push, still, still), Twist(-push, still, still))
    speed, (xi, eta, phi) = scene.speed or 0.0, scene.creepage or (0.0, 0.0, 0.0)
    flow, slip, origin = np.array([-speed, 0.0, 0.0]), speed * np.array([xi, eta, 0.0]), np.zeros(3)
    spin = np.array([0.0, 0.0, speed * phi])
    return RigidMotion(Twist(flow + 0.5 * slip, 0.5 * spin, origin), Twist(flow - 0.5 * slip, -0.5 * spin, origin))


def hertz_scale(scene: HertzScene, load: float) -> float:
    """Approach m at which to look for the load: Hertz's for a sphere of the mean relative curvature."""
    from wheelrail.contact.loading.hertz import sphere_approach

    curvature = sum(1.0 / radius for body in (scene.upper, scene.lower) for radius in body.radii)
    modulus = 1.0 / sum((1.0 - body.nu**2) / body.E for body in (scene.upper, scene.lower))
    return sphere_approach(load, radius=2.0 / curvature, modulus=modulus)


def wheelset_contact(scene: WheelsetScene | RunScene, profiles: Sequence[Profile] | None = None) -> WheelsetContact:
    """Both wheels of a wheelset on the rails of the scene's track; one model serves both sides.

    profiles: wheel, and rail as laid, the scene's own unless given. Raises SceneError for a profile that cannot be
    read, or a rail without the gauge's height.
    """
    from wheelrail.contact.laws.material import Material
    from wheelrail.contact.models.wheelset import WheelsetContact

    axle, steel = scene.wheelset, Material(scene.E, scene.nu)
    wheel, rail = profiles or laid_profiles(scene)
    mounting = mounted(scene, rail)
    if scene.model == "standard":
        from wheelrail.contact.geometry.rigid_surfaces import MERGE, RigidWheelRail

        merge = MERGE if scene.merge_distance is None else scene.merge_distance
        rigid = RigidWheelRail(wheel, rail, axle.radius, merge)
        return WheelsetContact(_standard(scene, rigid, scene, scene), mounting)
    from wheelrail.contact.models.builders import wheel_rail_pair

    assert scene.surface_size is not None
    model = wheel_rail_pair(
        wheel,
        rail,
        radius=axle.radius,
        wheel_steel=steel,
        rail_steel=steel,
        surface_size=scene.surface_size,
        laws=laws(scene),
        model=scene.model,
        bodies=scene.meshes,
        cell=scene.cell,
        degree=scene.degree,
        order=scene.slip_order,
        points=scene.placing,
        **({"warm": True} if scene.kind == "run" and scene.placing == "fitted" else {}),
        **_fineness(scene),
    )
    return WheelsetContact(model, mounting)


def mounted(scene: WheelsetScene | RunScene, rail: Profile) -> Mounting:
    """How wheels sit on the axle and rails, as laid, in the track. Raises SceneError for a rail without the gauge's
    height.
    """
    from wheelrail.contact.kinematics.wheelset_state import Mounting

    axle, track = scene.wheelset, scene.track
    try:
        rail_y = rail.gauge_offset(track.gauge, track.gauge_height)
    except ValueError as error:
        raise SceneError(f"profiles: {error}") from error
    return Mounting(0.5 * axle.flange_back_distance - axle.flange_back, rail_y, axle.radius)


def _standard(
    scene: HertzScene | WheelsetScene | RunScene, surfaces: RigidPair, upper: Material, lower: Material
) -> ContactModel:
    """The contact of multibody codes."""
    from wheelrail.contact.laws.material import Material
    from wheelrail.contact.models.standard.model import StandardContact

    given = {key: value for key in ("normal", "tangential") if (value := getattr(scene, key)) is not None}
    above, below = (Material(body.E, body.nu) for body in (upper, lower))
    return StandardContact(surfaces, laws(scene), above, below, **given)


def laid_profiles(scene: WheelsetScene | RunScene) -> tuple[Profile, Profile]:
    """Profiles of wheel and rail, the rail as laid. Raises SceneError for one that cannot be read."""
    from wheelrail.meshes.profiles.library import load_profile

    try:
        wheel = load_profile(scene.profiles.wheel, "wheel")
        return wheel, load_profile(scene.profiles.rail, "rail").laid(scene.profiles.laying_angle)
    except ValueError as error:
        raise SceneError(f"profiles: {error}") from error


def stressed_bodies(
    scene: HertzScene | WheelsetScene, pose: Pose, profiles: Sequence[Profile] | None = None
) -> dict[str, LoadedBody]:
    """The bodies inside which the scene asks for stresses, by name; pose of the upper one (of the left pair).

    profiles as for `wheelset_contact`.
    """
    return {} if scene.stress is None else loaded_bodies(scene, pose, scene.stress.bodies, profiles)


def loaded_bodies(
    scene: HertzScene | WheelsetScene, pose: Pose, names: Iterable[str], profiles: Sequence[Profile] | None = None
) -> dict[str, LoadedBody]:
    """Bodies of a scene as ones that its tractions load: "upper" and "lower", or "wheel" and "rail"."""
    from wheelrail.contact.laws.material import Material
    from wheelrail.contact.stress.subsurface import LoadedBody

    if isinstance(scene, HertzScene):
        pair = {"upper": scene.upper, "lower": scene.lower}
        return {name: LoadedBody.block(name == "upper", Material(pair[name].E, pair[name].nu)) for name in names}
    from wheelrail.meshes.bodies.outlines import rail_outline, wheel_outline

    steel = Material(scene.E, scene.nu)
    wheel, rail = profiles or laid_profiles(scene)
    made = {
        "wheel": lambda: LoadedBody.wheel(wheel_outline(wheel, scene.wheelset.radius), steel, pose),
        "rail": lambda: LoadedBody.rail(rail_outline(rail), steel),
    }
    return {name: made[name]() for name in names}


def _fineness(scene: HertzScene | WheelsetScene | RunScene) -> dict[str, Resolution]:
    """Strips and cells of fitted points, where the scene gives any."""
    given = {key: value for key in ("strips", "cells") if (value := getattr(scene, key)) is not None}
    if not given:
        return {}
    from wheelrail.contact.models.fitted.resolution import Resolution

    return {"fineness": Resolution(**given)}


def wheel_scale(scene: WheelsetScene, load: float) -> float:
    """Approach m at which to look for a wheel load: that of a sphere as curved as a rail head, R = 0.3 m."""
    from wheelrail.contact.loading.hertz import sphere_approach

    return sphere_approach(load, radius=0.3, modulus=0.5 * scene.E / (1.0 - scene.nu**2))
