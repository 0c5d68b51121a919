"""Quantities of a case in the results of a study, with units and descriptions."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.datasets.run_schema import of_wagon

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.scenes.contacts.side_values import SideValues

# Name: unit, meaning. One value for each side of a contact scene.
CONTACT = {
    "normal_force": ("N", "normal force of all patches"),
    "longitudinal_force": ("N", "contact force on the wheel or the upper body, positive forward"),
    "lateral_force": ("N", "contact force on the wheel or the upper body, positive to the left"),
    "vertical_force": ("N", "contact force on the wheel or the upper body, positive upwards"),
    "roll_moment": ("N m", "moment of the contact force about the forward axis"),
    "spin_moment": ("N m", "moment of the contact force about the lateral axis"),
    "yaw_moment": ("N m", "moment of the contact force about the upward axis"),
    "max_pressure": ("Pa", "peak pressure of all patches"),
    "area": ("m2", "area of all patches"),
    "approach": ("m", "approach of the bodies: largest penetration of the undeformed bodies; negative is a gap"),
    "semi_axis_x": ("m", "longitudinal semi-axis of the patch with the largest load"),
    "semi_axis_y": ("m", "lateral semi-axis of the patch with the largest load"),
    "stick_area": ("m2", "stick area"),
    "frictional_power": ("W", "frictional power"),
    "z": ("m", "height of the wheelset or the upper body"),
    "roll": ("rad", "roll of the wheelset"),
}
ESTIMATES = {
    "force_error_estimate": ("N", "estimated error of the contact force"),
    "moment_error_estimate": ("N m", "estimated error of the moment"),
    "max_pressure_error_estimate": ("Pa", "estimated error of the peak pressure"),
    "area_error_estimate": ("m2", "estimated error of the area"),
}
STRESSES = {
    f"largest_von_mises_{body}": ("Pa", f"largest von Mises stress at the requested depths, {body}")
    for body in ("wheel", "rail", "upper", "lower")
}
COST = {
    "patches": ("1", "number of contact patches"),
    "points": ("1", "contact points of the last solve"),
    "contact_solves": ("1", "contact problems solved"),
    "newton_iterations": ("1", "Newton iterations of the last solve, or of the whole run"),
    "solve_seconds": ("s", "time for all contact solves"),
    "warm_seconds": ("s", "time for all contact solves, repeated with compiled code, meshes and compliances at hand"),
}
# One value for each side of a run: variable, how it is summed up, unit, meaning.
RUN_SIDES = {
    "largest_lateral_force": (
        "lateral_force",
        "largest",
        "N",
        "largest magnitude of the lateral contact force on the wheel",
    ),
    "largest_longitudinal_force": (
        "longitudinal_force",
        "largest",
        "N",
        "largest magnitude of the longitudinal contact force on the wheel",
    ),
    "least_vertical_force": ("vertical_force", "least", "N", "minimum vertical contact force on the wheel"),
    "greatest_vertical_force": ("vertical_force", "greatest", "N", "maximum vertical contact force on the wheel"),
    "max_pressure": ("patch_max_pressure", "greatest", "Pa", "peak pressure of all patches"),
    "greatest_t_gamma": ("t_gamma", "greatest", "N", "maximum T-gamma"),
    "mean_t_gamma": ("t_gamma", "mean", "N", "T-gamma, mean over the samples"),
}
RUN = {
    "largest_wheelset_y": (
        "wheelset_y",
        "largest",
        "m",
        "largest magnitude of the lateral displacement of the wheelset",
    ),
    "largest_bogie_y": ("bogie_y", "largest", "m", "largest magnitude of the lateral displacement of the bogie"),
    "largest_car_body_y": (
        "car_body_y",
        "largest",
        "m",
        "largest magnitude of the lateral displacement of the car body",
    ),
    "largest_car_body_roll": ("car_body_roll", "largest", "rad", "largest magnitude of the roll of the car body"),
    "largest_bumpstop_force": ("bumpstop_force", "largest", "N", "largest magnitude of the bumpstop force"),
    "distance": ("distance", "greatest", "m", "distance run"),
}
RUN_COST = {
    "steps_accepted": ("1", "steps of the integrator"),
    "steps_rejected": ("1", "steps rejected"),
    "evaluations": ("1", "evaluations of the equations of motion"),
    "run_seconds": ("s", "computing time of the run without preparation of the contact model"),
}
HISTORIES = ("distance", "wheelset_y", "wheelset_z", "wheelset_roll", "bogie_y", "car_body_y", "car_body_roll")
SIDED_HISTORIES = ("longitudinal_force", "lateral_force", "vertical_force", "t_gamma")

PHYSICAL = {
    **CONTACT,
    **STRESSES,
    **{name: entry[2:] for name, entry in (RUN_SIDES | RUN).items()},
}
MEANINGS: dict[str, tuple[str, str]] = {**PHYSICAL, **ESTIMATES, **COST, **RUN_COST}
# Quantities of tables and figures, if they vary between cases: label, scale, unit.
MAIN = {
    "max_pressure": ("peak pressure", 1e-6, "MPa"),
    "area": ("area", 1e6, "mm²"),
    "lateral_force": ("lateral force", 1e-3, "kN"),
    "longitudinal_force": ("longitudinal force", 1e-3, "kN"),
    "approach": ("approach", 1e6, "µm"),
    "normal_force": ("normal force", 1e-3, "kN"),
    "largest_wheelset_y": ("largest wheelset y", 1e3, "mm"),
    "largest_lateral_force": ("largest lateral force", 1e-3, "kN"),
    "least_vertical_force": ("minimum vertical force", 1e-3, "kN"),
    "greatest_t_gamma": ("maximum T-gamma", 1.0, "N"),
    "largest_car_body_roll": ("largest car body roll", 1e3, "mrad"),
}
SAME = 1e-4  # relative differences below it are due to the load search
SUMMED: dict[str, Callable[[Any], Any]] = {
    "largest": lambda values: np.nanmax(np.abs(values)),
    "greatest": np.nanmax,
    "least": np.nanmin,
    "mean": np.nanmean,
}


def of_contact(own: SideValues) -> dict[str, float]:
    """Quantities of one side of a contact solution; none for a failed side."""
    if not own.ok:
        return {}
    load = own.by_patch("patch_normal_force")
    quantities = {
        "normal_force": sum(load),
        **{name: own[name] for name in ("longitudinal_force", "lateral_force", "vertical_force")},
        **{name: own[name] for name in ("roll_moment", "spin_moment", "yaw_moment")},
        "max_pressure": max(own.by_patch("patch_max_pressure"), default=0.0),
        **{name: sum(own.by_patch(f"patch_{name}")) for name in ("area", "stick_area", "frictional_power")},
        **{name: own[name] for name in ("approach", "z", "roll")},
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
        sides[side] = {
            name: _summed(side_data[variable].values, statistic)
            for name, (variable, statistic, _, _) in RUN_SIDES.items()
        } | {
            "contact_solves": float(side_data["contact_solves"]),
            "newton_iterations": float(side_data["newton_iterations"]),
            "solve_seconds": float(side_data["contact_seconds"]),
        }
    run_values = {
        name: _summed(of_wagon(data, variable).values, statistic) for name, (variable, statistic, _, _) in RUN.items()
    }
    run_values |= {name: float(data.attrs[name]) for name in ("steps_accepted", "steps_rejected", "evaluations")}
    return sides, run_values | {"run_seconds": float(data.attrs["seconds"])}


def histories_of(data: Dataset) -> dict[str, Any]:
    """Time histories of a run by name: values (time,) or (time, side), with unit and description."""
    histories = {}
    for name in ("time", *HISTORIES, *SIDED_HISTORIES):
        values = of_wagon(data, name)
        histories[name] = {"values": values.values.tolist()} | {
            key: values.attrs[key] for key in ("units", "long_name")
        }
    return histories


def _summed(values: Any, statistic: str) -> float:
    finite = values[np.isfinite(values)]
    return float(SUMMED[statistic](finite)) if finite.size else float("nan")


def varying(data: Dataset) -> list[str]:
    """Names of the main quantities that vary between cases."""
    names = []
    for name in MAIN:
        if name in data and name not in data.coords:
            values = data[name].values[np.isfinite(data[name].values)]
            if values.size and np.ptp(values) > SAME * np.abs(values).max():
                names.append(name)
    return names
