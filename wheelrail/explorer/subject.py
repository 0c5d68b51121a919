"""Contact of an explorer with its arguments, and the calls that values of the page stand for."""

from __future__ import annotations

import inspect
from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Literal

from wheelrail.api.hertz import Hertz
from wheelrail.api.wheelset import SECTIONS, Wheelset, usual_inclination
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.explorer.controls import ALTERNATIVES, HERTZ, WHEELSET, Control
from wheelrail.meshes.profiles.named import NAMES
from wheelrail.scenes.schema.scene import ELEMENTS
from wheelrail.scenes.schema.wheelset_defaults import LOAD, SCENE, SPEED, TRACK
from wheelrail.scenes.schema.wheelset_defaults import WHEELSET as POSITION

if TYPE_CHECKING:
    from wheelrail.meshes.profiles.profile import Profile

CLASSES: dict[str, type[Wheelset] | type[Hertz]] = {"wheelset": Wheelset, "hertz": Hertz}
ABSENT: dict[str, Any] = {**SCENE, **TRACK, **POSITION, "speed": SPEED, "model": "condensed", "z": 0.0}
ABSENT |= {"error_estimate": False}
ABSENT |= {"falling.share": 1.0, "falling.rate": 0.5, "pitch_rate": 0.0, "y_rate": 0.0, "yaw_rate": 0.0}
ABSENT |= {"wheel_load": LOAD, "axle_load": 2 * LOAD, "right.radius": 0.0, "approach": 5e-5, "load": 1e4}
ABSENT |= {f"creepage.{k}": 0.0 for k in range(3)} | {f"shift.{k}": 0.0 for k in range(2)}
CHOSEN = "at_load_by"  # variable of the page: which of the alternatives is given
OF_ELEMENTS = (*ELEMENTS, "error_estimate", "surface_size")


@dataclass(frozen=True)
class Calls:
    """Arguments of a class and of its `solve`."""

    kind: Literal["wheelset", "hertz"]
    contact: dict[str, Any]
    solve: dict[str, Any]

    @property
    def key(self) -> str:
        """Text that is equal for equal contacts."""
        return repr((self.kind, self.contact))


