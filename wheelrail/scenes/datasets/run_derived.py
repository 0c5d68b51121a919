"""Energy of a run beside what works on it, among its results."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.stress.shakedown import load_factor, surface_fatigue_index, utilisation
from wheelrail.vehicle.simulation.energy_balance import POWERS, energy_balance

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.vehicle.simulation.history import History
    from wheelrail.vehicle.track.track import Track
    from wheelrail.vehicle.wagon.wagon import Wagon
if TYPE_CHECKING:
    from xarray import DataArray, Dataset


def with_energy(data: Dataset, history: History, wagon: Wagon, track: Track) -> Dataset:
    """The results with mechanical energy, and power and work of all causes; attribute energy_balance_error."""
    found = energy_balance(history, wagon, track)
    energy = {"units": "J", "long_name": "kinetic energy and that of springs, spin counted from nominal rolling"}
    by_cause = ("time", "cause")
    added = data.assign(
        mechanical_energy=("time", found.energy, energy),
        power=(by_cause, found.power, {"units": "W", "long_name": "power of what changes the mechanical energy"}),
        work=(by_cause, found.work, {"units": "J", "long_name": "work of the same since the first sample"}),
    )
    return added.assign_coords(cause=list(POWERS)).assign_attrs(energy_balance_error=found.error)


def wear(data: Dataset, shear_yield: float) -> dict[str, DataArray]:
    """Variables to add to a run's, from its patches; shear_yield Pa, the yield stress in shear.

    T-gamma N is the energy that friction turns into heat per metre, spin included. Outside of any patch there is NaN.
    """
    power = data["patch_frictional_power"]
    tangential = np.stack([data["patch_longitudinal_force"], data["patch_lateral_force"]], axis=-1)
    normal = data["patch_normal_force"]
    used = normal.copy(data=np.where(normal.notnull(), utilisation(normal.values, tangential), np.nan))
    loaded = data["patch_max_pressure"].copy(data=load_factor(data["patch_max_pressure"].values, shear_yield))
    with np.errstate(divide="ignore"):
        index = used.copy(data=surface_fatigue_index(used.values, loaded.values))
    per_wheel = power.sum("patch")
    found = {
        "frictional_power": (per_wheel, "W", "power of friction that turns into heat, all patches of a wheel"),
        "t_gamma": (per_wheel / data["speed"], "N", "T-gamma: heat of friction per metre of track"),
        "patch_utilisation": (used, "1", "tangential over normal force of the patch"),
        "patch_load_factor": (loaded, "1", f"peak pressure over a yield stress in shear of {1e-6 * shear_yield:g} MPa"),
        "patch_surface_fatigue_index": (index, "1", "utilisation less one over the load factor: above 0 it ratchets"),
    }
    return {
        name: values.assign_attrs({"units": units, "long_name": text}) for name, (values, units, text) in found.items()
    }
