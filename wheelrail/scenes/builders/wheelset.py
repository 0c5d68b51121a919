"""Contact model of a wheelset on the scene's track. Heavy packages are imported only when a model is built."""

from __future__ import annotations

import logging
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

from wheelrail.scenes.builders.check_rail import with_check_rails
from wheelrail.scenes.builders.laws import laws, material, standard_contact
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.profiles import Side
from wheelrail.scenes.schema.scene import OnRails, RunScene, WheelsetScene
from wheelrail.scenes.schema.tables import PadsTable

if TYPE_CHECKING:
    from wheelrail.contact.geometry.first_contact import RigidWheelset
    from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
    from wheelrail.contact.loading.flexible_contact import FlexibleContact, FlexiblePairs
    from wheelrail.contact.loading.flexible_wheelset import Flexibility
    from wheelrail.contact.loading.structure import Structure
    from wheelrail.contact.models.wheelset import WheelsetContact
    from wheelrail.contact.results.vehicle_contact import VehicleContact
    from wheelrail.contact.structure.ballast import CoRunningTrack
    from wheelrail.contact.structure.hubs import HubCompliance
    from wheelrail.contact.structure.pads import RailCompliance, RailPads
    from wheelrail.meshes.profiles.profile import Profile

log = logging.getLogger(__name__)

K = TypeVar("K", bound=Hashable)
SideProfiles = Mapping[str, "tuple[Profile, Profile]"]  # of wheel and inclined rail by side


def wheelset_contact(
    scene: OnRails, profiles: SideProfiles | None = None, models: dict[Any, Any] | None = None
) -> WheelsetContact:
    """Contact model of both wheels of a wheelset on the track of the scene; one model serves two sides that are alike.

    Parameters:
        scene: of a wheelset, of a run, or a contact of some wheelsets.
        profiles: of wheel and inclined rail by side; those of the scene by default.
        models: made so far, by all but their laws; those of the same bodies share these.

    Raises SceneError for a profile that cannot be read, or a rail that does not extend to the gauge height.
    """
    pairs = profiles or side_profiles(scene)
    made = {} if models is None else models
    left = _side_contact(scene, "left", pairs["left"], made)
    return left if _alike(scene, pairs) else replace(left, right=_side_contact(scene, "right", pairs["right"], made))


def _alike(scene: OnRails, pairs: SideProfiles) -> bool:
    """Whether one model serves both sides: those of the scene, and the profiles given in place of its own."""
    return scene.sides_alike and all(a is b for a, b in zip(pairs["left"], pairs["right"], strict=True))


def _side_contact(scene: OnRails, side: Side, pair: tuple[Profile, Profile], models: dict[Any, Any]) -> WheelsetContact:
    """Contact model of the pair of one side, as a left-hand pair, on both sides."""
    from wheelrail.contact.models.wheelset import WheelsetContact

    mounting, radius = mounted(scene, pair[1]), scene.side(side).radius
    assert radius is not None
    if scene.model == "standard":
        from wheelrail.contact.geometry.rigid_surfaces import MERGE, RigidWheelRail

        merge = MERGE if scene.merge_distance is None else scene.merge_distance
        rigid = RigidWheelRail(*pair, radius, merge)
        return WheelsetContact(standard_contact(scene, rigid, scene, scene, side), mounting)
    if scene.model == "table":
        from wheelrail.scenes.builders.table import table_contact

        return WheelsetContact(table_contact(scene, side, pair, mounting), mounting)
    from wheelrail.contact.models.builders import wheel_rail_pair, with_laws

    materials, own = (material(scene), material(scene)), laws(scene, side)
    key = (*(profile.digest() for profile in pair), radius, scene.E, scene.nu, scene.discretisation)
    if key in models:
        return WheelsetContact(with_laws(models[key], own), mounting)
    models[key] = wheel_rail_pair(pair, radius, materials, own, scene.discretisation)
    return WheelsetContact(models[key], mounting)


