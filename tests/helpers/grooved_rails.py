"""Rails with a groove, from the standard head and closed forms."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import wheelrail as wr
from wheelrail.meshes.profiles.profile import Profile

FACE = -20e-3  # m, height at which the gauge face ends


def grooved(folder: Path, depth: float, flangeway: float, check: float = -10e-3) -> Profile:
    """60E1 with a groove beside its gauge face, and the check rail beyond it, of straight faces and round corners.

    Parameters:
        folder: for its file.
        depth: of the groove's floor below the top, m.
        flangeway: width of the groove, m.
        check: height of the check rail from the top, m, below it: the highest point is the head.
    """
    head = wr.profile("60E1")
    s = head.samples(2e-4)
    points = head.point(s)
    points = points[(s > 0.0) | (points[:, 1] > FACE)]
    corner, (sine, cosine) = 3e-3, (f(np.linspace(0.0, 0.5 * np.pi, 40)) for f in (np.sin, np.cos))
    face = points[0, 0]
    wall = face - flangeway
    outline = [
        [np.linspace(wall - 0.03, wall - corner, 40), np.full(40, check)],
        [wall - corner * (1 - sine), check - corner * (1 - cosine)],
        [np.full(60, wall), np.linspace(check - corner, -depth + corner, 60)],
        [wall + corner * (1 - cosine), -depth + corner * (1 - sine)],
        [np.linspace(wall + corner, face - corner, 40), np.full(40, -depth)],
        [face - corner * (1 - sine), -depth + corner * (1 - cosine)],
        [np.full(20, face), np.linspace(-depth + corner, points[0, 1], 20)],
    ]
    across = np.concatenate([np.column_stack(part)[:-1] for part in outline] + [points])
    file = folder / f"grooved_{1e3 * depth:g}_{1e3 * flangeway:g}_{1e3 * check:g}.txt"
    np.savetxt(file, 1e3 * across, fmt="%.6f")
    return wr.profile(file, "rail", noise=0.0)
