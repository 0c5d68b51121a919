"""Times and errors of one wheel with one patch and with two: under a load, and at its height cold and warm."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from time import process_time

import numpy as np

from benchmarks.common.measurement import Row
from benchmarks.common.models import PairTrack, frictional, wheelset_model
from benchmarks.common.reference_table import reference
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.laws.material import Material
from wheelrail.contact.loading.wheelset import WheelsetEquilibrium, wheel_under_load
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array

TASK = "wheel"
FRICTION, SPEED, RADIUS = 0.3, 20.0, 0.46  # -, m/s, m
LATERAL = {1: 0.0, 2: 5e-3}  # m, position of the wheelset with so many patches of its outer wheel
SIZE = 1e-3  # m, between the lines under the strips
EXPECTED = 1e-4  # m, approach under the load
DX = (0.4, 0.2)  # mm, elements of CONTACT
FINENESSES, FINEST = ((6, 12), (8, 10), (14, 12)), (24, 18)
ASIDE, DEEPER = 5e-6, 1e-7  # m, of a step of a path of warm solves
REPEATS = 7


def contact_rows() -> Iterator[Row]:
    """Times of CONTACT, of elements of two lengths."""
    for row in reference("contact_grids")["wheel_on_rail"]["rows"]:
        for dx, seconds in zip(DX, row["contact_s"], strict=True):
            yield {
                "task": TASK,
                "family": "CONTACT",
                "division": f"dx {dx:g} mm",
                "load": row["load_kN"],
                "patches": row["patches"],
                "least": seconds,
                "median": seconds,
            }


def strip_rows() -> Iterator[Row]:
    """Strips on half-spaces at the same loads and numbers of patches.

    Errors are differences from the finest strips and cells: force, of the tangential force in % of mu F_n, and peak, of
    the peak pressure of the smaller patch in %. Raises RuntimeError for another number of patches.
    """
    model = wheelset_model(PairTrack(Material()), frictional(FRICTION), SIZE, bodies="half-space")
    for row in reference("contact_grids")["wheel_on_rail"]["rows"]:
        state = WheelsetState(y=LATERAL[row["patches"]], speed=SPEED, pitch_rate=SPEED / RADIUS)
        load = 1e3 * row["load_kN"]
        exact = _figures(_under_load(_resolved(model, FINEST), state, load))
        for fineness in FINENESSES:
            tuned = _resolved(model, fineness)
            equilibrium = _under_load(tuned, state, load)
            found, patches = _figures(equilibrium), len(equilibrium.results["left"].patches)
            if patches != row["patches"]:
                raise RuntimeError(f"{row['load_kN']} kN: {patches} patches, must be {row['patches']}")
            timings = _processor_times(partial(_under_load, tuned, state, load))
            yield {
                "task": TASK,
                "family": "lattice, half-space",
                "division": f"{fineness[0]} x {fineness[1]}",
                "load": row["load_kN"],
                "patches": patches,
                "solves": equilibrium.solves,
                "least": min(timings),
                "median": float(np.median(timings)),
                "force error": float(100 * np.linalg.norm((found - exact)[:2])),
                "peak error": float(100 * abs(found[2] / exact[2] - 1)),
                **_single_solves(tuned, equilibrium.state),
            }


def _resolved(model: WheelsetContact, fineness: tuple[int, int]) -> WheelsetContact:
    """The model on other numbers of strips and cells."""
    return replace(model, model=replace(model.model, resolution=LatticeResolution(*fineness)))


def _under_load(model: WheelsetContact, state: WheelsetState, load: float) -> WheelsetEquilibrium:
    return wheel_under_load(model, state, "left", load, expected=EXPECTED)


def _figures(equilibrium: WheelsetEquilibrium) -> Array:
    """Tangential forces (2,) over mu F_n, and the peak pressure Pa of the smaller patch."""
    result = equilibrium.results["left"]
    smaller = min(result.patches, key=lambda patch: patch.area)
    return np.array([*result.force[:2] / (FRICTION * result.force[2]), smaller.max_pressure])


def _single_solves(model: WheelsetContact, here: WheelsetState) -> Row:
    """Seconds of a solve at a state from cold, and on a path that ends there."""

    def at(steps: int, guess: ContactResult | None) -> ContactResult:
        return model(replace(here, y=here.y + ASIDE * steps, z=here.z + DEEPER * steps), "left", guess)

    guess, warm = at(-REPEATS - 1, None), []
    for steps in range(-REPEATS, 1):
        began = process_time()
        guess = at(steps, guess)
        warm.append(process_time() - began)
    cold = _processor_times(lambda: at(0, None))
    return {"cold": float(np.median(cold)), "warm": float(np.median(warm))}


def _processor_times(solve: Callable[[], object]) -> list[float]:
    """Seconds of repeated calls."""
    timings = []
    for _ in range(REPEATS):
        began = process_time()
        solve()
        timings.append(process_time() - began)
    return timings
