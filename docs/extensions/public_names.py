"""The Python interface: the public package, and the modules below it that are meant to be used directly."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from importlib import import_module
from types import ModuleType
from typing import Any

# Topics, each with its page, by the beginnings of the titles of their chapters.
TOPICS = {"wheelrail": "wheelrail", "contact": "Contact", "meshes": "Meshes", "vehicle": "Vehicle", "scenes": "Scenes"}

# Title: modules, by package
CHAPTERS: dict[str, tuple[str, ...]] = {
    "wheelrail": ("wheelrail",),
    "Contact: kinematics and laws": (
        "wheelrail.contact.kinematics.frames",
        "wheelrail.contact.kinematics.wheelset_state",
        "wheelrail.contact.kinematics.hertz_state",
        "wheelrail.contact.laws.material",
        "wheelrail.contact.laws.parameters",
    ),
    "Contact: models": (
        "wheelrail.contact.models.builders",
        "wheelrail.contact.models.discretisation",
        "wheelrail.contact.models.condensed",
        "wheelrail.contact.models.full.model",
        "wheelrail.contact.models.lattice.model",
        "wheelrail.contact.models.lattice.resolution",
        "wheelrail.contact.models.standard.model",
        "wheelrail.contact.models.wheelset",
        "wheelrail.contact.models.hertz",
        "wheelrail.contact.solvers.options",
    ),
    "Contact: element of a time integration": (
        "wheelrail.contact.element.contact_element",
        "wheelrail.contact.element.element_solution",
        "wheelrail.contact.element.element_tangent",
    ),
    "Contact: results": (
        "wheelrail.contact.results.result",
        "wheelrail.contact.results.vehicle_contact",
        "wheelrail.contact.results.error_estimate",
    ),
    "Contact: loading": (
        "wheelrail.contact.loading.load_search",
        "wheelrail.contact.loading.hertz",
        "wheelrail.contact.loading.wheelset",
    ),
    "Contact: stress": (
        "wheelrail.contact.stress.subsurface",
        "wheelrail.contact.stress.shakedown",
    ),
    "Contact: wear": (
        "wheelrail.contact.wear.laws",
        "wheelrail.contact.wear.law_tables",
        "wheelrail.contact.wear.strips",
        "wheelrail.contact.wear.fatigue",
    ),
    "Contact: closed-form solutions": (
        "wheelrail.contact.analytical.hertz",
        "wheelrail.contact.analytical.cattaneo",
        "wheelrail.contact.analytical.carter",
        "wheelrail.contact.analytical.kalker",
    ),
    "Meshes: profiles": (
        "wheelrail.meshes.profiles.profile",
        "wheelrail.meshes.profiles.library",
        "wheelrail.meshes.profiles.named",
        "wheelrail.meshes.profiles.reader",
        "wheelrail.meshes.profiles.worn",
        "wheelrail.meshes.profiles.measures",
    ),
    "Meshes: bodies": (
        "wheelrail.meshes.bodies.outlines",
        "wheelrail.meshes.bodies.wheel_web",
    ),
    "Vehicle: wagon": (
        "wheelrail.vehicle.wagon.wagon",
        "wheelrail.vehicle.wagon.components",
        "wheelrail.vehicle.wagon.force_law",
    ),
    "Vehicle: track": (
        "wheelrail.vehicle.track.track",
        "wheelrail.vehicle.track.alignment",
        "wheelrail.vehicle.track.constant_curve",
        "wheelrail.vehicle.track.irregularity",
        "wheelrail.vehicle.track.irregularity_spectrum",
        "wheelrail.vehicle.track.speed_profile",
    ),
    "Vehicle: bodies and equations of motion": (
        "wheelrail.vehicle.multibody.vehicle",
        "wheelrail.vehicle.multibody.equations",
        "wheelrail.vehicle.multibody.plane_wagon",
        "wheelrail.vehicle.multibody.wheel_forces",
        "wheelrail.vehicle.multibody.body_equations",
    ),
    "Vehicle: steady states": (
        "wheelrail.vehicle.steady.equilibrium",
        "wheelrail.vehicle.steady.modes",
        "wheelrail.vehicle.steady.critical_speed",
    ),
    "Vehicle: simulation": (
        "wheelrail.vehicle.simulation.simulate",
        "wheelrail.vehicle.simulation.history",
        "wheelrail.vehicle.simulation.limits",
        "wheelrail.vehicle.simulation.energy_balance",
        "wheelrail.vehicle.simulation.limit_cycle",
        "wheelrail.vehicle.simulation.accelerometer",
        "wheelrail.vehicle.evaluation.comfort",
        "wheelrail.vehicle.evaluation.running_safety",
    ),
    "Scenes": (
        "wheelrail.scenes.schema.scene",
        "wheelrail.scenes.builders.vehicle_file",
        "wheelrail.scenes.datasets.run",
        "wheelrail.scenes.datasets.netcdf",
        "wheelrail.scenes.html_report.write",
    ),
}


def public(module: ModuleType) -> list[str]:
    """`__all__` of the public package; own classes and functions without an underscore of other modules."""
    if module.__name__ == "wheelrail":
        return list(getattr(module, "__all__", ()))
    names = {
        name: thing for name, thing in vars(module).items() if not name.startswith("_") and _defined(thing, module)
    }
    return sorted(names, key=lambda name: inspect.getsourcelines(inspect.unwrap(names[name]))[1])


def _defined(thing: Any, module: ModuleType) -> bool:
    thing = inspect.unwrap(thing) if callable(thing) else thing
    return (inspect.isclass(thing) or inspect.isfunction(thing)) and thing.__module__ == module.__name__


def public_names(topic: str) -> str:
    """reStructuredText: every public name of a topic, chapter by chapter and module by module."""
    chapters = {title: modules for title, modules in CHAPTERS.items() if title.startswith(TOPICS[topic])}
    return "\n".join(line for title, modules in chapters.items() for line in _chapter(title, modules))


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
        # inherited members of public classes only; pydantic's methods are omitted
        members = ("   :inherited-members: BaseException",) if path.count(".") == 1 else ()
        yield from (f".. autoclass:: {path}", "   :members:", *members, "")
    elif callable(thing):
        yield from (f".. autofunction:: {path}", "")
    elif inspect.ismodule(thing):
        yield from (f".. automodule:: {path}", "   :no-members:", "   :no-index:", "")
    else:
        yield from (f".. autodata:: {path}", "")
