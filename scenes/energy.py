"""Energy of a run beside what works on it, among its results."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicle.energy import POWERS, energy_balance

if TYPE_CHECKING:
    from xarray import Dataset

    from vehicle.history import History
    from vehicle.track import Track
    from vehicle.wagon import Wagon


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
