"""State in which a run begins."""

from __future__ import annotations

from dataclasses import replace

from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.coordinates import X
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.vehicle import SpeedHold
from wheelrail.vehicle.steady.equilibrium import equilibrium


def start_state(dynamics: VehicleDynamics, time: float = 0.0) -> Array:
    """Equilibrium (2 c + m + k,) at a time; of a vehicle that runs free the one in which its heaviest body is held at
    its place, to be released.

    Parameters:
        dynamics: equations of motion.
        time: s.

    Raises EquilibriumError.
    """
    if not dynamics.runs_free:
        return equilibrium(dynamics, time=time).state
    bodies = dynamics.vehicle.bodies
    heaviest = max(bodies, key=lambda name: bodies[name].mass)
    held = replace(dynamics, vehicle=replace(dynamics.vehicle, speed_hold=SpeedHold(heaviest)))
    state = equilibrium(held, time=time).state
    along = [dynamics.coordinates.index(name, X) for name in bodies]
    state[along] -= state[dynamics.coordinates.index(heaviest, X)]
    return state
