"""Randomly sampled ellipses that roll: a check of errors on cases that no figure of this package was chosen by."""

from __future__ import annotations

import numpy as np

from benchmarks.common.models import STEEL, Ellipse
from benchmarks.error_vs_time.cases import TimedCase
from wheelrail.contact.analytical.kalker import kalker

RADIUS = 0.46  # m, along the rolling direction
RATIOS = 0.2, 5.0  # of the semi-axes
LOADS = 1e4, 1.2e5  # N
FRICTIONS = 0.1, 0.6
SATURATIONS = 0.05, 1.5  # creepage over that at which Kalker's linear force reaches mu F_n
DIRECTIONS = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]])  # longitudinal, lateral, spin, mixed


def sampled_cases(count: int, seed: int, ratios: tuple[float, float] = RATIOS) -> tuple[TimedCase, ...]:
    """Ellipses of random ratio, load, friction and creepages, in the ranges of `contact_grids.json`."""
    random = np.random.default_rng(seed)
    cases = []
    for k in range(count):
        ratio, load = (float(np.exp(random.uniform(*np.log(limits)))) for limits in (ratios, LOADS))
        friction, saturation = float(random.uniform(*FRICTIONS)), random.uniform(*SATURATIONS)
        pair = Ellipse.of_ratio(ratio, RADIUS, load, STEEL)
        a, b = pair.exact.semi_axes
        linear = [kalker(name, a / b, STEEL.nu) for name in ("C11", "C22", "C23")]
        stiffness = pair.shear * a * b * np.array([*linear[:2], linear[2] * np.sqrt(a * b)])
        direction = DIRECTIONS[k % len(DIRECTIONS)] * random.choice([-1, 1], 3)
        creep = saturation * friction * load / stiffness * direction / np.linalg.norm(direction)
        cases.append(TimedCase(pair, friction, tuple(creep.tolist()), None))
    return tuple(cases)
