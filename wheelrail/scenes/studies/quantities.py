"""Quantities of a case in the results of a study, with units and descriptions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from wheelrail.scenes.datasets.run_file import is_of_wagon
from wheelrail.scenes.quantities import AXES, CONTACT, ERRORS, PATCH, RUN, SOLUTION, TURNS
from wheelrail.scenes.quantity import Quantity
from wheelrail.vehicle.multibody.plane_wagon import HELD

if TYPE_CHECKING:
    from xarray import DataArray, Dataset

    from wheelrail.scenes.contacts.side_values import SideValues
    from wheelrail.vehicle.steady.critical_speed import CriticalSpeed

ALL = "all patches"
# Reduction of the values of a run over time and patches: word of the label, words of the meaning, function.
REDUCTIONS: dict[str, tuple[str, str, Callable[[Any], Any]]] = {
    "largest": ("largest ", "largest magnitude", lambda values: np.nanmax(np.abs(values))),
    "greatest": ("maximum ", "maximum", np.nanmax),
    "least": ("minimum ", "minimum", np.nanmin),
    "mean": ("mean ", "mean over the samples", np.nanmean),
}


class Reduced(NamedTuple):
    """Variable of a run with its reduction to a number; at: place in a dimension, body or suspension element."""

    variable: str
    reduction: str
    at: Mapping[str, str] = {}

    def of(self, data: Dataset) -> DataArray:
        """Values over time, and side and patch."""
        values = data[self.variable].sel(self.at, drop=True)
        return values.squeeze(["wheelset"] if values.sizes.get("wheelset") == 1 else [], drop=True)

    @property
    def place(self) -> str:
        """Name of the body or of the element; empty without."""
        return next(iter(self.at.values()), "").replace("_", " ")

    @property
    def quantity(self) -> Quantity:
        """Quantity of the number."""
        (word, words, _), own, place = REDUCTIONS[self.reduction], RUN[self.variable], self.place
        label, text = (f"{place} {own.label}", f"{own.label} of the {place}") if place else (own.label, own.text)
        text = text.partition(":")[0].replace("the patch", ALL)
        return own._replace(label=f"{word}{label}", text=f"{text}, {words}")


def _of_patches(*names: str) -> dict[str, Quantity]:
    """Quantities of all patches together."""
    of_one = {name: PATCH[f"patch_{name}"] for name in names}
    return {name: own._replace(text=own.text.replace("the patch", ALL)) for name, own in of_one.items()}


FORCES = tuple(f"{axis}_force" for axis in AXES)
MOMENTS = tuple(f"{turn}_moment" for turn in TURNS)
# One value for each side of a contact scene.
CONTACT_SIDES = {
    **_of_patches("normal_force"),
    **{name: CONTACT[name]._replace(text=f"{CONTACT[name].text}, {CONTACT[name].sign}") for name in FORCES},
    **{name: CONTACT[name] for name in MOMENTS},
    **_of_patches("max_pressure", "area"),
    "approach": CONTACT["approach"],
    **{
        name: own._replace(text=f"{own.text}, patch with the largest load")
        for name, own in _of_patches("semi_axis_x", "semi_axis_y").items()
    },
    **_of_patches("stick_area", "frictional_power"),
    **{name: SOLUTION[name] for name in ("z", "roll")},
}
STRESSES = {
    f"largest_von_mises_{body}": Quantity((), "Pa", f"largest von Mises stress at the requested depths, {body}")
    for body in ("wheel", "rail", "upper", "lower")
}
COST = {
    "patches": CONTACT["patches"],
    "points": CONTACT["points_count"],
    "contact_solves": SOLUTION["contact_solves"],
    "newton_iterations": Quantity((), "1", "Newton iterations of the last solve, or of the whole run"),
    "solve_seconds": SOLUTION["contact_seconds"],
    "warm_seconds": Quantity(
        (), "s", "time for all contact solves, repeated with compiled code, meshes and compliances at hand"
    ),
}
RUN_SIDES = {
    **{f"largest_{name}": Reduced(name, "largest") for name in ("lateral_force", "longitudinal_force")},
    **{f"{how}_vertical_force": Reduced("vertical_force", how) for how in ("least", "greatest")},
    "max_pressure": Reduced("patch_max_pressure", "greatest"),
    **{f"{how}_t_gamma": Reduced("t_gamma", how) for how in ("greatest", "mean")},
}
RUN_WHOLE = {
    **{f"largest_{body}_y": Reduced("body_y", "largest", {"body": body}) for body in reversed(HELD)},
    "largest_car_body_roll": Reduced("body_roll", "largest", {"body": "car_body"}),
    "largest_bumpstop_force": Reduced("element_force", "largest", {"element": "bumpstop", "axis": "y"}),
    "distance": Reduced("distance", "greatest"),
}
RUN_COST = {
    "steps_accepted": Quantity((), "1", "steps of the integrator"),
    "steps_rejected": Quantity((), "1", "steps rejected"),
    "evaluations": Quantity((), "1", "evaluations of the equations of motion"),
    "run_seconds": Quantity((), "s", "computing time of the run without preparation of the contact model"),
}
HISTORIES = {
    **{name: Reduced(name, "") for name in ("time", "distance")},
    **{f"{body}_y": Reduced("body_y", "", {"body": body}) for body in HELD},
    **{f"{body}_roll": Reduced("body_roll", "", {"body": body}) for body in ("car_body", "wheelset")},
    "wheelset_z": Reduced("body_z", "", {"body": "wheelset"}),
    **{name: Reduced(name, "") for name in (*FORCES, "t_gamma")},
}
OF_VEHICLE = {
    "largest_guiding_force": Reduced("guiding_force", "largest"),
    "largest_derailment_quotient": Reduced("derailment_quotient", "largest"),
    "largest_track_shifting_force": Reduced("track_shifting_force", "largest"),
    "greatest_wheel_unloading": Reduced("wheel_unloading", "greatest"),
}
STEADY = {
    **{name: own.quantity for name, own in OF_VEHICLE.items()},
    "critical_speed": Quantity(
        (), "m/s", "linear critical speed on straight track", label="critical speed", shown="m/s"
    ),
    "critical_frequency": Quantity(
        (), "Hz", "frequency of the mode at the critical speed", label="frequency", shown="Hz"
    ),
}
PHYSICAL = {name: own.quantity for name, own in (RUN_SIDES | RUN_WHOLE).items()} | STEADY
PHYSICAL = {**CONTACT_SIDES, **STRESSES, **{name: own for name, own in PHYSICAL.items() if name not in CONTACT_SIDES}}
QUANTITIES: dict[str, Quantity] = {
    **PHYSICAL,
    **{f"{name}_error_estimate": own for name, own in ERRORS.items()},
    **COST,
    **RUN_COST,
}
# Quantities of tables and figures, if they vary between cases.
MAIN = (
    *("max_pressure", "area", "lateral_force", "longitudinal_force", "approach", "normal_force"),
    *("largest_wheelset_y", "largest_lateral_force", "least_vertical_force", "greatest_t_gamma"),
    "largest_car_body_roll",
    *("critical_speed", "largest_guiding_force", "largest_derailment_quotient", "largest_track_shifting_force"),
    "greatest_wheel_unloading",
)
SAME = 1e-4  # relative differences below it are due to the load search


def of_contact(own: SideValues) -> dict[str, float]:
    """Quantities of one side of a contact solution; none for a failed side."""
    if not own.ok:
        return {}
    load = own.by_patch("patch_normal_force")
    quantities = {
        "normal_force": sum(load),
        **{name: own[name] for name in (*FORCES, *MOMENTS, "approach", "z", "roll")},
        "max_pressure": max(own.by_patch("patch_max_pressure"), default=0.0),
        **{name: sum(own.by_patch(f"patch_{name}")) for name in ("area", "stick_area", "frictional_power")},
    }
    if load:
        main = load.index(max(load))
        quantities |= {name: own.by_patch(f"patch_{name}")[main] for name in ("semi_axis_x", "semi_axis_y")}
    quantities |= {f"{name}_error_estimate": value for name, value in own.error_estimate.items()}
    quantities |= {
        "patches": own.patches,
        "points": own["points_count"],
        "contact_solves": own["contact_solves"],
        "newton_iterations": own["newton_count"],
        "solve_seconds": own["contact_seconds"],
    }
    for body in own.stressed_bodies:
        largest = (own.largest_von_mises(body, patch)[0] for patch in range(own.patches))
        quantities[f"largest_von_mises_{body}"] = max(largest, default=0.0)
    return {name: float(value) for name, value in quantities.items()}


def of_run(data: Dataset) -> tuple[dict[str, dict[str, float]], dict[str, float]]:
    """Quantities of a run, by side and for the whole run."""
    sides: dict[str, dict[str, float]] = {}
    for side in map(str, data["side"].values):
        side_data = data.sel(side=side)
        sides[side] = {name: _number(own, side_data) for name, own in RUN_SIDES.items()} | {
            "contact_solves": float(side_data["contact_solves"]),
            "newton_iterations": float(side_data["newton_iterations"]),
            "solve_seconds": float(side_data["contact_seconds"]),
        }
    whole = RUN_WHOLE if is_of_wagon(data) else OF_VEHICLE | {"distance": RUN_WHOLE["distance"]}
    run_values = {name: _number(own, data) for name, own in whole.items()}
    run_values |= {name: float(data.attrs[name]) for name in ("steps_accepted", "steps_rejected", "evaluations")}
    return sides, run_values | {"run_seconds": float(data.attrs["seconds"])}


def of_curve(wheelsets: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    """Quantities of a steady curve, of the rows of its wheelsets."""
    columns = {
        name: np.ravel([list(own.values()) if isinstance(own, Mapping) else own for own in values]).astype(float)
        for name, key in ((name, own.variable) for name, own in OF_VEHICLE.items())
        for values in [[row[key] for row in wheelsets]]
    }
    return {name: float(REDUCTIONS[OF_VEHICLE[name].reduction][2](values)) for name, values in columns.items()}


def of_critical_speeds(found: Sequence[CriticalSpeed]) -> dict[str, float]:
    """Mean over the places of the strips."""
    speeds = [own.speed for own in found]
    return {
        "critical_speed": float(np.mean(speeds)),
        "critical_frequency": float(np.mean([own.mode.frequency for own in found])),
    }


def histories_of(data: Dataset) -> dict[str, Any]:
    """Time histories of a run by name: values (time,) or (time, side), with unit and description."""
    return {
        name: {
            "values": own.of(data).values.tolist(),
            "units": RUN[own.variable].unit,
            "long_name": ": ".join(filter(None, (own.place, RUN[own.variable].text))),
        }
        for name, own in HISTORIES.items()
    }


def _number(own: Reduced, data: Dataset) -> float:
    values = own.of(data).values
    finite = values[np.isfinite(values)]
    return float(REDUCTIONS[own.reduction][2](finite)) if finite.size else float("nan")


def varying(data: Dataset) -> list[str]:
    """Names of the main quantities that vary between cases."""
    names = []
    for name in MAIN:
        if name in data and name not in data.coords:
            values = data[name].values[np.isfinite(data[name].values)]
            if values.size and np.ptp(values) > SAME * np.abs(values).max():
                names.append(name)
    return names
