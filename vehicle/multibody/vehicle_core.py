"""A vehicle, its track and its loads as one object of the compiled core."""

from __future__ import annotations

from typing import TYPE_CHECKING

import wheelrail.bindings._vehicle as core
from wheelrail.vehicle.loads.load_table import LoadTable
from wheelrail.vehicle.wagon.force_law import ForceLaw

if TYPE_CHECKING:
    from wheelrail.vehicle.multibody.applied_forces import AppliedForces
    from wheelrail.vehicle.multibody.suspension_arrays import SuspensionArrays
    from wheelrail.vehicle.track.section_poses import TrackSections
    from wheelrail.vehicle.wagon.force_law import Law


def vehicle_core(suspension: SuspensionArrays, sections: TrackSections, applied: AppliedForces) -> core.Vehicle:
    """Equations of motion.

    Parameters:
        suspension: of the vehicle.
        sections: of the track.
        applied: torques and forces.
    """
    coordinates = suspension.coordinates
    vehicle, hold = coordinates.vehicle, coordinates.vehicle.speed_hold
    laws: list[core.Law] = []

    def index(law: Law) -> int:
        if not isinstance(law, ForceLaw):
            return -1
        laws.append(core.Law(law.odd, law.abscissae.tolist(), law.forces.tolist()))
        return len(laws) - 1

    def linear(law: Law) -> float:
        return 0.0 if isinstance(law, ForceLaw) else float(law)

    def friction(e: int, j: int) -> core.Friction:
        part = elements[e]
        numbers = part.friction_stiffness[j], part.friction[j], part.friction_coefficient[j]
        return core.Friction(coordinates.internal.get(("slider", e, j), -1), *numbers)

    def direction(e: int, j: int) -> core.Direction:
        part, m = elements[e], coordinates.internal.get(("series", e, j), -1)
        damping = part.damping[j]
        inverse = m >= 0 and part.surge_mass[j] == 0.0  # of Maxwell elements without mass the velocity over the force
        law = damping.inverse if inverse and isinstance(damping, ForceLaw) else damping
        series = float(part.series_stiffness[j]) if m >= 0 else 0.0
        numbers = index(part.stiffness[j]), index(law)
        surge = core.Surge(coordinates.internal.get(("flow", e, j), -1), part.surge_mass[j], part.surge_exponent[j])
        return core.Direction(linear(part.stiffness[j]), linear(damping), *numbers, m, series, friction(e, j), surge)

    elements, (upper_arms, lower_arms) = list(vehicle.elements.values()), suspension.arms
    return core.Vehicle(
        track=sections.core,
        bodies=[core.Body(b.x, b.height, b.mass, b.inertia, b.wheelset, held)
                for b, held in zip(vehicle.bodies.values(), (coordinates.held == 1).tolist(), strict=True)],
        elements=[core.Element(upper, lower, upper_arm, lower_arm, float(part.turn), load, part.length,
                               [direction(e, j) for j in range(3)])
                  for e, (part, upper, lower, upper_arm, lower_arm, load) in enumerate(zip(
                      elements, suspension.ends.upper.tolist(), suspension.ends.lower.tolist(), upper_arms.tolist(),
                      lower_arms.tolist(), suspension.static_loads.tolist(), strict=True))],
        laws=laws,
        pairs=[list(pair) for pair in vehicle.mirror_pairs],
        springs=[core.RotationalSpring(upper, lower, part.stiffness, part.damping) for part, upper, lower in zip(
            vehicle.rotational_springs.values(), suspension.rotational_ends.upper.tolist(),
            suspension.rotational_ends.lower.tolist(), strict=True)],
        torques=[core.Torque(i, j, part.brake, _table(LoadTable.of(part.torque))) for part, i, j in zip(
            applied.loads.torques, applied.wheelsets.tolist(), applied.reactions.tolist(), strict=True)],
        forces=[core.Force(i, arm, [_table(table) for table in part.components]) for part, i, arm in zip(
            applied.loads.forces, applied.bodies.tolist(), applied.arms.tolist(), strict=True)],
        radius=vehicle.radius, gravity=vehicle.gravity, release=applied.release,
        kept=-1 if hold is None else vehicle.names.index(hold.body),
        hold=(0.0, 0.0) if hold is None else (hold.stiffness, hold.damping),
        internal=len(coordinates.internal),
    )  # fmt: skip


def _table(table: LoadTable) -> core.Table:
    places, values = zip(*table.points, strict=True)
    return core.Table(table.by_distance, places, values)
