"""Derived variables of a run: energy balance, wear, forces in the terms of running safety."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.stress.shakedown import load_factor, surface_fatigue_index, utilisation
from wheelrail.scenes.quantities import RUN
from wheelrail.scenes.quantity import filled
from wheelrail.vehicle.multibody.wheel_forces import OUTWARDS, STEEP
from wheelrail.vehicle.simulation.energy_balance import energy_balance

if TYPE_CHECKING:
    from xarray import Dataset, Variable

    from wheelrail.vehicle.simulation.history import History


def with_energy(data: Dataset, history: History) -> Dataset:
    """Results with mechanical energy, power and work by cause, and attribute energy_balance_error.

    Parameters:
        data: Dataset of the run.
        history: of the run.
    """
    balance = energy_balance(history)
    values = {
        "mechanical_energy": balance.energy,
        "power": balance.power,
        "work": balance.work,
        "cause": list(balance.causes),
    }
    return data.assign(filled(RUN, values)).assign_attrs(energy_balance_error=balance.error)


def wear(data: Dataset, shear_yield: float) -> dict[str, Variable]:
    """Wear variables of a run, from its patches; NaN without a patch.

    Parameters:
        data: Dataset of the run.
        shear_yield: yield stress in shear, Pa.

    T-gamma, N, is the frictional energy per metre, including spin.
    """
    power = data["patch_frictional_power"]
    tangential = np.stack([data["patch_longitudinal_force"], data["patch_lateral_force"]], axis=-1)
    normal = data["patch_normal_force"]
    used = normal.copy(data=np.where(normal.notnull(), utilisation(normal.values, tangential), np.nan))
    loaded = data["patch_max_pressure"].copy(data=load_factor(data["patch_max_pressure"].values, shear_yield))
    with np.errstate(divide="ignore"):
        index = used.copy(data=surface_fatigue_index(used.values, loaded.values))
    unknown = (normal.notnull() & power.isnull()).any("patch")  # of a table, whose patches are resultants only
    per_wheel = power.sum("patch").where(~unknown)
    values = {
        "frictional_power": per_wheel,
        "t_gamma": per_wheel / data["speed"],
        "patch_utilisation": used,
        "patch_load_factor": loaded,
        "patch_surface_fatigue_index": index,
    }
    variables = filled(RUN, values)
    variables["patch_load_factor"].attrs["long_name"] += f" of {1e-6 * shear_yield:g} MPa"
    return variables


def on_check_rails(data: Dataset) -> dict[str, Variable]:
    """Normal force and frictional power of the backs of flanges on check rails, where any touches.

    Parameters:
        data: Dataset of the run.
    """
    outwards = data["side"].copy(data=[OUTWARDS[side] for side in data["side"].values.tolist()])
    back = outwards * data["patch_contact_angle"] > STEEP
    if not back.any():
        return {}
    own = {name: data[f"patch_{name}"].where(back, 0.0).sum("patch") for name in ("normal_force", "frictional_power")}
    return filled(RUN, {"check_rail_force": own["normal_force"], "check_rail_power": own["frictional_power"]})


def guiding_variables(data: Dataset) -> dict[str, Variable]:
    """Forces in the terms of running safety: Y, Y/Q, sum of Y and sum of Q of every wheelset.

    Parameters:
        data: Dataset of the run.
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
    return filled(RUN, values)
