"""Contact elements behind numbers, with errors as text: what the C library calls."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit
from urllib.request import url2pathname
from weakref import WeakValueDictionary

import numpy as np

from wheelrail.api.elements.checks import WHEEL_LOAD
from wheelrail.api.elements.variables import INPUTS, PARAMETERS
from wheelrail.api.elements.wheelset_arrays import inputs_of, invalid_input, state_of
from wheelrail.api.elements.wheelset_element import TRACK_FRAME, WheelsetElement
from wheelrail.bindings._contact import sphere_approach
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.scenes.builders.wheelset import wheel_sphere
from wheelrail.support.arrays import Array
from wheelrail.support.text_file import json_value

if TYPE_CHECKING:
    from wheelrail.api.wheelset import Wheelset
    from wheelrail.contact.element.contact_element import ElementState
    from wheelrail.contact.kinematics.wheelset_state import WheelsetState

DONE, FAILED = 0, 1  # as in the C header
BOTH, EACH = 2, 3  # wheels, after the left and the right one
OTHERS = tuple(number for number in range(len(INPUTS)) if number not in TRACK_FRAME)
INPUT_NUMBERS = {variable.name: number for number, variable in enumerate(INPUTS)}
NOT_OF_THE_START = ("sides", "stress", "error_estimate")  # of a wheelset's solves
NOBODY = 0  # in place of an element's number: the last failed `open`


@dataclass
class OpenElement:
    """An element that a host program has opened.

    Parameters:
        wheelset: whose bodies and tables the element uses.
        element: the contact.
        error: text of the last failure.
        tangent: derivatives (12,) at the last solved state by number of the input, once they have been asked for.
        states: stored accepted states by number.
    """

    wheelset: Wheelset
    element: WheelsetElement
    error: str = ""
    tangent: dict[int, Array] = field(default_factory=dict)
    states: dict[int, ElementState[Any]] = field(default_factory=dict)


class Host:
    """All open elements of a process, by number from 1; those with equal options share bodies and tables.

    Every method returns DONE or FAILED, `open` a number or 0; none raises. The reason is `error`'s. One thread computes
    at a time: compiled code runs without the interpreter's lock.
    """

    def __init__(self) -> None:
        self._elements: dict[int, OpenElement] = {}
        self._count = 0
        self._error = ""
        self._wheelsets: WeakValueDictionary[str, Wheelset] = WeakValueDictionary()
        self._lock = Lock()

    def open(self, options: str, folder: str = "") -> int:
        """Number of a new element, 0 for a failure.

        Parameters:
            options: JSON object of arguments of `wheelrail.Wheelset`; "scene" is a scene file whose values they
                replace, "left_friction" and "right_friction" are coefficients of one side.
            folder: of the scene file, a path or a URL file://...; by default the working directory.
        """
        with self._lock:
            try:
                path = url2pathname(urlsplit(folder).path) if folder.startswith("file:") else folder
                wheelset = loaded_wheelset(options, Path(path))
                wheelset = self._wheelsets.setdefault(repr(wheelset), wheelset)
                opened = OpenElement(wheelset, wheelset.element())
            except Exception as error:  # of any library below: a host in C cannot catch it
                self._error = _text(error)
                return NOBODY
            self._count += 1
            self._elements[self._count] = opened
            return self._count

    def close(self, number: int) -> int:
        """Forget an element."""
        return self._with(number, lambda own: self._elements.pop(number))

    def start(self, number: int, inputs: Array) -> int:
        """Inputs (17,) of the state of the scene, in equilibrium with its load."""
        return self._with(number, lambda own: np.copyto(inputs, loaded_inputs(own.wheelset)))

    def solve(self, number: int, inputs: Array, outputs: Array) -> int:
        """Solve a trial state; outputs (14,) of a failed side are NaN."""
        return self._with(number, lambda own: _solve(own, inputs, outputs))

    def load(self, number: int, wheels: int, load: float, inputs: Array, outputs: Array) -> int:
        """Solve the height, of each wheel and the roll, at which wheels carry a load N; fills inputs and outputs."""

        def carry(own: OpenElement) -> None:
            outputs.fill(np.nan)
            inputs[:] = inputs_of(_state_under_load(own, wheels, load, inputs))
            _solve(own, inputs, outputs)

        return self._with(number, carry)

    def accept(self, number: int) -> int:
        """The next solves start from the last solved state."""
        return self._with(number, lambda own: own.element.accept())

    def tangent(self, number: int, column: int, derivatives: Array) -> int:
        """Derivatives (12,) of forces and moments by one input at the last solved state."""

        def write(own: OpenElement) -> None:
            if not 0 <= column < len(INPUTS):
                raise ValueError(f"tangent: input {column}: must be from 0 to {len(INPUTS) - 1}")
            if column not in own.tangent:
                group = TRACK_FRAME if column in TRACK_FRAME else OTHERS
                own.tangent.update(zip(group, own.element.tangent_array(group).T, strict=True))
            derivatives[:] = own.tangent[column]

        return self._with(number, write)

    def patches(self, number: int, values: Array) -> int:
        """The most loaded patch of each side (26,) at the last solved state."""
        return self._with(number, lambda own: np.copyto(values, own.element.patch_array().ravel()))

    def save(self, number: int, place: int) -> int:
        """Store the accepted state at a place of the caller's choice."""
        return self._with(number, lambda own: own.states.__setitem__(place, own.element.state()))

    def restore(self, number: int, place: int) -> int:
        """Return to a stored state."""

        def restore(own: OpenElement) -> None:
            if place not in own.states:
                raise ValueError(f"restore: no state has been saved at {place}")
            own.tangent.clear()
            own.element.restore(own.states[place])

        return self._with(number, restore)

    def error(self, number: int) -> str:
        """Text of the last failure of an element, or of `open` for 0."""
        own = self._elements.get(number)
        return own.error if own is not None else self._error

    def _with(self, number: int, action: Callable[[OpenElement], object]) -> int:
        with self._lock:
            own = self._elements.get(number)
            if own is None:
                self._error = f"element {number}: not open"
                return FAILED
            try:
                action(own)
            except Exception as error:
                own.error = _text(error)
                return FAILED
            return DONE


