"""Places of the patches of a wheelset with elastic axle, on rails on pads, beside those of clamped bodies.

A table, and a figure if a file is named.

`python -m benchmarks.flexible_wheelset [FIGURE.png]`: S1002 on 60E1 laid at 1/40, 57 kN on each wheel, no friction, an
axle of 160 mm with journals 2 m apart, pads of 100 kN/mm vertically and 40 kN/mm laterally every 0.6 m.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

import wheelrail as wr

LOAD = 57e3  # N
POSITIONS = (0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0)  # mm, y of the wheelset
CASES: dict[str, dict[str, Any]] = {
    "clamped": {},
    "axle": {"axle": True},
    "pads": {"pads": True},
    "axle and pads": {"axle": True, "pads": True},
}


@dataclass(frozen=True)
class Place:
    """A patch of the left wheel: y of the wheelset mm, place on the rail mm, load kN and peak pressure MPa."""

    y: float
    place: float
    load: float
    peak: float


def places(options: Mapping[str, Any]) -> tuple[list[Place], float]:
    """Patches at all positions, and seconds of the solves without the first one, which builds the bodies."""
    wheelset = wr.Wheelset(rail="UIC60-benchmark", friction=0.0, **options)
    wheelset.solve(y=0.5e-3, roll="solve", wheel_load=LOAD)
    patches, start = [], perf_counter()
    for y in POSITIONS:
        result = wheelset.solve(y=1e-3 * y, roll="solve", wheel_load=LOAD).results["left"]
        patches += [
            Place(y, 1e3 * patch.rail_y, 1e-3 * patch.normal_force, 1e-6 * patch.max_pressure)
            for patch in result.patches
        ]
    return patches, (perf_counter() - start) / len(POSITIONS)


def table(cases: Mapping[str, list[Place]]) -> str:
    """Text: one row for each position, one column for each case."""
    rows = ["y mm  " + "".join(f"{name + ': place mm (kN, MPa)':44s}" for name in cases)]
    for y in POSITIONS:
        cells = []
        for patches in cases.values():
            own = [patch for patch in patches if patch.y == y]
            cells.append("; ".join(f"{patch.place:.2f} ({patch.load:.1f}, {patch.peak:.0f})" for patch in own))
        rows.append(f"{y:4.1f}  " + "".join(f"{cell:44s}" for cell in cells))
    return "\n".join(rows)


def figure(cases: Mapping[str, list[Place]], file: Path) -> None:
    """Places over the position of the wheelset, the area of a mark being the load of the patch."""
    import matplotlib.pyplot as plt

    drawing, axes = plt.subplots(figsize=(8, 5), layout="constrained")
    for index, (name, patches) in enumerate(cases.items()):
        beside = [patch.y + 0.14 * (index - 1.5) for patch in patches]  # cases side by side
        sizes = [1.2 * patch.load for patch in patches]
        axes.scatter(
            beside, [patch.place for patch in patches], sizes, color=("0.5", "C0", "C1", "C3")[index], label=name
        )
    axes.set_xlabel("lateral displacement of the wheelset, mm")
    axes.set_ylabel("place of the patch on the left rail, mm")
    axes.legend(title="area: load of the patch")
    drawing.savefig(file, dpi=120)


def main(arguments: list[str]) -> None:
    """Print the table, and draw the figure if a file is given."""
    cases = {}
    for name, options in CASES.items():
        cases[name], seconds = places(options)
        print(f"{name}: {seconds:.2f} s for a solve of both wheels", flush=True)
    print(table(cases))
    if arguments:
        figure(cases, Path(arguments[0]))


if __name__ == "__main__":
    main(sys.argv[1:])
