"""Contacts of flange backs and check rails, added to the contacts of wheels and running rails."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from wheelrail.scenes.schema.errors import SceneError

if TYPE_CHECKING:
    from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
    from wheelrail.contact.models.wheelset import WheelsetContact
    from wheelrail.contact.results.vehicle_contact import VehicleContact
    from wheelrail.meshes.profiles.profile import Profile
    from wheelrail.scenes.schema.profiles import Side
    from wheelrail.scenes.schema.scene import OnRails, RunScene


def with_check_rails(
    scene: RunScene, profiles: Mapping[int, Mapping[str, tuple[Profile, Profile]]], contacts: Mapping[int, Any]
) -> Mapping[int, VehicleContact]:
    """Contacts of a run with the contacts of its check rails, if there are any.

    Parameters:
        scene: of the run.
        profiles: of wheel and inclined rail by table of a contact and side.
        contacts: by table of a contact; with moving hubs and rails where these are elastic, check rails on the rails.

    Raises SceneError.
    """
    table = scene.track.check_rail
    if table is None:
        return contacts
    from wheelrail.contact.loading.flexible_contact import FlexibleContact
    from wheelrail.contact.results.added_contact import AddedContact

    out: dict[int, VehicleContact] = {}
    for named in (scene, *(scene.contacts or {}).values()):
        contact, pairs = contacts[id(named)], profiles[id(named)]
        moving = isinstance(contact, FlexibleContact)
        rigid = contact.contact if moving else contact
        made = {side: _side(scene, named, side, pairs[side][0], rigid.of(side).mounting) for side in table.sides}
        added = replace(next(iter(made.values())), right=made.get("right"))
        if moving:
            out[id(named)] = AddedContact(contact, FlexibleContact(added, contact.flexibility), table.sides)
        else:
            out[id(named)] = AddedContact(contact, added, table.sides, partial(_clears, made))
    return out


def _clears(made: Mapping[Side, WheelsetContact], state: WheelsetState, side: Side) -> bool:
    """Whether the check rail of a side is too far from a wheelset; made: contacts by side."""
    own = made[side]
    return own.model.clears(own.mounting, state, side)  # type: ignore[attr-defined,no-any-return]


def _side(scene: RunScene, named: OnRails, side: Side, wheel: Profile, mounting: Mounting) -> WheelsetContact:
    """Contact of the flange back of one side, as of a left-hand pair."""
    from wheelrail.contact.analytical.hertz import modulus
    from wheelrail.contact.geometry.flange_back import CheckRail, FlangeBack
    from wheelrail.contact.models.check_rail import CheckRailContact
    from wheelrail.contact.models.wheelset import WheelsetContact

    table, own = scene.track.check_rail, named.side(side)
    assert table is not None
    y, radius = named.wheelset.flange_back, own.radius
    assert radius is not None
    if table.back_height is None or table.back_rounding is None:
        try:
            back = FlangeBack.of(wheel, y)
        except ValueError as error:
            raise SceneError(f"track.check_rail.back_rounding: required, with back_height: {error}") from None
    else:
        back = FlangeBack(y, table.back_height, table.back_rounding)
    face = 0.5 * named.track.gauge - table.flangeway - mounting.rail_y
    rail = CheckRail(face, table.height, table.rounding, table.stiffness)
    friction = own.friction if table.friction is None else table.friction
    assert isinstance(friction, float)
    steel = named.E, named.nu
    return WheelsetContact(CheckRailContact(back, rail, radius, modulus(steel, steel), friction), mounting)
