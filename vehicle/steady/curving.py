"""Steady-state curving: wheel forces and positions of the bodies."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.results.result import Patch
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.coordinates import Y
from wheelrail.vehicle.multibody.equations import wheelset_wrenches
from wheelrail.vehicle.multibody.plane_wagon import COUNT, WHEELSET, wagon_dynamics
from wheelrail.vehicle.multibody.wheel_forces import WheelsetForces, wheelset_forces
from wheelrail.vehicle.steady.equilibrium import Equilibrium, EquilibriumError, equilibrium
from wheelrail.vehicle.track.constant_curve import ConstantCurve
from wheelrail.vehicle.wagon.wagon import Wagon

if TYPE_CHECKING:
    from wheelrail.contact.loading.structure import Structure


@dataclass(frozen=True)
class SteadyCurving:
    """Steady-state solution in a curve, in the track's axes; lateral quantities are positive to the left.

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


def curving(
    wagon: Wagon,
    contact: VehicleContact,
    curve: ConstantCurve,
    structure: Structure | None = None,
    *,
    before: SteadyCurving | None = None,
) -> SteadyCurving:
    """Steady-state solution in a curve.

    Parameters:
        wagon: masses and suspension.
        contact: model of the wheel-rail contacts.
        curve: curve and speed.
        structure: axle and rails that move with the contact's loads.
        before: solution of a similar curve, used as initial guess.

    Raises EquilibriumError.
    """
    dynamics = wagon_dynamics(wagon, curve.track, contact, curve.speed, structure)
    guess = None if before is None else _scaled_guess(before, curve)
    return SteadyCurving(curve, equilibrium(dynamics, guess=guess))


def curving_over(
    wagon: Wagon,
    contact: VehicleContact,
    curves: Iterable[ConstantCurve],
    structure: Structure | None = None,
) -> list[SteadyCurving]:
    """Steady-state solutions of a series of curves, each the initial guess of the next one.

    Parameters:
        wagon: masses and suspension.
        contact: model of the wheel-rail contacts.
        curves: in order of speed, radius or cant.
        structure: axle and rails that move with the contact's loads.

    Raises EquilibriumError naming the curve.
    """
    solutions: list[SteadyCurving] = []
    for curve in curves:
        try:
            solutions.append(curving(wagon, contact, curve, structure, before=solutions[-1] if solutions else None))
        except EquilibriumError as error:
            raise EquilibriumError(f"{curve}: {error}") from error
    return solutions


def _scaled_guess(before: SteadyCurving, curve: ConstantCurve) -> Array:
    """State of the earlier solution with its rates, including the pitch rate, scaled to the new speed."""
    state: Array = before.equilibrium.state.copy()
    state[COUNT : 2 * COUNT] *= curve.speed / before.curve.speed
    return state
