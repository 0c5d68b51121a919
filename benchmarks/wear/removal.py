"""Checks of smoothing, worn profiles and their measures."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scipy.integrate import trapezoid

import wheelrail as wr
from benchmarks.population.profiles import rail, wheel
from benchmarks.wear.check import Check
from wheelrail.contact.laws.material import Material
from wheelrail.meshes.profiles.measures import WheelMeasures
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.meshes.profiles.worn import cell_bounds
from wheelrail.support.arrays import Array
from wheelrail.vehicle.wear.smoothing import smoothed, smoothing_length, step_factor

STEEL = Material()
MODULUS = 0.5 * STEEL.E / (1.0 - STEEL.nu**2)  # Pa, E* of steel on steel
FINE = 2e-6  # m, of polygons
SEEDS = 4
PROFILES: dict[str, Callable[[], Profile]] = {
    "S1002": lambda: wr.profile("S1002"),
    "60E1": lambda: wr.profile("60E1").inclined(0.025),
    "UIC60-benchmark": lambda: wr.profile("UIC60-benchmark"),
    "worn wheel from a file": lambda: wheel("S1002", hollow=1e-3, flange=1.5e-3).profile,
    "cone from a file": lambda: wheel("cone", slope=0.05).profile,
    "rail of arcs from a file": lambda: rail("arcs", crown=0.254, shoulder=60e-3, radius=10e-3).profile,
    "side-worn rail from a file": lambda: rail("60E1", side=2e-3, crown=0.5e-3).profile,
}


def removed_volume() -> Iterator[Check]:
    """Area through smoothing and profile, by polygons of 2 um; of depths from a step of a loop to millimetres."""
    kept, polygons, added = 0.0, 0.0, 0.0
    for of in PROFILES.values():
        new = of()
        bounds = cell_bounds(new)
        width = float(np.diff(bounds)[0])
        for seed in range(SEEDS):
            explicit, pressure = _duty(new, bounds, seed)
            length = smoothing_length(explicit, pressure, modulus=MODULUS, width=width)
            depth = smoothed(explicit, length, width)
            worn = new.worn(bounds, width * depth)
            kept = max(kept, abs(depth.sum() / explicit.sum() - 1.0))
            polygons = max(polygons, abs(_polygon(new, worn) / (width * explicit.sum()) - 1.0))
            added = max(added, float(new.closest(worn.point(worn.samples(1e-4))).distance.max()))
    cases = f"{len(PROFILES)} profiles x {SEEDS}"
    yield Check(f"area before and after smoothing, {cases}", kept, 1e-12)
    yield Check("polygon between new and worn profile beside it", polygons, 1e-6)
    yield Check("height m of added material, by closest points, which are exact to 1e-12 m", added, 1e-12)


def ripples() -> Iterator[Check]:
    """Waves after a step, and the pressure of ripples of 0.2 um on the tread by half-spaces."""
    width, least, most = 0.5e-3, np.inf, -np.inf
    k = np.linspace(0.0, np.pi / width, 2001)
    for depth in 10.0 ** np.linspace(-8, -3, 101):
        left = step_factor(depth, 0.8e9, k, modulus=MODULUS, width=width)
        least, most = min(least, float(left.min())), max(most, float(left.max()))
    yield Check("negative fraction of a wave after a step, steps of 10 nm to 1 mm", -least, 1e-12)
    yield Check("largest", most, 1.0)
    for wavelength, strips in ((3e-3, 40), (6e-3, 24)):
        pressure = _ripple_pressure(wavelength, strips)
        expected = MODULUS * np.pi / wavelength * 0.2e-6
        text = f"ripple of {1e3 * wavelength:g} mm: {1e-6 * pressure:.3g} MPa beside E* k d / 2 = {1e-6 * expected:.3g}"
        yield Check(text, abs(pressure / expected - 1.0), 0.2)


def measures() -> Iterator[Check]:
    """Flange after a layer of 1 mm beside the offset polygon; conicity of a worn wheel from a file."""
    layer = 1e-3
    for name in ("S1002", "worn wheel from a file", "cone from a file"):
        new = PROFILES[name]()
        end = 0.045

        def depth(s: Array, end: float = end) -> Array:
            return layer * np.clip((end - s) / 0.01, 0.0, 1.0) ** 3 * (s < end) + 0.0

        bounds = cell_bounds(new)
        s = np.linspace(bounds[:-1], bounds[1:], 101, axis=1)
        turn = np.unwrap(np.angle(new.tangent(s) @ [1.0, 1j]))
        worn = new.worn(bounds, trapezoid(depth(s), s) + trapezoid(0.5 * depth(s) ** 2, turn))
        found = worn.measures()
        assert isinstance(found, WheelMeasures)
        s = new.samples(1e-5)
        expected = _flange(new.point(s) - depth(s)[:, None] * new.normal(s))
        error = np.abs(np.array([found.Sh, found.Sd, found.qR]) - expected).max()
        yield Check(f"Sh, Sd, qR beside an offset polygon, {name}, m", float(error), 2e-6)
    for seed in range(SEEDS):
        new = wr.profile("S1002")
        bounds = cell_bounds(new)
        worn = new.worn(bounds, np.diff(bounds) * 0.3 * _duty(new, bounds, seed)[0])
        with TemporaryDirectory() as folder, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            np.savetxt(file := Path(folder, "worn.txt"), 1e3 * worn.point(worn.samples(2e-4)), fmt="%.6f")
            of_file, own = (_conicity(profile) for profile in (wr.profile(file, "wheel", rolling_circle=0.0), worn))
        yield Check(f"conicity {own:.3f} at 3 mm, from a file beside the curve", abs(of_file / own - 1.0), 0.01)


def _duty(new: Profile, bounds: Array, seed: int) -> tuple[Array, Array]:
    """Depths (n,) m and pressures (n,) Pa in cells: bands with sharp ends on the running surface, 10 to 500 um."""
    random, s = np.random.default_rng(seed), 0.5 * (bounds[1:] + bounds[:-1])
    low, high = (-0.035, 0.03) if new.kind == "wheel" else (-0.03, 0.015)
    depth = np.zeros(len(s))
    for _ in range(4):
        x = (s - random.uniform(low, high)) / random.uniform(2e-3, 12e-3)
        depth += random.uniform(0.2, 1.0) * np.maximum(1.0 - x**2, 0.0)
    depth *= 10.0 ** random.uniform(-5, -3.3) / depth.max()
    return depth, np.full(len(s), random.uniform(3e8, 2e9))


def _polygon(new: Profile, worn: Profile) -> float:
    """Area m2 between both curves, as polygons."""
    points = np.concatenate([new.point(new.samples(FINE)), worn.point(worn.samples(FINE))[::-1]]) @ [1.0, 1j]
    return float(-0.5 * np.sum((points.conj() * np.roll(points, -1)).imag))


@cache
def _pressed(wavelength: float, strips: int, ripple: bool) -> tuple[Array, Array]:
    """Places m on the wheel and peak pressures Pa of strips, with or without a ripple of 0.2 um on 1 um of wear."""
    new = wr.profile("S1002")
    bounds = cell_bounds(new)
    s = np.linspace(bounds[:-1], bounds[1:], 21, axis=1)
    wave = 0.2e-6 * np.cos(2.0 * np.pi / wavelength * s) if ripple else 0.0
    depth = (1e-6 + wave) * np.clip((0.03 - np.abs(s)) / 5e-3, 0.0, 1.0)
    worn = new.worn(bounds, trapezoid(depth, s))
    wheelset = wr.Wheelset(wheel=worn, rail="60E1", friction=0.0, bodies="half-space", strips=strips, cells=20)
    fields = wheelset.solve(y=2e-3, wheel_load=60e3, sides=["left"]).results["left"].fields
    assert fields is not None
    assert fields.wheel_s is not None
    place, strip = np.unique(np.round(fields.wheel_s, 8), return_inverse=True)
    peak = np.zeros(len(place))
    np.maximum.at(peak, strip, fields.pressure)
    return place, peak


def _ripple_pressure(wavelength: float, strips: int) -> float:
    """Amplitude Pa of the pressure in phase with a ripple, 2 mm and more within the patch."""
    smooth, rippled = (_pressed(wavelength, strips, ripple) for ripple in (False, True))
    s = np.linspace(max(smooth[0][0], rippled[0][0]) + 2e-3, min(smooth[0][-1], rippled[0][-1]) - 2e-3, 400)
    k = 2.0 * np.pi / wavelength
    terms = np.stack([np.cos(k * s), np.sin(k * s), np.ones_like(s), s], axis=1)
    change = np.interp(s, *rippled) - np.interp(s, *smooth)
    return -float(np.linalg.lstsq(terms, change, rcond=None)[0][0])


def _flange(points: Array) -> Array:
    """Sh, Sd, qR (3,) m of a polyline."""
    y, z = points.T
    tip = int(np.argmax(z))
    level = float(np.interp(0.0, y[tip:], z[tip:]))

    def face(height: float) -> float:
        i = tip + int(np.argmax(z[tip:] < height))
        return float(np.interp(height, [z[i], z[i - 1]], [y[i], y[i - 1]]))

    thick = face(level + 10e-3)
    return np.array([z[tip] - level, thick + 70e-3, thick - face(z[tip] - 2e-3)])


def _conicity(profile: Profile) -> float:
    data = wr.contact_geometry(wheel=profile, rail="60E1", y=np.linspace(0.0, 6e-3, 25))
    return float(data.equivalent_conicity.sel(amplitude=3e-3, method="nearest"))
