"""The plane wagon on linear contact springs compared with Exudyn: 5 s from a large displacement, differences by
channel.

    pip install exudyn; python -m benchmarks.exudyn.report --keep

--keep writes the samples that tests/contact/models/test_other_codes.py compares with.
"""

from __future__ import annotations

import argparse
import json
from importlib.metadata import version
from pathlib import Path

import numpy as np

from benchmarks.exudyn.linear_contact import LinearContact
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.plane_wagon import COORDINATES, COUNT, wagon_dynamics
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.simulation.time_run import Recording
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

REFERENCE = Path(__file__).parents[1] / "reference" / "exudyn.json"
END, EVERY = 5.0, 0.1  # s
# m and rad, m/s and rad/s: large enough that the car body hits the bumpstop on both sides during its decay.
POSITION = (0.055, -0.01, 0.01, 0.01, 0.003, -0.01, 0.002, 1e-4, 1e-3)
RATE = (-0.4, 0.1, -0.1, 0.1, -0.05, 0.1, 0.02, 0.01, 0.02)


def initial() -> np.ndarray:
    """Initial state (20,), with nominal spin."""
    return np.array([*POSITION, 0.0, *RATE, 0.0])


def ours(*, wagon: Wagon | None = None, end: float = END, rtol: float = 1e-8) -> np.ndarray:
    """Positions (n, 9) by `simulate`."""
    wagon = wagon or Wagon()
    history = simulate(
        wagon_dynamics(wagon, Track(), LinearContact(wagon.wheel_load), 1.0),
        (0.0, end),
        initial=initial(),
        steps=StepSettings("ode45", rtol, 1e-3 * rtol),
        recording=Recording(EVERY),
    )
    if history.status != "completed":
        raise RuntimeError(history.status)
    return history.state[:, : COUNT - 1]


def theirs(step: float, *, end: float = END) -> np.ndarray:
    """Positions (n, 9) by Exudyn at a fixed step s."""
    from benchmarks.exudyn.model import trajectory

    wagon, start = Wagon(), np.array([*POSITION, *RATE])
    return trajectory(wagon, LinearContact(wagon.wheel_load), start, end=end, every=EVERY, step=step)


def relative(values: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """Largest difference of each channel (9,) relative to its largest value."""
    return np.abs(values - reference).max(axis=0) / np.abs(reference).max(axis=0)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument(
        "--step", type=float, default=5e-5, help="Exudyn's step [s]; a run with twice the step is compared"
    )
    parser.add_argument("--keep", action="store_true", help=f"write {REFERENCE.name}")
    step, keep = (arguments := parser.parse_args()).step, arguments.keep
    exudyn, coarse, result = theirs(step), theirs(2 * step), ours()
    print(f"Exudyn {version('exudyn')}, RK67 at {step:g} s; {END:g} s, rows every {EVERY:g} s; relative to the largest")
    print(f"| channel | ours against Exudyn | Exudyn at {2 * step:g} s against {step:g} s |\n|---|---|---|")
    for name, ours_difference, exudyn_difference in zip(
        COORDINATES, relative(result, exudyn), relative(coarse, exudyn), strict=False
    ):
        print(f"| {name} | {ours_difference:.1e} | {exudyn_difference:.1e} |")
    if keep:
        REFERENCE.write_text(json.dumps(_reference_data(exudyn, step), indent=1) + "\n", encoding="utf-8")
        print(REFERENCE)


def _reference_data(positions: np.ndarray, step: float) -> dict[str, object]:
    return {
        "what": "plane Manchester wagon on linear contact springs, free motion from a large displacement",
        "source": f"Exudyn {version('exudyn')} (PyPI), benchmarks/exudyn/report.py, RK67 with steps of {step:g} s",
        "units": {"time": "s", "position": "m from the nominal position, rad"},
        "time": np.round(EVERY * np.arange(len(positions)), 9).tolist(),
        "channels": list(COORDINATES[: COUNT - 1]),
        "positions": [[float(f"{value:.10g}") for value in row] for row in positions],
    }


if __name__ == "__main__":
    main()
