"""A vehicle and its track as arrays for compiled code."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wheelrail.vehicle.multibody.applied_forces import AppliedForces
from wheelrail.vehicle.multibody.compiled.applied_loads import LoadArrays
from wheelrail.vehicle.multibody.compiled.bodies import BodyArrays
from wheelrail.vehicle.multibody.compiled.elements import ElementArrays, LawArrays
from wheelrail.vehicle.multibody.compiled.equations import VehicleArrays
from wheelrail.vehicle.multibody.compiled.sections import TrackArrays
from wheelrail.vehicle.multibody.coordinates import Coordinates
from wheelrail.vehicle.multibody.suspension_forces import SuspensionForces
from wheelrail.vehicle.track.section_poses import TrackSections
from wheelrail.vehicle.wagon.force_law import ForceLaw, Law


def vehicle_arrays(suspension: SuspensionForces, track: TrackSections, applied: AppliedForces) -> VehicleArrays:
    """Arrays of the vehicle of a suspension, of a track, and of torques and forces."""
    bodies, elements = body_arrays(suspension.coordinates), element_arrays(suspension)
    return VehicleArrays(bodies, elements, track_arrays(track), load_arrays(applied))


def body_arrays(coordinates: Coordinates) -> BodyArrays:
    vehicle = coordinates.vehicle
    bodies, hold = list(vehicle.bodies.values()), vehicle.speed_hold
    return BodyArrays(
        place=np.array([float(b.x) for b in bodies]),
        height=np.array([float(b.height) for b in bodies]),
        mass=np.array([float(b.mass) for b in bodies]),
        inertia=np.array([b.inertia for b in bodies], dtype=float),
        wheelset=np.array([float(b.wheelset) for b in bodies]),
        radius=float(vehicle.radius),
        gravity=float(vehicle.gravity),
        held=coordinates.held,
        kept=-1 if hold is None else vehicle.names.index(hold.body),
        hold_stiffness=0.0 if hold is None else float(hold.stiffness),
        hold_damping=0.0 if hold is None else float(hold.damping),
    )


def element_arrays(suspension: SuspensionForces) -> ElementArrays:
    coordinates, vehicle = suspension.coordinates, suspension.coordinates.vehicle
    elements, laws = list(vehicle.elements.values()), list[ForceLaw]()

    def index(law: Law) -> int:
        if not isinstance(law, ForceLaw):
            return -1
        laws.append(law)
        return len(laws) - 1

    count = (len(elements), 3)
    spring_law = np.array([index(law) for e in elements for law in e.stiffness], dtype=np.int64).reshape(count)
    series, damper_law = np.full(count, -1), np.full(count, -1)
    for m, place in enumerate(coordinates.maxwell):
        series[place] = m
    for e, j in zip(*np.nonzero(series < 0), strict=True):
        damper_law[e, j] = index(elements[e].damping[j])
    in_series = [elements[e].damping[j] for e, j in coordinates.maxwell]
    series_law = [index(law.inverse) if isinstance(law, ForceLaw) else -1 for law in in_series]
    return ElementArrays(
        suspension.ends.upper,
        suspension.ends.lower,
        *suspension.arms,
        suspension.turn.astype(float),
        suspension.static_loads,
        suspension.stiffness[0],
        suspension.damping[0],
        spring_law,
        damper_law,
        series,
        np.array([float(elements[e].series_stiffness[j]) for e, j in coordinates.maxwell]),
        np.array([0.0 if isinstance(law, ForceLaw) else float(law) for law in in_series]),
        np.array(series_law, dtype=np.int64),
        law_arrays(laws),
        np.array(vehicle.mirror_pairs, dtype=np.int64).reshape(-1, 2),
        suspension.rotational_ends.upper,
        suspension.rotational_ends.lower,
        suspension.rotational_stiffness,
    )


def law_arrays(laws: Sequence[ForceLaw]) -> LawArrays:
    none = [np.empty(0)]
    return LawArrays(
        np.cumsum([0, *(len(law.points) for law in laws)]),
        np.array([law.odd for law in laws], dtype=np.int64),
        np.concatenate([law.abscissae for law in laws] or none),
        np.concatenate([law.forces for law in laws] or none),
    )


def track_arrays(sections: TrackSections) -> TrackArrays:
    line = sections.alignment
    return TrackArrays(line.starts, np.ascontiguousarray(line.coefficients), float(sections.track.base))


def load_arrays(applied: AppliedForces) -> LoadArrays:
    tables, torques = applied.loads.tables, len(applied.loads.torques)
    points = np.array([point for table in tables for point in table.points], dtype=float).reshape(-1, 2)
    return LoadArrays(
        wheelset=applied.wheelsets,
        reaction=applied.reactions,
        brake=applied.brakes.astype(np.int64),
        torque=np.arange(torques),
        release=float(applied.release),
        body=applied.bodies,
        arm=applied.arms,
        force=np.arange(torques, len(tables)).reshape(-1, 3),
        starts=np.cumsum([0, *(len(table.points) for table in tables)]),
        by_distance=np.array([table.by_distance for table in tables], dtype=np.int64),
        abscissae=np.ascontiguousarray(points[:, 0]),
        values=np.ascontiguousarray(points[:, 1]),
    )
