"""Derivatives of the equations of motion of a vehicle with respect to the state and time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.loading.flexible_state import MOTIONS, by_parts
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.contact_differences import ContactDifferences, renewed
from wheelrail.vehicle.multibody.coordinates import PITCH, ROLL, YAW, X, Y, Z
from wheelrail.vehicle.multibody.equations import (
    VehicleDynamics,
    VehicleEvaluation,
    WheelContacts,
    all_side_wrenches,
    side_wrenches,
    wheelset_wrenches,
)
from wheelrail.vehicle.track.speed_profile import TrackPosition

# Steps of `WheelsetState.coordinates`, well above the residual noise of a contact solve; those antisymmetric in y are
# differentiated centrally, which keeps the mirror symmetry.
DIFFERENCE_STEPS = (1e-6, 1e-6, 2e-6, 2e-6, 1e-3, 1e-3, 2e-3, 2e-3, 2e-3)
ODD = ("y", "roll", "yaw", "y_rate", "roll_rate", "yaw_rate")
FRICTION_STEP = 1e-3  # of the factor
FIRST_RATE = WheelsetState.coordinates.index("y_rate")
RATES = slice(FIRST_RATE, len(WheelsetState.coordinates))
PITCH_RATE = WheelsetState.coordinates.index("pitch_rate") - FIRST_RATE


@dataclass(frozen=True)
class VehicleLinearisation:
    """Derivatives of the rate (n,), n = 2 c + m + k.

    Parameters:
        by_state: (n, n).
        by_time: (n,) at constant contact forces, but for the motion of irregular rails.
        exact: whether those of the contact forces are tangents of this state.
        outputs: (6 w, n) N, derivatives of the forces of the left and the right wheel of each wheelset; None: none.
        tangents: (w, 2, 6, 9 or 27), derivatives of force and moment of each wheel by the wheelset's coordinates.
    """

    by_state: Array
    by_time: Array
    exact: bool = True
    outputs: Array | None = None
    tangents: Array | None = None


class RailSlopes(NamedTuple):
    """Derivatives (w, 2, 2, 1) of the displacements y, z of irregular rails at the wheels by distance, and by time in
    the reference motion.
    """

    by_distance: Array
    by_time: Array


class ContactTangents(NamedTuple):
    """Derivatives (w, 2, 6, 10 or 28) of force and moment of each wheel; whether they are the contact model's own. With
    independent wheels there is one more, by the rate of the twist.
    """

    values: Array
    own: Array
    exact: bool


@dataclass
class VehicleJacobian:
    """Linearisation at a time s and state (n,) with its evaluation.

    Parameters:
        dynamics: the equations of motion.
        counts: statistics to which Jacobians and contact differences are added.
        central: central differences of contacts throughout, for uses of the matrix itself such as modes.
        differences: contact tangents (w, 2, 6, 9) by differences at an earlier state; None: none yet.
        needed: coordinates of the wheelsets by which differences are taken; derivatives by the others are zero.

    Suspension, inertia and kinematics: exact, at constant contact forces. Contact forces: the contact's tangent or,
    without one, differences.
    """

    dynamics: VehicleDynamics
    counts: StepStatistics
    central: bool = False
    differences: ContactDifferences | None = None
    needed: tuple[str, ...] = WheelsetState.coordinates

    def __call__(self, time: float, state: Array, at: VehicleEvaluation) -> VehicleLinearisation:
        """Derivatives of the rate.

        Parameters:
            time: s.
            state: (n,).
            at: evaluation at this time and state.

        Raises StepFailure when a contact solve or its tangent fails, and where axle and rails move and the contact has
        no tangent.
        """
        self.counts.jacobians += 1
        d, c = self.dynamics, self.dynamics.coordinates.count
        travel, (_, _, jerk) = d.speed_profile(time), d.speed_profile.speeds(time)
        bodies = d.bodies.derivatives(travel, jerk, state, wheelset_wrenches(at.contacts))
        states = d.wheelset_states(time, state) if at.states is None else at.states
        tangents, rails = self.tangents(states, at.contacts), self._rail_slopes(travel, state)
        if d.track.rubs:
            by_friction = self._by_friction(d.distances(travel, state), states, at.contacts)
            tangents = tangents._replace(values=np.concatenate([tangents.values, by_friction], axis=-1))
        forces = self._by_state(tangents.values[:, :, :3])
        result = VehicleLinearisation(self._kinematic.copy(), np.zeros(d.size), tangents.exact, forces, tangents.own)
        places = d.coordinates.of_bodies
        rows = places[len(d.coordinates.free) :]
        result.by_state[rows[:, None], places], result.by_time[rows] = bodies.by_state, bodies.by_time
        for i, (own, tangent) in enumerate(zip(self._own, tangents.values, strict=True)):
            self._add(result, i, c + own, bodies.by_wrench[:, own].T @ tangent, rails)
        if d.twists:
            self._add_twists(result, states, all_side_wrenches(at.contacts), tangents.values, rails)
        if d.structures.elastic:
            self._add_structures(result, travel, state, states, at.contacts, tangents.values, rails)
        return result

    def _by_state(self, tangents: Array) -> Array:
        """Derivatives (6 w, n) of the forces of all wheels, of tangents (w, 2, 3, 10 or 28)."""
        result = np.zeros((*tangents.shape[:3], self.dynamics.size))
        for i, own in enumerate(tangents):
            columns, free = self._columns[i]
            result[i][..., columns] = own[..., free]
        return result.reshape(-1, self.dynamics.size)

    def _rail_slopes(self, travel: TrackPosition, state: Array) -> RailSlopes | None:
        """Derivatives of the displacements of irregular rails at the wheels; None on smooth rails."""
        d = self.dynamics
        if not d.track.moves_rails:
            return None
        yaws = d.coordinates.split(state).position[d.coordinates.wheelset_bodies, YAW]
        # As in `VehicleDynamics`: yaw puts the left wheel behind.
        ways = d.vehicle.wheel_y * yaws[:, None] * [-1.0, 1.0]
        at = d.distances(travel, state)[:, None] + ways
        by_distance = d.track.rail_slopes(at.ravel()).reshape(*at.shape, 4)
        slopes = np.stack([by_distance[:, 0, :2], by_distance[:, 1, 2:]], axis=1)[..., None]
        return RailSlopes(slopes, travel.speed * slopes)

    def _add(
        self, result: VehicleLinearisation, i: int, rows: NDArray[np.int64], by_contact: Array, rails: RailSlopes | None
    ) -> None:
        """Add derivatives (2, rows, 10 or 28) of rates by the changes of both contacts of wheelset i."""
        columns, free = self._columns[i]
        result.by_state[rows[:, None], columns] += (by_contact[0] + by_contact[1])[:, free]
        if self.dynamics.track.rubs:
            result.by_time[rows] += by_contact[:, :, -1].sum(axis=0)
        if rails is not None:
            # Contact forces depend on the relative position only: rail motion is the opposite wheelset motion.
            result.by_time[rows] -= (by_contact[:, :, :2] @ rails.by_time[i]).sum(axis=0)[:, 0]
            x = 6 * int(self.dynamics.coordinates.wheelset_bodies[i]) + X
            if self.dynamics.drifts and (place := self._places.get(x)) is not None:
                result.by_state[rows, place] -= (by_contact[:, :, :2] @ rails.by_distance[i]).sum(axis=0)[:, 0]

    def _by_friction(self, distances: Array, states: Mapping[str, WheelsetState], contacts: WheelContacts) -> Array:
        """Rates (w, 2, 6, 1) of forces and moments by friction that changes along the track, from differences."""
        result = np.zeros((len(states), len(SIDES), 6, 1))
        for i, (name, state) in enumerate(states.items()):
            slope = self.dynamics.track.friction(float(distances[i]))[1]
            if slope != 0.0:
                change = self._perturbed(name, state, contacts, "friction", FRICTION_STEP) - side_wrenches(
                    contacts[name]
                )
                result[i, ..., 0] = state.speed * slope / FRICTION_STEP * change
        return result

    def _add_twists(
        self,
        result: VehicleLinearisation,
        states: Mapping[str, WheelsetState],
        wrenches: Array,
        tangents: Array,
        rails: RailSlopes | None,
    ) -> None:
        """Add the rows of the twists of independent wheels."""
        d, slopes = self.dynamics, self.dynamics.twists.slopes(states, wrenches)
        rows = np.arange(d.size)[d.coordinates.twist_rates]
        result.by_state[rows, : d.coordinates.size] = slopes.by_state
        for row, i, own in zip(rows, d.twists.wheelsets, slopes.by_wrench, strict=True):
            self._add(result, i, np.array([row]), own[:, None] @ tangents[i], rails)

    def _add_structures(
        self,
        result: VehicleLinearisation,
        travel: TrackPosition,
        state: Array,
        states: Mapping[str, WheelsetState],
        contacts: WheelContacts,
        tangents: Array,
        rails: RailSlopes | None,
    ) -> None:
        """Add the rows of the motions of axles and rails."""
        d, wheelsets, wrenches = self.dynamics, list(states.values()), all_side_wrenches(contacts)
        motions, distances = d.motions(state), d.distances(travel, state).tolist()
        by_contact = d.structures.load_slopes(wheelsets, wrenches, tangents)
        for (i, anywhere, own), slopes in zip(d.structures.elastic, by_contact, strict=True):
            structure, rows = anywhere.at(distances[i]), d.coordinates.size + np.arange(own.start, own.stop)
            self._add(result, i, rows, structure.by_loads @ slopes, rails)
            result.by_state[rows[:, None], rows] += structure.by_motions
            if not structure.varies:
                continue
            (load,) = structure.pairs.loads([wheelsets[i]], wrenches[[i]])
            by_distance = structure.rates_by_distance(motions[own], load)
            result.by_time[rows] += travel.speed * by_distance
            x = 6 * d.coordinates.wheelset_bodies[i] + X
            result.by_state[rows[:, None], np.flatnonzero(d.coordinates.free == x)] += by_distance[:, None]

    @cached_property
    def _kinematic(self) -> Array:
        """(n, n), derivatives of the coordinates' rates; zero elsewhere."""
        result, c = np.zeros((self.dynamics.size, self.dynamics.size)), self.dynamics.coordinates.count
        result[:c, c : 2 * c] = np.eye(c)
        return result

    @cached_property
    def _places(self) -> dict[int, int]:
        """Index in the state by index among all coordinates and rates."""
        coordinates = self.dynamics.coordinates
        return dict(zip(coordinates.within_all.tolist(), coordinates.of_bodies.tolist(), strict=True))

    @cached_property
    def _columns(self) -> list[tuple[NDArray[np.int64], NDArray[np.int64]]]:
        """Indices of each wheelset's free coordinates, motions and speed in the state, and of their columns in the
        tangents.
        """
        d = self.dynamics
        places, total = self._places, d.coordinates.held.size
        first = {own.wheelset: d.coordinates.size + own.states.start for own in d.structures.elastic}
        moving = len(MOTIONS) if first else 0
        rates = range(d.size)[d.coordinates.twist_rates]
        twists = dict(zip(d.twists.wheelsets, rates, strict=True))
        result = list[tuple[NDArray[np.int64], NDArray[np.int64]]]()
        for i, body in enumerate(d.coordinates.wheelset_bodies.tolist()):
            columns = [6 * body + k for k in (Y, Z, ROLL, YAW)]
            columns += [total + 6 * body + k for k in (Y, Z, ROLL, YAW, PITCH)]
            indices = [places.get(column, -1) for column in columns]
            indices += range(first[i], first[i] + moving) if i in first else [-1] * moving
            indices.append(places.get(total + 6 * body + X, -1))
            if d.twists:
                indices.append(twists.get(i, -1))
            free = np.flatnonzero(np.array(indices) >= 0)
            result.append((np.array(indices)[free], free))
        return result

    @cached_property
    def _own(self) -> list[NDArray[np.int64]]:
        """Indices in the state of the free coordinates of each wheelset."""
        return [self.dynamics.coordinates.of_body(body) for body in self.dynamics.coordinates.wheelset_bodies.tolist()]

    def tangents(self, states: Mapping[str, WheelsetState], contacts: WheelContacts) -> ContactTangents:
        """Derivatives of each wheel's force and moment by the wheelset's coordinates, moving hubs and rails, and the
        speed.

        With friction that does not depend on speed, forces depend on the ratio of all rates, that of the track frame
        included, to the speed V: dF/dV = -sum(rate dF/drate) / V. Raises StepFailure where hubs and rails move and the
        contact has no tangent.
        """
        tangents = self._analytical_tangents(states, contacts)
        exact = tangents is not None
        if tangents is None and self.dynamics.structures.elastic:
            raise StepFailure("the contact has no tangent, which elastic axles and rails on pads need")
        if tangents is None:
            tangents = self._differences(states, contacts)
        own = tangents
        if self.dynamics.structures.elastic:
            tangents = by_parts(tangents)
        by_rates = tangents[..., RATES]
        parts = [tangents, by_speed(tangents, list(states.values()))]
        if self.dynamics.twists:
            by_spin = by_rates[..., [PITCH_RATE]] * np.array([1.0, -1.0])[:, None, None]
            twists = np.array([s.twist_rate / s.speed for s in states.values()])
            parts = [tangents, parts[1] - twists[:, None, None, None] * by_spin, by_spin]
        return ContactTangents(np.concatenate(parts, axis=-1), own, exact)

    def _analytical_tangents(self, states: Mapping[str, WheelsetState], contacts: WheelContacts) -> Array | None:
        """Tangents (w, 2, 6, 9 or 27) of the contact model; None if it has none.

        Raises StepFailure when one fails.
        """
        try:
            tangents = self.dynamics.element.tangents(list(states.values()), [contacts[name] for name in states])
        except ValueError:  # some models and results have no tangent
            return None
        except (ArithmeticError, RuntimeError, np.linalg.LinAlgError) as error:
            raise StepFailure(f"tangent of a contact: {type(error).__name__}: {error}") from error
        return tangents if np.isfinite(tangents).all() else None

    def _differences(self, states: Mapping[str, WheelsetState], contacts: WheelContacts) -> Array:
        """Tangents (w, 2, 6, 9) by differences, reused from an earlier call where allowed."""
        self.differences = renewed(self.differences, lambda: self._differentiated(states, contacts))
        return self.differences.tangents

    def _differentiated(self, states: Mapping[str, WheelsetState], contacts: WheelContacts) -> Array:
        result = np.zeros((len(states), len(SIDES), 6, len(WheelsetState.coordinates)))
        for i, (name, state) in enumerate(states.items()):
            _, free = self._columns[i]
            for column, (key, step) in enumerate(zip(WheelsetState.coordinates, DIFFERENCE_STEPS, strict=True)):
                if column not in free or key not in self.needed:
                    continue
                try:
                    result[i, :, :, column] = self._difference(name, state, contacts, key, step)
                except StepFailure:  # close to the end of what the contact model can solve
                    result[i, :, :, column] = self._difference(name, state, contacts, key, 0.2 * step)
        return result

    def _difference(self, name: str, state: WheelsetState, contacts: WheelContacts, key: str, step: float) -> Array:
        """Derivatives (2, 6) of force and moment of each wheel of a wheelset by a coordinate, by finite differences."""
        plus = self._perturbed(name, state, contacts, key, step)
        if not self.central and key not in ODD:
            return np.asarray((plus - side_wrenches(contacts[name])) / step)
        return np.asarray((plus - self._perturbed(name, state, contacts, key, -step)) / (2 * step))

    def _perturbed(self, name: str, state: WheelsetState, contacts: WheelContacts, key: str, step: float) -> Array:
        self.counts.differences += 1
        perturbed = replace(state, **{key: getattr(state, key) + step})
        return side_wrenches(self.dynamics.solve_wheelset(name, perturbed, contacts))


def by_speed(tangents: Array, states: Sequence[WheelsetState]) -> Array:
    """Derivatives (w, s, 6, 1) by the speed of w states, from derivatives (w, s, 6, n) by coordinates; see
    `VehicleJacobian.tangents`.
    """
    rates = np.array([[getattr(s, name) for name in WheelsetState.coordinates[RATES]] for s in states])
    speeds = np.array([s.speed for s in states])
    return -np.asarray(np.einsum("wsij,wj->wsi", tangents[..., RATES], rates / speeds[:, None]))[..., None]
