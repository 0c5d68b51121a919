"""Energy balance of a run: mechanical energy and the work of external forces and dampers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.equations import Dynamics
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

if TYPE_CHECKING:
    from wheelrail.contact.loading.structure import Structure

POWERS = ("contact", "dampers", "gravity", "inertial")


@dataclass(frozen=True)
class EnergyBalance:
    """Energy balance in the moving track frame.

    Parameters:
        time: (n,) s.
        energy: (n,) J, kinetic energy and potential energy of springs.
        power: (n, 4) W of `POWERS`; that of dampers is negative.

    Spin is measured from nominal rolling, whose half a megajoule would hide the other contributions. Contact forces do
    work on the wheelset, gravity and the inertial forces of the frame on all bodies. The constraint that moves the
    wagon along the track does no work in this frame. With an elastic axle or pads their energy is part of the energy,
    and the loads on hubs and rails do work on their motions, which is part of that of the contact; so is, on discrete
    sleepers, the work of moving the loads along rails whose compliance changes.
    """

    time: Array
    energy: Array
    power: Array

    @cached_property
    def work(self) -> Array:
        """Work (n, 4) J of each power since the first row, by a cubic spline through the samples."""
        from scipy.interpolate import CubicSpline

        if len(self.time) < 2:
            return np.zeros(self.power.shape)
        integral = CubicSpline(self.time, self.power).antiderivative()
        return np.asarray(integral(self.time) - integral(self.time[0]))

    @property
    def gap(self) -> Array:
        """Change of energy minus total work (n,), J."""
        return np.asarray(self.energy - self.energy[0] - self.work.sum(axis=1))

    @property
    def error(self) -> float:
        """Largest gap relative to the largest work or change of energy."""
        energies = np.column_stack([self.work, self.energy - self.energy[0]])
        scale = float(np.abs(energies).max(initial=0.0))
        return float(np.abs(self.gap).max(initial=0.0)) / scale if scale > 0.0 else 0.0


def energy_balance(history: History, wagon: Wagon, track: Track) -> EnergyBalance:
    """Energy balance of a run.

    Parameters:
        history: rows at all accepted steps.
        wagon, track: of the run.
    """
    structure = history.structure
    dynamics = Dynamics(wagon, track, _RecordedContact(), history.speed, structure)
    position, rate, _, pitch_rate, series, _ = dynamics.split(history.state)
    suspension, n = dynamics.suspension, len(history)
    frames = [dynamics.frame(t) for t in history.time.tolist()]
    spin, spin_change = pitch_rate, np.array([frame.acceleration for frame in frames]) / dynamics.wagon.radius
    axle_inertia = dynamics.constants[2, 2]
    kinetic = 0.5 * (dynamics.inertia * rate**2).sum(axis=(1, 2)) + 0.5 * axle_inertia * spin**2
    force, moment = history.outputs.force.sum(axis=1), history.outputs.moment.sum(axis=1)
    roll, (vy, vz, roll_rate) = position[:, 2, 2], rate[:, 2].T
    axle = np.cos(roll) * moment[:, 1] + np.sin(roll) * moment[:, 2]
    power = np.empty((n, len(POWERS)))
    power[:, 0] = force[:, 1] * vy + force[:, 2] * vz + moment[:, 0] * roll_rate + axle * spin
    power[:, 1] = -suspension.dissipated_power(position, rate, series)
    for i, (frame, state) in enumerate(zip(frames, history.state, strict=True)):
        inertial = dynamics.inertial_forces(frame, state)
        power[i, 2] = (dynamics.weight(frame) * rate[i, :, :2]).sum()
        power[i, 3] = (inertial.on_bodies * rate[i]).sum() + (
            inertial.about_axle.item() - axle_inertia * spin_change[i]
        ) * spin[i]
    energy = kinetic + suspension.stored_energy(position, series)
    if structure is not None:
        stored, supplied, dissipated = _structure_balance(history, dynamics, structure)
        energy = energy + stored
        power[:, 0] += supplied
        power[:, 1] -= dissipated
    return EnergyBalance(history.time, energy, power)


def _structure_balance(history: History, dynamics: Dynamics, structure: Structure) -> Array:
    """Elastic energy J of axle and rails, power W that the contact supplies to them, and that their dampers dissipate,
    (3, n).

    Rates are those of a cubic spline through the samples: in those of the equations of motion, a small difference over
    a short time constant, the errors of the motions are a hundred times larger.
    """
    from scipy.interpolate import CubicSpline

    motions, n = history.structure_motion, len(history)
    rates = CubicSpline(history.time, motions)(history.time, 1) if n > 1 else np.zeros_like(motions)
    wrenches = np.concatenate([history.outputs.force, history.outputs.moment], axis=2)
    balance = np.empty((3, n))
    for i, (time, state) in enumerate(zip(history.time.tolist(), history.state, strict=True)):
        frame = dynamics.frame(time)
        here, loads = structure.at(frame.distance), structure.loads(dynamics.wheelset_state(frame, state), wrenches[i])
        along = frame.speed * here.energy_by_distance(motions[i])
        balance[:, i] = here.energy(motions[i]), loads @ rates[i, : len(loads)] + along, here.dissipated_power(rates[i])
    return balance


class _RecordedContact(VehicleContact):
    """Placeholder contact: the contact forces are taken from the history."""

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        raise AssertionError("contact forces are in the history")
