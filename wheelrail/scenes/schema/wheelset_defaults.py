"""Keys left out in tables of a scene: defaults of a wheelset scene, and the scene's own ones for contacts by name.

The defaults are equal to those of `wheelrail.Wheelset`: `kind = "wheelset"` alone is a scene.
"""

from __future__ import annotations

from collections.abc import Container, Mapping
from typing import Any

from wheelrail.scenes.schema import quantities as q
from wheelrail.scenes.schema.profiles import BODIES, OF_FILES, SIDES

UPRIGHT = ("60E1", "UIC60")  # profiles that are given upright
INCLINED = 0.025  # rad, 1/40: their inclination
WITHOUT_ELEMENTS = ("standard", "table")  # models
LOADS = ("wheel_load", "axle_load", "z")

SCENE = {"friction": 0.3, "E": 2.1e11, "nu": 0.3}
PROFILES = {"wheel": "S1002", "rail": "UIC60"}
TRACK = {"gauge": 1.435, "gauge_height": 0.014, "curvature": 0.0}
WHEELSET = {"flange_back_distance": 1.360, "flange_back": -0.070, "radius": 0.46, "y": 0.0, "roll": 0.0, "yaw": 0.0}
LOAD, SPEED, SURFACE_SIZE = 57e3, 10.0, 1e-3  # N, m/s, m

MODEL = "condensed"  # the default
OF_VEHICLE = ("wheelset", "track")  # tables that are those of the scene
# Keys of a scene for contacts by another model.
OF_ALL_MODELS = (*OF_VEHICLE, "friction", "falling", "laws", "surface_size", "E", "nu", "profiles")


def with_defaults(data: Mapping[str, Any]) -> dict[str, Any]:
    """Tables of a scene with the keys that are missing; values of another type are left to the validation."""
    scene = {**SCENE, **data}
    if scene.get("model") not in WITHOUT_ELEMENTS:
        scene.setdefault("surface_size", SURFACE_SIZE)
    if isinstance(table := scene.get("profiles", {}), Mapping):
        scene["profiles"] = _profiles(table)
    if isinstance(table := scene.get("track", {}), Mapping):
        scene["track"] = {**TRACK, **table}
    if isinstance(table := scene.get("wheelset", {}), Mapping):
        scene["wheelset"] = _wheelset(table, frictional=_frictional(scene), flexible=_is_flexible(scene))
    return scene


def _is_flexible(scene: Mapping[str, Any]) -> bool:
    """Whether the axle bends or the rails move on pads."""
    tables = (scene.get("wheelset", {}), "axle"), (scene.get("track", {}), "pads")
    return any(isinstance(table, Mapping) and table.get(key) not in (None, False) for table, key in tables)


def _profiles(table: Mapping[str, Any]) -> Mapping[str, Any]:
    profiles = {**PROFILES, **table}
    profiles.setdefault("laying_angle", inclination(profiles["rail"]))
    for side in ("left", "right"):
        own = table.get(side)
        if isinstance(own, Mapping) and "rail" in own:
            profiles[side] = {"laying_angle": inclination(own["rail"]), **own}
    return profiles


def inclination(rail: object) -> float:
    """Inclination rad of a rail, zero unless its profile is given upright."""
    return INCLINED if rail in UPRIGHT else 0.0


def _frictional(scene: Mapping[str, Any]) -> bool:
    """Whether there is friction on either side."""
    profiles = scene["profiles"] if isinstance(scene["profiles"], Mapping) else {}
    sides = [profiles.get(side) for side in ("left", "right")]
    own = [side["friction"] for side in sides if isinstance(side, Mapping) and "friction" in side]
    return any(friction != 0.0 for friction in (scene["friction"], *own))


def _wheelset(table: Mapping[str, Any], *, frictional: bool, flexible: bool) -> Mapping[str, Any]:
    wheelset = {**WHEELSET, **table}
    if not any(key in wheelset for key in LOADS):
        wheelset["wheel_load"] = LOAD
    if flexible and "roll" not in table and "wheel_load" in wheelset:
        wheelset["roll"] = "solve"  # one wheelset cannot have a height for each wheel
    if frictional:
        wheelset.setdefault("speed", SPEED)
    speed, radius = wheelset.get("speed"), wheelset["radius"]
    if isinstance(speed, float | int) and isinstance(radius, float | int) and radius:
        wheelset.setdefault("pitch_rate", speed / radius)
    return wheelset


def with_contacts(scene: Mapping[str, Any], keys: Container[str], rails: Container[str]) -> dict[str, Any]:
    """Tables of a scene whose `contacts` are complete; values of another type are left to the validation.

    Parameters:
        scene: tables.
        keys: of a contact.
        rails: keys of its track.
    """
    shared = {key: value for key, value in scene.items() if key in keys}
    if isinstance(track := shared.get("track"), Mapping):
        shared["track"] = {key: value for key, value in track.items() if key in rails}
    contacts = dict[str, Any]()
    for name, own in scene["contacts"].items():
        if isinstance(own, Mapping):
            if given := [key for key in OF_VEHICLE if key in own]:
                raise q.reject("not allowed; that of the scene is used", f"contacts.{name}.{given[0]}")
            contacts[name] = _own_contact(own, shared)
        else:
            contacts[name] = own
    return {**scene, "contacts": contacts}


def _own_contact(own: Mapping[str, Any], scene: Mapping[str, Any]) -> dict[str, Any]:
    """Table of a contact with its missing keys from the scene."""
    other = "model" in own and own["model"] != scene.get("model", MODEL)
    shared = {key: value for key, value in scene.items() if not other or key in OF_ALL_MODELS}
    result = {**shared, **own}
    if isinstance(profiles := shared.get("profiles"), Mapping):
        result["profiles"] = _own_profiles(own, profiles)
    return result


def _own_profiles(own: Mapping[str, Any], scene: Mapping[str, Any]) -> Any:
    """Profiles of a contact; what it gives for both sides takes the place of what the scene gives for one."""
    profiles = own.get("profiles", {})
    if not isinstance(profiles, Mapping):
        return profiles
    given = {*profiles, *(key for key in ("friction", "radius") if key in own)}
    replaced = given.union(*(_of_file(body) for body in BODIES if body in profiles))
    result = {**_without(scene, replaced), **profiles}
    for side in SIDES:
        mine, theirs = profiles.get(side), scene.get(side)
        if not isinstance(theirs, Mapping) or not isinstance(mine, Mapping | None):
            continue
        mine = mine or {}
        result[side] = {**_without(theirs, replaced.union(*(_of_file(b) for b in BODIES if b in mine))), **mine}
    return result


def _of_file(body: str) -> set[str]:
    """Keys on reading the file of a body alone, which do not fit another file."""
    return {key for key, bodies in OF_FILES.items() if bodies == (body,)}


def _without(table: Mapping[str, Any], keys: Container[str]) -> dict[str, Any]:
    return {key: value for key, value in table.items() if key not in keys}
