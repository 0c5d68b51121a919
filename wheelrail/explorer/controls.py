"""Controls of a page: each is one argument of a contact, with its range and unit for readers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from decimal import Decimal
from math import isfinite
from typing import Any

from wheelrail.meshes.profiles.named import NAMES

INCLINATIONS = {"as usual for the rail": None, "0": 0.0, "1:60": 1 / 60, "1:40": 0.025, "1:30": 1 / 30, "1:20": 0.05}
ROLL = {"each wheel at its own height": 0.0, "solved with one height": "solve"}
MODELS = {"elastic bodies": "condensed", "standard (no elements)": "standard"}
BODIES = {"bodies of the profiles": None, "half-spaces": "half-space"}
SIDES = {"both wheels": None, "left wheel": ("left",), "right wheel": ("right",)}
YES = {"no": False, "yes": True}


@dataclass(frozen=True)
class Control:
    """One argument on the page.

    Parameters:
        key: argument, with dots into tables and lists: "y", "right.radius", "creepage.0".
        label: for readers.
        group: heading under which it is shown.
        unit: for readers.
        power: of ten of that unit in the SI unit: -3 for mm.
        low, high, step: of a slider, in the unit for readers.
        choices: values by their texts, in place of a slider.
        text: whether any number may be written, "straight" for inf, in place of a slider.
        per_solve: whether it is an argument of `solve`.
        relative: argument that the value is added to: "radius", or "speed" for the pitch rate of rolling.
    """

    key: str
    label: str
    group: str
    unit: str = ""
    power: int = 0
    low: float = 0.0
    high: float = 1.0
    step: float = 0.1
    choices: Mapping[str, Any] | None = None
    text: bool = False
    per_solve: bool = False
    relative: str = ""

    @property
    def name(self) -> str:
        """Name of its variable on the page."""
        return "at_" + self.key.replace(".", "_")

    def shown(self, value: Any) -> Any:
        """Value for the page, exactly that of an argument in SI units."""
        if self.choices is not None:
            return next((text for text, own in self.choices.items() if own == value), str(value))
        if value is None or not isfinite(value):
            return "straight" if self.text else None
        number = float(Decimal(repr(float(value))).scaleb(-self.power))
        return f"{number:g}" if self.text and float(f"{number:g}") == number else repr(number) if self.text else number

    def argument(self, shown: Any) -> Any:
        """Argument in SI units of a value of the page; raises ValueError for a text that is not a number."""
        if self.choices is not None:
            return self.choices.get(shown, shown)
        if self.text and str(shown).strip().lower() in ("straight", "inf", "∞"):
            return float("inf")
        try:
            number = float(shown)
        except (TypeError, ValueError):
            raise ValueError(f"{self.label} = {shown!r}: must be a number") from None
        if not isfinite(number):
            raise ValueError(f"{self.label} = {shown!r}: must be finite")
        return float(Decimal(repr(number)).scaleb(self.power))

    def around(self, value: Any) -> Control:
        """The same control, with a range or choices that have the value."""
        shown = self.shown(value)
        if self.choices is not None:
            return self if shown in self.choices else replace(self, choices={**self.choices, str(value): value})
        if self.text or shown is None:
            return self
        return replace(self, low=min(self.low, shown), high=max(self.high, shown))


def _slider(key: str, label: str, group: str, unit: str, power: int, *span: float, **more: Any) -> Control:
    low, high, step = span
    return Control(key, label, group, unit, power, low, high, step, **more)


def _choice(key: str, label: str, group: str, choices: Mapping[str, Any], **more: Any) -> Control:
    return Control(key, label, group, choices=choices, **more)


def _names(kind: str) -> dict[str, str]:
    return {name: name for name, own in NAMES.items() if own == kind}


ELASTIC: tuple[Control, ...] = (
    _slider("strips", "strips across", "model", "", 0, 4, 40, 1),
    _slider("cells", "cells along", "model", "", 0, 6, 60, 1),
    _choice("error_estimate", "error estimate", "model", YES, per_solve=True),
)
FRICTION: tuple[Control, ...] = (
    _slider("friction", "friction coefficient", "friction", "", 0, 0.0, 1.0, 0.01),
    _slider("falling.share", "falling friction: share at high slip", "friction", "", 0, 0.1, 1.0, 0.05),
    _slider("falling.rate", "falling friction: rate", "friction", "s/m", 0, 0.0, 2.0, 0.05),
)
MOTION = _slider("speed", "speed", "motion", "m/s", 0, 1.0, 100.0, 1.0, per_solve=True)
WHEELSET: tuple[Control, ...] = (
    _slider("y", "lateral position y, to the left", "position", "mm", -3, -10.0, 10.0, 0.05, per_solve=True),
    _slider("yaw", "yaw, to the left", "position", "mrad", -3, -30.0, 30.0, 0.1, per_solve=True),
    _choice("roll", "height and roll", "position", ROLL, per_solve=True),
    _slider("wheel_load", "load of each wheel", "load", "kN", 3, 1.0, 200.0, 0.5, per_solve=True),
    _slider("axle_load", "load of both wheels", "load", "kN", 3, 2.0, 400.0, 1.0, per_solve=True),
    _slider("z", "height above the nominal one", "load", "mm", -3, -1.0, 1.0, 0.001, per_solve=True),
    MOTION,
    _slider(
        *("pitch_rate", "pitch rate above that of rolling", "motion", "rad/s", 0, -5.0, 5.0, 0.01),
        per_solve=True,
        relative="speed",
    ),
    _slider("y_rate", "lateral velocity, to the left", "motion", "mm/s", -3, -200.0, 200.0, 1.0, per_solve=True),
    _slider("yaw_rate", "yaw rate", "motion", "mrad/s", -3, -100.0, 100.0, 1.0, per_solve=True),
    *FRICTION,
    _choice("wheel", "wheel profile", "profiles", _names("wheel")),
    _choice("rail", "rail profile", "profiles", _names("rail")),
    _slider("radius", "rolling radius", "wheelset and track", "mm", -3, 250.0, 650.0, 1.0),
    _slider(
        "right.radius", "right radius minus left", "wheelset and track", "mm", -3, -3.0, 3.0, 0.05, relative="radius"
    ),
    _slider("gauge", "gauge", "wheelset and track", "mm", -3, 1425.0, 1470.0, 0.5),
    _choice("laying_angle", "rail inclination", "wheelset and track", INCLINATIONS),
    _choice("sides", "wheels", "model", SIDES, per_solve=True),
    _choice("model", "model", "model", MODELS),
    _choice("bodies", "bodies", "model", BODIES),
    *ELASTIC,
)
HERTZ: tuple[Control, ...] = (
    *(
        Control(f"{body}.radii.{axis}", f"{body} radius in {'xy'[axis]}", "bodies", "m", text=True)
        for body in ("upper", "lower")
        for axis in (0, 1)
    ),
    _slider("load", "load", "load", "kN", 3, 0.1, 200.0, 0.1, per_solve=True),
    _slider("approach", "approach", "load", "µm", -6, 1.0, 500.0, 1.0, per_solve=True),
    MOTION,
    _slider("creepage.0", "longitudinal creepage", "motion", "1e-3", -3, -10.0, 10.0, 0.01, per_solve=True),
    _slider("creepage.1", "lateral creepage", "motion", "1e-3", -3, -10.0, 10.0, 0.01, per_solve=True),
    _slider("creepage.2", "spin creepage", "motion", "1/m", 0, -2.0, 2.0, 0.01, per_solve=True),
    _slider("shift.0", "longitudinal displacement", "motion", "µm", -6, -50.0, 50.0, 0.1, per_solve=True),
    _slider("shift.1", "lateral displacement", "motion", "µm", -6, -50.0, 50.0, 0.1, per_solve=True),
    *FRICTION,
    _choice("model", "model", "model", MODELS),
    *ELASTIC,
)
# Arguments of which one excludes the others: the page has one slider for them and a choice.
ALTERNATIVES = (("wheel_load", "axle_load", "z"), ("load", "approach"))
