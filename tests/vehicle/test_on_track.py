"""Zones, sections, estimates and comfort in curves against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import freqs

from wheelrail.vehicle.evaluation.comfort import WEIGHTINGS
from wheelrail.vehicle.evaluation.criteria import CRITERIA, zone_of
from wheelrail.vehicle.evaluation.curve_comfort import event_discomfort, lateral, transition_discomfort
from wheelrail.vehicle.evaluation.estimates import estimates_of
from wheelrail.vehicle.evaluation.on_track import Part, RunSignals, constant_parts, sections_of

PLACES = {"front": 6.0, "rear": -7.0}  # m


def signals(
    parts: list[Part],
    speed: float,
    guiding: np.ndarray,
    load: np.ndarray,
    acceleration: np.ndarray | None = None,
    base: float = 1.5,
) -> RunSignals:
    """Forces (n, w, 2) and accelerations (n, 1, 3) every 10 ms at constant speed."""
    time = 0.01 * np.arange(len(guiding))
    floor = np.zeros((len(time), 1, 3)) if acceleration is None else acceleration
    return RunSignals(
        "run",
        time,
        speed * time,
        PLACES,
        guiding,
        load,
        {"floor": 0.0},
        floor,
        np.zeros((len(time), 1)),
        parts,
        base,
        9.81,
        60e3,
    )


def test_zones_by_radius_and_cant_deficiency() -> None:
    assert [zone_of(1.0 / r, 0.1) for r in (1e4, 601.0, 600.0, 400.0, 399.0, 250.0, 249.0)] == list("2233445")
    assert zone_of(0.0, 0.0) == zone_of(-1 / 3000, 0.04) == "1"


def test_parts_of_constant_curvature_between_ramps() -> None:
    s = np.arange(0.0, 400.1, 0.25)
    ramp = np.interp(s, [100.0, 150.0, 250.0, 290.0], [0.0, 1.0, 1.0, 0.0])
    found = constant_parts(s, -ramp / 300.0, -0.1 * ramp)
    np.testing.assert_allclose([part[:2] for part in found], [[0, 100], [150, 250], [290, 400]], atol=0.3)
    assert [part.curvature for part in found] == [0.0, -1 / 300.0, 0.0]
    assert constant_parts(s, np.zeros(len(s)), np.zeros(len(s))) == [Part(0.0, 400.0, 0.0, 0.0)]


@pytest.mark.parametrize("seed", range(4))
def test_steady_forces_in_a_curve_have_their_own_values(seed: int) -> None:
    """Random forces, radii, cants, speeds, gauges; sections keep the whole vehicle in the curve."""
    random = np.random.default_rng(seed)
    radius, speed, base = random.uniform(260.0, 1500.0), random.uniform(15.0, 40.0), random.uniform(1.0, 1.7)
    sign, cant = random.choice([-1.0, 1.0]), random.uniform(0.0, 0.15)
    y, q = random.uniform(-20e3, 40e3, (2, 2)), random.uniform(30e3, 90e3, (2, 2))
    count = int(300.0 / speed / 0.01)
    run = signals(
        [Part(20.0, 260.0, sign / radius, sign * cant)],
        speed,
        np.tile(y, (count, 1, 1)),
        np.tile(q, (count, 1, 1)),
        base=base,
    )
    sections, _ = sections_of(run, 100.0)
    assert len(sections) == 2
    one, outer = sections[0], int(sign > 0.0)
    assert one.start == pytest.approx(27.0, abs=0.1)
    assert sections[-1].end <= 254.0
    assert one.deficiency == pytest.approx(base * speed**2 / radius / 9.81 - cant)
    assert one.radius == pytest.approx(radius)
    for k, name in enumerate(PLACES):
        assert one.values["track_shifting"][name].value == pytest.approx(abs(y[k, 1] - y[k, 0]))
        for side, label in ((outer, "outer"), (1 - outer, "inner")):
            assert one.values["quotient"][f"{name} {label}"].value == pytest.approx(abs(y[k, side] / q[k, side]))
            assert one.values["load"][f"{name} {label}"].value == pytest.approx(q[k, side])
            if one.zone in "34":
                assert one.values["quasi_static_guiding"][f"{name} {label}"].value == pytest.approx(abs(y[k, side]))
    estimates = {own.criterion: own for own in estimates_of(sections, 60e3)}
    assert estimates["load"].one == pytest.approx(q.max())  # without scatter
    assert estimates["track_shifting"].limit == pytest.approx(50e3)
    assert estimates["track_shifting"].passed == (np.abs(y[:, 1] - y[:, 0]).max() <= 50e3)
    assert estimates_of(sections, 60e3, 0.85)[0].limit == pytest.approx(42.5e3)


def test_a_push_is_found_at_the_place_of_its_wheelset() -> None:
    """The rear wheelset is pushed while the reference point runs from 200 to 210 m."""
    count, speed = 1500, 25.0
    guiding, load = np.zeros((count, 2, 2)), np.full((count, 2, 2), 60e3)
    there = (speed * 0.01 * np.arange(count) >= 200.0) & (speed * 0.01 * np.arange(count) <= 210.0)
    guiding[there, 1, 1] = 80e3
    sections, _ = sections_of(signals([Part(0.0, 400.0, 0.0, 0.0)], speed, guiding, load), 50.0)
    worst = next(own for own in estimates_of(sections, 60e3) if own.criterion == "track_shifting")
    assert (worst.signal, worst.zone, worst.passed) == ("rear", "1", False)
    assert 193.0 <= worst.place <= 204.0
    assert worst.largest == pytest.approx(80e3, rel=0.12)  # the filter overshoots
    values = [section.values["track_shifting"]["rear"].value for section in sections]
    assert worst.one == pytest.approx(np.mean(values) + 3.0 * np.std(values, ddof=1))
    quotient = next(own for own in estimates_of(sections, 60e3) if own.criterion == "quotient")
    assert quotient.largest > CRITERIA["quotient"].limit(None)  # type: ignore[arg-type]


def test_accelerations_of_a_sine_in_the_band() -> None:
    """2 Hz of amplitude 1 m/s2 on 0.6 m/s2: percentiles and rms of a sine, the median of its mean; 40 Hz is outside."""
    count, speed = 4000, 20.0
    time = 0.01 * np.arange(count)
    acceleration = np.zeros((count, 1, 3))
    acceleration[:, 0, 1] = 0.6 + np.sin(4 * np.pi * time)
    acceleration[:, 0, 2] = 9.81 + np.sin(80 * np.pi * time)
    forces = np.full((count, 2, 2), 6e4)
    curve = [Part(-10.0, 900.0, 1 / 500, 0.1)]
    section = sections_of(signals(curve, speed, forces, forces, acceleration), 100.0)[0][-1]
    of = {key: own["floor"].value for key, own in section.values.items() if "floor" in own}
    assert of["lateral_acceleration"] == pytest.approx(np.sin(0.5 * np.pi * 0.997), rel=5e-3)
    assert of["lateral_rms"] == pytest.approx(0.5**0.5, rel=5e-3)
    assert of["quasi_static_acceleration"] == pytest.approx(0.6, abs=0.02)
    assert of["vertical_acceleration"] < 0.02


def test_estimates_at_a_cant_deficiency_lie_on_the_line_of_the_sections() -> None:
    """Curves of 500 m at four speeds; Q grows in proportion to the cant deficiency, so the regression is exact."""
    sections = []
    for speed in (18.0, 20.0, 22.0, 24.0):
        deficiency = 1.5 * speed**2 / 500.0 / 9.81 - 0.1
        count = int(200.0 / speed / 0.01)
        load = np.full((count, 2, 2), 50e3 + 100e3 * deficiency)
        run = signals([Part(0.0, 200.0, 1 / 500, 0.1)], speed, np.zeros_like(load), load)
        sections += sections_of(run, 150.0)[0]
    own = next(one for one in estimates_of(sections, 60e3, deficiency=0.13) if one.criterion == "load")
    assert own.two == own.assessed == pytest.approx(63e3, rel=1e-9)
    assert own.one > own.mean


def test_wp_is_a_low_pass_of_2_hz() -> None:
    """Coefficients of PyRidy."""
    f, w = np.array([0.0, 0.2, 1.0, 2.0, 5.0, 20.0]), 2 * np.pi * 2.0
    high = 2 * np.pi * 100.0
    _, low_pass = freqs([high**2], [1.0, high / 2**-0.5, high**2], 2 * np.pi * f)
    _, transition = freqs([w, w**2], [1.0, w / 0.63, w**2], 2 * np.pi * f)
    np.testing.assert_allclose(WEIGHTINGS["Wp"](f), low_pass * transition, rtol=1e-12)
    np.testing.assert_allclose(lateral(np.full(1000, 0.7), 5e-3), 0.7, rtol=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_discomfort_of_a_linear_transition(seed: int) -> None:
    """Acceleration rises linearly to y in T, with a constant roll rate in it."""
    random = np.random.default_rng(seed)
    y, duration, roll = random.uniform(0.6, 1.2), random.uniform(2.5, 5.0), random.uniform(0.5, 4.0)
    time = 0.005 * np.arange(4000)
    acceleration = np.interp(time, [6.0, 6.0 + duration], [0.0, -y])
    rate = np.where((time >= 6.0) & (time <= 6.0 + duration), np.radians(roll), 0.0)
    bounds = (6.0, 6.0 + duration)
    standing = 28.54 * y + 20.69 * y / duration - 11.1 + 0.185 * roll**2.283
    assert transition_discomfort(acceleration, rate, 0.005, bounds) == pytest.approx(standing, rel=2e-3)
    seated = 8.97 * y + 9.68 * y / duration - 5.9 + 0.120 * roll**1.626
    assert transition_discomfort(acceleration, rate, 0.005, bounds, "seated") == pytest.approx(seated, rel=2e-3)
    assert transition_discomfort(0.01 * acceleration, 0.0 * rate, 0.005, bounds) == 0.0
    with pytest.raises(ValueError, match="must be within the signal of 20 s"):
        transition_discomfort(acceleration, rate, 0.005, (18.0, 21.0))


def test_discomfort_of_an_event() -> None:
    """1 Hz of amplitude 2 about -0.8 m/s2: range 4, mean 0.8 over two periods."""
    time = 0.005 * np.arange(4000)
    found = event_discomfort(-0.8 + 2.0 * np.sin(2 * np.pi * time), 0.005)
    assert found[2000] == pytest.approx(16.62 * 4.0 + 27.01 * 0.8 - 37.0, rel=1e-3)
    assert event_discomfort(np.full(500, 1.0), 0.005).max() == 0.0
    with pytest.raises(ValueError, match="must be 2 s at least"):
        event_discomfort(np.zeros(100), 0.005)
