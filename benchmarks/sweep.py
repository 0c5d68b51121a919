"""Lateral sweep of a wheel across its rail at constant load: smoothness of forces as patches merge, split or change
cells.

python -m benchmarks.sweep [--step MM] [--from MM] [--to MM] [--friction MU] [--size MM] [--points lattice|grid]
                           [--picture FILE] [--json FILE]

One wheel of a wheelset (the other is its mirror image) under 57 kN from y = -8 to 8 mm, roll 0, rolling. Output for
every force and moment: the largest change between positions, and the scatter, the RMS of the second difference, both
relative to the load (moments: to the load on one nominal radius).
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from time import perf_counter

import numpy as np

from benchmarks.common.machine import machine_description
from benchmarks.common.models import STEEL, PairTrack, wheelset_model
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array

LOAD = 57e3  # N
NAMES = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
SPEED = 10.0  # m/s
RTOL = 1e-7  # of the load


def under_load(contact: WheelsetContact, y: float, depth: float, slope: float) -> tuple[float, float, ContactResult]:
    """Depth m at which the left wheel carries the load, slope N/m there, and the contact result, by secant steps."""
    last: tuple[float, float] | None = None
    for _ in range(30):
        state = WheelsetState(y=y, z=-depth, speed=SPEED, pitch_rate=SPEED / contact.mounting.radius)
        result = contact(state, "left")
        if not result.ok:
            raise RuntimeError(f"y = {1e3 * y:.2f} mm: {result.status}")
        force = float(result.force[2])
        if last is not None and abs(depth - last[0]) > 1e-10:
            slope = max((force - last[1]) / (depth - last[0]), 1e7)
        if abs(force - LOAD) <= RTOL * LOAD or (last is not None and abs(depth - last[0]) < 1e-12):
            break
        last = depth, force
        depth += float(np.clip((LOAD - force) / slope, -2e-5, 2e-5)) if force > 0 else 2e-5
    return depth, slope, result


def sweep(contact: WheelsetContact, positions: Array, say: bool = True) -> tuple[Array, list[int], Array, Array]:
    """Forces and moments (m, 6) on the wheel, number of patches, error of the load, seconds, for each position."""
    forces, patches, seconds, load_errors = [], [], [], []
    depth, slope = 0.0, 1e9
    depths: list[float] = []
    start = perf_counter()
    for i, y in enumerate(positions):
        began = perf_counter()
        guess = 2 * depths[-1] - depths[-2] if len(depths) > 1 else depth
        try:
            depth, slope, result = under_load(contact, float(y), guess, slope)
        except RuntimeError as error:
            print(f"  {error}", flush=True)
            result = ContactResult.failed(str(error))
        depths.append(depth)
        forces.append(np.concatenate([result.force, result.moment]) if result.ok else np.full(6, np.nan))
        patches.append(len(result.patches))
        load_errors.append(abs(result.force[2] / LOAD - 1))
        seconds.append(perf_counter() - began)
        if say and i % 50 == 49:
            left = (perf_counter() - start) / (i + 1) * (len(positions) - i - 1)
            print(f"  {1e3 * y:6.2f} mm, {left:.0f} s left", flush=True)
    return np.array(forces), patches, np.array(load_errors), np.array(seconds)


def picture(path: Path, y: Array, forces: Array, patches: list[int]) -> None:
    """Forces and moments over the lateral position, and their second differences."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(3, 1, figsize=(9, 9), sharex=True, layout="constrained")
    for k, name in enumerate(NAMES[:3]):
        axes[0].plot(1e3 * y, 1e-3 * forces[:, k], label=name)
        axes[1].semilogy(1e3 * y[1:-1], np.abs(np.diff(forces[:, k], 2)) / LOAD * 100, lw=0.8, label=name)
    axes[2].step(1e3 * y, patches, where="mid")
    axes[0].set_ylabel("force on the left wheel, kN")
    axes[1].set_ylabel("second difference, % of the load")
    axes[2].set(ylabel="patches", xlabel="lateral position y of the wheelset, mm (to the left)")
    axes[0].legend()
    axes[0].set_title(f"{LOAD / 1e3:g} kN on the left wheel")
    figure.savefig(path, dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--step", type=float, default=0.02)
    parser.add_argument("--from", dest="low", type=float, default=-8.0)
    parser.add_argument("--to", dest="high", type=float, default=8.0)
    parser.add_argument("--friction", type=float, default=0.3)
    parser.add_argument("--size", type=float, default=1.0)
    parser.add_argument("--points", choices=("lattice", "grid"), default="lattice")
    parser.add_argument("--picture", type=Path)
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    print(machine_description())
    contact = wheelset_model(
        PairTrack(STEEL), ContactLaws(friction=arguments.friction), 1e-3 * arguments.size, points=arguments.points
    )
    positions = 1e-3 * np.arange(arguments.low, arguments.high + 0.5 * arguments.step, arguments.step)
    forces, patches, load_errors, seconds = sweep(contact, positions)
    scale = np.array([1, 1, 1, *(3 * [contact.mounting.radius])]) * LOAD
    changes, second_differences = np.abs(np.diff(forces, axis=0)) / scale, np.diff(forces, 2, axis=0) / scale
    settings = f"{arguments.step:g} mm apart, friction {arguments.friction:g}, {arguments.points} points"
    print(f"\n{len(positions)} positions, {settings}")
    print("| | largest change % | at y mm | scatter % | largest second difference % | at y mm |")
    print("|---|---|---|---|---|---|")
    for k, name in enumerate(NAMES):
        i, j = int(np.nanargmax(changes[:, k])), int(np.nanargmax(np.abs(second_differences[:, k])))
        scatter, largest = (
            100 * np.sqrt(np.nanmean(second_differences[:, k] ** 2)),
            100 * np.abs(second_differences[j, k]),
        )
        where = 1e3 * positions[i], 1e3 * positions[j + 1]
        print(
            f"| {name} | {100 * changes[i, k]:.3f} | {where[0]:.2f} | {scatter:.4f} | {largest:.3f} | {where[1]:.2f} |"
        )
    print(
        f"\npatches from {min(patches)} to {max(patches)}, {np.count_nonzero(np.diff(patches))} changes of their number"
    )
    print(f"{np.count_nonzero(np.isnan(forces[:, 0]))} positions without a solution")
    print(f"largest error of the load {100 * np.nanmax(load_errors):.1e} %")
    print(f"{1e3 * np.median(seconds):.0f} ms a position, {seconds.sum():.0f} s in all")
    if arguments.json:
        rows = np.column_stack([positions, forces, patches]).tolist()
        arguments.json.write_text(json.dumps({"columns": ["y", *NAMES, "patches"], "rows": rows}))
    if arguments.picture:
        picture(arguments.picture, positions, forces, patches)


if __name__ == "__main__":
    main()
