"""Results of a run of a vehicle as variables with units over time, body, wheelset and side."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.scenes.datasets.declared import filled
from wheelrail.scenes.datasets.patches import patch_variables
from wheelrail.scenes.datasets.run import cost_values, run_attributes, run_coordinates, track_values, wheel_values
from wheelrail.scenes.datasets.run_derived import wear
from wheelrail.scenes.datasets.run_schema import BY_WHEEL, VEHICLE
from wheelrail.vehicle.multibody.vehicle import COORDINATES
from wheelrail.vehicle.multibody.wheel_forces import OUTWARDS

if TYPE_CHECKING:
    from xarray import Dataset, Variable

    from wheelrail.vehicle.simulation.history import History


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
    values = {
        **_motion(history),
        **track_values(history),
        **wheel_values(history.force, history.moment, history.approach),
        "in_contact": statuses == "converged",
        **_suspension(history),
        **_applied(history),
        **cost_values(history.cost),
        **run_coordinates(history),
        "body": list(history.dynamics.vehicle.names),
        "nominal_x": [body.x for body in bodies.values()],
        "wheelset": list(names),
        "element": list(history.dynamics.vehicle.elements),
        "axis": ["x", "y", "z"],
    }
    patches = patch_variables(wheels, BY_WHEEL, (len(history), len(names), len(SIDES)))
    attributes = {
        "title": "Run of a vehicle in three dimensions on elastic wheel-rail contact",
        "frame": "track frame of each body at its own distance: x forward, y to the left, z upwards; forces act on the "
        "wheels",
        "vehicle": vehicle,
        "wheel_y": history.dynamics.vehicle.wheel_y,
        "nominal_radius": history.dynamics.vehicle.radius,
        "mean_wheel_load": history.dynamics.vehicle.mean_wheel_load,
    }
    data = Dataset(filled(VEHICLE, values) | patches, attrs=attributes | run_attributes(history, scene))
    data = data.set_coords(["distance", "nominal_x"])
    return data.assign(wear(data, shear_yield)).assign(guiding_variables(data))


def guiding_variables(data: Dataset) -> dict[str, Variable]:
    """Forces in the terms of running safety: Y, Y/Q, sum of Y and sum of Q of every wheelset.

    Parameters:
        data: Dataset of a run of a vehicle.
    """
    outwards = data["side"].copy(data=[OUTWARDS[side] for side in data["side"].values.tolist()])
    guiding, load = data["lateral_force"] * outwards, data["vertical_force"]
    shifting = data["lateral_force"].sum("side", skipna=False)
    values = {
        "guiding_force": guiding,
        "derailment_quotient": guiding / load.where(load > 0.0),
        "track_shifting_force": shifting,
        "axle_load": load.sum("side", skipna=False),
        "wheel_unloading": 1.0 - load / data.attrs["mean_wheel_load"],
    }
    return filled(VEHICLE, values)


def _motion(history: History) -> dict[str, Any]:
    """Coordinates of the bodies and their rates."""
    values: dict[str, Any] = {}
    position, rate, series = history.motion
    for index, name in enumerate(COORDINATES):
        values[f"body_{name}"], values[f"body_{name}_rate"] = position[..., index], rate[..., index]
    return values | ({"series_deflection": series} if series.size else {})


def _suspension(history: History) -> dict[str, Any]:
    """Deflections and forces of the suspension elements."""
    deflections, forces = history.suspension()
    return {"element_deflection": deflections, "element_force": forces}


def _applied(history: History) -> dict[str, Any]:
    """Torques and forces on the vehicle, where there are any."""
    loads = history.dynamics.loads
    if not loads:
        return {}
    torque, force = history.applied()
    torques = {"applied_torque": torque} if loads.torques else {}
    return torques | ({"applied_force": force} if loads.forces else {})
