"""Steady-state curving of the plane wagon: wheel forces and positions of the bodies."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.results.result import Patch
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.coordinates import Y
from wheelrail.vehicle.multibody.equations import wheelset_wrenches
from wheelrail.vehicle.multibody.plane_wagon import WHEELSET
from wheelrail.vehicle.multibody.wheel_forces import WheelsetForces, wheelset_forces
from wheelrail.vehicle.steady.equilibrium import Equilibrium
from wheelrail.vehicle.track.constant_curve import ConstantCurve


@dataclass(frozen=True)
class SteadyCurving:
    """Steady-state solution of the plane wagon in a curve, in the track's axes; lateral values positive to the left.

    Parameters:
        curve: curve and speed.
        equilibrium: state and contacts.

    Forces on the wheels in N, by side; positions of the bodies (3,): y, z m (z from the nominal height), roll rad.
    """

    curve: ConstantCurve
    equilibrium: Equilibrium

    @cached_property
    def forces(self) -> WheelsetForces:
        """Forces of both wheels."""
        at = self.equilibrium
        return wheelset_forces(at.dynamics, at.state, at.contacts, at.time)[WHEELSET]

    @property
    def yaw_reaction(self) -> float:
        """Constraint moment about the wheelset's vertical axis, N m."""
        at = self.equilibrium
        return at.dynamics.yaw_reactions(at.time, at.state, wheelset_wrenches(at.contacts)).item()

    @property
    def wheel_load(self) -> dict[Side, float]:
        """Vertical force Q on each wheel, upwards, N."""
        return {side: wheel.vertical for side, wheel in self.forces.wheels.items()}

    @property
    def guiding_force(self) -> dict[Side, float]:
        """Lateral force Y of each wheel on its rail, towards the field side, N."""
        return {side: wheel.guiding for side, wheel in self.forces.wheels.items()}

    @property
    def derailment_quotient(self) -> dict[Side, float]:
        """Y / Q; infinite for an unloaded wheel."""
        return {side: wheel.derailment_quotient for side, wheel in self.forces.wheels.items()}

    @property
    def lateral_force(self) -> float:
        """Lateral force of both rails on the wheelset, N."""
        return self.forces.track_shifting

    @property
    def unloading(self) -> float:
        """Wheel unloading: relative reduction of the load of the lighter wheel."""
        loads = self.wheel_load.values()
        return 1.0 - 2.0 * min(loads) / sum(loads)

    @property
    def secondary_deflection(self) -> float:
        """Lateral deflection of the secondary springs, car body relative to bogie, mean of both sides, m."""
        return 0.5 * sum(self._element(f"{side}_secondary_spring")[0] for side in SIDES)

    @property
    def bumpstop_force(self) -> float:
        """Force of the bumpstop on the car body, N."""
        return self._element("bumpstop")[1] + 0.0  # never -0

    def _element(self, name: str) -> tuple[float, float]:
        """Lateral deflection m of a suspension element, and its force N on the upper body."""
        d, state = self.equilibrium.dynamics, self.equilibrium.state
        values = d.bodies.element_states([d.speed_profile(self.equilibrium.time)], state[None])
        deflection, force = (value[0, list(d.vehicle.elements).index(name), Y].item() for value in values)
        return deflection, force

    @property
    def car_body(self) -> Array:
        return self.equilibrium.state[:3]

    @property
    def bogie(self) -> Array:
        return self.equilibrium.state[3:6]

    @property
    def wheelset(self) -> Array:
        return self.equilibrium.state[6:9]

    @cached_property
    def patches(self) -> dict[Side, tuple[Patch, ...]]:
        """Contact patches by side."""
        return {side: wheel.patches for side, wheel in self.forces.wheels.items()}
