"""Energy balance of a run: what flows in and out beside the mechanical energy that it changes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.equations import Dynamics
from wheelrail.vehicle.dynamics.state import split
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

POWERS = ("contact", "dampers", "gravity", "fictitious")


@dataclass(frozen=True)
class EnergyBalance:
    """In the moving track frame, over time (n,) s: mechanical energy (n,) J, kinetic and of springs, and power (n, 4) W
    of what `POWERS` names; dampers take away.

    Spin counts by what exceeds nominal rolling, whose half a megajoule would hide the rest. Contact forces work on the
    wheelset's motion, gravity and the fictitious forces of the frame on all bodies. What carries the wagon along the
    track is a constraint and does no work in this frame.
    """

    time: Array
    energy: Array
    power: Array

    @cached_property
    def work(self) -> Array:
        """Of each power since the first row (n, 4), J, by the cubic spline through its samples."""
        from scipy.interpolate import CubicSpline

        if len(self.time) < 2:
            return np.zeros(self.power.shape)
        integral = CubicSpline(self.time, self.power).antiderivative()
        return np.asarray(integral(self.time) - integral(self.time[0]))

    @property
    def gap(self) -> Array:
        """Change of the energy less all work (n,), J."""
        return np.asarray(self.energy - self.energy[0] - self.work.sum(axis=1))

    @property
    def error(self) -> float:
        """Largest gap over the largest of the works and the change of energy."""
        moved = np.column_stack([self.work, self.energy - self.energy[0]])
        most = float(np.abs(moved).max(initial=0.0))
        return float(np.abs(self.gap).max(initial=0.0)) / most if most > 0.0 else 0.0


def energy_balance(history: History, wagon: Wagon, track: Track) -> EnergyBalance:
    """Of a run of this wagon on this track, with rows at its accepted steps."""
    dynamics = Dynamics(wagon, track, _RecordedContact(), history.speed)
    position, rate, _, pitch_rate, series = split(history.state)
    suspension, n = dynamics.suspension, len(history)
    frames = [dynamics.frame(t) for t in history.time.tolist()]
    spin, change = pitch_rate, np.array([frame.acceleration for frame in frames]) / dynamics.wagon.radius
    axle_inertia = dynamics.constants[2, 2]
    kinetic = 0.5 * (dynamics.inertia * rate**2).sum(axis=(1, 2)) + 0.5 * axle_inertia * spin**2
    force, moment = history.outputs.force.sum(axis=1), history.outputs.moment.sum(axis=1)
    roll, (vy, vz, turning) = position[:, 2, 2], rate[:, 2].T
    axle = np.cos(roll) * moment[:, 1] + np.sin(roll) * moment[:, 2]
    power = np.empty((n, len(POWERS)))
    power[:, 0] = force[:, 1] * vy + force[:, 2] * vz + moment[:, 0] * turning + axle * spin
    power[:, 1] = -suspension.dissipated_power(position, rate, series)
    for i, (frame, state) in enumerate(zip(frames, history.state, strict=True)):
        fictitious = dynamics.fictitious(frame, state)
        power[i, 2] = (dynamics.weight(frame) * rate[i, :, :2]).sum()
        power[i, 3] = (fictitious.on_bodies * rate[i]).sum() + (
            fictitious.about_axle.item() - axle_inertia * change[i]
        ) * spin[i]
    return EnergyBalance(history.time, kinetic + suspension.stored_energy(position, series), power)


class _RecordedContact(VehicleContact):
    """Contact of a run whose forces are in the history: never solved."""

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        raise AssertionError("the history knows the contact forces")
