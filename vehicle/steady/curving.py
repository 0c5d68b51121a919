"""Steady position in curves: what each wheel carries, and where the bodies stand."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property

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

OUTWARDS: dict[Side, float] = {"left": 1.0, "right": -1.0}


@dataclass(frozen=True)
class SteadyCurving:
    """What a curve does to the wagon, in the track's axes; signs to the left are positive, wheels by side.

    Forces N on the wheels; positions y, z m (z from the nominal height) and roll rad of the bodies.
    """

    curve: ConstantCurve
    equilibrium: Equilibrium
    suspension: SuspensionForces = field(repr=False)
    yaw_reaction: float

    @classmethod
    def of(cls, dynamics: Dynamics, curve: ConstantCurve, found: Equilibrium) -> SteadyCurving:
        at = dynamics.track.frame(0.0, curve.speed)
        _, yaw_reaction = dynamics.accelerations(at, found.state, Wrench.of(found.contacts))
        position = found.state[:9].reshape(3, 3)
        return cls(curve, found, dynamics.suspension.forces(position, np.zeros((3, 3))), yaw_reaction.item())

    @property
    def wheel_load(self) -> dict[Side, float]:
        """Q, upwards on each wheel, N."""
        return {side: float(self.equilibrium.contacts[side].force[2]) for side in SIDES}

    @property
    def guiding_force(self) -> dict[Side, float]:
        """Y, which each wheel exerts on its rail to the outside of the track, N."""
        return {side: -OUTWARDS[side] * float(self.equilibrium.contacts[side].force[1]) for side in SIDES}

    @property
    def derailment_quotient(self) -> dict[Side, float]:
        """Y / Q; infinite or NaN of a wheel that carries nothing."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return {s: float(np.divide(self.guiding_force[s], self.wheel_load[s])) for s in SIDES}

    @property
    def lateral_force(self) -> float:
        """Of both rails on the wheelset, N."""
        return float(sum(self.equilibrium.contacts[side].force[1] for side in SIDES))

    @property
    def unloading(self) -> float:
        """Share of its static load that the lighter wheel has lost."""
        loads = self.wheel_load.values()
        return 1.0 - 2.0 * min(loads) / sum(loads)

    @property
    def secondary_deflection(self) -> float:
        """Of the car body against the bogie at the secondary springs, mean of both sides, m."""
        return self.suspension.secondary_deflection

    @property
    def bumpstop_force(self) -> float:
        """On the car body, N."""
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
        """With their positions on the profiles, where the contact tells."""
        return {side: tuple(self.equilibrium.contacts[side].patches) for side in SIDES}


def curving(
    wagon: Wagon, contact: VehicleContact, curve: ConstantCurve, *, before: SteadyCurving | None = None
) -> SteadyCurving:
    """Steady position in a curve; one found before, in a curve much like this, saves contact solves.

    Raises EquilibriumError.
    """
    dynamics = Dynamics(wagon, curve.track, contact, curve.speed)
    guess = None if before is None else _carried_over(before, curve)
    return SteadyCurving.of(dynamics, curve, equilibrium(dynamics, guess=guess))


def curving_over(wagon: Wagon, contact: VehicleContact, curves: Iterable[ConstantCurve]) -> list[SteadyCurving]:
    """Steady positions in curves, each from the one before: over speeds, radii or cants in order.

    Raises EquilibriumError naming the curve.
    """
    found: list[SteadyCurving] = []
    for curve in curves:
        try:
            found.append(curving(wagon, contact, curve, before=found[-1] if found else None))
        except EquilibriumError as error:
            raise EquilibriumError(f"{curve}: {error}") from error
    return found


def _carried_over(before: SteadyCurving, curve: ConstantCurve) -> Array:
    """The earlier state with its rates, the creepage of rolling among them, at the new speed."""
    state: Array = before.equilibrium.state.copy()
    state[COUNT : 2 * COUNT] *= curve.speed / before.curve.speed
    return state
