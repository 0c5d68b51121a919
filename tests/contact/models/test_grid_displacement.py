"""Places of patches on grids: those of the material of both bodies that touches."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from small_pairs import BRICKS, STEEL, condensed, full, rolling

from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose

PAIR: dict[str, Any] = {"upper": (0.3, 0.3), "size": 1.5e-3, "laws": ContactLaws.penalty(friction=0.3)}


@pytest.mark.parametrize(("modulus", "fraction"), [(210e9, 0.5), (70e9, 0.25)])
def test_blocks_divide_their_displacement_by_their_compliance(modulus: float, fraction: float) -> None:
    """Under a lateral creepage each body's material comes from where its displacement has taken it. The contraction by
    pressure is opposite on both sides in half-spaces alone; in these small blocks 0.4 % of the displacement remain.
    """
    for build in (condensed, full):
        model = build(BRICKS, steels=(STEEL, Material(modulus, 0.3)), **PAIR)
        result = model(hertz_pose(6e-5), rolling(0.0, 5e-3, 0.0))
        (patch,) = result.patches
        assert result.fields is not None
        load = result.fields.pressure * result.fields.area
        values = np.column_stack([result.fields.point[:, 1], result.fields.displacement[:, 1]])
        place, relative = load @ values / load.sum()
        assert relative < -1e-6
        assert place - patch.wheel_s == pytest.approx(fraction * relative, rel=1e-2)
        assert place - patch.rail_s == pytest.approx((fraction - 1) * relative, rel=1e-2)


def test_pressure_alone_does_not_displace_a_plane_surface_in_the_mean() -> None:
    """Positions are those of the points, and nothing is solved for."""
    model = condensed(BRICKS, **(PAIR | {"laws": ContactLaws.penalty(friction=0.0)}))
    result = model(hertz_pose(6e-5), rolling(0.0, 0.0, 0.0))
    (patch,) = result.patches
    assert result.fields is not None
    load = result.fields.pressure * result.fields.area
    assert patch.wheel_s == pytest.approx(load @ result.fields.point[:, 1] / load.sum(), abs=1e-12)
    assert patch.contact_angle == 0.0
