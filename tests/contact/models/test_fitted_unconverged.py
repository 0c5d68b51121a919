"""Warm solves on fitted cells whose fixed-point iteration with friction does not converge."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from test_fitted import exact, flowing, pair

import wheelrail.contact.models.fitted.model
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.fitted.cell_compliance import CellCompliance
from wheelrail.contact.models.fitted.model import ITERATIONS, PENETRATION_TOLERANCE, REMAINDER_DECAY
from wheelrail.contact.models.fitted.resolution import Resolution
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.solvers.tractions import Tractions
from wheelrail.support.arrays import Array

SHARE = 0.04  # of the approach


def test_unconverged_warm_solves_stay_on_one_branch(monkeypatch: pytest.MonkeyPatch) -> None:
    """Friction increases the penetration on narrow cells and reduces it on wide ones: no layout is consistent."""
    model = replace(pair(0.3, resolution=Resolution(4, 10)), warm=True)
    depths = exact().approach * (1 + 2e-4 * np.arange(8))
    motion = flowing(5e-3)
    free = model(hertz_pose(depths[0]), motion)
    assert free.warm_start is not None
    width = np.ptp(free.warm_start.layout.sides)
    pull = free.warm_start.traction.sum()
    real = CellCompliance.displacement

    def displacement(self: CellCompliance) -> Array:
        found = real.__get__(self).copy()
        n = len(found) // 3
        wide = np.ptp(self.layout.sides) > width
        found[2 * n :, : 2 * n] += (-1 if wide else 1) * SHARE * depths[0] / pull
        return found

    solves = [0]
    solve: Callable[..., Tractions] = wheelrail.contact.models.fitted.model.solve_tractions

    def counted(*args: object, **kwargs: object) -> Tractions:
        solves[0] += 1
        return solve(*args, **kwargs)

    monkeypatch.setattr(wheelrail.contact.models.fitted.model, "solve_tractions", counted)
    found: list[ContactResult] = []
    with monkeypatch.context() as folded:
        folded.setattr(CellCompliance, "displacement", property(displacement))
        cold = model(hertz_pose(depths[0]), motion)
        assert cold.ok
        assert not cold.statistics.settled
        rounds = []
        for depth in depths:
            solves[0] = 0
            found.append(model(hertz_pose(depth), motion, found[-1] if found else cold))
            rounds.append(solves[0])
    assert not any(result.statistics.settled for result in found)
    assert rounds == [ITERATIONS] + [1] * (len(depths) - 1)
    # the residual decreases, and forces are continuous: 2 % between narrow and wide cells
    left = [
        float(np.abs(result.warm_start.remainder.values).max())
        for result in found
        if result.warm_start and result.warm_start.remainder
    ]
    np.testing.assert_allclose(left, left[0] * REMAINDER_DECAY ** np.arange(len(depths)), rtol=1e-9)
    assert 0 < left[0] <= SHARE
    forces = np.array([result.force for result in found])
    assert np.abs(np.diff(forces, 2, axis=0)).max() < 1e-5 * forces[0, 2]

    last = found[-1]
    for _ in range(int(np.log(PENETRATION_TOLERANCE / SHARE) / np.log(REMAINDER_DECAY)) + 1):
        last = model(hertz_pose(depths[0]), motion, last)
    assert last.statistics.settled
    np.testing.assert_allclose(last.force, free.force, atol=3e-3 * free.force[2])
