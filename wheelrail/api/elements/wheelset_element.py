"""Contact of both wheels of a wheelset as an element of a time integration."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.api.elements.checks import checked_motions, checked_numbers, checked_rates, checked_shifts
from wheelrail.api.elements.variables import FORCES, INPUTS, OUTPUTS
from wheelrail.api.elements.wheelset_arrays import inputs_of, invalid_input, patch_values, state_of, write_outputs
from wheelrail.bindings._contact import CREEPAGE_STEP, RAIL_INPUTS, SPEED_INPUT
from wheelrail.contact.element.contact_element import ContactElement
from wheelrail.contact.element.element_solution import ElementSolution
from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from wheelrail.contact.results.vehicle_contact import VehicleContact


COORDINATES = len(WheelsetState.coordinates)
TRACK_FRAME = tuple(range(SPEED_INPUT, RAIL_INPUTS))  # numbers of the motion of the track frame


class WheelsetElement(ContactElement[WheelsetState, Side]):
    """Contact of both wheels of a wheelset as an element of a time integration, from `wheelrail.Wheelset.element`.

    Parameters:
        contact: model of both contacts.
        radius: nominal rolling radius, m.
        default: values of arguments that a solve does not give.
        curvature: of the track, 1/m.

    SI units; x forward, y to the left, z up; forces act on the wheels, moments are about the wheelset's centre. With
    an elastic axle or pads every solve finds the motions of hubs and rails under its loads, and the tangent has them
    follow; the wheelset's centre is the middle of the line through its hubs.
    """

    def __init__(self, contact: VehicleContact, radius: float, default: WheelsetState, curvature: float) -> None:
        super().__init__(contact, SIDES)
        self._default, self._radius, self._curvature = default, radius, curvature

    def solve(
        self,
        *,
        y: float | None = None,
        z: float | None = None,
        roll: float | None = None,
        yaw: float | None = None,
        y_rate: float | None = None,
        z_rate: float | None = None,
        roll_rate: float | None = None,
        yaw_rate: float | None = None,
        pitch_rate: float | None = None,
        speed: float | None = None,
        frame_rate: Sequence[float] | None = None,
        rail_shift: Sequence[Sequence[float]] | None = None,
        wheel_motion: Sequence[Sequence[float]] | None = None,
        rail_motion: Sequence[Sequence[float]] | None = None,
    ) -> ElementSolution[WheelsetState, Side]:
        """Solve both contacts of a trial state, starting from the last accepted one.

        Parameters:
            y, z: position of the wheelset's centre, m, z above the nominal height.
            roll, yaw: rad.
            y_rate, z_rate: m/s.
            roll_rate, yaw_rate: time derivatives of roll and yaw, rad/s.
            pitch_rate: spin about the axle, rad/s, positive when rolling forward; pure rolling by default.
            speed: of the track frame along the track, m/s.
            frame_rate: (3,) angular velocity of the track frame, rad/s; that of the wheelset's curvature by default.
            rail_shift: ((y, z), (y, z)), displacement of the left and the right rail by irregularities, m.
            wheel_motion: of the left and the right wheel about its centre, x, y, z, then about x, y, z in the axes of
                the wheelset; rail_motion: of the left and the right rail, y, z, then roll about the middle of its foot;
                m and rad, 0 by default. Only of an element for a program that knows them, see `Wheelset.element`.

        Other defaults are those of the `Wheelset`. A contact that cannot be solved gives status "failed: ..." and no
        exception. Raises SceneError for values that are not numbers in range, naming argument and value.
        """
        numbers = {
            "y": y,
            "z": z,
            "roll": roll,
            "yaw": yaw,
            "y_rate": y_rate,
            "z_rate": z_rate,
            "roll_rate": roll_rate,
            "yaw_rate": yaw_rate,
            "pitch_rate": pitch_rate,
            "speed": speed,
        }
        given: dict[str, Any] = checked_numbers(numbers)
        if speed is not None:
            given.setdefault("pitch_rate", given["speed"] / self._radius)
            given["frame_rate"] = (0.0, 0.0, given["speed"] * self._curvature)
        if frame_rate is not None:
            given["frame_rate"] = checked_rates("frame_rate", frame_rate)
        if rail_shift is not None:
            given["rail_shift"] = checked_shifts("rail_shift", rail_shift)
        if wheel_motion is not None or rail_motion is not None:
            given["motions"] = self._given_motions(wheel_motion, rail_motion)
        return self.solve_state(replace(self._default, **given))

    def _given_motions(self, wheels: object, rails: object) -> tuple[float, ...]:
        """Motions (18,) of a `FlexibleState`. Raises SceneError, also where the program does not know them."""
        from wheelrail.contact.loading.flexible_state import FlexibleState
        from wheelrail.contact.loading.flexible_wheelset import MIRRORED_HUB, MIRRORED_RAIL

        if not isinstance(self._default, FlexibleState):
            raise SceneError('solve: wheel_motion, rail_motion: allowed only with element(host=["wheels", "rails"])')
        left, right = checked_motions("wheel_motion", np.zeros((2, 6)) if wheels is None else wheels, 3, 3)
        left_rail, right_rail = checked_motions("rail_motion", np.zeros((2, 3)) if rails is None else rails, 2, 1)
        return (*left, *(MIRRORED_HUB * right).tolist(), *left_rail, *(MIRRORED_RAIL * right_rail).tolist())

    def motions(self) -> dict[Side, tuple[Array, Array]]:
        """Motions of hub (6,) and rail (3,), m and rad, at the last solved state. Hub: x, y, z, then about x, y, z,
        relative to the line through the journals. Rail: y, z, then roll about its foot.

        Raises ValueError when it failed, or there is none, and for rigid axle and clamped rails.
        """
        from wheelrail.contact.loading.quasi_static_contact import QuasiStaticContact

        results = self._solved("motions").results
        if not isinstance(self.contact, QuasiStaticContact):
            raise ValueError("motions: the axle is rigid, and the rails are clamped")
        return {side: self.contact.motions(results[side], side) for side in SIDES}

    def start_array(self) -> Array:
        """Inputs (17,) of the state that `solve()` without arguments solves, in the order of `variables.INPUTS`.

        Raises SceneError as `solve_array`.
        """
        self._check_arrays("start_array")
        return inputs_of(self._default)

    def solve_array(self, inputs: Array, outputs: Array) -> str:
        """Solve both contacts of a trial state, arrays in and out; for right-hand sides and programs in C.

        Parameters:
            inputs: (17,), numbers in the order of `variables.INPUTS`, all of them: the spin, too.
            outputs: (14,), filled in the order of `variables.OUTPUTS`; forces of a side that failed are NaN.

        Returns the status of `ElementSolution`. Inputs that are not finite or out of range fail, without an exception:
        trial states of an integrator may be wild. Raises ValueError for arrays of another size, SceneError for an
        element whose program gives motions of wheels or rails, which only `solve` takes.
        """
        self._check_arrays("solve_array")
        if inputs.shape != (len(INPUTS),) or outputs.shape != (len(OUTPUTS),):
            sizes = f"({len(INPUTS)},) and ({len(OUTPUTS)},), got {inputs.shape} and {outputs.shape}"
            raise ValueError(f"solve_array: inputs and outputs must be arrays {sizes}")
        values = inputs.tolist()
        if invalid := invalid_input(values):
            self._latest = None
            outputs[:] = np.nan
            return f"failed: {invalid}"
        solution = self.solve_state(state_of(values))
        write_outputs([solution.results[side] for side in SIDES], outputs)
        return solution.status

    def tangent_array(self, columns: Sequence[int] = tuple(range(len(INPUTS)))) -> Array:
        """Derivatives (12, n) of `variables.FORCES` by inputs at the last solved state.

        Parameters:
            columns: numbers of the n inputs, all by default.

        Those by the nine coordinates and by the displacements of the rails are those of `tangent` (for the rails
        without the velocity that the frame's rotation gives to the displaced rail, a part of 1e-5); those by the
        motion of the track frame are central differences, two solves each. Raises ValueError as `tangent`, and
        SceneError as `solve_array`.
        """
        self._check_arrays("tangent_array")
        by_coordinates = self.tangent().values
        derivatives = np.zeros((len(FORCES), len(INPUTS)))
        derivatives[:, :COORDINATES] = by_coordinates.reshape(len(FORCES), COORDINATES)
        for side in range(len(SIDES)):
            rail = RAIL_INPUTS + 2 * side
            derivatives[6 * side : 6 * side + 6, rail : rail + 2] = -by_coordinates[side, :, :2]
        inputs = inputs_of(self._solved("tangent").state)
        size = CREEPAGE_STEP * (inputs[SPEED_INPUT] or 1.0)  # at standstill, without friction: the derivatives are zero
        for number in set(columns) & set(TRACK_FRAME):
            step = size * (np.arange(len(INPUTS)) == number)
            ahead, behind = self._forces(inputs + step), self._forces(inputs - step)
            derivatives[:, number] = (ahead - behind) / (2 * size)
        return derivatives[:, columns]

    def _check_arrays(self, caller: str) -> None:
        """Raises SceneError for states with more than position and velocity of the wheelset."""
        if type(self._default) is not WheelsetState:
            raise SceneError(f"{caller}: not allowed with element(host=...), whose motions are arguments of solve")

    def _forces(self, inputs: Array) -> Array:
        """Forces and moments (12,) from the accepted state, which is not changed."""
        outputs = np.zeros(len(OUTPUTS))
        results = dict(self.solve_sides(state_of(inputs.tolist()), self._accepted))
        write_outputs([results[side] for side in SIDES], outputs)
        return outputs[: len(FORCES)]

    def patch_array(self) -> Array:
        """The most loaded patch of each side at the last solved state, (2, 13), in the order of `variables.PATCH`.

        Raises ValueError as `patches`.
        """
        patches = self.patches()
        return np.array([patch_values(patches[side]) for side in SIDES])
