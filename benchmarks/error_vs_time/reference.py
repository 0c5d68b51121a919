"""Reference creep forces, extrapolated from the finest solutions, and their difference from CONTACT's extrapolated
forces.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.common.measurement import Row
from benchmarks.common.reference_table import reference
from benchmarks.error_vs_time.cases import ModelVariant, TimedCase, timing_case
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.support.arrays import Array

Say = Callable[[str], None]
WARM_GAIN = 2.0  # of CONTACT's time by a warm start: 1.6 to 2


@dataclass(frozen=True)
class Reference:
    """Forces (cases, 2) over mu F_n, extrapolated with an order from the two finest solutions; left: RMS of the
    extrapolation.
    """

    finest: LatticeResolution
    cases: tuple[TimedCase, ...]
    forces: Array
    order: float
    left: float

    def of(self, case: TimedCase) -> Array:
        """Forces (2,) of a case."""
        return np.asarray(self.forces[self.cases.index(case)])

    @property
    def contact_deviations(self) -> Array:
        """CONTACT's forces minus ours (cases, 2), over mu F_n, of the cases whose forces by CONTACT are known; the one
        that is timed is the first.
        """
        known = [k for k, case in enumerate(self.cases) if case.contact_forces is not None]
        return np.array([self.cases[k].contact_forces for k in known]) - self.forces[known]

    def description(self) -> str:
        """Origin and agreement of the reference, in words."""
        timed, others = np.split(100 * self.contact_deviations, [1])
        cells = f"{self.finest.strips} x {self.finest.cells}"
        return (
            f"Reference of the creep forces: strips x cells on half-spaces, {cells} and half as many, extrapolated at "
            f"the order {self.order:.2f} of their differences, which adds {100 * self.left:.3f} % RMS of mu F_n. "
            f"CONTACT's extrapolated forces differ from it by {rms(others):.3f} % RMS, {np.abs(others).max():.3f} % at "
            f"most, over {len(others)} cases (their uncertainty: up to {100 * _uncertainty():.2f} %), and by "
            f"{np.abs(timed).max():.3f} % on the ellipse that is timed."
        )


def extrapolated(finest: LatticeResolution, cases: Sequence[TimedCase], say: Say) -> Reference:
    """Reference whose order is that of the RMS of differences of three solutions as cells are halved.

    Raises ValueError where strips or cells cannot be halved twice, RuntimeError where the forces do not converge.
    """
    all_cases = (timing_case(), *cases)
    if finest.strips % 4 or finest.cells % 4:
        raise ValueError(f"numbers of strips and cells must be multiples of 4, got {finest.strips} and {finest.cells}")
    levels = [LatticeResolution(finest.strips // k, finest.cells // k) for k in (4, 2, 1)]
    solutions = []
    for fineness in levels:
        variant = ModelVariant("reference", "half-space", fineness)
        forces = []
        for k, case in enumerate(all_cases):
            say(f"reference, {fineness.strips} x {fineness.cells} cells, case {k + 1} of {len(all_cases)}")
            model = variant.of(case.pair, case.friction)
            forces.append(case.forces(case.solved(model, variant.loaded_depth(case.pair))))
        solutions.append(np.array(forces))
    first_change, second_change = solutions[1] - solutions[0], solutions[2] - solutions[1]
    order = float(np.log2(rms(first_change) / rms(second_change)))
    if not order > 0.5:
        raise RuntimeError(f"the creep forces do not converge: order {order:.2f}")
    extrapolation = second_change / (2**order - 1)
    return Reference(finest, all_cases, solutions[2] + extrapolation, order, rms(extrapolation))


def contact_rows(forces: Array) -> list[Row]:
    """Times and errors of CONTACT; forces (2,) over mu F_n are the reference of its errors.

    Its load is prescribed and its approach computed: an error of the approach is 1.5 times one of the force, which is
    proportional to its power 1.5. Its area is that of its elements.
    """
    case, result_rows = timing_case(), []
    a, b = case.pair.exact.semi_axes
    for row in reference("timing")["rows"]:
        task = row["case"].split("_")[-1]
        result_row: Row = {
            "family": "CONTACT",
            "division": f"dx {row['dx']:g} mm",
            "laws": "exact",
            "task": task,
            "points": row["ncon"],
            "least": row["min_s"],
            "median": row["median_s"],
        }
        if task == "normal":
            result_row["force error"] = -150 * (1e-3 * row["pen"] / case.pair.exact.approach - 1)
            result_row["area error"] = 100 * (row["ncon"] * (1e-3 * row["dx"]) ** 2 / (np.pi * a * b) - 1)
        else:
            result_row["order"] = 1
            result_row["creep error"] = 100 * float(
                np.abs(np.array([row["Fx"], row["Fy"]]) / case.bound - forces).max()
            )
        result_rows.append(result_row)
    return result_rows


def long_cell_rows() -> list[Row]:
    """Times of CONTACT on the timed ellipse and its errors over 40 sampled ones, for cells of any shape."""
    result_rows = []
    for warm in (False, True):
        for row in (row for row in reference("contact_grids")["rows"] if row["timed_s"] is not None):
            seconds = row["timed_s"] / (WARM_GAIN if warm else 1.0)
            result_rows.append(
                {
                    "family": "CONTACT, long cells" + (", warm" if warm else ""),
                    "division": f"{row['nx']} x {row['ny']}",
                    "laws": "exact",
                    "task": "rolling",
                    "points": row["elements"],
                    "least": seconds,
                    "median": seconds,
                    "order": 1,
                    "sampled RMS": row["force_rms"],
                    "sampled worst": row["force_worst"],
                }
            )
    return result_rows


def rms(e: Array) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(e))))


def _uncertainty() -> float:
    """Largest uncertainty of CONTACT's extrapolated forces, of mu F_n, as stated with them."""
    return float(max(case[7] for curve in reference("creep_curves")["curves"] for case in curve["cases"]))
