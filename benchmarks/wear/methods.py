"""Wear by standard and by elastic contact: rates on new wheels by case, and worn profiles at equal distance.

`python -m benchmarks.wear.methods`: three curves of the Manchester vehicle, USFD, to 2000 km, five minutes. Draws
`benchmarks/figures/wear_methods.png`.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import wheelrail as wr
from benchmarks.common.machine import machine_description

if TYPE_CHECKING:
    from xarray import Dataset

SCENES, PICTURE = Path(__file__).parents[2] / "scenes", Path(__file__).parents[1] / "figures" / "wear_methods.png"
UNTIL = 2e6  # m
CURVES = {8000.0: (0.4, 0.0, 45.0), 1200.0: (0.4, 0.06, 35.0), 600.0: (0.2, 0.10, 25.0)}  # R: share, cant, speed
METHODS: Mapping[str, tuple[str, Mapping[str, Any]]] = {
    "standard": ("vehicle", {}),
    "half-spaces": ("vehicle_elastic", {"bodies": "half-space"}),
    "finite bodies": ("vehicle_elastic", {}),
    "finite bodies, 20 cells": ("vehicle_elastic", {"cells": 20}),
}
LOOPS = {  # method and depth of steps to the end; of other methods new wheels only
    "standard, steps of 0.05 mm": ("standard", 5e-5),
    "half-spaces, steps of 0.05 mm": ("half-spaces", 5e-5),
    "finite bodies, steps of 0.05 mm": ("finite bodies", 5e-5),
    "standard": ("standard", 2.5e-5),
    "half-spaces": ("half-spaces", 2.5e-5),
    "finite bodies": ("finite bodies", 2.5e-5),
}


def worn(method: str, until: float, depth: float) -> Dataset:
    """Wear by a method to a distance m, in steps of a largest depth m."""
    scene, changes = METHODS[method]
    duty = [
        {
            "share": share,
            "name": f"R = {radius:.0f} m",
            "steady": {"curvature": 1.0 / radius, "cant": cant, "speed": speed},
            "both_hands": True,
            "set": dict(changes),
        }
        for radius, (share, cant, speed) in CURVES.items()
    ]
    table = {
        "scene": str(SCENES / f"{scene}.toml"),
        "vehicle": str(SCENES / "manchester_vehicle.toml"),
        "law": {"name": "usfd", "scale": 0.18},
        "until": until,
        "depth": depth,
        "duty": duty,
    }
    return wr.wear(table).data


def sections(data: Dataset, step: int = 0) -> np.ndarray:  # type: ignore[type-arg]
    """Section (cases,) m removed per distance in each case."""
    return np.asarray(data["depth_rate"].values[step, :, 0].sum(axis=1) * np.diff(data["s"].values).mean())


def new_table(data: Mapping[str, Dataset]) -> str:
    """Markdown: T-gamma and section by case on new wheels."""
    cases = [str(name) for name in next(iter(data.values()))["case"].values]
    rows = [
        f"| method | {' | '.join(f'{name}: N, mm² in 10 000 km' for name in cases)} |",
        f"|---|{'---|' * len(cases)}",
    ]
    for name, own in data.items():
        values = zip(own["t_gamma"].values[0], 1e13 * sections(own), strict=True)
        rows.append(f"| {name} | {' | '.join(f'{t_gamma:.1f}, {area:.1f}' for t_gamma, area in values)} |")
    return "\n".join(rows)


def worn_table(data: Mapping[str, Dataset]) -> str:
    """Markdown: wheels at the end, and change of the profile against that of the last method."""
    columns = "method", "km", "mm²", "deepest mm", "conicity", "Sd mm", "steps", "largest error", "differs (RMS)", "s"
    rows = [f"| {' | '.join(columns)} |", f"|{'---|' * len(columns)}"]
    last = list(data.values())[-1]
    for name, own in data.items():
        depth, size = own["depth"].values[-1, 0], np.linalg.norm(last["depth"].values[-1, 0])
        cells = (
            name if own.attrs["status"] == "completed" else f"{name}: {own.attrs['status']}",
            f"{1e-3 * own['distance'].values[-1]:.0f}",
            f"{1e6 * own['removed_section'].values[-1, 0]:.2f}",
            f"{1e3 * depth.max():.3f}",
            f"{own['conicity'].values[-1]:.3f}",
            f"{1e3 * own['Sd'].values[-1, 0]:.2f}",
            f"{own.sizes['step'] - 1}",
            f"{100 * np.nanmax(own['step_error'].values[2:], initial=0.0):.0f} %",
            f"{100 * np.linalg.norm(depth - last['depth'].values[-1, 0]) / size:.0f} %",
            f"{own['seconds'].values.sum():.0f}",
        )
        rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(rows)


def draw(data: Mapping[str, Dataset], file: Path = PICTURE) -> None:
    """Rates on new wheels, and depths at the end."""
    from wheelrail.scenes.plots.style import SERIES, save, shown, styled

    with styled():
        figure = shown(None, (7.2, 5.4))
        axes = figure.subplots(2, 1, sharex=True)
        for k, (name, own) in enumerate(data.items()):
            style = {key: value for key, value in SERIES[k].items() if key != "marker"}
            s, rate = 1e3 * own["s"].values, own["share"].values @ own["depth_rate"].values[0, :, 0]
            axes[0].plot(s, 1e10 * rate, label=name, **style)
            axes[1].plot(s, 1e3 * own["depth"].values[-1, 0], label=name, **style)
        axes[0].set(ylabel="new: depth [mm in 10 000 km]", xlim=(-45.0, 40.0))
        end = 1e-3 * next(iter(data.values()))["distance"].values[-1]
        axes[1].set(ylabel=f"depth after {end:.0f} km [mm]", xlabel="arc length, flange side negative [mm]")
        axes[0].legend()
        save(figure, file)


def main() -> None:
    """Print the tables and draw the picture."""
    loops = {name: worn(method, UNTIL, depth) for name, (method, depth) in LOOPS.items()}
    first = {name: loops[name] if name in loops else worn(name, 1.0, 1e-4) for name in METHODS}
    print(machine_description(), new_table(first), worn_table(loops), sep="\n\n")
    draw({name: own for name, own in loops.items() if name in METHODS})


if __name__ == "__main__":
    main()
