"""Whether the rows of a run resolve its largest wheel loads."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.support.arrays import Array

ROUGH = 0.05  # of a largest load
FINE = 2e-4  # s, between rows: ten a period at 500 Hz; what stands out there is a kink of the track


def unresolved_loads(time: Array, distance: Array, wheelsets: Sequence[str], load: Array) -> list[str]:
    """Remarks on the largest loads of wheels that are part of a vibration hardly resolved by the rows of a run.

    Parameters:
        time, distance: (n,) s and m.
        wheelsets: names of w wheelsets.
        load: (n, w, 2) N on left and right wheels, NaN where unknown.

    Between its neighbours a maximum of amplitude A stands out by A (1 - cos(2 pi / m)) where m samples make a period,
    and steps as long damp the vibration, so that the part that stands out is about what is missing. Wheels that hop
    have other impacts with every tolerance.
    """
    remarks, names = [], [f"{name} {side}" for name in wheelsets for side in SIDES]
    for name, values in zip(names, load.reshape(-1, len(names)).T, strict=True):
        known = np.flatnonzero(np.isfinite(values))
        own, at = values[known], time[known]
        k = int(own.argmax()) if len(own) else 0
        if not 0 < k < len(own) - 1:
            continue
        part = 1.0 - float(np.interp(at[k], at[[k - 1, k + 1]], own[[k - 1, k + 1]])) / float(own[k])
        apart = 0.5 * float(at[k + 1] - at[k - 1])
        if part > ROUGH and apart > FINE:
            largest = f"{1e-3 * own[k]:.4g} kN at {distance[known[k]]:.1f} m"
            closer = f"closer ones (solver.rtol, output.interval) may change it by {part:.0%}"
            rows = f"rows {1e3 * apart:.2g} ms apart"
            remarks.append(f"The largest load of {name}, {largest}, is not resolved by {rows}: {closer}")
    return remarks
