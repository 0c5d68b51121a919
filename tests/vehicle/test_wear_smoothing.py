"""Smoothing of a wear step: conservation, waves of all lengths, a loop with the response of half-spaces, steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.fft import dct, idct

from wheelrail.contact.wear.strips import ProfileRates
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.vehicle.wear.evolution import WearingProfile
from wheelrail.vehicle.wear.smoothing import TAPER, smoothed, smoothing_length, step, step_factor

E_STAR, WIDTH, PRESSURE = 115e9, 0.5e-3, 0.8e9


def duty(seed: int, n: int = 320) -> tuple[np.ndarray, np.ndarray]:
    """Depths m of a step and pressures Pa: bands of wear with sharp ends and noise, nothing between."""
    random, s = np.random.default_rng(seed), np.arange(n) * WIDTH
    depth = np.zeros(n)
    for _ in range(3):
        x = (s - random.uniform(0.02, 0.14)) / random.uniform(2e-3, 15e-3)
        depth += random.uniform(1e-6, 1e-4) * np.maximum(1.0 - x**2, 0.0) * random.uniform(0.7, 1.3, n)
    return depth, np.where(depth > 0.0, random.uniform(3e8, 2.5e9), 0.0)


@pytest.mark.parametrize("seed", range(6))
def test_the_filter_keeps_the_volume_and_the_sign(seed: int) -> None:
    depth, pressure = duty(seed)
    length = smoothing_length(depth, pressure, modulus=E_STAR, width=WIDTH)
    found = smoothed(depth, length, WIDTH)
    assert found.sum() == pytest.approx(depth.sum(), rel=1e-12)
    assert found.min() >= 0.0
    assert found.max() <= depth.max() * (1.0 + 1e-12)
    between = (depth[1:] == 0.0) & (depth[:-1] == 0.0)
    assert np.abs(np.diff(length)[between]).max() < 1.0001 * TAPER * WIDTH
    worn = np.flatnonzero(depth)
    reach = int(length.max() / TAPER / WIDTH) + 2
    assert not found[: max(worn[0] - reach, 0)].any()
    assert not found[worn[-1] + reach :].any()


def test_the_ends_have_no_flux_and_equal_depths_stay() -> None:
    depth = np.full(50, 3e-5)
    length = smoothing_length(depth, np.full(50, PRESSURE), modulus=E_STAR, width=WIDTH)
    np.testing.assert_allclose(length, E_STAR * 3e-5 / 4 / PRESSURE)
    np.testing.assert_allclose(smoothed(depth, length, WIDTH), depth, rtol=1e-12)


@pytest.mark.parametrize("depth", 10.0 ** np.linspace(-8, -3, 40))
def test_a_step_leaves_between_nothing_and_all_of_any_wave(depth: float) -> None:
    n = 400
    k = np.pi * np.arange(n) / (n * WIDTH)
    left = step_factor(depth, PRESSURE, k, modulus=E_STAR, width=WIDTH)
    assert left.min() >= -1e-12
    assert left.max() <= 1.0
    length = smoothing_length(np.full(n, depth), np.full(n, PRESSURE), modulus=E_STAR, width=WIDTH)
    for mode in (1, 17, 133, n - 1):  # of the filter itself
        wave = np.cos(np.pi * mode * (np.arange(n) + 0.5) / n)
        factor = (1.0 - left[mode]) / (2.0 * length[0] * k[mode])
        np.testing.assert_allclose(smoothed(wave, length, WIDTH), factor * wave, atol=1e-9)


def test_the_filter_is_that_of_the_differential_equation() -> None:
    """Second order in the width: a cosine of wavelength 40 mm keeps 1 / (1 + (l k)^2)."""
    n, length = 640, 2e-3
    k = np.pi * 16 / (n * WIDTH)
    wave = np.cos(k * WIDTH * (np.arange(n) + 0.5))
    found = smoothed(wave, np.full(n, length), WIDTH)
    np.testing.assert_allclose(found, wave / (1.0 + (length * k) ** 2), atol=(k * WIDTH) ** 2 / 10)


def loop(steps: int, *, filtered: bool) -> np.ndarray:
    """Waves (n,) m of the depth after steps of 50 um, from noise of 0.1 um, with the pressure of half-spaces."""
    n, depth = 256, 5e-5
    k = np.pi * np.arange(n) / (n * WIDTH)
    total = 1e-7 * np.random.default_rng(0).standard_normal(n)
    for _ in range(steps):
        pressure = PRESSURE - 0.5 * E_STAR * idct(k * dct(total, norm="ortho"), norm="ortho")
        rate = np.maximum(depth * pressure / PRESSURE, 0.0)
        length = smoothing_length(np.full(n, depth), np.full(n, PRESSURE), modulus=E_STAR, width=WIDTH)
        total = total + (smoothed(rate, length, WIDTH) if filtered else rate)
    return np.asarray(dct(total - total.mean(), norm="ortho"))


def test_noise_decays_with_the_filter_and_grows_without() -> None:
    start = np.abs(loop(0, filtered=True)).max()
    assert np.abs(loop(1, filtered=False)).max() > 10 * start
    assert np.abs(loop(30, filtered=True)).max() < 0.3 * start
    assert np.sum(loop(30, filtered=True) ** 2) < np.sum(loop(5, filtered=True) ** 2)


@pytest.mark.parametrize("seed", range(4))
def test_distance_of_a_step(seed: int) -> None:
    depth, pressure = duty(seed)
    how = {"modulus": E_STAR, "width": WIDTH}
    found = step(1e-9 * depth / depth.max(), pressure, **how, depth=5e-5)
    explicit = found.distance * 1e-9
    assert found.depth.max() == pytest.approx(5e-5, rel=1e-4) or explicit == pytest.approx(1e-4)
    assert explicit >= 5e-5 * (1 - 1e-9)
    assert found.depth.max() <= 5e-5 * (1 + 1e-4)
    assert found.depth.sum() == pytest.approx(explicit * (depth / depth.max()).sum(), rel=1e-12)
    assert step(1e-9 * depth / depth.max(), pressure, **how, depth=5e-5, distance=1e3).distance == 1e3


def test_bad_input() -> None:
    none, how = np.zeros(9), {"modulus": E_STAR, "width": WIDTH}
    assert step(none, none, **how, depth=5e-5, distance=2e3).distance == 2e3
    with pytest.raises(ValueError, match="nothing wears"):
        step(none, none, **how, depth=5e-5)
    with pytest.raises(ValueError, match="positive pressure"):
        step(np.ones(9), none, **how, depth=5e-5)
    with pytest.raises(ValueError, match="must be positive"):
        step(np.ones(9), np.ones(9), **how, depth=0.0)


def test_a_profile_that_is_worn_through_is_named() -> None:
    wheel = WearingProfile.unworn(named_profile("S1002"), 0.46)
    with pytest.raises(ValueError, match=r"S1002: wear of .* mm at"):
        _ = replace(wheel, removed=np.full(len(wheel.removed), 30e-3 * wheel.width)).present


def test_even_wear_of_a_worn_profile_stays_even() -> None:
    """Beside the jumps of the curvature of a flange's root, where cells of the new profile differ in length."""
    own = WearingProfile.unworn(named_profile("S1002"), 0.46)
    middle = 0.5 * (own.grid.bounds[1:] + own.grid.bounds[:-1])
    even = np.clip(np.minimum(middle + 0.064, 0.024 - middle) / 4e-3, 0.0, 1.0)
    for _ in range(10):
        removed = even * own.widths
        own = own.after(own.step(ProfileRates.of_sections(removed, 2e9 * removed, 0.0), E_STAR, 2e-4, np.inf))
    s, distance, _ = own.new.closest(own.present.point(own.present.samples(2e-4)))
    inside = (s > -0.046) & (s < 0.006)
    assert np.ptp(distance[inside]) < 0.015 * -distance[inside].mean()  # in cells of the new profile 0.067


@pytest.mark.parametrize("radius", [6e-3, 12e-3])
def test_radius_of_a_groove(radius: float) -> None:
    """A wave of 10 mm in a tread that is nearly straight."""
    wheel = WearingProfile.unworn(named_profile("S1002"), 0.46)
    assert np.isnan(wheel.groove)
    x = np.pi * (0.5 * (wheel.grid.bounds[1:] + wheel.grid.bounds[:-1]) - 0.01) / 5e-3
    depth = (5e-3 / np.pi) ** 2 / radius * (1.0 + np.cos(np.clip(x, -np.pi, np.pi)))
    assert replace(wheel, removed=depth * wheel.width).groove == pytest.approx(radius, rel=0.06)
