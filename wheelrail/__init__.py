"""Detailed wheel-rail contact by finite elements, inside a vehicle simulation: what a notebook or a script needs.

    import wheelrail as wr
    found = wr.Wheelset(wheel="S1002", rail="UIC60", friction=0.3).solve(y=2e-3, wheel_load=57e3, speed=45.0)
    found.plot()

SI units everywhere: m, N, Pa, s, rad. x forward, y to the left, z up; forces act on the wheel.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from scenes.complaint import SceneError
    from wheelrail.files import load, open, profile, report
    from wheelrail.geometry import contact_geometry
    from wheelrail.hertz import Hertz
    from wheelrail.pictures import plot_convergence, plot_profiles, plot_work_precision
    from wheelrail.runs import Run, run
    from wheelrail.solution import Solution
    from wheelrail.studies import Study, study
    from wheelrail.wheelset import Wheelset

# Name: the module that it is taken from when it is first asked for, so that importing the package costs nothing.
_HOMES = {
    "Hertz": "wheelrail.hertz",
    "Run": "wheelrail.runs",
    "SceneError": "scenes.complaint",
    "Solution": "wheelrail.solution",
    "Study": "wheelrail.studies",
    "Wheelset": "wheelrail.wheelset",
    "contact_geometry": "wheelrail.geometry",
    "load": "wheelrail.files",
    "open": "wheelrail.files",
    "plot_convergence": "wheelrail.pictures",
    "plot_profiles": "wheelrail.pictures",
    "plot_work_precision": "wheelrail.pictures",
    "profile": "wheelrail.files",
    "report": "wheelrail.files",
    "run": "wheelrail.runs",
    "study": "wheelrail.studies",
}
__all__ = [
    "Hertz",
    "Run",
    "SceneError",
    "Solution",
    "Study",
    "Wheelset",
    "contact_geometry",
    "load",
    "open",
    "plot_convergence",
    "plot_profiles",
    "plot_work_precision",
    "profile",
    "report",
    "run",
    "study",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'wheelrail' has no attribute {name!r}; it has {', '.join(__all__)}")
    from importlib import import_module

    found = globals()[name] = getattr(import_module(_HOMES[name]), name)
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