def _solve(own: OpenElement, inputs: Array, outputs: Array) -> None:
    own.tangent.clear()
    outputs.fill(np.nan)
    status = own.element.solve_array(inputs, outputs)
    if status.startswith("failed"):
        raise ValueError(status)


def _state_under_load(own: OpenElement, wheels: int, load: float, inputs: Array) -> WheelsetState:
    """State at the height, of each wheel also the roll, at which wheels carry a load. Raises ValueError, LoadError."""
    from wheelrail.contact.loading.wheelset import axle_under_load, wheel_under_load, wheels_under_load
    from wheelrail.contact.models.wheelset import WheelsetContact

    each, contact, arguments = 0.5 * load if wheels == BOTH else load, own.element.contact, own.wheelset.arguments
    if not 0 <= wheels <= EACH:
        raise ValueError(f"load: wheels = {wheels}: must be from 0 to {EACH}")
    if not WHEEL_LOAD.low <= each <= WHEEL_LOAD.high:
        raise ValueError(f"load = {load!r}: of a wheel must be {WHEEL_LOAD}")
    if invalid := invalid_input(inputs.tolist()):
        raise ValueError(f"failed: {invalid}")
    if not isinstance(contact, WheelsetContact):
        raise ValueError("load: not with an elastic axle and elastic pads, whose equilibrium is the start")
    state, expected = state_of(inputs.tolist()), sphere_approach(each, *wheel_sphere(arguments["E"], arguments["nu"]))
    if wheels == BOTH:
        return axle_under_load(contact, state, load, expected=expected).state
    if wheels == EACH:
        return wheels_under_load(contact, state, load, expected=expected).state
    return wheel_under_load(contact, state, SIDES[wheels], load, expected=expected).state


def _text(error: Exception) -> str:
    return str(error) if isinstance(error, ValueError | OSError) else f"{type(error).__name__}: {error}"


def loaded_inputs(wheelset: Wheelset) -> Array:
    """Inputs (17,) of a wheelset's state, at the height and the roll at which both wheels carry their loads.

    Of an axle load each wheel carries half, unless a roll is given. Raises ValueError where the load cannot be carried.
    """
    import wheelrail as wr

    inputs = wheelset.element().start_array()
    arguments = {key: value for key, value in wheelset.arguments.items() if key not in NOT_OF_THE_START}
    if arguments.get("z") is not None:
        return inputs
    load, tilted = arguments.get("axle_load"), arguments.get("roll") not in (None, 0.0, "solve")
    by_wheel = {} if load is None else {"wheel_load": 0.5 * load}
    given = {} if load and tilted else {**by_wheel, "roll": "solve"}
    _, sides = wr.Wheelset(**arguments).solved_sides(given)
    if failed := [side.result.status for side in sides.values() if not side.result.ok]:
        raise ValueError(f"the load of the scene cannot be carried: {failed[0]}")
    inputs[INPUT_NUMBERS["z"]], inputs[INPUT_NUMBERS["roll"]] = sides["left"].z, sides["left"].roll
    return inputs


def loaded_wheelset(options: str, folder: Path) -> Wheelset:
    """Wheelset of the options of `Host.open`. Raises ValueError, OSError."""
    import wheelrail as wr

    given = json_value(options or "{}")
    if not isinstance(given, dict):
        raise ValueError(f"options = {options!r}: must be a JSON object")
    friction = {side: given.pop(f"{side}_friction", None) for side in SIDES}
    arguments: dict[str, Any] = {}
    if (scene := given.pop("scene", None)) is not None:
        loaded = wr.load(folder / str(scene))
        if not isinstance(loaded, wr.Wheelset):
            raise ValueError(f'{scene}: kind = "hertz": must be "wheelset"')
        arguments = loaded.arguments
    arguments = {**arguments, **given}
    for side, value in friction.items():
        if value is not None:
            arguments[side] = {**(arguments.get(side) or {}), "friction": value}
    return wr.Wheelset(**arguments)


assert [variable.name for variable in PARAMETERS] == [f"{side}_friction" for side in SIDES]
