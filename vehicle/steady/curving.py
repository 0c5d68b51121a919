"""Steady-state curving: wheel forces and positions of the bodies."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.results.result import Patch
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.equations import Dynamics, Wrench
from wheelrail.vehicle.dynamics.state import COUNT
from wheelrail.vehicle.steady.equilibrium import Equilibrium, EquilibriumError, equilibrium
from wheelrail.vehicle.track.constant_curve import ConstantCurve
from wheelrail.vehicle.wagon.suspension import SuspensionForces
from wheelrail.vehicle.wagon.wagon import Wagon

if TYPE_CHECKING:
    from wheelrail.contact.loading.structure import Structure

OUTWARDS: dict[Side, float] = {"left": 1.0, "right": -1.0}


@dataclass(frozen=True)
class SteadyCurving:
    """Steady-state solution in a curve, in the track's axes; lateral quantities are positive to the left.

    Parameters:
        curve: curve and speed.
        equilibrium: state and contacts.
        suspension: forces of the suspension.
        yaw_reaction: N m, constraint moment about the wheelset's vertical axis.

    Forces on the wheels in N, by side; positions of the bodies (3,): y, z m (z from the nominal height), roll rad.
    """

    curve: ConstantCurve
    equilibrium: Equilibrium
    suspension: SuspensionForces = field(repr=False)
    yaw_reaction: float

    @classmethod
    def of(cls, dynamics: Dynamics, curve: ConstantCurve, solution: Equilibrium) -> SteadyCurving:
        frame = dynamics.track.frame(0.0, curve.speed)
        _, yaw_reaction = dynamics.accelerations(frame, solution.state, Wrench.of(solution.contacts))
        position = solution.state[:9].reshape(3, 3)
        return cls(curve, solution, dynamics.suspension.forces(position, np.zeros((3, 3))), yaw_reaction.item())

    @property
    def wheel_load(self) -> dict[Side, float]:
        """Vertical force Q on each wheel, upwards, N."""
        return {side: float(self.equilibrium.contacts[side].force[2]) for side in SIDES}

    @property
    def guiding_force(self) -> dict[Side, float]:
        """Lateral force Y of each wheel on its rail, towards the field side, N."""
        return {side: -OUTWARDS[side] * float(self.equilibrium.contacts[side].force[1]) for side in SIDES}

    @property
    def derailment_quotient(self) -> dict[Side, float]:
        """Y / Q; infinite or NaN for an unloaded wheel."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return {s: float(np.divide(self.guiding_force[s], self.wheel_load[s])) for s in SIDES}

    @property
    def lateral_force(self) -> float:
        """Lateral force of both rails on the wheelset, N."""
        return float(sum(self.equilibrium.contacts[side].force[1] for side in SIDES))

    @property
    def unloading(self) -> float:
        """Wheel unloading: relative reduction of the load of the lighter wheel."""
        loads = self.wheel_load.values()
        return 1.0 - 2.0 * min(loads) / sum(loads)

    @property
    def secondary_deflection(self) -> float:
        """Lateral deflection of the secondary springs, car body relative to bogie, mean of both sides, m."""
        return self.suspension.secondary_deflection

    @property
    def bumpstop_force(self) -> float:
        """Force of the bumpstop on the car body, N."""
        return float(self.suspension.force[-1, 0]) + 0.0  # never -0

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
        return {side: tuple(self.equilibrium.contacts[side].patches) for side in SIDES}


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
    dynamics = Dynamics(wagon, curve.track, contact, curve.speed, structure)
    guess = None if before is None else _scaled_guess(before, curve)
    return SteadyCurving.of(dynamics, curve, equilibrium(dynamics, guess=guess))


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
