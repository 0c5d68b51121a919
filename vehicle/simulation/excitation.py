"""What a run prescribes over time and distance, and the longest step that resolves it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing
from wheelrail.vehicle.loads.load_table import LoadTable
from wheelrail.vehicle.multibody.coordinates import RATE_SCALE
from wheelrail.vehicle.multibody.equations import VehicleDynamics, VehicleEvaluation
from wheelrail.vehicle.track.irregularity import Irregularities
from wheelrail.vehicle.track.section_poses import LocalPolynomials, TrackSections, sample_points
from wheelrail.vehicle.track.speed_profile import SpeedProfile
from wheelrail.vehicle.track.track import Track

TOLERANCES = 10.0  # that a step may overlook: several are of the size of the errors within a step
SHORTEST = 1e-9  # s
PARTS = 4  # of each smooth piece, at whose ends values and slopes are compared


@dataclass(frozen=True)
class Prescribed:
    """Functions of distance or time, of which those of distance act at places that move with the vehicle.

    Parameters:
        functions: k of them, m or rad.
        places: (p,) m ahead of the vehicle's reference point; 0 for functions of time.
    """

    functions: LocalPolynomials
    places: Array

    def resolved(self, start: float, end: float, rate: float, tolerance: float) -> bool:
        """Whether all functions are, over an interval, the cubics through their values and rates at both ends within a
        tolerance of values, m and rad, and a hundred 1/s of it of rates.

        Parameters:
            start, end: m, of the reference point; or s.
            rate: of the distance, m/s; 1 for functions of time.
            tolerance: m and rad.
        """
        slope = RATE_SCALE * tolerance / rate
        return not any(
            differ(*self._arrays, start + place, end + place, tolerance, slope) for place in self.places.tolist()
        )

    @cached_property
    def _arrays(self) -> tuple[Array, Array]:
        """Starts and coefficients in the order of rows, for which the compiled function is made."""
        return np.ascontiguousarray(self.functions.starts), np.ascontiguousarray(self.functions.coefficients)


@dataclass(frozen=True)
class Excitation:
    """Motion of the track under a vehicle, its reference motion, and loads over distance, as a step sees them.

    Parameters:
        dynamics: equations of motion.
        tolerance: atol of positions and angles, m and rad.

    A method knows what is prescribed at its few stages only: none of a step that is too long may meet a curve, a joint,
    or a change of speed or load. A step resolves a function if the cubic through its values and rates at both ends
    differs from it by at most 10 tolerances throughout: atol in m and rad, 100 atol in m/s and rad/s. The functions are
    heading, cant and gradient of the track under each body; y and z of both rails under each wheelset; the distance of
    the reference motion; and the displacement that a load over distance would give the mass of its body alone. Linear
    loads over time are resolved by steps that end at their kinks.
    """

    dynamics: VehicleDynamics
    tolerance: float

    @cached_property
    def of_distance(self) -> tuple[Prescribed, ...]:
        """Alignment and rails."""
        vehicle, line = self.dynamics.vehicle, self.dynamics.track
        places = np.unique([body.x for body in vehicle.bodies.values()])
        found = [Prescribed(_alignment(line), places)] if len(TrackSections(line).breaks) > 1 else []
        if line.irregularities is not None:
            wheelsets = np.array([vehicle.bodies[name].x for name in vehicle.wheelsets])
            found.append(Prescribed(_rails(line.irregularities), wheelsets))
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
        """Longest step s, but for a third, that resolves all functions and is not longer than a given one, nor on
        discrete sleepers than a third of the time from one to the next.

        Parameters:
            time: s.
            state: (n,).
            at: evaluation there.
            step: s.
        """
        if self.dynamics.structure is not None:
            _, speed = self.dynamics.progress(time, state)
            step = min(step, self.dynamics.structure.period / (3.0 * speed))
        if self._resolves(time, state, at, step):
            return step
        while step > SHORTEST:
            step *= 0.5
            if self._resolves(time, state, at, step):
                return longer if self._resolves(time, state, at, longer := 1.5 * step) else step
        return step

    def _resolves(self, time: float, state: Array, at: VehicleEvaluation, step: float) -> bool:
        """Whether a step of a length s resolves all functions."""
        allowed = TOLERANCES * self.tolerance
        if self.reference is not None and not self.reference.resolved(time, time + step, 1.0, allowed):
            return False
        if not (self.of_distance or self.loads):
            return True
        d = self.dynamics
        before, after = d.speed_profile(time), d.speed_profile(time + step)
        (ahead, faster), (_, acceleration) = d.drift(state), d.drift(at.rate)
        start = before.distance + float(ahead)
        end = after.distance + float(ahead + step * (faster + 0.5 * step * max(float(acceleration), 0.0)))
        speed = (end - start) / step
        return all(f.resolved(start, end, speed, allowed) for f in self.of_distance) and all(
            f.resolved(start, end, speed, allowed * speed**2) for f in self.loads
        )

    def _loads(self) -> Iterator[Prescribed]:
        d = self.dynamics
        owners = [*d.applied.wheelsets.tolist(), *np.repeat(d.applied.bodies, 3).tolist()]
        torques = len(d.applied.wheelsets)
        for index, (table, owner) in enumerate(zip(d.loads.tables, owners, strict=True)):
            if table.by_distance and len(table.points) > 1:
                arm = d.vehicle.radius if index < torques else 1.0
                body = d.vehicle.bodies[d.vehicle.names[owner]]
                acceleration = _linear(table, 1.0 / (arm * body.mass))
                yield Prescribed(acceleration.integral.integral, np.array([body.x]))


def _alignment(track: Track) -> LocalPolynomials:
    """Heading, cant angle and gradient, rad."""
    whole = TrackSections(track).alignment
    factors = np.array([1.0, 1.0 / track.base, 1.0])
    return LocalPolynomials(whole.starts, whole.coefficients[:, :, [0, 2, 3]] * factors)


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


@borrowing
def differ(starts: Array, coefficients: Array, first: float, last: float, value: float, slope: float) -> bool:
    """Whether a function differs, between two abscissae, from the cubic through its values and slopes at both.

    Parameters:
        starts: (m,), of the pieces, the first and the last of which are unbounded.
        coefficients: (m, degree + 1, k), see `LocalPolynomials`.
        first, last: abscissae.
        value, slope: differences that are not exceeded.
    """
    span, begin = last - first, piece_at(starts, first)
    for k in range(coefficients.shape[2]):
        at_start, left = value_and_slope(starts, coefficients, begin, k, first)
        at_end, right = value_and_slope(starts, coefficients, piece_at(starts, last), k, last)
        rise, left, right = at_end - at_start, left * span, right * span
        bend, piece, low = left + right - 2.0 * rise, begin, first
        while low < last:
            high = min(last, starts[piece + 1]) if piece + 1 < len(starts) else last
            for part in range(1, PARTS + 1):
                s = low + (high - low) * part / PARTS
                u = (s - first) / span
                there, tilt = value_and_slope(starts, coefficients, piece, k, s)
                cubic = u * (rise + (1.0 - u) * (left - rise - u * bend))
                if abs(there - at_start - cubic) > value:
                    return True
                if abs(tilt - (left + u * (2.0 * (rise - left - bend) + 3.0 * u * bend)) / span) > slope:
                    return True
            piece, low = piece + 1, high
    return False


@borrowing
def piece_at(starts: Array, s: float) -> int:
    """Index of the piece at an abscissa."""
    low, high = 0, len(starts) - 1
    while low < high:
        middle = (low + high + 1) // 2
        if s >= starts[middle]:
            low = middle
        else:
            high = middle - 1
    return low


@borrowing
def value_and_slope(starts: Array, coefficients: Array, piece: int, function: int, s: float) -> tuple[float, float]:
    """Value and slope of a polynomial of a piece."""
    x, value, slope = s - starts[piece], 0.0, 0.0
    for power in range(coefficients.shape[1] - 1, -1, -1):
        slope = slope * x + value
        value = value * x + coefficients[piece, power, function]
    return value, slope
