"""Sway of bodies on canted track at standstill: the coefficient of flexibility."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import asin

from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.coordinates import ROLL, Y
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.steady.equilibrium import Equilibrium, EquilibriumError, equilibrium
from wheelrail.vehicle.track.piecewise import PiecewiseFunction
from wheelrail.vehicle.track.track import Track

SPEED = 1.0  # m/s: wheels roll into their place across the track


@dataclass(frozen=True)
class Sway:
    """Attitude of a body on canted track.

    Parameters:
        body: name.
        cant: m, over the base of the track.
        angle: of the track, rad.
        roll: of the body relative to the track towards its lower side, rad.
        shift: of its centre of mass to this side, m.
        height: of the centre above top of rail, m.
    """

    body: str
    cant: float
    angle: float
    roll: float
    shift: float
    height: float

    @property
    def coefficient(self) -> float:
        """Roll of the body relative to the track over the angle of the track."""
        return self.roll / self.angle

    @property
    def centre(self) -> float:
        """Height above top of rail at which the body does not shift, m."""
        return self.height - self.shift / self.roll


def sway(dynamics: VehicleDynamics, cants: Sequence[float], bodies: Sequence[str]) -> list[Sway]:
    """Attitude of bodies by equilibria on straight track, of which each is the guess of the next.

    Parameters:
        dynamics: equations of motion; its track and speed are not used.
        cants: m, positive raises the right rail.
        bodies: names.

    Raises EquilibriumError naming the cant.
    """
    found, last = list[Sway](), None
    for cant in cants:
        try:
            last = _on_cant(dynamics, cant, last)
        except EquilibriumError as error:
            raise EquilibriumError(f"{error}, at a cant of {1e3 * cant:g} mm") from error
        position: Array = dynamics.coordinates.split(last.state)[0]
        angle = asin(cant / last.dynamics.track.base)
        for name in bodies:
            own = position[dynamics.vehicle.names.index(name)]
            height = dynamics.vehicle.bodies[name].height
            found.append(Sway(name, cant, angle, float(-own[ROLL]), float(own[Y]), height))
    return found


def _on_cant(dynamics: VehicleDynamics, cant: float, near: Equilibrium | None) -> Equilibrium:
    track = Track(superelevation=PiecewiseFunction.constant(cant))
    guess, contacts = (None, None) if near is None else (near.state, near.contacts)
    return equilibrium(replace(dynamics, track=track, speed=SPEED), guess=guess, near=contacts)
