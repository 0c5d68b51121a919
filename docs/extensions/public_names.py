"""The Python interface: the public package, and the modules below it that are meant to be used directly."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from importlib import import_module
from types import ModuleType
from typing import Any

# Title: modules
CHAPTERS: dict[str, tuple[str, ...]] = {
    "wheelrail": ("wheelrail",),
    "Contact": (
        "contact.laws",
        "contact.pose",
        "contact.pairs",
        "contact.condensed",
        "contact.fitted",
        "contact.full",
        "contact.standard",
        "contact.fineness",
        "contact.convergence",
        "contact.loading",
        "contact.wheelset",
        "contact.seating",
        "contact.result",
        "contact.error_estimate",
        "contact.patch_stress",
        "contact.shakedown",
    ),
    "Closed forms": (
        "contact.references.hertz",
        "contact.references.cattaneo",
        "contact.references.carter",
        "contact.references.kalker",
    ),
    "Profiles and bodies": ("meshes.profiles", "meshes.readers", "meshes.sections", "meshes.wheel_shape"),
    "Vehicle and track": (
        "vehicle.wagon",
        "vehicle.parts",
        "vehicle.characteristic",
        "vehicle.track",
        "vehicle.layout",
        "vehicle.irregularity",
        "vehicle.track_spectrum",
        "vehicle.drive",
        "vehicle.simulate",
        "vehicle.history",
        "vehicle.limits",
        "vehicle.equilibrium",
        "vehicle.curving",
        "vehicle.curve",
        "vehicle.modes",
        "vehicle.energy",
    ),
    "Scenes and results": ("scenes.scene", "scenes.results", "scenes.netcdf"),
}


def public(module: ModuleType) -> list[str]:
    """What the public package says; of other modules their own classes and functions without an underscore."""
    if module.__name__ == "wheelrail":
        return list(getattr(module, "__all__", ()))
    own = {name: thing for name, thing in vars(module).items() if not name.startswith("_") and _defined(thing, module)}
    return sorted(own, key=lambda name: inspect.getsourcelines(inspect.unwrap(own[name]))[1])


def _defined(thing: Any, module: ModuleType) -> bool:
    thing = inspect.unwrap(thing) if callable(thing) else thing
    return (inspect.isclass(thing) or inspect.isfunction(thing)) and thing.__module__ == module.__name__


def public_names() -> str:
    """reStructuredText: every public name, chapter by chapter and module by module."""
    return "\n".join(line for title, modules in CHAPTERS.items() for line in _chapter(title, modules))


def _chapter(title: str, modules: tuple[str, ...]) -> Iterator[str]:
    yield from (title, "-" * len(title), "")
    for name in modules:
        module = import_module(name)
        if name != title:
            yield from (name, "~" * len(name), "")
        yield from (f".. automodule:: {name}", "   :no-members:", "")
        for thing in public(module):
            yield from _entry(f"{name}.{thing}", getattr(module, thing))


def _entry(path: str, thing: Any) -> Iterator[str]:
    if inspect.isclass(thing):
        # what results have in common is theirs; pydantic's methods are not those of scenes
        whole = ("   :inherited-members: BaseException",) if path.startswith("wheelrail.") else ()
        yield from (f".. autoclass:: {path}", "   :members:", *whole, "")
    elif callable(thing):
        yield from (f".. autofunction:: {path}", "")
    elif inspect.ismodule(thing):
        yield from (f".. automodule:: {path}", "   :no-members:", "   :no-index:", "")
    else:
        yield from (f".. autodata:: {path}", "")
