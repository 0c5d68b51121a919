"""S1002 wheels on UIC60 rails by the standard contact."""

from __future__ import annotations

from wheelrail.contact.geometry.rigid_surfaces import RigidWheelRail
from wheelrail.contact.kinematics.wheelset_state import Mounting
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.standard.model import StandardContact
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.meshes.profiles.named import named_profile

WHEEL, RAIL = named_profile("S1002"), named_profile("UIC60-benchmark")
MOUNTING = Mounting(0.75, RAIL.gauge_offset(1.435, 0.014), 0.46)


def wheel_on_rail(friction: float = 0.3, radius: float = 0.46, **options: object) -> WheelsetContact:
    model = StandardContact(RigidWheelRail(WHEEL, RAIL, radius), ContactLaws(friction=friction), **options)  # type: ignore[arg-type]
    return WheelsetContact(model, MOUNTING)
