"""Notebooks on railways, executed at a reduced size, with checks of their numbers."""

from __future__ import annotations

import numpy as np
import pytest
from notebook_runner import executed


def test_manchester_contact_benchmark() -> None:
    """Differences from CONTACT within the notebook's bounds; finite bodies change flange contact considerably."""
    names = executed(
        "05_manchester_contact_benchmark.py", PLACES=(0.0, 3.0, 5.0), SURFACE_SIZE=4e-3, STRIPS=12, CELLS=10
    )
    assert names["errors"].loc["half-spaces", "peak"] < 2.0
    assert names["flange"]["CONTACT"] == pytest.approx(33.62, abs=0.01)  # kN


def test_the_papers_curve() -> None:
    changes = {"strips": 6, "cells": 6, "surface_size": 3e-3, "track.tangent": 10.0, "track.curve": 60.0}
    changes |= {"solver.rtol": 1e-2, "solver.atol": 1e-5}
    names = executed("06_the_papers_curve.py", CHANGES=changes, SIZES={"exact laws": 3e-3, "paper's laws": 2e-3})
    for expected, found in names["by_hand"].values():  # 0.4 % at most with the last bits of this coarse run disturbed
        assert found == pytest.approx(expected, rel=0.01)


def test_what_bends() -> None:
    names = executed("09_what_bends.py", PLACES=(5.0,), RESOLUTION={"strips": 8, "cells": 8})
    ((place, _),) = names["patches"](names["solutions"]["axle"][0])
    assert place == pytest.approx(-21.75, abs=0.2)  # on the tread alone
    assert len(names["patches"](names["solutions"]["clamped"][0])) == 2
    assert float(names["stress"][0]) == pytest.approx(names["closed_form"], rel=0.1)


def test_your_own_measured_profile() -> None:
    names = executed("07_your_own_measured_profile.py", PLACES=25, SURFACE_SIZE=3e-3, STRIPS=6, CELLS=8)
    assert names["conicity"]["new"] == pytest.approx(0.177, abs=0.01)
    assert len(names["rejected"]) == 3


def test_hunting() -> None:
    """The standard contact is unstable from 70.7 m/s on; its load moves as that of elastic bodies."""
    names = executed(
        "08_hunting.py",
        SPEEDS=(66.0, 73.0),
        SHIFTS=(0.1, 0.2, 0.3),
        STRIPS=6,
        CELLS=6,
        BODIES="half-space",
        DURATION=0.1,
        PLACES=2,
    )
    growth = names["growth"]
    assert growth.loc[66.0, "standard"] < 0.0 < growth.loc[73.0, "standard"]
    assert (growth["elastic"] < 0.0).all()
    assert names["critical"].loc["standard", "mean"] == pytest.approx(70.67, abs=0.02)
    assert len(names["by_place"]["elastic"]) == 2
    moves = {name: np.diff(places) for name, places in names["centres"].items()}  # mm for 0.1 mm
    assert (moves["elastic"] < -0.4).all()
    np.testing.assert_allclose(moves["standard"], moves["elastic"], rtol=0.25)
    assert names["run"].status == "completed"


def test_a_wheels_life() -> None:
    """Energy in the sharp curve grows with friction, and sharp curves wear more; a worn wheel bears on other places."""
    changes = {"bodies": "half-space", "strips": 4, "cells": 6}
    names = executed("10_a_wheels_life.py", UNTIL=3e5, CHANGES=changes, PLACES=(0.0, 5.0), FRICTION=[0.2, 0.4])
    assert names["worn"].status == "completed"
    assert (names["peaks"]["worn"] / names["peaks"]["new"]).between(0.5, 2.0).all()
    assert (names["peaks"]["worn"] != names["peaks"]["new"]).all()
    assert names["by_case"][2, 1] > names["by_case"][2, 0]
    assert names["rates"].values[0, 2] > names["rates"].values[0, 0]


def test_a_vehicle_assessed() -> None:
    """Acceleration of the steady curve is the unbalanced one; friction raises the guiding force."""
    parameters = {"friction": {"low": 0.2, "high": 0.45}}
    track = {"CURVES": {300.0: (0.12, 22.0)}, "TANGENT": 20.0, "TRANSITION": 40.0, "LENGTH": 100.0}
    names = executed("12_a_vehicle_assessed.py", PARAMETERS=parameters, **track)
    (found,) = (
        own[own["criterion"]]
        for own in names["found"].data["estimates"]
        if own["criterion"] == "quasi_static_acceleration"
    )
    # On the floor, which springs lean outwards by some per cent.
    assert found["mean"] == pytest.approx(22.0**2 / 300.0 - 9.81 * 0.12 / 1.5, rel=0.2)
    low, high = names["study"].data["largest_guiding_force"].values[1:]
    assert high > 1.2 * low
