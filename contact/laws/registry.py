"""Laws by name, with their constants, for scenes and other text.

Names are those of this package, or "module:Class" for a user's own law. A module is imported only if the user has
allowed it (`allow`, the command line's option --laws): the text of a scene alone never imports code.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Mapping
from dataclasses import fields
from importlib import import_module
from typing import Any

from wheelrail.contact.laws.friction import Coulomb, FallingFriction, FrictionLaw, Stribeck, parameters
from wheelrail.contact.laws.normal import NormalLaw, Penalty, PowerPenalty
from wheelrail.contact.laws.pointwise import friction_functions, is_shipped, pressure_function

FRICTION: Mapping[str, Callable[..., FrictionLaw]] = {
    "coulomb": Coulomb,
    "falling": FallingFriction,
    "stribeck": Stribeck,
    "polach-dry": FallingFriction.polach,
    "polach-wet": lambda: FallingFriction.polach(wet=True),
}
NORMAL: Mapping[str, Callable[..., NormalLaw]] = {"penalty": Penalty, "power": PowerPenalty}
ALLOWED = "WHEELRAIL_LAWS"  # environment variable: modules that may be imported, also by processes started later

_classes: dict[str, type] = {}  # of laws given as objects


class InvalidLaw(ValueError):
    """A law that does not exist, may not be imported, or has invalid constants.

    Parameters:
        allowed: what is allowed.
        key: constant concerned, "law" for the name.
    """

    def __init__(self, allowed: str, key: str = "law") -> None:
        super().__init__(f"{key}: {allowed}")
        self.allowed, self.key = allowed, key


def allow(*modules: str) -> None:
    """Allow laws of modules, importable or in the current folder, in this process and its children."""
    os.environ[ALLOWED] = ",".join({**dict.fromkeys(_allowed()), **dict.fromkeys(modules)})


def _allowed() -> list[str]:
    return [name for name in os.environ.get(ALLOWED, "").split(",") if name]


def friction_law(name: str, constants: Mapping[str, Any]) -> FrictionLaw:
    """Friction law by name and constants, checked. Raises InvalidLaw."""
    law: FrictionLaw = _law(name, constants, FRICTION, friction_functions)
    return law


def normal_law(name: str, constants: Mapping[str, Any]) -> NormalLaw:
    """Normal law by name and constants, checked. Raises InvalidLaw."""
    law: NormalLaw = _law(name, constants, NORMAL, pressure_function)
    return law


def law_table(law: FrictionLaw | NormalLaw) -> dict[str, str | float]:
    """Name and constants of a law given as an object, whose class is registered. Raises TypeError."""
    kind = type(law)
    constants = parameters(law)
    for name, shipped in {**FRICTION, **NORMAL}.items():
        if shipped is kind:
            return {"law": name, **constants}
    name = f"{kind.__module__}:{kind.__qualname__}"
    _classes[name] = kind
    return {"law": name, **constants}


def _law(
    name: str, constants: Mapping[str, Any], shipped: Mapping[str, Callable[..., Any]], check: Callable[[Any], object]
) -> Any:
    """Law by name and constants; a user's own is checked by compiling it."""
    make = shipped[name] if name in shipped else _class(name, shipped)
    if isinstance(make, type):
        names = [item.name for item in fields(make)]
        for key, value in constants.items():
            if key not in names:
                raise InvalidLaw(f"unknown constant; allowed are {', '.join(names)}", key)
            if isinstance(value, bool) or not isinstance(value, int | float):
                raise InvalidLaw("must be a number", key)
    elif constants:
        raise InvalidLaw(f'not allowed: "{name}" has no constants to choose', next(iter(constants)))
    try:
        law = make(**constants)
        if not is_shipped(law):
            check(law)
    except (TypeError, ValueError) as error:
        raise InvalidLaw(str(error)) from error
    return law


def _class(name: str, shipped: Mapping[str, Any]) -> type:
    """Class of a user's law."""
    if name in _classes:
        return _classes[name]
    module, _, attribute = name.partition(":")
    if not attribute:
        raise InvalidLaw(f'must be {", ".join(map(repr, shipped))}, or "module:Class"'.replace("'", '"'))
    if module not in _allowed():
        raise InvalidLaw(f"a scene does not import code by itself; to allow it: wheelrail --laws {module} ...")
    sys.path.insert(0, current := os.getcwd())
    try:
        law = getattr(import_module(module), attribute, None)
    except Exception as error:  # of the user's module: any
        raise InvalidLaw(f"module {module} cannot be imported: {type(error).__name__}: {error}") from error
    finally:
        sys.path.remove(current)
    if not isinstance(law, type):
        raise InvalidLaw(f"module {module} has no class {attribute}")
    return law
