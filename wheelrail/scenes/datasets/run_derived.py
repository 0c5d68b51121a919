"""Derived variables of a run: energy balance and wear."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.stress.shakedown import load_factor, surface_fatigue_index, utilisation
from wheelrail.scenes.datasets.patches import means
from wheelrail.vehicle.simulation.energy_balance import APPLIED, energy_balance

if TYPE_CHECKING:
    from xarray import DataArray, Dataset, Variable

    from wheelrail.vehicle.simulation.history import History


def with_energy(data: Dataset, history: History) -> Dataset:
    """Results with mechanical energy, power and work by cause, and attribute energy_balance_error.

    Parameters:
        data: Dataset of the run.
        history: of the run.
    """
    balance = energy_balance(history)
    energy = {"units": "J", "long_name": "kinetic and elastic energy, spin relative to nominal rolling"}
    by_cause = ("time", "cause")
    added = data.assign(
        mechanical_energy=("time", balance.energy, energy),
        power=(
            by_cause,
            balance.power,
            {"units": "W", "long_name": "power by cause of change of the mechanical energy"},
        ),
        work=(by_cause, balance.work, {"units": "J", "long_name": "work by the same cause since the first sample"}),
    )
    return added.assign_coords(cause=list(APPLIED[: balance.power.shape[1]])).assign_attrs(
        energy_balance_error=balance.error
    )


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
    per_wheel = power.sum("patch")
    variables = {
        "frictional_power": (per_wheel, "W", "frictional power, all patches of a wheel"),
        "t_gamma": (per_wheel / data["speed"], "N", "T-gamma: frictional energy per metre of track"),
        "patch_utilisation": (used, "1", "tangential over normal force of the patch"),
        "patch_load_factor": (loaded, "1", f"peak pressure over the shear yield stress of {1e-6 * shear_yield:g} MPa"),
        "patch_surface_fatigue_index": (
            index,
            "1",
            "surface fatigue index, utilisation minus 1 / load factor; above 0: ratcheting",
        ),
    }
    return described(variables)


def described(variables: Mapping[str, tuple[DataArray, str, str]]) -> dict[str, Variable]:
    """Variables with their units and meanings, on the coordinates of the Dataset that they are assigned to."""
    from xarray import Variable

    return {name: Variable(v.dims, v.data, means(units, text)) for name, (v, units, text) in variables.items()}
