"""Detailed wheel-rail contact by finite elements, inside a vehicle simulation: what a notebook or a script needs.

    import wheelrail as wr
    found = wr.Wheelset(wheel="S1002", rail="UIC60", friction=0.3).solve(y=2e-3, wheel_load=57e3, speed=45.0)
    found.plot()

SI units everywhere: m, N, Pa, s, rad. x forward, y to the left, z up; forces act on the wheel.
"""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from wheelrail.support.terminal import LOGGER
from wheelrail.support.working_directory import load_libraries_outside

if TYPE_CHECKING:
    from wheelrail.api.assess import RunAssessment, assess
    from wheelrail.api.contact_geometry import contact_geometry
    from wheelrail.api.elements.hertz_element import HertzElement
    from wheelrail.api.elements.wheelset_element import WheelsetElement
    from wheelrail.api.figures import plot_convergence, plot_profiles, plot_work_precision
    from wheelrail.api.files import load, open, profile, report
    from wheelrail.api.hertz import Hertz
    from wheelrail.api.runs import Run, run
    from wheelrail.api.solution import Solution
    from wheelrail.api.studies import Study, study
    from wheelrail.api.wear import Wear, wear
    from wheelrail.api.wheelset import Wheelset
    from wheelrail.explorer.start import explore
    from wheelrail.scenes.schema.errors import SceneError

# Name: the module that it is taken from when it is first asked for, so that importing the package costs nothing.
_HOMES = {
    "Hertz": "wheelrail.api.hertz",
    "HertzElement": "wheelrail.api.elements.hertz_element",
    "Run": "wheelrail.api.runs",
    "RunAssessment": "wheelrail.api.assess",
    "SceneError": "wheelrail.scenes.schema.messages",
    "Solution": "wheelrail.api.solution",
    "Study": "wheelrail.api.studies",
    "Wear": "wheelrail.api.wear",
    "Wheelset": "wheelrail.api.wheelset",
    "WheelsetElement": "wheelrail.api.elements.wheelset_element",
    "assess": "wheelrail.api.assess",
    "contact_geometry": "wheelrail.api.contact_geometry",
    "explore": "wheelrail.explorer.start",
    "load": "wheelrail.api.files",
    "open": "wheelrail.api.files",
    "plot_convergence": "wheelrail.api.figures",
    "plot_profiles": "wheelrail.api.figures",
    "plot_work_precision": "wheelrail.api.figures",
    "profile": "wheelrail.api.files",
    "report": "wheelrail.api.files",
    "run": "wheelrail.api.runs",
    "study": "wheelrail.api.studies",
    "wear": "wheelrail.api.wear",
}
__all__ = [
    "Hertz",
    "HertzElement",
    "Run",
    "RunAssessment",
    "SceneError",
    "Solution",
    "Study",
    "Wear",
    "Wheelset",
    "WheelsetElement",
    "assess",
    "contact_geometry",
    "explore",
    "load",
    "open",
    "plot_convergence",
    "plot_profiles",
    "plot_work_precision",
    "profile",
    "report",
    "run",
    "study",
    "wear",
]

load_libraries_outside()
logging.getLogger(LOGGER).addHandler(logging.NullHandler())  # nothing is printed unless the user configures logging


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'wheelrail' has no attribute {name!r}; it has {', '.join(__all__)}")
    from importlib import import_module

    found = globals()[name] = getattr(import_module(_HOMES[name]), name)
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
