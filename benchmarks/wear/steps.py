"""Check of steps of wear: a wheelset on half-spaces at fixed positions, whose wheels wear alike."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

import wheelrail as wr
from benchmarks.wear.check import Check
from benchmarks.wear.removal import MODULUS
from wheelrail.contact.wear.laws import Archard
from wheelrail.contact.wear.strips import ProfileGrid, profile_rates, total, worn_strips
from wheelrail.meshes.profiles.worn import new_arc_length
from wheelrail.support.arrays import Array
from wheelrail.vehicle.wear.smoothing import step

POSITIONS = ((0.0, 0.0), (1e-3, 0.0), (2.5e-3, 5e-4), (4e-3, 1e-3), (5e-3, 1.5e-3), (6e-3, 2e-3))  # y m, yaw rad
SPEED, LOAD, FRICTION, RADIUS = 25.0, 57e3, 0.3, 0.46
DISTANCE, LONG = 300e3, 1.5e6  # m
SHORT_WAVE = 3e-3  # m


def worn_depth(depth: float, distance: float) -> Array:
    """Depth (n,) m after a distance m in steps of a largest depth m; both wheels in all positions wear one profile."""
    new = wheel = wr.profile("S1002")
    grid = ProfileGrid.wheel(new, RADIUS)
    width, area, travelled = float(np.diff(grid.bounds)[0]), np.zeros(len(grid.per_passage)), 0.0
    while travelled < distance * (1.0 - 1e-9):
        wheelset = wr.Wheelset(wheel, "60E1", friction=FRICTION, bodies="half-space", strips=10, cells=10)
        solved = [wheelset.solve(y=y, yaw=yaw, wheel_load=LOAD, speed=SPEED).results for y, yaw in POSITIONS]
        strips = [worn_strips(own, Archard(), FRICTION, SPEED) for results in solved for own in results.values()]
        parts = [profile_rates(own, grid, partial(new_arc_length, new, wheel)) for own in strips]
        rates = total(parts, [1.0 / len(parts)] * len(parts))
        of_step = step(
            rates.removed / width,
            rates.pressure,
            modulus=MODULUS,
            width=width,
            depth=depth,
            distance=distance - travelled,
        )
        area, travelled = area + width * of_step.depth, travelled + of_step.distance
        wheel = new.worn(grid.bounds, area)
    return np.asarray(area / width)


def short_waves(depth: Array, width: float) -> float:
    """Mean size of waves shorter than 3 mm over the mean depth."""
    waves = np.fft.rfft(depth)
    waves[np.fft.rfftfreq(len(depth), width) < 1.0 / SHORT_WAVE] = 0.0
    return float(np.abs(np.fft.irfft(waves, len(depth))).sum() / depth.sum())


def steps() -> Iterator[Check]:
    """Worn depths at equal distance for halved steps, and waves that a long run leaves."""
    coarse, middle, fine = (worn_depth(depth, DISTANCE) for depth in (1e-4, 5e-5, 2.5e-5))
    changes = [
        float(np.linalg.norm(one - other) / np.linalg.norm(fine)) for one, other in ((coarse, middle), (middle, fine))
    ]
    text = f"order of the depth in the step, changes of {changes[0]:.3f} and {changes[1]:.3f} RMS"
    yield Check(text, float(np.log2(changes[0] / changes[1])), 0.8, at_least=True)
    yield Check("part of waves below 3 mm after 0.3 mm of wear", short_waves(worn_depth(5e-5, LONG), 0.5e-3), 0.01)
