"""Arguments of the solve of an element: numbers in SI units, each with its plausible range."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from numbers import Real
from typing import Any, get_args

import numpy as np

from wheelrail.scenes.schema import quantities as q
from wheelrail.scenes.schema.errors import SceneError


def _range(quantity: Any) -> q.Range:
    """Range of a quantity of a scene."""
    (limits,) = (item for item in get_args(quantity) if isinstance(item, q.Range))
    return limits


OFFSET, ANGLE, RATE, FRICTION = _range(q.Offset), _range(q.Angle), _range(q.Rate), _range(q.Friction)
WHEEL_LOAD = _range(q.WheelLoad)
SPEED = replace(_range(q.Speed), low=0.0, open=False)  # standing still is a state of a program
RANGES: Mapping[str, q.Range] = {
    **dict.fromkeys(("x", "y", "z"), OFFSET),
    **dict.fromkeys(("roll", "yaw"), ANGLE),
    **dict.fromkeys(("x_rate", "y_rate", "z_rate", "roll_rate", "yaw_rate", "pitch_rate"), RATE),
    "speed": SPEED,
}


def checked_numbers(values: Mapping[str, object]) -> dict[str, float]:
    """The numbers given by name, None left out. Raises SceneError."""
    return {name: _checked(name, value, RANGES[name]) for name, value in values.items() if value is not None}


def checked_rates(name: str, values: object) -> tuple[float, ...]:
    """Three angular velocities, rad/s. Raises SceneError."""
    rates = _items(name, values, 3, "three numbers in rad/s")
    return tuple(_checked(f"{name}[{i}]", rate, RATE) for i, rate in enumerate(rates))


def checked_shifts(name: str, values: object) -> tuple[tuple[float, ...], ...]:
    """Displacements (y, z) of the left and the right rail, m. Raises SceneError."""
    rails = _items(name, values, 2, "((y, z), (y, z)) of the left and the right rail, in m")
    rows = [_items(f"{name}[{i}]", rail, 2, "(y, z) in m") for i, rail in enumerate(rails)]
    return tuple(tuple(_checked(f"{name}[{i}]", value, OFFSET) for value in row) for i, row in enumerate(rows))


def checked_motions(name: str, values: object, lengths: int, angles: int) -> tuple[tuple[float, ...], ...]:
    """Motions of a body of the left and of the right side: lengths m, then angles rad. Raises SceneError."""
    count = lengths + angles
    sides = _items(name, values, 2, f"{count} numbers in m and rad for the left and for the right side")
    limits, rows = [OFFSET] * lengths + [ANGLE] * angles, []
    for i, side in enumerate(sides):
        numbers = _items(f"{name}[{i}]", side, count, f"{count} numbers in m and rad")
        rows.append(tuple(_checked(f"{name}[{i}]", *item) for item in zip(numbers, limits, strict=True)))
    return tuple(rows)


def _items(name: str, values: object, count: int, allowed: str) -> tuple[object, ...]:
    """The items of a list, tuple or array. Raises SceneError for another number of them."""
    if isinstance(values, list | tuple | np.ndarray) and len(values) == count:
        return tuple(values)
    raise SceneError(f"solve: {name} = {values!r}: must be {allowed}")


def _checked(name: str, value: object, limits: q.Range) -> float:
    """The number. Raises SceneError for anything that is no number in range; NaN is none."""
    if isinstance(value, Real) and not isinstance(value, bool):
        number = float(value)
        if limits.low <= number <= limits.high:
            return number
    raise SceneError(f"solve: {name} = {value!r}: must be {limits}")
