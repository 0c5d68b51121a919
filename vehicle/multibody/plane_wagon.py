"""The plane wagon: a vehicle of three bodies above one another, of which x, yaw and, but for the wheelset, pitch are
held.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import inf
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.body_equations import BodyEquations
from wheelrail.vehicle.multibody.coordinates import ROLL, YAW, Y
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.vehicle import COORDINATES as ALL
from wheelrail.vehicle.multibody.vehicle import RotationalSpring, SuspensionElement, Vehicle, VehicleBody
from wheelrail.vehicle.track.section_poses import TrackSections
from wheelrail.vehicle.track.speed_profile import SpeedProfile, TrackPosition
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
    structure: Structure | None = None,
) -> VehicleDynamics:
    """Equations of motion of the plane wagon on a track; parameters as for `VehicleDynamics`."""
    return VehicleDynamics(plane_vehicle(wagon), track, contact, speed, structure)


class WagonOutputs(NamedTuple):
    """Outputs besides state and contacts at n times; lateral ones are positive to the left.

    Parameters:
        yaw_reaction: (n,) N m, constraint moment about the wheelset's vertical axis.
        secondary_deflection: (n,) m, lateral, of the car body relative to the bogie at the secondary springs, mean of
            both sides.
        bumpstop_deflection: (n,) m.
        bumpstop_force: (n,) N on the car body.
    """

    yaw_reaction: Array
    secondary_deflection: Array
    bumpstop_deflection: Array
    bumpstop_force: Array

    @classmethod
    def of(cls, dynamics: VehicleDynamics, times: Array, states: Array, wrenches: Array) -> WagonOutputs:
        """Outputs of the plane wagon.

        Parameters:
            dynamics: equations of motion, from `wagon_dynamics`.
            times: (n,) s.
            states: (n, 20 + m + k).
            wrenches: (n, 6) force N and moment N m of both contacts.
        """
        coordinates, names = dynamics.coordinates, list(dynamics.vehicle.elements)
        rows = zip(times.tolist(), states, wrenches, strict=True)
        reactions = [dynamics.accelerations(*row[:2], row[2][None]).reactions[-1, YAW] for row in rows]
        # Bodies in one section of the track: the deflections are those on straight track.
        straight = BodyEquations(dynamics.suspension, TrackSections(Track()), dynamics.applied)
        deflection, force = straight.element_states([TrackPosition(0.0, 0.0, 0.0)] * len(states), states)
        left, right, stop = (names.index(n) for n in ("left_secondary_spring", "right_secondary_spring", "bumpstop"))
        lateral, force = deflection[..., Y], force[..., Y]
        # About the vertical of the track, the constraint has the moment cos(roll) times that about the wheelset's own.
        about_vertical = np.array(reactions) / np.cos(states[:, coordinates.index(WHEELSET, ROLL)])
        secondary = 0.5 * (lateral[:, left] + lateral[:, right])
        return cls(about_vertical, secondary, lateral[:, stop], force[:, stop])


def outward(dynamics: VehicleDynamics, series: Array) -> Array:
    """Spring deflections (..., m) m of Maxwell elements, lateral ones positive outwards: left side, then right side."""
    names = list(dynamics.vehicle.elements)
    right = [j == Y and names[e].startswith("right") for e, j in dynamics.coordinates.maxwell]
    return np.where(right, -series, series)


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
