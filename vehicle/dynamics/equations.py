"""Equations of motion of the plane wagon in the moving track frame."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from wheelrail.contact.element.contact_element import ContactElement
from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.state import COUNT, Split, split
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.track.frame import Frame
from wheelrail.vehicle.track.speed_profile import SpeedProfile
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.suspension import Assembly
from wheelrail.vehicle.wagon.wagon import Wagon

if TYPE_CHECKING:
    from wheelrail.contact.loading.structure import Structure

Contacts = dict[Side, ContactResult]


@dataclass(frozen=True)
class Wrench:
    """Resultant of both contacts on the wheelset, in the track's axes.

    Parameters:
        force: (3,) N.
        moment: (3,) N m about the centre of the wheelset.
    """

    force: Array
    moment: Array

    @classmethod
    def of(cls, contacts: Contacts) -> Wrench:
        force: Array = np.sum([c.force for c in contacts.values()], axis=0)
        moment: Array = np.sum([c.moment for c in contacts.values()], axis=0)
        return cls(force, moment)


def wrenches(contacts: Contacts) -> Array:
    """Force and moment (2, 6) of the left and the right wheel, N and N m."""
    return np.array([np.concatenate([contacts[side].force, contacts[side].moment]) for side in SIDES])


@dataclass(frozen=True)
class Evaluation:
    """Result of one evaluation of the equations of motion.

    Parameters:
        rate: (20 + m + k,) time derivative of the state.
        contacts: contact results by side.
        yaw_reaction: N m, constraint moment about the wheelset's vertical axis (yaw is not a degree of freedom).
        guess: contact results from which the contact solves started.
    """

    rate: Array
    contacts: Contacts
    yaw_reaction: float
    guess: Contacts | None = None


class InertialForces(NamedTuple):
    """Inertial forces of the moving frame.

    Parameters:
        on_bodies: (..., 3, 3) lateral and vertical force N and roll moment N m on the three bodies.
        about_axle, about_vertical: (...) N m about the wheelset's axle and about its vertical axis.
    """

    on_bodies: Array
    about_axle: Array
    about_vertical: Array


@dataclass(frozen=True)
class Dynamics:
    """Equations of motion of a wagon on a track.

    Parameters:
        wagon: masses and suspension of the whole vehicle; `Wagon.scaling` reduces them to the plane model.
        track: alignment and irregularities.
        contact: model of the wheel-rail contacts.
        speed: constant, m/s, or a `SpeedProfile`.
        structure: axle and rails that move with the contact's loads; the contact then is that of a `FlexibleState`.

    Raises ValueError for a speed that is not positive and finite.
    """

    wagon: Wagon
    track: Track
    contact: VehicleContact
    speed: float | SpeedProfile
    structure: Structure | None = None

    def __post_init__(self) -> None:
        _ = self.speed_profile  # validates the speed

    @cached_property
    def speed_profile(self) -> SpeedProfile:
        return SpeedProfile.of(self.speed)

    @cached_property
    def element(self) -> ContactElement[WheelsetState, Side]:
        """Both contacts; an evaluation starts from the one before it, within a step from the stage before."""
        return ContactElement(self.contact, SIDES)

    @cached_property
    def plane(self) -> Wagon:
        return self.wagon.plane

    @cached_property
    def suspension(self) -> Assembly:
        return Assembly.of(self.wagon)

    @cached_property
    def constants(self) -> Array:
        """(5, 3): mass kg, roll, pitch and yaw inertia kg m2 and height m of the three bodies."""
        bodies = (self.plane.car_body, self.plane.bogie, self.plane.wheelset)
        rows = [(b.mass, b.roll_inertia, b.pitch_inertia, b.yaw_inertia, b.height) for b in bodies]
        return np.array(rows).T

    @property
    def size(self) -> int:
        """Length of a state: 20, plus one for the spring of each Maxwell element, plus the motions of the structure."""
        return 2 * COUNT + self.suspension.laws.states + self.motions

    @property
    def motions(self) -> int:
        """Number of motions of axle and rails in the state."""
        return 0 if self.structure is None else self.structure.size

    def split(self, state: Array) -> Split:
        """Parts of states (..., 20 + m + k)."""
        return split(state, self.motions)

    def frame(self, time: float) -> Frame:
        """The track frame at the vehicle's position at a time s."""
        return self.track.frame(*self.speed_profile(time))

    def rolling_rate(self, frame: Frame) -> float:
        """Spin of a wheel that rolls on its nominal radius, rad/s."""
        return frame.speed / self.wagon.radius

    def __call__(
        self, time: float, state: Array, previous: Evaluation | None = None, guess: Contacts | None = None
    ) -> Evaluation:
        """Time derivative of the state.

        Parameters:
            time: s.
            state: (20 + m + k,), see `wheelrail.vehicle.dynamics.state`.
            previous: evaluation whose contact results are the initial guess of the contact solves.
            guess: contact results in place of those of a previous evaluation.

        Raises StepFailure when a contact solve fails.
        """
        frame, guess = self.frame(time), previous.contacts if previous else guess
        contacts = self.solve_contacts(frame, state, guess)
        accelerations, yaw_reaction = self.accelerations(frame, state, Wrench.of(contacts))
        rate = np.concatenate(
            [state[COUNT : 2 * COUNT], accelerations, self.structure_rates(frame, state, wrenches(contacts))]
        )
        return Evaluation(rate, contacts, float(np.asarray(yaw_reaction).item()), guess)

    def wheelset_state(self, frame: Frame, state: Array) -> WheelsetState:
        """Position and velocity of the wheelset, with the motions of hubs and rails where they are elastic."""
        position, rate, _, pitch_rate, _, motions = self.split(state)
        y, z, roll = position[2].tolist()
        vy, vz, spin = rate[2].tolist()
        wheelset = WheelsetState(
            y=y,
            z=z,
            roll=roll,
            y_rate=vy,
            z_rate=vz,
            roll_rate=spin,
            pitch_rate=self.rolling_rate(frame) + float(pitch_rate),
            speed=frame.speed,
            frame_rate=frame.rate,
            rail_shift=frame.rails,
        )
        return wheelset if self.structure is None else self.structure.moved(wheelset, motions)

    def structure_rates(self, frame: Frame, state: Array, wrenches: Array) -> Array:
        """Rates (k,) of the motions of axle and rails.

        Parameters:
            frame: the track frame.
            state: (20 + m + k,).
            wrenches: (2, 6) of the contacts.
        """
        if self.structure is None:
            return np.zeros(0)
        structure, wheelset = self.structure.at(frame.distance), self.wheelset_state(frame, state)
        return structure.rates(self.split(state).motions, structure.loads(wheelset, wrenches))

    def solve_contacts(self, frame: Frame, state: Array, guess: Contacts | None) -> Contacts:
        """Both contacts; raises StepFailure for a result that failed or is not finite."""
        if not np.isfinite(state).all():
            raise StepFailure("the state is not finite")
        return self.solve_wheelset(self.wheelset_state(frame, state), guess)

    def solve_wheelset(self, wheelset: WheelsetState, guess: Contacts | None) -> Contacts:
        """Both contacts at a state of the wheelset; raises StepFailure as `solve_contacts`."""
        contacts: Contacts = {}
        for side, result in self.element.solve_sides(wheelset, guess):
            if not result.ok:
                raise StepFailure(f"{side} contact: {result.status}")
            contacts[side] = result
        return contacts

    def accelerations(self, frame: Frame, state: Array, contact: Wrench) -> tuple[Array, Array]:
        """Accelerations under given contact forces.

        Parameters:
            frame: the track frame.
            state: (..., 20 + m + k).
            contact: resultant of the contacts.

        Returns accelerations of the coordinates, then the m rates of the springs of Maxwell elements, (..., 10 + m);
        yaw reactions (...) N m.
        """
        position, rate, _, _, series, _ = self.split(state)
        loads, _, _, series_rate = self.suspension.forces(position, rate, series)
        inertial = self.inertial_forces(frame, state)
        loads += inertial.on_bodies
        loads[..., :2] += self.weight(frame)
        loads[..., 2, :] += contact.force[1], contact.force[2], contact.moment[0]

        result = np.empty((*state.shape[:-1], COUNT + series.shape[-1]))
        result[..., :9] = (loads / self.inertia).reshape(*state.shape[:-1], 9)
        result[..., COUNT:] = series_rate
        # Moments about the axle and the vertical axis of the wheelset: axes that roll but do not spin with it.
        wheelset_roll = np.ascontiguousarray(position[..., 2, 2])
        c, s = np.cos(wheelset_roll), np.sin(wheelset_roll)
        _, my, mz = contact.moment
        about_axle = my * c + mz * s + inertial.about_axle
        result[..., 9] = about_axle / self.constants[2, 2] - frame.acceleration / self.wagon.radius
        return result, -inertial.about_vertical - (mz * c - my * s)

    @cached_property
    def inertia(self) -> Array:
        """(3, 3): mass for y and z, roll inertia of the three bodies."""
        mass, roll, _, _, _ = self.constants
        return np.stack([mass, mass, roll], axis=1)

    def weight(self, frame: Frame) -> Array:
        """Lateral and vertical part (3, 2) of the weights of the three bodies, N."""
        return np.asarray(self.plane.gravity * np.outer(self.constants[0], frame.down[1:]))

    def inertial_forces(self, frame: Frame, state: Array) -> InertialForces:
        """Inertial forces of the moving frame on states (..., 20 + m + k), gyroscopic moments included."""
        position, rate, _, pitch_rate, _, _ = self.split(state)
        mass, ixx, iyy, izz, height = self.constants
        roll = np.ascontiguousarray(position[..., 2])
        lateral, vertical = frame.acceleration_of(
            position[..., 0], height + position[..., 1], rate[..., 0], rate[..., 1]
        )
        o_y, o_z = frame.rate_in_body_axes(roll)
        theta_rate = self.rolling_rate(frame) + pitch_rate
        gyroscopic = (izz - iyy) * o_y * o_z
        gyroscopic[..., 2] -= iyy[2] * theta_rate * o_z[..., 2]
        on_bodies = -np.stack([mass * lateral, mass * vertical, gyroscopic + ixx * frame.rate_dot[0]], axis=-1)

        wheelset_roll, roll_rate = np.ascontiguousarray(roll[..., 2]), rate[..., 2, 2]
        o_y, o_z = o_y[..., 2], o_z[..., 2]
        c, s = np.cos(wheelset_roll), np.sin(wheelset_roll)
        _, dy, dz = frame.rate_dot
        o_x = frame.rate[0] + roll_rate
        about_axle = -iyy[2] * (dy * c + dz * s + roll_rate * o_z)
        gyroscopic_yaw = o_x * iyy[2] * (o_y + theta_rate) - ixx[2] * o_x * o_y
        return InertialForces(on_bodies, about_axle, -(izz[2] * (dz * c - dy * s - roll_rate * o_y) + gyroscopic_yaw))
