"""Energy balance of a run: mechanical energy and the work of external forces and dampers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.simulation.history import History

POWERS = ("contact", "dampers", "gravity", "inertial")
APPLIED = (*POWERS, "applied")  # with torques and forces
FRICTION = "friction"  # of elements with sliders, after the others


@dataclass(frozen=True)
class EnergyBalance:
    """Energy balance in the moving track frame.

    Parameters:
        time: (n,) s.
        energy: (n,) J, kinetic energy and potential energy of springs.
        power: (n, p) W of the causes; that of dampers and friction is negative.
        causes: names (p,).
        friction: (n,) J, work of friction since the first row; None: there is none.

    Spin is measured from nominal rolling, whose half a megajoule would hide the other contributions. Contact forces do
    work on the wheelset, gravity and the inertial forces of the frames on all bodies. Each body has the frame at its
    own distance, in which motion along the track does no work. Where frames turn against each other, elements between
    bodies deflect: that power counts as inertial. With an elastic axle or pads their energy is part of the energy, and
    the loads on hubs and rails do work on their motions, which is part of that of the contact; so is, on discrete
    sleepers, the work of moving the loads along rails whose compliance changes.
    """

    time: Array
    energy: Array
    power: Array
    causes: tuple[str, ...] = POWERS
    friction: Array | None = None

    @cached_property
    def work(self) -> Array:
        """Work (n, p) J of each power since the first row, by a piecewise cubic curve through the samples.

        Slopes depend on the next two samples to each side: the kinks of the contact's power where wheels lift and land
        stay local. H. Akima, Journal of the ACM 17 (1970) 589-602, DOI 10.1145/321607.321609. Work of friction is the
        sum of force times slip, exact under constant normal force.
        """
        from scipy.interpolate import Akima1DInterpolator

        if len(self.time) < 2:
            return np.zeros(self.power.shape)
        integral = Akima1DInterpolator(self.time, self.power).antiderivative()
        work = np.asarray(integral(self.time) - integral(self.time[0]))
        if self.friction is not None:
            work[:, self.causes.index(FRICTION)] = self.friction
        return work

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


def energy_balance(history: History) -> EnergyBalance:
    """Energy balance of a run.

    Parameters:
        history: rows at all accepted steps.
    """
    dynamics = history.dynamics
    sliders = bool(dynamics.coordinates.sliders)
    causes = (*POWERS, *(("applied",) if dynamics.loads else ()), *((FRICTION,) if sliders else ()))
    energy, power = np.empty(len(history)), np.empty((len(history), len(causes)))
    for i, row in enumerate(history.rows):
        travel, wheels = dynamics.speed_profile(row.time), np.concatenate([row.force, row.moment], axis=2)
        kinetic, elastic, *powers = dynamics.bodies.energy_rates(travel, row.state, wheels.sum(axis=1))
        found = dict(zip((*APPLIED, FRICTION), powers, strict=True))
        energy[i], power[i] = kinetic + elastic, [found[cause] for cause in causes]
        if dynamics.twists:
            states = dynamics.wheelset_states(row.time, row.state)
            own, *supplied = dynamics.twists.energy_rates(row.state, states, wheels)
            energy[i] += own
            power[i, :2] += supplied
    if dynamics.structures.elastic:
        stored, supplied, dissipated = _of_structures(history)
        energy += stored
        power[:, 0] += supplied
        power[:, 1] -= dissipated
    return EnergyBalance(history.time, energy, power, causes, _friction_work(history) if sliders else None)


def _friction_work(history: History) -> Array:
    """Work (n,) J of friction since the first row: mean limits of both rows times what the sliders moved between."""
    d = history.dynamics
    limits = np.array([d.bodies.friction_limits(d.speed_profile(row.time), row.state) for row in history.rows])
    slips = np.abs(np.diff(history.series[:, -len(d.coordinates.sliders) :], axis=0))
    return np.append(0.0, -np.cumsum((0.5 * (limits[1:] + limits[:-1]) * slips).sum(axis=1)))


def _of_structures(history: History) -> Array:
    """Elastic energy J of axles and rails, power W supplied by the contacts, and power W dissipated by dampers, (3, n).

    Rates are those of a cubic spline through the samples: in those of the equations of motion, a small difference over
    a short time constant, the errors of the motions are a hundred times larger.
    """
    from scipy.interpolate import CubicSpline

    dynamics, motions, n = history.dynamics, history.motions, len(history)
    rates = CubicSpline(history.time, motions)(history.time, 1) if n > 1 else np.zeros_like(motions)
    balance = np.zeros((3, n))
    for i, row in enumerate(history.rows):
        states = list(dynamics.wheelset_states(row.time, row.state).values())
        distances = dynamics.distances(dynamics.speed_profile(row.time), row.state).tolist()
        wrenches = np.concatenate([row.force, row.moment], axis=2)
        loads = dynamics.structures.loads(states, wrenches)
        for (k, structure, own), load in zip(dynamics.structures.elastic, loads, strict=True):
            here, motion, rate = structure.at(distances[k]), motions[i, own], rates[i, own]
            supplied = load @ rate[: len(load)] + states[k].speed * here.energy_by_distance(motion)
            balance[:, i] += here.energy(motion), supplied, here.dissipated_power(rate)
    return balance