@dataclass(frozen=True)
class Subject:
    """A contact to explore.

    Parameters:
        kind: "wheelset" or "hertz".
        arguments: of `wheelrail.Wheelset` or `wheelrail.Hertz` and of their `solve`, profiles by names.
        given: profiles that are not files of the library, by those names.
        files: names of files that profiles were read from by dropping them on the page, by the same names.
    """

    kind: Literal["wheelset", "hertz"]
    arguments: Mapping[str, Any]
    given: Mapping[str, Profile] = field(default_factory=dict)
    files: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, contact: Wheelset | Hertz) -> Subject:
        """Subject of a contact."""
        if isinstance(contact, Wheelset):
            arguments = dict(contact.arguments)
            rail = arguments["rail"]
            if arguments["laying_angle"] == usual_inclination(contact.given.get(rail, rail)):
                del arguments["laying_angle"]  # that of another rail may differ
            return cls("wheelset", arguments, dict(contact.given))
        return cls("hertz", dict(contact.arguments))

    def with_profile(self, profile: Profile, file: str) -> tuple[Subject, str]:
        """Subject that knows another profile of a file, and the profile's name; it replaces an earlier one of its kind
        from a file of the same name.
        """
        name = f"{profile.name} ({profile.digest()[:8]})"
        file = f"./{file}" if file in NAMES else file  # not the profile of the library
        kept = {own: of for own, of in self.files.items() if of != file or self.given[own].kind != profile.kind}
        given = {own: of for own, of in self.given.items() if own in kept or own not in self.files}
        return replace(self, given={**given, name: profile}, files={**kept, name: file}), name

    @cached_property
    def controls(self) -> tuple[Control, ...]:
        """Controls of the page, with ranges that have the arguments."""
        own = WHEELSET if self.kind == "wheelset" else HERTZ
        shifted = self.arguments.get("shift") is not None
        hidden = ("speed", "creepage") if shifted else ("shift",)
        kept = [control for control in own if control.key.split(".")[0] not in hidden]
        if not isinstance(self.arguments.get("friction"), float | int):
            kept = [control for control in kept if control.group != "friction"]  # a law with constants of its own
        for body in ("wheel", "rail"):
            names = {name: name for name, profile in self.given.items() if profile.kind == body}
            kept = [replace(own, choices={**(own.choices or {}), **names}) if own.key == body else own for own in kept]
        return tuple(control.around(self._value(control)) for control in kept)

    @cached_property
    def initial(self) -> dict[str, Any]:
        """Values of the page for the arguments, by variable."""
        values = {control.name: control.shown(self._value(control)) for control in self.controls}
        return {**values, CHOSEN: self.load_key}

    @property
    def load_key(self) -> str:
        """Name of the argument that gives the load."""
        return next((key for key in self.alternatives if self.arguments.get(key) is not None), self.alternatives[0])

    @property
    def alternatives(self) -> tuple[str, ...]:
        return next(keys for keys in ALTERNATIVES if keys[0] in {control.key for control in self.controls_of_kind})

    @property
    def controls_of_kind(self) -> tuple[Control, ...]:
        return WHEELSET if self.kind == "wheelset" else HERTZ

    def calls(self, values: Mapping[str, Any]) -> Calls:
        """Arguments for values of the page; those that were not moved stay the very ones that were given.

        Parameters:
            values: by variable; missing ones are as at first.

        Raises ValueError for a text that is not a number.
        """
        shown = {**self.initial, **values}
        keys = {key: value for key, value in deepcopy(dict(self.arguments)).items() if value is not None}
        load = shown[CHOSEN]
        for control in sorted(self.controls, key=lambda own: own.relative != ""):  # after what they are added to
            moved = shown[control.name] != self.initial[control.name] or control.key == load
            moved |= control.relative != "" and self._base(control, keys) != self._base(control, self.arguments)
            if moved and shown[control.name] is not None:
                _put(keys, control.key, self._argument(control, shown, keys))
        for key in self.alternatives:
            if key != load:
                keys.pop(key, None)
        _tidy(keys)
        per_solve = inspect.signature(CLASSES[self.kind].solve).parameters
        contact = {key: value for key, value in keys.items() if key not in per_solve}
        return Calls(self.kind, contact, {key: value for key, value in keys.items() if key in per_solve})

    def python(self, calls: Calls) -> str:
        """Python text that solves the same contact."""
        lines = ["import wheelrail as wr", ""]
        names: dict[str, str] = {}
        for body in ("wheel", "rail"):
            name = str(calls.contact.get(body))
            if name in self.given:
                names[name] = body
                source = f"wr.profile({self.files[name]!r}, {body!r})" if name in self.files else "..."
                remark = name if name in self.files else f"{name}: put in the profile that the page was given"
                lines.append(f"{body} = {source}  # {' '.join(remark.split())}")
        made = inspect.signature(CLASSES[self.kind]).parameters
        kept = {
            key: value
            for key, value in calls.contact.items()
            if key not in made or made[key].default is inspect.Parameter.empty or made[key].default != value
        }
        made_text, solve = _arguments(kept, names), _arguments(calls.solve, names)
        lines += [f"contact = wr.{CLASSES[self.kind].__name__}({made_text})", f"solution = contact.solve({solve})"]
        return "\n".join([*lines, "solution", ""])

    def scene(self, calls: Calls) -> str:
        """Scene file (TOML) of the same contact."""
        import tomli_w

        from wheelrail.api.arguments import plain

        data: dict[str, Any] = {"kind": self.kind}
        sections = SECTIONS if self.kind == "wheelset" else {}
        whole = {**calls.contact, **calls.solve}
        if self.kind == "hertz":
            defaults = Hertz(**calls.contact).arguments  # that a scene file requires
            whole = {**{key: value for key, value in defaults.items() if value is not None}, **whole}
            if whole["friction"] != 0.0 and "shift" not in whole:
                whole = {"speed": SPEED, "creepage": [0.0, 0.0, 0.0], **whole}
        for key, value in whole.items():
            section = next((name for name, own in sections.items() if key in own), None)
            table = data if section is None else data.setdefault(section, {})
            table[key] = self.files.get(value, value) if isinstance(value, str) else plain(value)
        tables = {key: value for key, value in data.items() if isinstance(value, dict)}
        return tomli_w.dumps({**{key: value for key, value in data.items() if key not in tables}, **tables})

    def _value(self, control: Control) -> Any:
        """Argument of a control in SI units; None where the contact has none."""
        value = _get(self.arguments, control.key)
        if control.relative and value is not None:
            return float(value) - float(self._base(control, self.arguments))
        if value is not None:
            return value
        if control.key in ("strips", "cells"):
            return getattr(LatticeResolution(), control.key)
        return ABSENT.get(control.key)

    def _argument(self, control: Control, shown: Mapping[str, Any], keys: Mapping[str, Any]) -> Any:
        value = control.argument(shown[control.name])
        if control.key in ("strips", "cells"):
            if not value.is_integer():
                raise ValueError(f"{control.label} = {value!r}: must be a whole number")
            return int(value)
        if not control.relative:
            return value
        return None if value == 0.0 else self._base(control, keys) + value

    def _base(self, control: Control, keys: Mapping[str, Any]) -> float:
        """Value that a relative control adds to."""
        if control.relative == "radius":
            return float(keys["radius"])
        radius = float(keys["radius"])
        return float(keys.get("speed", SPEED)) / radius if radius else 0.0  # the contact refuses it