def run_contact(scene: RunScene, wheelsets: Sequence[str]) -> tuple[VehicleContact, Sequence[Structure | None] | None]:
    """Contact of a run, and axle and rails of each of its wheelsets by name; None where all are rigid.

    Errors as for `wheelset_contact`.
    """
    profiles, contacts = dict[int, SideProfiles](), dict[int, Any]()  # by contact of the scene
    models = dict[Any, Any]()
    for named in (scene, *(scene.contacts or {}).values()):
        profiles[id(named)] = side_profiles(named)
        contacts[id(named)] = wheelset_contact(named, profiles[id(named)], models)
        if named.model == "table":
            log.info("%s: %s", named.table, contacts[id(named)].model.table)
        if scene.tabulated is not None and named.has_elements:
            from wheelrail.scenes.builders.demanded_table import tabulated

            contacts[id(named)] = tabulated(scene, named, contacts[id(named)], profiles[id(named)])
        if scene.track.friction is not None:
            try:
                contacts[id(named)].rubbing(1.0)
            except ValueError as error:
                raise SceneError(f"track.friction: {error}") from None
    if not scene.is_flexible:
        return _by_wheelset(scene, with_check_rails(scene, profiles, contacts)), None
    own = {name: id(scene.contact_of(name)) for name in wheelsets}
    moving, structures = on_structures(scene, own, profiles, contacts)
    return _by_wheelset(scene, with_check_rails(scene, profiles, moving)), structures


def on_structures(
    scene: RunScene, own: Mapping[str, K], profiles: Mapping[K, SideProfiles], contacts: Mapping[K, WheelsetContact]
) -> tuple[dict[K, FlexibleContact], tuple[Structure | None, ...]]:
    """Contacts of moving hubs and rails by key, and axle and rails of each wheelset; None where both are rigid.

    Parameters:
        scene: with elastic axles or tracks.
        own: key of the contact of each wheelset by name.
        profiles, contacts: by key.

    Raises SceneError for an axle that does not fit the wheels.
    """
    from wheelrail.contact.loading.flexible_contact import FlexibleContact
    from wheelrail.contact.loading.flexible_wheelset import Flexibility

    scenes = [(scene.on_wheelset(name), key) for name, key in own.items()]
    kinds = {(on.elastic_keys, key): on for on, key in scenes}
    of = {(keys, key): flexibility(on, profiles[key]) for (keys, key), on in kinds.items()}
    moving = dict[K, FlexibleContact]()
    for key, contact in contacts.items():
        # Of its flexibility the contact takes the feet of the rails, which do not depend on their supports.
        on_feet = (flexible for (_, other), flexible in of.items() if other == key and flexible.rails is not None)
        moving[key] = FlexibleContact(contact, next(on_feet, Flexibility()))
    structures = {
        (keys, key): _structure(on, profiles[key], replace(moving[key].pairs, flexibility=of[keys, key]))
        for (keys, key), on in kinds.items()
    }
    return moving, tuple(structures[on.elastic_keys, key] for on, key in scenes)


def _by_wheelset(scene: RunScene, contacts: Mapping[int, VehicleContact]) -> VehicleContact:
    """Contact of a scene, by wheelset if there are several; contacts: models by the table of a contact."""
    if not scene.contacts:
        return contacts[id(scene)]
    from wheelrail.contact.results.vehicle_contact import ContactsByWheelset

    own = {name: contacts[id(named)] for named in scene.contacts.values() for name in named.wheelsets}
    return ContactsByWheelset(contacts[id(scene)], own)


def _structure(scene: RunScene, profiles: SideProfiles, pairs: FlexiblePairs) -> Structure | None:
    """Axle and rails of a run with the same ones for all wheelsets; None where both are rigid."""
    from wheelrail.contact.loading.co_running_structure import CoRunningStructure
    from wheelrail.contact.loading.quasi_static_structure import QuasiStaticStructure

    if not scene.is_flexible:
        return None
    if scene.track.ballast is None:
        return QuasiStaticStructure(pairs)
    tracks, mirrored = _with_mass(scene, profiles)
    assert tracks is not None
    return CoRunningStructure(pairs, tracks=tracks, mirrored_tracks=mirrored)


