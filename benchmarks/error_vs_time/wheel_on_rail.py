"""Times of one wheel under a load from cold, with one patch and with two, beside CONTACT's."""

from __future__ import annotations

from collections.abc import Iterator
from time import process_time

import numpy as np

from benchmarks.common.measurement import Row
from benchmarks.common.models import PairTrack, frictional, wheelset_model
from benchmarks.common.reference_table import reference
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.laws.material import Material
from wheelrail.contact.loading.wheelset import wheel_under_load
from wheelrail.contact.models.lattice.resolution import LatticeResolution

TASK = "wheel"
FRICTION, SPEED, RADIUS = 0.3, 20.0, 0.46  # -, m/s, m
LATERAL = {1: 0.0, 2: 5e-3}  # m, position of the wheelset with so many patches of its outer wheel
SIZE = 1e-3  # m, between the lines under the strips
EXPECTED = 1e-4  # m, approach under the load
DX = (0.4, 0.2)  # mm, elements of CONTACT
REPEATS = 5


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
    """Times of strips on half-spaces at the default, at the same loads and numbers of patches.

    Raises RuntimeError for another number of patches.
    """
    fineness = LatticeResolution()
    model = wheelset_model(PairTrack(Material()), frictional(FRICTION), SIZE, bodies="half-space")
    for row in reference("contact_grids")["wheel_on_rail"]["rows"]:
        state = WheelsetState(y=LATERAL[row["patches"]], speed=SPEED, pitch_rate=SPEED / RADIUS)
        timings = []
        for _ in range(REPEATS + 1):  # the first one computes what all share
            began = process_time()
            equilibrium = wheel_under_load(model, state, "left", 1e3 * row["load_kN"], expected=EXPECTED)
            timings.append(process_time() - began)
        patches = len(equilibrium.results["left"].patches)
        if patches != row["patches"]:
            raise RuntimeError(f"{row['load_kN']} kN: {patches} patches, must be {row['patches']}")
        yield {
            "task": TASK,
            "family": "lattice, half-space",
            "division": f"{fineness.strips} x {fineness.cells}",
            "load": row["load_kN"],
            "patches": patches,
            "solves": equilibrium.solves,
            "least": min(timings[1:]),
            "median": float(np.median(timings[1:])),
        }
