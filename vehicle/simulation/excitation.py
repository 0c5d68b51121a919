"""Prescribed excitation of a run over time and distance, and the longest step that resolves all functions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from wheelrail.bindings._vehicle import differ
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.support.arrays import Array
from wheelrail.vehicle.loads.load_table import LoadTable
from wheelrail.vehicle.multibody.coordinates import RATE_SCALE
from wheelrail.vehicle.multibody.equations import VehicleDynamics, VehicleEvaluation
from wheelrail.vehicle.track.irregularity import Irregularities
from wheelrail.vehicle.track.piecewise import PiecewiseFunction
from wheelrail.vehicle.track.section_poses import LocalPolynomials, TrackSections, sample_points
from wheelrail.vehicle.track.speed_profile import SpeedProfile
from wheelrail.vehicle.track.track import Track

TOLERANCES = 10.0  # that a step may overlook: several are of the size of the errors within a step
STIFFNESS = 1e9  # N/m, of a steel wheel on its rail, by Hertz 1.0 to 1.4e9 at 50 to 100 kN
SHORTEST = 1e-9  # s


@dataclass(frozen=True)
class Overlooked:
    """Prescribed displacements that a step may overlook: their size, rate, and the force that they cause.

    Parameters:
        value: m.
        force: N on a wheel; infinite: any.
        mass, carried: kg, of the wheel with its part of the axle, and of all that it carries.

    A wheel follows its rail, as an oscillator of its mass and the stiffness k of the contact. To a displacement r, of
    which it knows nothing, its contact answers with at most about the least of k |r|, sqrt(k m) |r'| and m |r''|: those
    of motions that are short against the oscillator's period, of a kink, and of long ones, where the mass is all that
    the wheel carries.
    """

    value: float
    force: float
    mass: float
    carried: float

    @cached_property
    def limits(self) -> Array:
        """(5,) of displacement m and rate m/s; of displacement, rate and acceleration m/s2 by the force."""
        by_force = self.force / np.array([STIFFNESS, np.sqrt(STIFFNESS * self.mass), self.carried])
        return np.array([self.value, RATE_SCALE * self.value, *by_force])


@dataclass(frozen=True)
class Prescribed:
    """Prescribed functions of time, or of distance at places that move with the vehicle.

    Parameters:
        functions: k displacements, m.
        places: (p,) m ahead of the vehicle's reference point; 0 for functions of time.
    """

    functions: LocalPolynomials
    places: Array

    def resolved(self, start: float, end: float, rate: float, limits: Array) -> bool:
        """Whether all functions are, over an interval, the cubics through their values and rates at both ends within
        limits.

        Parameters:
            start, end: m, of the reference point; or s.
            rate: of the distance, m/s; 1 for functions of time.
            limits: (5,) see `Overlooked`.
        """
        scaled = limits / rate ** np.array([0, 1, 0, 1, 2])
        return not differ(*self._arrays, start, end, scaled)

    @cached_property
    def _arrays(self) -> tuple[Array, Array, Array]:
        """Starts, coefficients and places in the order of rows."""
        starts, coefficients = self.functions.starts, self.functions.coefficients
        return np.ascontiguousarray(starts), np.ascontiguousarray(coefficients), np.ascontiguousarray(self.places)


@dataclass(frozen=True)
class Excitation:
    """Excitation of a vehicle by track motion, reference motion and loads over distance, and its resolution by a step.

    Parameters:
        dynamics: equations of motion.
        tolerance: atol of positions, m.
        force: tolerance of forces of wheels, N.

    A method knows what is prescribed at its few stages only: none of a step that is too long may meet a curve, a joint,
    or a change of speed or load. A step resolves a function if the cubic through its values and rates at both ends
    differs from it throughout by at most 10 tolerances, atol in m and 100 atol in m/s, and by no more than what changes
    the force of a wheel by its tolerance. The functions are displacements: of the track under each body, by curves,
    gradients and cant; y and z of both rails under each wheelset; the distance of the reference motion; and that by a
    load over distance of the mass of its body alone. Linear loads over time are resolved by steps that end at their
    kinks.
    """

    dynamics: VehicleDynamics
    tolerance: float
    force: float = np.inf

    @cached_property
    def limits(self) -> Array:
        """(5,) see `Overlooked`."""
        d, wheels = self.dynamics, len(SIDES) * len(self.dynamics.vehicle.wheelsets)
        own = sum(d.vehicle.bodies[name].mass for name in d.vehicle.wheelsets)
        return Overlooked(TOLERANCES * self.tolerance, self.force, own / wheels, d.mass.sum() / wheels).limits

    @cached_property
    def of_distance(self) -> tuple[Prescribed, ...]:
        """Alignment and rails."""
        vehicle, line = self.dynamics.vehicle, self.dynamics.track
        places = np.unique([body.x for body in vehicle.bodies.values()])
        found = [Prescribed(_alignment(line), places)] if len(TrackSections(line).breaks) > 1 else []
        wheelsets = np.array([vehicle.bodies[name].x for name in vehicle.wheelsets])
        if line.irregularities is not None:
            found.append(Prescribed(_rails(line.irregularities), wheelsets))
        if line.widens and len(line.widening.breaks) > 1:
            found.append(Prescribed(_through(line.widening, 0.5), wheelsets))
        return tuple(found)

    @cached_property
    def loads(self) -> tuple[Prescribed, ...]:
        """Displacements by loads over distance, times the squared speed."""
        return tuple(self._loads())

    @cached_property
    def reference(self) -> Prescribed | None:
        """Distance of the reference motion over time; None at constant speed."""
        profile = self.dynamics.speed_profile
        return None if profile.constant else Prescribed(_distance(profile), np.zeros(1))

    def longest_step(self, time: float, state: Array, at: VehicleEvaluation, step: float) -> float:
        """Longest step s, but for a third, that resolves all functions, at most the given step; on discrete sleepers,
        also at most a third of the time from one to the next.

        Parameters:
            time: s.
            state: (n,).
            at: evaluation there.
            step: s.
        """
        if self.dynamics.structures.elastic:
            _, speed = self.dynamics.progress(time, state)
            step = min(step, self.dynamics.structures.period / (3.0 * speed))
        if self._resolves(time, state, at, step):
            return step
        while step > SHORTEST:
            step *= 0.5
            if self._resolves(time, state, at, step):
                return longer if self._resolves(time, state, at, longer := 1.5 * step) else step
        return step

    def _resolves(self, time: float, state: Array, at: VehicleEvaluation, step: float) -> bool:
        """Whether a step of a length s resolves all functions."""
        if self.reference is not None and not self.reference.resolved(time, time + step, 1.0, self.limits):
            return False
        if not (self.of_distance or self.loads):
            return True
        d = self.dynamics
        before, after = d.speed_profile(time), d.speed_profile(time + step)
        (ahead, faster), (_, acceleration) = d.drift(state), d.drift(at.rate)
        start = before.distance + float(ahead)
        end = after.distance + float(ahead + step * (faster + 0.5 * step * max(float(acceleration), 0.0)))
        speed = (end - start) / step
        return all(f.resolved(start, end, speed, self.limits) for f in self.of_distance) and all(
            f.resolved(start, end, speed, speed**2 * self.limits) for f in self.loads
        )

    def _loads(self) -> Iterator[Prescribed]:
        d = self.dynamics
        if len(d.track.friction.breaks) > 1:  # as of creep forces of the whole load
            friction = _through(d.track.friction, d.vehicle.gravity)
            yield Prescribed(
                friction.integral.integral, np.array([d.vehicle.bodies[name].x for name in d.vehicle.wheelsets])
            )
        owners = [*d.applied.wheelsets.tolist(), *np.repeat(d.applied.bodies, 3).tolist()]
        torques = len(d.applied.wheelsets)
        for index, (table, owner) in enumerate(zip(d.loads.tables, owners, strict=True)):
            if table.by_distance and len(table.points) > 1:
                arm = d.vehicle.radius if index < torques else 1.0
                body = d.vehicle.bodies[d.vehicle.names[owner]]
                acceleration = _linear(table, 1.0 / (arm * body.mass))
                yield Prescribed(acceleration.integral.integral, np.array([body.x]))


def _alignment(track: Track) -> LocalPolynomials:
    """Displacements of the track to the left and upwards, and of its rails by cant, m."""
    line = TrackSections(track).alignment
    direction, cant = (LocalPolynomials(line.starts, line.coefficients[:, :, columns]) for columns in ([0, 3], [2]))
    return LocalPolynomials.joined([direction.integral, replace(cant, coefficients=0.5 * cant.coefficients)])


def _through(function: PiecewiseFunction, factor: float) -> LocalPolynomials:
    """A function of distance times a factor."""
    values = np.array([[factor * function(s)[0] for s in row] for row in sample_points(function.breaks).tolist()])
    outside = factor * np.array([[function.values[end]] for end in (0, -1)])
    return LocalPolynomials.through(function.breaks, values[..., None], outside)


def _rails(irregularities: Irregularities) -> LocalPolynomials:
    """Displacements y, z of both rails, m."""
    stations = irregularities.stations
    value, slope, second, third = irregularities.derivatives(stations[:-1])
    coefficients = np.zeros((len(stations) + 1, 4, 2 * len(SIDES)))
    coefficients[1:-1] = np.stack([value, slope, second / 2.0, third / 6.0], axis=1)
    return LocalPolynomials(np.append(stations[0], stations), coefficients)


def _distance(profile: SpeedProfile) -> LocalPolynomials:
    """Distance over time, m."""
    speeds = profile.speeds
    values = np.array([[speeds(t)[0] for t in row] for row in sample_points(speeds.breaks).tolist()])
    outside = np.array([[speeds.values[0]], [speeds.values[-1]]])
    return LocalPolynomials.through(speeds.breaks, values[..., None], outside).integral


def _linear(table: LoadTable, factor: float) -> LocalPolynomials:
    """Values of a table times a factor, over distance."""
    at, value = np.array(table.points).T
    coefficients = np.zeros((len(at) + 1, 2, 1))
    coefficients[:, 0, 0] = factor * np.append(value[0], value)
    coefficients[1:-1, 1, 0] = factor * np.diff(value) / np.diff(at)
    return LocalPolynomials(np.append(at[0], at), coefficients)