def element_contact(
    scene: WheelsetScene, contact: WheelsetContact, profiles: SideProfiles, host: Sequence[str]
) -> VehicleContact:
    """Contact of an element, with axle and rails quasi-static or moved by the host.

    Parameters:
        scene: of a wheelset.
        contact: of both sides.
        profiles: of wheel and inclined rail by side.
        host: bodies whose motions are given, of "axle", "wheels" and "rails".

    Raises SceneError.
    """
    if not scene.is_flexible and not host:
        return contact
    if scene.track.sleepers is not None:
        raise SceneError("track.sleepers: not allowed in an element, which has no place along the track")
    own = {"axle": scene.wheelset.axle, "wheels": scene.wheelset.axle, "rails": scene.track.pads}
    for name in host:
        if name not in own:
            raise SceneError(f"element: host: {name!r}: must be axle, wheels or rails")
        if own[name] is not None:
            raise SceneError(f"element: host: {name!r}: not allowed with axle or pads of the wheelset itself")
    if not scene.has_elements or scene.discretisation.bodies == "solid":
        raise SceneError('element: host: allowed only with bodies = "waveguide" or "half-space"')
    from wheelrail.contact.loading.flexible_wheelset import FlexibleWheelset
    from wheelrail.contact.loading.quasi_static_contact import QuasiStaticContact

    moving = _with_host(scene, flexibility(scene, profiles), profiles, host)
    return QuasiStaticContact(FlexibleWheelset(contact, moving, on_hubs=scene.wheelset.axle is not None))


def _with_host(scene: WheelsetScene, own: Flexibility, profiles: SideProfiles, host: Sequence[str]) -> Flexibility:
    """Flexibility without the compliance that clamped elastic bodies and the host would both contribute."""
    from wheelrail.contact.structure.pads import RailPads
    from wheelrail.contact.structure.rim import rim_compliance
    from wheelrail.contact.structure.section_motion import section_motion
    from wheelrail.meshes.bodies.outlines import rail_outline, wheel_outline

    steel, clamped = material(scene), scene.discretisation.bodies == "waveguide"
    if "wheels" in host and clamped:
        own = replace(own, hubs=rim_compliance(wheel_outline(profiles["left"][0], scene.wheelset.radius), steel))
    if "rails" in host:
        factor = 1.0 if clamped else 0.0  # half-spaces have no motion as a whole
        left, right = (
            section_motion(rail_outline(profiles[side][1]), steel, RailPads()).removed for side in ("left", "right")
        )
        rails = replace(left, matrix=factor * left.matrix), replace(right, matrix=factor * right.matrix)
        own = replace(own, rails=rails)
    return own


def rigid_wheelset(scene: OnRails, profiles: SideProfiles | None = None) -> RigidWheelset:
    """Rigid surfaces of both sides and their mounting; parameters and errors as for `wheelset_contact`."""
    from wheelrail.contact.geometry.first_contact import RigidWheelset
    from wheelrail.contact.geometry.rigid_surfaces import RigidWheelRail

    pairs = profiles or side_profiles(scene)

    def on(side: Side) -> RigidWheelset:
        radius = scene.side(side).radius
        assert radius is not None
        return RigidWheelset(RigidWheelRail(*pairs[side], radius), mounted(scene, pairs[side][1]))

    return on("left") if _alike(scene, pairs) else replace(on("left"), right=on("right"))


def flexibility(scene: OnRails, profiles: SideProfiles) -> Flexibility:
    """Compliance of the axle and of the rails on their pads; where the wheels differ, that of two left-hand ones.

    Raises SceneError for an axle that does not fit the wheels.
    """
    from wheelrail.contact.loading.flexible_wheelset import Flexibility
    from wheelrail.contact.structure.pads import rail_compliance
    from wheelrail.contact.structure.sleepers import sleeper_compliance
    from wheelrail.meshes.bodies.outlines import rail_outline

    rails: tuple[RailCompliance, RailCompliance] | None = None
    mirrored: tuple[RailCompliance, RailCompliance] | None = None
    steel, pads, sleepers = material(scene), scene.track.pads, scene.track.sleepers
    if pads is not None:
        supports = _pads(pads)

        def on_pads(side: Side) -> RailCompliance:
            outline = rail_outline(profiles[side][1])
            if sleepers is None:
                return rail_compliance(outline, steel, supports)
            return sleeper_compliance(outline, steel, supports, sleepers.length)

        if scene.track.ballast is not None:
            rails, mirrored = (tracks and (tracks[0].rail, tracks[1].rail) for tracks in _with_mass(scene, profiles))
        else:
            left = on_pads("left")
            rails = left, left if profiles["left"] is profiles["right"] else on_pads("right")
    hubs = None if scene.wheelset.axle is None else _hubs(scene, profiles["left"])
    return Flexibility(hubs, rails, 0.0 if sleepers is None else sleepers.position, mirrored)


def _pads(table: PadsTable) -> RailPads:
    """Pads of a scene."""
    from wheelrail.contact.structure.pads import RailPads

    return RailPads(table.vertical, table.lateral, table.longitudinal, table.spacing)


