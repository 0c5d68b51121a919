"""Equations of motion of a vehicle of rigid bodies on a track."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wheelrail.contact.element.contact_element import ContactElement
from wheelrail.contact.kinematics.copies import changed
from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.kinematics.wheelset_state import NO_SHIFT, RailShift, WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import (
    ContactsByWheelset,
    FrictionAlong,
    IndependentWheels,
    VehicleContact,
)
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.problem import Settle, StepFailure
from wheelrail.vehicle.loads.applied_loads import AppliedLoads
from wheelrail.vehicle.multibody.applied_forces import AppliedForces
from wheelrail.vehicle.multibody.body_equations import Accelerations, BodyEquations
from wheelrail.vehicle.multibody.coordinates import PITCH, RATE_SCALE, ROLL, YAW, Coordinates, X, Y, Z
from wheelrail.vehicle.multibody.elements import InvalidVehicle
from wheelrail.vehicle.multibody.structures import Structures
from wheelrail.vehicle.multibody.suspension_arrays import SuspensionArrays
from wheelrail.vehicle.multibody.twists import Twists
from wheelrail.vehicle.multibody.vehicle import Vehicle
from wheelrail.vehicle.track.section_poses import TrackSections
from wheelrail.vehicle.track.speed_profile import SpeedProfile, TrackPosition
from wheelrail.vehicle.track.track import Track

if TYPE_CHECKING:
    from wheelrail.contact.loading.structure import Structure

WheelContacts = Mapping[str, Mapping[Side, ContactResult]]  # by wheelset and side
NO_LOADS = AppliedLoads()


@dataclass(frozen=True)
class VehicleEvaluation:
    """Result of one evaluation of the equations of motion.

    Parameters:
        rate: (2 c + m + k,) time derivative of the state.
        contacts: results by wheelset and side.
        guess: results from which the contact solves started; None: none.
        states: of the wheelsets, each in the track frame at its own distance; None: not at hand.
        solved: state (n,) nearby at which the contacts were solved, and the guess of these solves; None: at this state.
    """

    rate: Array
    contacts: WheelContacts
    guess: WheelContacts | None = None
    states: Mapping[str, WheelsetState] | None = None
    solved: tuple[Array, WheelContacts | None] | None = None


@dataclass(frozen=True)
class VehicleDynamics:
    """Equations of motion of a vehicle of w wheelsets on a track.

    Parameters:
        vehicle: bodies and suspension.
        track: alignment and irregularities.
        contact: model of the wheel-rail contacts, the same for all wheelsets or `ContactsByWheelset`.
        speed: of the reference motion along the track, constant, m/s, or a `SpeedProfile`.
        structure: axle and rails that move with the contact's loads, with k motions in all; the contact then is that of
            a `FlexibleState`. One for all wheelsets or one for each, None where both are rigid.
        loads: torques on the wheelsets and forces on the bodies.

    A state (2 c + m + k,) has the parts of `Coordinates`, then the motions of the structures. Each body is described
    in the track frame at its own distance along the track. Raises ValueError for a speed that is not positive and
    finite and for a number of structures that is not that of the wheelsets, InvalidVehicle for a body that the vertical
    springs cannot carry, and for loads that do not fit the vehicle.
    """

    vehicle: Vehicle
    track: Track
    contact: VehicleContact
    speed: float | SpeedProfile
    structure: Structure | Sequence[Structure | None] | None = None
    loads: AppliedLoads = NO_LOADS

    def __post_init__(self) -> None:
        _ = self.speed_profile, self.suspension.static_loads, self.applied, self.structures  # validates all
        if isinstance(self.contact, ContactsByWheelset):
            for name in self.contact.own:
                if name not in self.vehicle.wheelsets:
                    wheelsets = ", ".join(self.vehicle.wheelsets)
                    raise InvalidVehicle("contact", f"of an unknown wheelset {name!r}: must be one of {wheelsets}")

    @cached_property
    def speed_profile(self) -> SpeedProfile:
        return SpeedProfile.of(self.speed)

    @cached_property
    def coordinates(self) -> Coordinates:
        return Coordinates(self.vehicle)

    @cached_property
    def suspension(self) -> SuspensionArrays:
        return SuspensionArrays(self.coordinates)

    @cached_property
    def bodies(self) -> BodyEquations:
        """Equations of motion of the bodies under given contact forces."""
        return BodyEquations(self.suspension, TrackSections(self.track), self.applied)

    @cached_property
    def twists(self) -> Twists:
        """Equations of wheelsets whose wheels turn by themselves."""
        return Twists(self.coordinates)

    @cached_property
    def structures(self) -> Structures:
        """Axle and track of each wheelset."""
        return Structures.of(self.structure, len(self.vehicle.wheelsets))

    @cached_property
    def applied(self) -> AppliedForces:
        return AppliedForces(self.coordinates, self.loads)

    @property
    def runs_free(self) -> bool:
        """Whether nothing keeps the vehicle at its place in the reference motion."""
        return self.vehicle.speed_hold is None and not self.coordinates.held[:, X].any()

    @property
    def drifts(self) -> bool:
        """Whether the vehicle may move away from its place in the reference motion by more than some millimetres."""
        return self.runs_free or bool(self.loads)

    @cached_property
    def drifting(self) -> NDArray[np.bool_]:
        """Components (2 c + m + k,) of a state that contain the distance from the reference motion: x of all bodies,
        the wheelsets' angles of rolling, and their rates.
        """
        free, result = self.coordinates.free, np.zeros(self.size, dtype=bool)
        along = np.flatnonzero((free % 6 == X) | np.isin(np.arange(len(free)), self.coordinates.rolling_angles))
        result[along] = result[self.coordinates.count + along] = True
        return result

    def drift(self, state: Array) -> tuple[Array, Array]:
        """Distance m and speed m/s of the centre of mass relative to the reference motion, of states (..., n)."""
        position, rate, _ = self.coordinates.split(state)
        share = self.mass / self.mass.sum()
        return np.asarray(position[..., X] @ share), np.asarray(rate[..., X] @ share)

    def progress(self, time: float, state: Array) -> tuple[float, float]:
        """Distance m that the vehicle has run at a time s, and its speed m/s: of a vehicle that runs free those of its
        centre of mass, otherwise those of the reference motion.
        """
        distance, speed, *_ = self.speed_profile(time)
        if not self.runs_free:
            return distance, speed
        ahead, faster = self.drift(state)
        return distance + float(ahead), speed + float(faster)

    def with_constant_loads(self, time: float) -> VehicleDynamics:
        """The same with torques and forces constant at their values at a time s."""
        if not self.loads:
            return self
        return replace(self, loads=self.loads.at(time, self.speed_profile(time).distance))

    @cached_property
    def element(self) -> ContactElement[WheelsetState, Side]:
        """Both contacts of a wheelset."""
        contact = FrictionAlong(self.contact) if self.track.rubs else self.contact
        return ContactElement(IndependentWheels(contact) if self.twists else contact, SIDES)

    @cached_property
    def mass(self) -> Array:
        return np.array([body.mass for body in self.vehicle.bodies.values()])

    @cached_property
    def inertia(self) -> Array:
        """(n, 3) kg m2."""
        return np.array([body.inertia for body in self.vehicle.bodies.values()])

    @property
    def size(self) -> int:
        """Length of a state."""
        return self.coordinates.size + self.structures.size

    def motions(self, state: Array) -> Array:
        """Motions (..., k) of axles and rails of states (..., 2 c + m + k)."""
        return state[..., self.coordinates.size :]

    def tolerances(self, atol: float) -> Array:
        """Absolute tolerances (2 c + m + k,) for implicit steps, see `Coordinates.tolerances`; those of the rates of
        tracks with mass are 100 atol.
        """
        motions = np.where(self.structures.velocities, RATE_SCALE * float(atol), float(atol))
        return np.concatenate([self.coordinates.tolerances(atol), motions])

    def __call__(
        self,
        time: float,
        state: Array,
        previous: VehicleEvaluation | None = None,
        guess: WheelContacts | None = None,
    ) -> VehicleEvaluation:
        """Time derivative of the state.

        Parameters:
            time: s.
            state: (2 c + m + k,), see `wheelrail.vehicle.multibody.coordinates`.
            previous: evaluation whose contact results are the initial guess of the contact solves.
            guess: contact results that are the initial guess instead.

        Raises StepFailure when a contact solve fails.
        """
        start = previous.contacts if guess is None and previous is not None else guess
        return changed(self.under(time, state, lambda states: self._solve_contacts(states, start)), guess=start)

    def under(
        self, time: float, state: Array, contacts_of: Callable[[Mapping[str, WheelsetState]], WheelContacts]
    ) -> VehicleEvaluation:
        """Time derivative of a state under contacts by the states of the wheelsets."""
        _require_finite(state)
        travel = self.speed_profile(time)
        sections = self.bodies.sections(travel, state)
        states = self._wheelset_states(travel, state, sections)
        contacts, c = contacts_of(states), self.coordinates.count
        accelerations = self._accelerations(travel, state, states, contacts, sections)
        structure = self._structure_rates(travel, state, states, contacts)
        rate = np.concatenate([state[c : 2 * c], accelerations, structure])
        return VehicleEvaluation(rate, contacts, states=states)

    @property
    def settle(self) -> Settle | None:
        """How the sliders of frictional elements follow a step; None: there are none."""
        return self._settled if self.coordinates.sliders else None

    def _settled(self, t0: float, x0: Array, t: float, x: Array) -> tuple[Array, Array]:
        """State (2 c + m + k,) at the end of a step with its sliders drawn along, and errors m of the sliders."""
        return self.bodies.settled((self.speed_profile(t0), self.speed_profile(t)), (x0, x))

    def accelerations_by(self, time: float, state: Array, contacts: WheelContacts) -> Array:
        """Accelerations (c,) of the coordinates, then rates (m,) of Maxwell elements, under the contacts' loads."""
        travel = self.speed_profile(time)
        sections = self.bodies.sections(travel, state)
        states = self._wheelset_states(travel, state, sections)
        return self._accelerations(travel, state, states, contacts, sections)

    def _accelerations(
        self,
        travel: TrackPosition,
        state: Array,
        states: Mapping[str, WheelsetState],
        contacts: WheelContacts,
        sections: Array,
    ) -> Array:
        rates = self.bodies.accelerations(travel, state, wheelset_wrenches(contacts), sections).rates
        if not self.twists:
            return rates
        own = self.twists.accelerations(state, states, all_side_wrenches(contacts))
        return np.insert(rates, self.coordinates.twists.start, own)

    def distances(self, travel: TrackPosition, state: Array) -> Array:
        """Distances (w,) m of the wheelsets along the track."""
        position, wheelsets = self.coordinates.split(state).position, self.coordinates.wheelset_bodies
        return np.asarray(travel.distance + (self.coordinates.places + position[..., X])[..., wheelsets])

    def structure_rates(self, time: float, state: Array, contacts: WheelContacts) -> Array:
        """Rates (k,) of the motions of axles and rails under the loads of the contacts at a time s."""
        return self._structure_rates(self.speed_profile(time), state, self.wheelset_states(time, state), contacts)

    def _structure_rates(
        self, travel: TrackPosition, state: Array, states: Mapping[str, WheelsetState], contacts: WheelContacts
    ) -> Array:
        """Rates (k,) of the motions of axles and rails."""
        rates = np.empty(self.structures.size)
        if not rates.size:
            return rates
        motions, distances = self.motions(state), self.distances(travel, state).tolist()
        loads = self.structures.loads(list(states.values()), all_side_wrenches(contacts))
        for (i, structure, own), load in zip(self.structures.elastic, loads, strict=True):
            rates[own] = structure.at(distances[i]).rates(motions[own], load)
        return rates

    def wheelset_states(self, time: float, state: Array) -> dict[str, WheelsetState]:
        """State of each wheelset in the track frame at its own distance."""
        travel = self.speed_profile(time)
        return self._wheelset_states(travel, state, self.bodies.sections(travel, state))

    def _wheelset_states(self, travel: TrackPosition, state: Array, sections: Array) -> dict[str, WheelsetState]:
        position, rate, _ = self.coordinates.split(state)
        states, rolling = dict[str, WheelsetState](), travel.speed / self.vehicle.radius
        for i, name in zip(self.coordinates.wheelset_bodies.tolist(), self.vehicle.wheelsets, strict=True):
            q, v = position[i].tolist(), rate[i].tolist()
            speed = travel.speed + v[X]
            if not speed > 0.0:
                raise StepFailure(f"{name} does not move forwards")
            wx, wy, wz = (speed * sections[i, 4]).tolist()
            states[name] = WheelsetState(
                y=q[Y],
                z=q[Z],
                roll=q[ROLL],
                yaw=q[YAW],
                y_rate=v[Y],
                z_rate=v[Z],
                roll_rate=v[ROLL],
                yaw_rate=v[YAW],
                pitch_rate=v[PITCH] + rolling,
                speed=speed,
                frame_rate=(wx, wy, wz),
                rail_shift=self._rail_shift(travel.distance + self.vehicle.bodies[name].x + q[X], q[YAW]),
                wheelset=name,
            )
        if self.track.rubs:
            for name, s in zip(self.vehicle.wheelsets, self.distances(travel, state).tolist(), strict=True):
                states[name] = changed(states[name], friction=self.track.friction(s)[0])
        rates = state[self.coordinates.twist_rates].tolist()
        for name, twist in zip(self.vehicle.independent, rates, strict=True):
            states[name] = changed(states[name], twist_rate=twist)
        motions = self.motions(state)
        for i, structure, own in self.structures.elastic:
            name = self.vehicle.wheelsets[i]
            states[name] = structure.moved(states[name], motions[own])
        return states

    def _rail_shift(self, distance: float, yaw: float) -> RailShift | None:
        """Displacement m of the rails at the wheels of a wheelset, of which yaw puts the left one behind the centre."""
        if not self.track.moves_rails:
            return None
        if yaw == 0.0:
            return self.track.rails(distance)
        left, right = (self.track.rails(distance + way * self.vehicle.wheel_y * yaw) for way in (-1.0, 1.0))
        return ((left or NO_SHIFT)[0], (right or NO_SHIFT)[1])

    def solve_contacts(self, time: float, state: Array, guess: WheelContacts | None) -> WheelContacts:
        """Contacts of all wheels; raises StepFailure for a result that failed or is not finite."""
        _require_finite(state)
        return self._solve_contacts(self.wheelset_states(time, state), guess)

    def _solve_contacts(
        self,
        states: Mapping[str, WheelsetState],
        guess: WheelContacts | None,
    ) -> WheelContacts:
        names, contacts = list(states), {name: dict[Side, ContactResult]() for name in states}
        starts = [guess[name] if guess else None for name in names]
        for i, side, result in self.element.solve_states(list(states.values()), starts):
            if not result.ok:
                wheel = side if len(self.vehicle.wheelsets) == 1 else f"{names[i]}, {side}"
                raise StepFailure(f"{wheel} contact: {result.status}")
            contacts[names[i]][side] = result
        return contacts

    def solve_wheelset(
        self, name: str, wheelset: WheelsetState, guess: WheelContacts | None
    ) -> Mapping[Side, ContactResult]:
        """Both contacts of a wheelset; raises StepFailure as `solve_contacts`."""
        return self._solve_contacts({name: wheelset}, guess)[name]

    def accelerations(self, time: float, state: Array, wrenches: Array) -> Accelerations:
        """Accelerations under given contact forces.

        Parameters:
            time: s.
            state: (2 c + m,).
            wrenches: (w, 6) force N and moment N m about the centre of each wheelset, in its track frame.
        """
        travel = self.speed_profile(time)
        return self.bodies.accelerations(travel, state, wrenches, self.bodies.sections(travel, state))

    def yaw_reactions(self, time: float, state: Array, wrenches: Array) -> Array:
        """Moments (w,) N m, about the track normal, of the yaw constraints of wheelsets, zero where free; parameters as
        for `accelerations`.
        """
        own = self.coordinates.wheelset_bodies
        reactions = self.accelerations(time, state, wrenches).reactions[own, YAW] * self.coordinates.held[own, YAW]
        # About the normal of the track the constraint has 1 / cos(roll) times its moment about the wheelset's own axis.
        return np.asarray(reactions / np.cos(self.coordinates.split(state).position[own, ROLL]))


def _require_finite(state: Array) -> None:
    """Raises StepFailure."""
    if not np.isfinite(state).all():
        raise StepFailure("the state is not finite")


def side_wrenches(contacts: Mapping[Side, ContactResult]) -> Array:
    """Force N and moment N m (2, 6) of the left and the right contact on a wheelset, in its track frame."""
    return np.array([np.concatenate([contacts[side].force, contacts[side].moment]) for side in SIDES])


def all_side_wrenches(contacts: WheelContacts) -> Array:
    """Force N and moment N m (w, 2, 6) of the left and the right contact on each wheelset, in its track frame."""
    return np.array([side_wrenches(sides) for sides in contacts.values()])


def wheelset_wrenches(contacts: WheelContacts) -> Array:
    """Force N and moment N m (w, 6) of both contacts on each wheelset, in its track frame."""
    parts = [part for sides in contacts.values() for side in SIDES for part in (sides[side].force, sides[side].moment)]
    left_and_right = np.concatenate(parts).reshape(len(contacts), len(SIDES), 6)
    return np.asarray(left_and_right.sum(axis=1))