def _get(table: Any, key: str) -> Any:
    for part in key.split("."):
        if isinstance(table, Mapping):
            table = table.get(part)
        elif isinstance(table, Sequence) and not isinstance(table, str) and part.isdigit():
            table = table[int(part)]
        else:
            return None
    return table


def _put(table: dict[str, Any], key: str, value: Any) -> None:
    """Set a nested value; lists that are missing have zeros."""
    *inner, last = key.split(".")
    at: Any = table
    for part, after in pairwise([*inner, last]):
        if after.isdigit():
            at[part] = list(at.get(part) or [0.0] * (3 if part == "creepage" else 2))
        else:
            at[part] = dict(at.get(part) or {})
        at = at[part]
    if last.isdigit():
        at[int(last)] = value
    elif value is None:
        at.pop(last, None)
    else:
        at[last] = value


def _tidy(keys: dict[str, Any]) -> None:
    """Remove arguments that the chosen model does not have, and laws that change nothing."""
    falling = keys.get("falling")
    if isinstance(falling, dict):
        falling.setdefault("share", ABSENT["falling.share"])
        falling.setdefault("rate", ABSENT["falling.rate"])
        if falling["share"] == 1.0 or falling["rate"] == 0.0:
            del keys["falling"]
    if keys.get("model") == "standard":
        for key in OF_ELEMENTS:
            keys.pop(key, None)
    if not keys.get("right", True):
        del keys["right"]


def _arguments(values: Mapping[str, Any], names: Mapping[str, str]) -> str:
    return ", ".join(f"{key}={_text(value, names)}" for key, value in values.items())


def _text(value: Any, names: Mapping[str, str]) -> str:
    """Python text of an argument."""
    if isinstance(value, str):
        return names.get(value, repr(value))
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key!r}: {_text(own, names)}" for key, own in value.items()) + "}"
    if isinstance(value, list | tuple):
        inner = ", ".join(_text(own, names) for own in value)
        return f"[{inner}]" if isinstance(value, list) else f"({inner},)" if len(value) == 1 else f"({inner})"
    return 'float("inf")' if value == float("inf") else repr(value)


def with_profiles(arguments: Mapping[str, Any], profiles: Mapping[str, Profile]) -> dict[str, Any]:
    """Arguments with profiles in place of their names, in the tables of the sides, too."""
    return {
        key: profiles[value]
        if key in ("wheel", "rail") and value in profiles
        else with_profiles(value, profiles)
        if key in ("left", "right")
        else value
        for key, value in arguments.items()
    }
