"""Contact on strips at several places of their lattice on the wheel, over which slopes of forces are averaged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.wheelset import ContactModel, WheelsetContact
from wheelrail.contact.results.vehicle_contact import ContactsByWheelset, VehicleContact


def at_places(contact: VehicleContact, count: int) -> Sequence[VehicleContact]:
    """The contact with its strips at a number of places, evenly over the width of a strip; itself if it has none.

    The slope of the force on strips ripples with their place on the wheel, where one comes or goes; its mean over the
    places is that of narrower strips.
    """
    if isinstance(contact, ContactsByWheelset):
        if all(len(at_places(own, count)) == 1 for own in (contact.default, *contact.own.values())):
            return [contact]
        return [contact.changed(partial(_at, offset=k / count)) for k in range(count)]
    if not (isinstance(contact, WheelsetContact) and isinstance(contact.model, LatticeContact)):
        return [contact]
    return [_at(contact, k / count) for k in range(count)]


def _at(contact: VehicleContact, offset: float) -> VehicleContact:
    """The contact with its strips, if there are any, moved by a part of their width."""
    return contact.changed(partial(_moved, offset=offset)) if isinstance(contact, WheelsetContact) else contact


def _moved(model: ContactModel, offset: float) -> ContactModel:
    return replace(model, offset=offset) if isinstance(model, LatticeContact) else model
