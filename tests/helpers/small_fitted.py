"""A wheelset on half-spaces with few fitted cells that follow the contact, made anew at every call."""

from __future__ import annotations

from wheelrail.contact.kinematics.wheelset_state import Mounting
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.builders import wheel_rail_pair
from wheelrail.contact.models.fitted.resolution import Resolution
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.meshes.profiles.named import named_profile


def warm_cells() -> WheelsetContact:
    rail = named_profile("UIC60-benchmark")
    model = wheel_rail_pair(
        named_profile("S1002"),
        rail,
        radius=0.46,
        wheel_steel=Material(),
        rail_steel=Material(),
        surface_size=1e-3,
        laws=ContactLaws(friction=0.3),
        bodies="half-space",
        fineness=Resolution(4, 8),
        warm=True,
    )
    return WheelsetContact(model, Mounting(0.75, rail.gauge_offset(1.435, 0.014), 0.46))
