"""Torques on wheelsets and forces on bodies."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

from wheelrail.vehicle.loads.load_table import LoadTable

Load = float | LoadTable


@dataclass(frozen=True)
class WheelsetTorque:
    """Torque on a wheelset about its axle, and the opposite one on the body that carries motor or brake.

    Parameters:
        wheelset: name.
        torque: N m. Of a motor positive forwards, negative ones brake electrically; of a friction brake its magnitude,
            not negative.
        reaction: name of the body that carries motor or brake; None: the only body that elements join to the wheelset.
        brake: whether it is a friction brake, whose torque acts against the wheelset's rotation relative to that body
            and at most holds it.
    """

    wheelset: str
    torque: Load
    reaction: str | None = None
    brake: bool = False


@dataclass(frozen=True)
class BodyForce:
    """Force at a point of a body, along the axes of the track section at the body: of a drawbar, or of wind.

    Parameters:
        body: name.
        point: (3,) m, in the nominal position: x forward of the vehicle's reference point, y to the left, height above
            top of rail.
        longitudinal, lateral, vertical: N, forwards, to the left, upwards.
    """

    body: str
    point: tuple[float, float, float]
    longitudinal: Load = 0.0
    lateral: Load = 0.0
    vertical: Load = 0.0

    @property
    def components(self) -> tuple[LoadTable, LoadTable, LoadTable]:
        x, y, z = (LoadTable.of(value) for value in (self.longitudinal, self.lateral, self.vertical))
        return x, y, z


@dataclass(frozen=True)
class AppliedLoads:
    """Torques and forces that act together.

    Parameters:
        torques, forces: in any number.
    """

    torques: tuple[WheelsetTorque, ...] = ()
    forces: tuple[BodyForce, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.torques or self.forces)

    @cached_property
    def tables(self) -> tuple[LoadTable, ...]:
        """Tables of the torques, then three of each force."""
        torques = (LoadTable.of(part.torque) for part in self.torques)
        return (*torques, *(table for part in self.forces for table in part.components))

    @cached_property
    def kinks(self) -> tuple[float, ...]:
        """Times s, in order, at which the slope of a torque or force changes."""
        return tuple(sorted({time for table in self.tables for time in table.kinks}))

    def at(self, time: float, distance: float) -> AppliedLoads:
        """The same torques and forces, constant at their values at a time s and a distance m."""

        def value(load: Load) -> float:
            return LoadTable.of(load).at(time, distance)

        torques: Iterable[WheelsetTorque] = (replace(part, torque=value(part.torque)) for part in self.torques)
        forces: Iterable[BodyForce] = (
            replace(
                part,
                longitudinal=value(part.longitudinal),
                lateral=value(part.lateral),
                vertical=value(part.vertical),
            )
            for part in self.forces
        )
        return AppliedLoads(tuple(torques), tuple(forces))
