"""A new wheelset on half-spaces with few strips and cells at every call."""

from __future__ import annotations

from wheelrail.contact.kinematics.wheelset_state import Mounting
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.builders import wheel_rail_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.meshes.profiles.named import named_profile


def few_strips(radius: float = 0.46, *, strips: int = 6, cells: int = 8) -> WheelsetContact:
    rail = named_profile("UIC60-benchmark")
    how = Discretisation(1e-3, bodies="half-space", strips=strips, cells=cells)
    profiles, steels = (named_profile("S1002"), rail), (Material(), Material())
    model = wheel_rail_pair(profiles, radius, steels, ContactLaws(friction=0.3), how)
    return WheelsetContact(model, Mounting(0.75, rail.gauge_offset(1.435, 0.014), 0.46))
