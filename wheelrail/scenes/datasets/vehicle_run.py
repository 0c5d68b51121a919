"""Results of a run of a vehicle as variables with units over time, body, wheelset and side."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.scenes.datasets.patches import means, patch_variables
from wheelrail.scenes.datasets.run import (
    cost_variables,
    run_attributes,
    run_coordinates,
    track_variables,
    wheel_variables,
)
from wheelrail.scenes.datasets.run_derived import described, wear
from wheelrail.vehicle.multibody.vehicle import COORDINATES
from wheelrail.vehicle.multibody.wheel_forces import OUTWARDS

if TYPE_CHECKING:
    from xarray import Dataset, Variable

    from wheelrail.vehicle.simulation.history import History

BY_WHEEL = ("time", "wheelset", "side")
BY_ELEMENT = ("time", "element", "axis")
COORDINATE_TEXTS = {
    "x": "displacement forward of the place in the reference motion, with distance and speed",
    "y": "lateral displacement from the centre line of the track at the body's own centre, positive to the left; in a "
    "curve that of a long body contains the rise of its chord",
    "z": "height above the nominal position",
    "roll": "roll about the track direction",
    "pitch": "pitch; of a wheelset in excess of nominal rolling",
    "yaw": "yaw about the track normal, positive to the left",
}


def vehicle_dataset(history: History, *, scene: str, vehicle: str, shear_yield: float) -> Dataset:
    """Dataset over time, body, wheelset, side (left, right), element, axis, patch (padded with NaN), edge (low, high).

    Parameters:
        history: of the run.
        scene, vehicle: their texts.
        shear_yield: yield stress in shear, Pa, for the shakedown map.
    """
    from xarray import Dataset

    names, bodies = history.dynamics.vehicle.wheelsets, history.dynamics.vehicle.bodies
    wheels = [patches for row in history.rows for pair in row.patches for patches in pair]
    statuses = np.array([row.contact_status for row in history.rows])
    variables = {
        **_motion(history),
        **track_variables(history),
        **wheel_variables(history.force, history.moment, history.approach, BY_WHEEL),
        **patch_variables(wheels, BY_WHEEL, (len(history), len(names), len(SIDES))),
        "in_contact": (BY_WHEEL, statuses == "converged", means("1", "whether wheel and rail are in contact")),
        **_suspension(history),
        **_applied(history),
        **cost_variables(history.cost),
    }
    coordinates = run_coordinates(history) | {
        "body": ("body", list(history.dynamics.vehicle.names)),
        "nominal_x": ("body", [body.x for body in bodies.values()], means("m", "place along the vehicle, forward")),
        "wheelset": ("wheelset", list(names)),
        "element": ("element", list(history.dynamics.vehicle.elements)),
        "axis": ("axis", ["x", "y", "z"]),
    }
    attributes = {
        "title": "Run of a vehicle in three dimensions on elastic wheel-rail contact",
        "frame": "track frame of each body at its own distance: x forward, y to the left, z upwards; forces act on the "
        "wheels",
        "vehicle": vehicle,
        "wheel_y": history.dynamics.vehicle.wheel_y,
        "nominal_radius": history.dynamics.vehicle.radius,
        "mean_wheel_load": history.dynamics.vehicle.mean_wheel_load,
    }
    data = Dataset(variables, coords=coordinates, attrs=attributes | run_attributes(history, scene))
    return data.assign(wear(data, shear_yield)).assign(guiding_variables(data))


def guiding_variables(data: Dataset) -> dict[str, Variable]:
    """Forces in the terms of running safety: Y, Y/Q, sum of Y and sum of Q of every wheelset.

    Parameters:
        data: Dataset of a run of a vehicle.
    """
    outwards = data["side"].copy(data=[OUTWARDS[side] for side in data["side"].values.tolist()])
    guiding, load = data["lateral_force"] * outwards, data["vertical_force"]
    shifting = data["lateral_force"].sum("side", skipna=False)
    texts = {
        "guiding_force": (guiding, "N", "guiding force Y: lateral force on the rail, positive outwards"),
        "derailment_quotient": (guiding / load.where(load > 0.0), "1", "derailment quotient Y/Q; NaN without load"),
        "track_shifting_force": (shifting, "N", "sum of Y: lateral force of both wheels on the track, to the right"),
        "axle_load": (load.sum("side", skipna=False), "N", "sum of Q"),
        "wheel_unloading": (1.0 - load / data.attrs["mean_wheel_load"], "1", "1 - Q / mean static wheel load"),
    }
    return described(texts)


def _motion(history: History) -> dict[str, Any]:
    """Coordinates of the bodies and their rates."""
    variables: dict[str, Any] = {}
    position, rate, series = history.motion
    for index, name in enumerate(COORDINATES):
        units, text = ("m" if name in "xyz" else "rad"), COORDINATE_TEXTS[name]
        by_body = ("time", "body")
        variables[f"body_{name}"] = (by_body, position[..., index], means(units, text))
        variables[f"body_{name}_rate"] = (by_body, rate[..., index], means(f"{units}/s", f"rate of {text}"))
    if series.size:
        text = "deflection of the series springs of the Maxwell elements, in the order of elements and axes"
        variables["series_deflection"] = (("time", "series"), series, means("m", text))
    return variables


def _suspension(history: History) -> dict[str, Any]:
    """Deflections and forces of the suspension elements."""
    deflections, forces = history.suspension()
    deflection = "displacement of the upper point of the element relative to the lower one, in the element's axes"
    force = "force of the element on the upper body, static load included, in the element's axes"
    return {
        "element_deflection": (BY_ELEMENT, deflections, means("m", deflection)),
        "element_force": (BY_ELEMENT, forces, means("N", force)),
    }


def _applied(history: History) -> dict[str, Any]:
    """Torques and forces on the vehicle, where there are any."""
    loads, variables = history.dynamics.loads, dict[str, Any]()
    if not loads:
        return variables
    torque, force = history.applied()
    if loads.torques:
        text = "torque of motors and brakes on the wheelset about its axle, positive forwards"
        variables["applied_torque"] = (("time", "wheelset"), torque, means("N m", text))
    if loads.forces:
        text = "sum of the applied forces on the body, along the axes of the track section there"
        variables["applied_force"] = (("time", "body", "axis"), force, means("N", text))
    return variables
