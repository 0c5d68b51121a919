"""Contact on strips at several places of their lattice on the wheel, over which slopes of forces are averaged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.wheelset import ContactModel
from wheelrail.contact.results.vehicle_contact import ContactsByWheelset, VehicleContact


def at_places(contact: VehicleContact, count: int) -> Sequence[VehicleContact]:
    """The contact with its strips at a number of places, evenly over the width of a strip; itself if it has none.

    Parameters:
        contact: with the attributes `model` and `changed`, as that of a wheelset and that of moving hubs and rails, or
            any other, which has no strips.
        count: number of places.

    The slope of the force on strips ripples with their place on the wheel, where one comes or goes; its mean over the
    places is that of narrower strips.
    """
    if isinstance(contact, ContactsByWheelset):
        moves = any(len(at_places(own, count)) > 1 for own in (contact.default, *contact.own.values()))
    else:
        moves = isinstance(getattr(contact, "model", None), LatticeContact)
    return [_at(contact, k / count) for k in range(count)] if moves else [contact]


def _at(contact: Any, offset: float) -> VehicleContact:
    """The contact with its strips, if there are any, moved by a part of their width."""
    if isinstance(contact, ContactsByWheelset):
        return contact.changed(partial(_at, offset=offset))
    changed = getattr(contact, "changed", None)
    return contact if changed is None else changed(partial(_moved, offset=offset))  # type: ignore[no-any-return]


def _moved(model: ContactModel, offset: float) -> ContactModel:
    return replace(model, offset=offset) if isinstance(model, LatticeContact) else model
