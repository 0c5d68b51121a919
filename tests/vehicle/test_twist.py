"""Wheel unloading on twisted track: statics, a slow run over the same track, mirror image, geometry."""

from __future__ import annotations

import numpy as np
import pytest
from standin_contact import CONTACT

from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.simulation.time_run import Recording
from wheelrail.vehicle.steady.twist_test import (
    FADE,
    _irregularities,
    bogies,
    cross_levels,
    en_14363_twists,
    twisted,
)
from wheelrail.vehicle.track.track import Track

DYNAMICS = VehicleDynamics(load_vehicle(), Track(), CONTACT, 20.0)


def test_cross_levels_are_twists_over_their_bases() -> None:
    vehicle = DYNAMICS.vehicle
    assert bogies(vehicle) == [["wheelset_1", "wheelset_2"], ["wheelset_3", "wheelset_4"]]
    np.testing.assert_allclose(en_14363_twists(vehicle), [15e-3 / 19.0 + 2e-3, 7e-3 - 5e-3 / 2.56])
    np.testing.assert_allclose(cross_levels(vehicle, 3e-3, 0.0), [28.5e-3, 28.5e-3, -28.5e-3, -28.5e-3])
    np.testing.assert_allclose(cross_levels(vehicle, 0.0, 2e-3), [2.56e-3, -2.56e-3, 0.0, 0.0])


@pytest.mark.parametrize("seed", range(2))
def test_statics_and_mirror_images(seed: int) -> None:
    """Random levels: the wheels carry the weight; turned levels exchange the sides; small ones superpose."""
    vehicle, levels = DYNAMICS.vehicle, 4e-3 * np.random.default_rng(seed).normal(size=4)
    found, turned = twisted(DYNAMICS, levels), twisted(DYNAMICS, -levels)
    weight = sum(body.mass for body in vehicle.bodies.values()) * vehicle.gravity
    assert found.load.sum() == pytest.approx(weight, rel=1e-4)
    np.testing.assert_allclose(turned.load, found.load[:, ::-1], rtol=2e-3)
    half = twisted(DYNAMICS, 0.5 * levels)
    np.testing.assert_allclose(half.unloading, 0.5 * found.unloading, atol=5e-3)


def test_twist_against_a_slow_run() -> None:
    """Loads as of a run at 5 m/s over the same cross levels, at the place where all wheelsets stand on them."""
    vehicle = DYNAMICS.vehicle
    levels = cross_levels(vehicle, 1e-3, 2e-3)
    place = FADE + 20.78
    track = Track(irregularities=_irregularities(vehicle, levels, place))
    slow = VehicleDynamics(vehicle, track, CONTACT, 5.0)
    steps = StepSettings("rosenbrock", rtol=1e-3, atol=1e-6)
    run = simulate(slow, (0.0, place / 5.0), steps=steps, recording=Recording(0.2))
    loads = run.force[-1][..., 2]
    found = twisted(DYNAMICS, levels)
    assert np.abs(found.unloading).max() > 0.08
    np.testing.assert_allclose(loads, found.load, atol=0.012 * found.level_load.mean())
