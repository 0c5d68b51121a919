"""Reader of run results, including files of earlier versions; names of the files of a run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.scenes.datasets.declared import check
from wheelrail.scenes.datasets.input_files import scene_of_run
from wheelrail.scenes.datasets.netcdf import read
from wheelrail.scenes.datasets.run_derived import guiding_variables
from wheelrail.scenes.quantities import EDGES, MOTION, RUN, TIME, TRACK
from wheelrail.scenes.quantity import Quantity, filled
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.vehicle.multibody.plane_wagon import COORDINATES, HELD, WHEELSET, plane_vehicle

if TYPE_CHECKING:
    from xarray import Dataset

RESULTS, CHECKPOINTS = "run.nc", "run.checkpoints"  # files that a run writes
FARTHEST = 1e7  # m along the track
FORM = 2  # of results, their attribute; those of the plane wagon without it have no bodies, wheelsets and elements
ATTRIBUTES: dict[str, type] = {
    **dict.fromkeys(("status", "scene", "vehicle"), str),
    **dict.fromkeys(("speed", "seconds", "steps_accepted", "steps_rejected", "steps_failed", "evaluations"), float),
    **dict.fromkeys(("nominal_radius", "wheel_y", "mean_wheel_load"), float),
}


def is_of_wagon(data: Dataset) -> bool:
    """Whether the results belong to the plane wagon of the scene, without the text of a vehicle file."""
    return not data.attrs["vehicle"]


def read_run(file: Path) -> Dataset:
    """Dataset of a run; raises SceneError as `run_of`."""
    return run_of(read(file), file)


def run_of(data: Dataset, file: Path) -> Dataset:
    """Results of a run in the present form. Raises SceneError, naming what is missing or differs in the file.

    Parameters:
        data: Dataset of the file.
        file: for messages.
    """
    if not data.sizes.get("time") or "patches" not in data or not {"body_y", "wheelset_y"} & set(data.variables):
        raise SceneError(f"{file}: must contain results of a run, as run.nc of wheelrail run does")
    form = data.attrs.get("form", 1)
    if not isinstance(form, int | np.integer) or form > FORM:
        raise SceneError(f"{file}: attribute form: {form!r:.60}; must be up to {FORM}, the latest that is known")
    if "wheelset_y" in data.variables:
        data = _with_wheelsets(data, file)
    check(data, file, RUN, ATTRIBUTES)
    for name, expected in {"side": SIDES, "edge": EDGES, "axis": ("x", "y", "z")}.items():
        if tuple(data[name].values.tolist()) != tuple(expected):
            raise SceneError(f"{file}: {name}: must be {', '.join(expected)}")
    if not data.sizes["patch"]:
        raise SceneError(f"{file}: patch: without length; must have one place at least")
    time, distance = data["time"].values, data["distance"].values
    if not np.isfinite(time).all() or (np.diff(time) <= 0.0).any():
        raise SceneError(f"{file}: time: must be finite numbers that increase")
    if not (np.abs(distance) <= FARTHEST).all() or (np.diff(distance) < 0.0).any():
        raise SceneError(f"{file}: distance: must be numbers up to {FARTHEST:g} m that do not decrease")
    for name in (*TRACK, *MOTION):
        if not np.isfinite(data[name].values).all():
            raise SceneError(f"{file}: {name}: must be finite numbers")
    _check_names(data, file)
    return data


def _check_names(data: Dataset, file: Path) -> None:
    """Raise SceneError unless body names are unique and wheelsets, one at least, are bodies."""
    bodies, wheelsets = data["body"].values.tolist(), data["wheelset"].values.tolist()
    if len(set(bodies)) < len(bodies):
        raise SceneError(f"{file}: body: must be different names")
    if not wheelsets or not set(wheelsets) <= set(bodies):
        raise SceneError(f"{file}: wheelset: must be names of bodies, one at least")


def _with_wheelsets(data: Dataset, file: Path) -> Dataset:
    """Results of the plane wagon of form 1 with dimensions of bodies, wheelsets and elements.

    Of the elements they have the bumpstop; other variables keep names and meanings. Raises SceneError for missing
    variables, and for a scene whose files are missing.
    """
    moving = [f"{name}{rate}" for name in COORDINATES for rate in ("", "_rate")]
    outputs = ("yaw_reaction", "bumpstop_deflection", "bumpstop_force")
    needed = dict.fromkeys((*moving, *outputs, "distance"), Quantity(TIME, "1", ""))
    wheels = {name: Quantity(("time", "side"), "1", "") for name in ("lateral_force", "vertical_force")}
    check(data, file, {**TRACK, **needed, **wheels}, {"nominal_radius": float})
    scene = scene_of_run(data, file)
    vehicle, zero = plane_vehicle(scene.vehicle.on(scene.wheelset.radius)), np.zeros(data.sizes["time"])
    turns = {"": data["distance"] / data.attrs["nominal_radius"], "_rate": data["speed"] / data.attrs["nominal_radius"]}
    values = {name: data[name].values for name in moving}
    for rate, turn in turns.items():  # the angle of rolling was part of the pitch
        values[f"{WHEELSET}_pitch{rate}"] = values[f"{WHEELSET}_pitch{rate}"] - turn.values
    motions = {
        name: np.stack([values.get(name.replace("body", body, 1), zero) for body in HELD], axis=-1) for name in MOTION
    }
    bumpstop = {
        "element_deflection": data["bumpstop_deflection"].values,
        "element_force": data["bumpstop_force"].values,
    }
    unknown = {"element_deflection": np.full_like(zero, np.nan), "element_force": zero}
    elements = {
        name: np.stack([unknown[name], lateral, unknown[name]], axis=-1)[:, None] for name, lateral in bumpstop.items()
    }
    of_wheelset = {
        name: own.expand_dims("wheelset", 1).variable
        for name, own in data.data_vars.items()
        if own.dims[:2] == ("time", "side") or name == "yaw_reaction"
    }
    places = {
        "body": list(HELD),
        "nominal_x": np.zeros(len(HELD)),
        "wheelset": [WHEELSET],
        "element": ["bumpstop"],
        "axis": ["x", "y", "z"],
    }
    own = {"form": FORM, "vehicle": "", "wheel_y": vehicle.wheel_y, "mean_wheel_load": vehicle.mean_wheel_load}
    data = data.drop_vars([*moving, *outputs[1:]]).assign(of_wheelset).assign_attrs(own)
    data = data.assign(filled(RUN, motions | elements | places)).set_coords("nominal_x")
    return data.assign(guiding_variables(data))
