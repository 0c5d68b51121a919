"""The plane wagon: a vehicle of three bodies above one another, of which x, yaw and, but for the wheelset, pitch are
held.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import inf
from typing import TYPE_CHECKING

from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.vehicle.multibody.elements import RotationalSpring, SuspensionElement
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.vehicle import COORDINATES as ALL
from wheelrail.vehicle.multibody.vehicle import Vehicle, VehicleBody
from wheelrail.vehicle.track.speed_profile import SpeedProfile
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.components import RigidBody, Suspension
from wheelrail.vehicle.wagon.force_law import ForceLaw, Law
from wheelrail.vehicle.wagon.wagon import Wagon

if TYPE_CHECKING:
    from wheelrail.contact.loading.structure import Structure

CAR_BODY, BOGIE, WHEELSET = "car_body", "bogie", "wheelset"
HELD = {CAR_BODY: ("x", "pitch", "yaw"), BOGIE: ("x", "pitch", "yaw"), WHEELSET: ("x", "yaw")}
COORDINATES = tuple(f"{body}_{name}" for body, held in HELD.items() for name in ALL if name not in held)
COUNT = len(COORDINATES)
OUTWARDS = {"left": 1.0, "right": -1.0}


def wagon_dynamics(
    wagon: Wagon,
    track: Track,
    contact: VehicleContact,
    speed: float | SpeedProfile,
    structure: Structure | Sequence[Structure | None] | None = None,
) -> VehicleDynamics:
    """Equations of motion of the plane wagon on a track; parameters as for `VehicleDynamics`."""
    return VehicleDynamics(plane_vehicle(wagon), track, contact, speed, structure)


def plane_vehicle(wagon: Wagon) -> Vehicle:
    """One wheelset's fraction of a wagon, see `wheelrail.vehicle.wagon.components.Scaling`.

    Elements: spring and damper of the primary and the secondary suspension of the left side, those of the right side,
    bumpstop. Force laws of lateral deflections, positive outwards in `Suspension`, are mirrored on the right side.
    """
    w = wagon.plane
    elements = dict[str, SuspensionElement]()
    for side, sign in OUTWARDS.items():
        elements.update(_stage(f"{side}_primary", w.primary, BOGIE, WHEELSET, sign))
        elements.update(_stage(f"{side}_secondary", w.secondary, CAR_BODY, BOGIE, sign))
    stop = (0.0, w.bumpstop, 0.0)
    elements["bumpstop"] = SuspensionElement(
        CAR_BODY, BOGIE, (0.0, 0.0, w.bumpstop_height), stiffness=stop, turn=w.secondary.turn
    )
    springs = {
        "roll_bar": RotationalSpring(CAR_BODY, BOGIE, (w.roll_bar + 2 * w.secondary.bending_stiffness, 0.0, 0.0)),
        "primary_bending": RotationalSpring(BOGIE, WHEELSET, (2 * w.primary.bending_stiffness, 0.0, 0.0)),
    }
    return Vehicle(
        bodies={
            CAR_BODY: _body(w.car_body, HELD[CAR_BODY]),
            BOGIE: _body(w.bogie, HELD[BOGIE]),
            WHEELSET: _body(w.wheelset, HELD[WHEELSET], wheelset=True),
        },
        elements=elements,
        rotational_springs={name: spring for name, spring in springs.items() if spring.stiffness[0] > 0.0},
        gravity=w.gravity,
    )


def _body(body: RigidBody, held: tuple[str, ...], wheelset: bool = False) -> VehicleBody:
    inertia = (body.roll_inertia, body.pitch_inertia, body.yaw_inertia)
    return VehicleBody(body.mass, inertia, 0.0, body.height, wheelset, held)


def _stage(
    name: str, stage: Suspension, upper: str, lower: str, sign: float
) -> Iterator[tuple[str, SuspensionElement]]:
    """Spring and damper by name on one side, left (sign 1) or right (-1), of a stage."""

    def of_side(law: Law) -> Law:
        return law.mirrored if isinstance(law, ForceLaw) and sign < 0.0 else law

    yield (
        f"{name}_spring",
        SuspensionElement(
            upper,
            lower,
            (0.0, sign * stage.spring_y, stage.spring_height),
            stiffness=(0.0, of_side(stage.lateral_stiffness), stage.vertical_stiffness),
            turn=stage.turn,
        ),
    )
    yield (
        f"{name}_damper",
        SuspensionElement(
            upper,
            lower,
            (0.0, sign * stage.damper_y, stage.damper_height),
            damping=(0.0, of_side(stage.lateral_damping), stage.vertical_damping),
            series_stiffness=(inf, stage.lateral_series_stiffness, stage.vertical_series_stiffness),
            turn=stage.turn,
        ),
    )
