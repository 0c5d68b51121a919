"""What `run.nc` holds: the variables of a short run on springs, so that the table cannot go stale."""

from __future__ import annotations

from typing import Any


def run_variables() -> str:
    """Markdown: a table of coordinates and variables with dimensions, units and meaning; and the attributes."""
    data = _example()
    rows = ["| name | dimensions | unit | meaning |", "|---|---|---|---|"]
    for name in (*data.coords, *data.data_vars):
        values = data[name]
        meaning = str(values.attrs.get("long_name", "")) or _listed(values)
        rows.append(f"| `{name}` | {', '.join(map(str, values.dims))} | {values.attrs.get('units', '')} | {meaning} |")
    return "\n".join([*rows, "", "Attributes: " + ", ".join(f"`{name}`" for name in data.attrs) + "."])


def _listed(values: Any) -> str:
    return ", ".join(map(str, values.values.tolist()))


def _example() -> Any:
    from benchmarks.exudyn.linear_contact import LinearContact
    from wheelrail.scenes.datasets.run import dataset
    from wheelrail.scenes.datasets.run_derived import with_energy
    from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
    from wheelrail.vehicle.simulation.simulate import simulate
    from wheelrail.vehicle.track.irregularity_spectrum import ERRI
    from wheelrail.vehicle.track.track import Track
    from wheelrail.vehicle.wagon.wagon import Wagon

    wagon = Wagon()
    track = Track(irregularities=ERRI["low"].irregularities(40.0, seed=1))
    history = simulate(wagon_dynamics(wagon, track, LinearContact(wagon.wheel_load), 20.0), (0.0, 0.01))
    return with_energy(dataset(history), history)
