"""Overlap that virtual penetration leaves outside its patches is named with its depth and place."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

import wheelrail as wr
from benchmarks.population.checks import lowering, section_of
from benchmarks.population.draw import situation
from benchmarks.population.results import side_result, solved
from wheelrail.scenes.contacts.report import contact_report
from wheelrail.scenes.contacts.table import table


@pytest.mark.parametrize(("seed", "side"), [(720097, "left"), (50219, "right"), (800285, "right")])
def test_overlap_beside_a_patch_is_named(seed: int, side: str) -> None:
    """A shoulder, a second hump, and one at the gauge corner, against the distance of the profiles' points less the
    lowering by the pressures.
    """
    drawn = situation(seed)
    shape = drawn.wheelset["wheel"]
    shape = replace(shape, parameters=tuple(part for part in shape.parameters if part[0] != "abraded"))
    drawn = replace(drawn, wheelset=drawn.wheelset | {"wheel": shape})
    solution = solved(drawn)
    result = side_result(solution.data, side)
    section, ((low, high),) = section_of(drawn, side, result), result.bands
    outside = (section.depth > 0.0) & ((section.y < low) | (section.y > high))
    beyond = section.depth[outside] - lowering(section.place[outside], result)
    own = solution.data.sel(side=side)
    assert float(own["unsolved_overlap"]) == pytest.approx(beyond.max(), abs=3e-7)
    assert float(own["unsolved_overlap_y"]) == pytest.approx(section.y[outside][np.argmax(beyond)], abs=1e-3)
    text = f"overlap of {1e6 * float(own['unsolved_overlap']):.1f} µm not solved at y = "
    assert text in repr(solution)
    assert text in str(table(solution.data))
    assert text in json.loads(json.dumps(contact_report(solution.data)))[side]["unsolved"]


def test_patches_of_a_centred_wheelset_leave_none() -> None:
    solution = wr.Wheelset(wheel="S1002", rail="60E1", radius=0.46, friction=0.3, model="standard").solve(
        y=0.0, wheel_load=54.5e3, speed=20.0
    )
    assert solution.data["unsolved_overlap"].values.tolist() == [0.0, 0.0]
    assert "not solved" not in repr(solution)