def _with_mass(scene: OnRails, profiles: SideProfiles) -> list[tuple[CoRunningTrack, CoRunningTrack] | None]:
    """Tracks under both wheels with the masses of rail and sleepers: under loads to the same side, and under mirrored
    loads; None for the latter where both rails have sleepers of their own.
    """
    from wheelrail.contact.structure.ballast import Ballast, co_running_track
    from wheelrail.contact.structure.ballasted_sleepers import sleeper_track
    from wheelrail.meshes.bodies.outlines import rail_outline

    pads, table, sleepers = scene.track.pads, scene.track.ballast, scene.track.sleepers
    assert pads is not None
    assert table is not None
    halves = Ballast(table.sleeper_mass, table.vertical, table.lateral, table.pad_damping, table.damping)

    def on(side: Side, ballast: Ballast) -> CoRunningTrack:
        layers = rail_outline(profiles[side][1]), material(scene), _pads(pads), ballast
        return co_running_track(*layers) if sleepers is None else sleeper_track(*layers, sleepers.length)

    def both(ballast: Ballast) -> tuple[CoRunningTrack, CoRunningTrack]:
        left = on("left", ballast)
        return left, left if profiles["left"] is profiles["right"] else on("right", ballast)

    if table.length == "halves":
        return [both(halves), None]
    return [both(ballast) for ballast in halves.rigid(table.length, mounted(scene, profiles["left"][1]).rail_y)]


def _hubs(scene: OnRails, pair: tuple[Profile, Profile]) -> HubCompliance:
    """Compliance of the hubs of the scene's axle."""
    from wheelrail.contact.structure.hubs import hub_compliance
    from wheelrail.meshes.bodies.axle import AxleShape
    from wheelrail.meshes.bodies.outlines import wheel_outline

    table, mounting = scene.wheelset.axle, mounted(scene, pair[1])
    assert table is not None
    try:
        if table.steps is None or table.journal is None:
            axle = replace(AxleShape.typical(table.diameter or 0.160, mounting.wheel_y), bore=table.bore)
        else:
            axle = AxleShape(table.steps, table.journal, table.bore)
        outline = wheel_outline(pair[0], mounting.radius)
        return hub_compliance(outline, axle, material(scene), wheel_y=mounting.wheel_y, weight=table.weight)
    except ValueError as error:
        raise SceneError(f"wheelset.axle: {error}") from error


def mounted(scene: OnRails, rail: Profile) -> Mounting:
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


def side_profiles(scene: OnRails) -> SideProfiles:
    """Profiles of wheel and inclined rail by side, with a log message for each profile from a file.

    Raises SceneError for one that cannot be read, and for a gauge into which the flanges do not fit.
    """
    left = inclined_profiles(scene)
    pairs = {"left": left, "right": left if scene.sides_alike else inclined_profiles(scene, "right")}
    axle, gauge = scene.wheelset, scene.track.gauge
    thickness = [pair[0].measures(flange_back=axle.flange_back).Sd for pair in pairs.values()]  # type: ignore[union-attr]
    width = axle.flange_back_distance + sum(thickness)  # NaN without flanges
    if gauge < width:
        text = f"must be at least {width:.4f} m, the width of the wheelset over its flanges"
        raise SceneError(f"track.gauge = {gauge:g}: {text}")
    measurements = (profile.measurement for pair in pairs.values() for profile in pair)
    for message in dict.fromkeys(str(measurement) for measurement in measurements if measurement is not None):
        log.info("%s", message)
    return pairs


def inclined_profiles(scene: OnRails, side: Side = "left") -> tuple[Profile, Profile]:
    """Profiles of wheel and inclined rail of one side. Raises SceneError for one that cannot be read."""
    angle = scene.side(side).laying_angle
    assert angle is not None
    try:
        return scene.profiles.profile(side, "wheel"), scene.profiles.profile(side, "rail").inclined(angle)
    except ValueError as error:
        raise SceneError(f"profiles: {error}") from error


def wheel_scale(scene: WheelsetScene | RunScene, load: float) -> float:
    """Initial guess of the approach for a wheel load N, m: that of a sphere of rail-head radius."""
    from wheelrail.bindings._contact import sphere_approach

    return sphere_approach(load, *wheel_sphere(scene.E, scene.nu))


def wheel_sphere(E: float, nu: float) -> tuple[float, float]:
    """Radius m of a sphere whose approach is about that of a wheel, and its contact modulus Pa."""
    return 0.3, 0.5 * E / (1.0 - nu**2)


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
