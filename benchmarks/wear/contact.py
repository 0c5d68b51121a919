"""Checks of laws and rates on single contacts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.common.models import STEEL, Ellipse, PairTrack, frictional, hertz_model, rolling, wheelset_model
from benchmarks.wear.check import Check
from wheelrail.contact.analytical.carter import carter
from wheelrail.contact.analytical.hertz import modulus
from wheelrail.contact.geometry.rigid_surfaces import RigidWheelRail
from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.loading.hertz import hertz_under_load
from wheelrail.contact.loading.wheelset import wheel_under_load
from wheelrail.contact.models.standard.model import StandardContact
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.wear.laws import DENSITY, HARDNESS, Archard, Usfd, WearLaw
from wheelrail.contact.wear.strips import ProfileGrid, WornStrips, profile_rates, worn_strips
from wheelrail.meshes.profiles.library import load_profile
from wheelrail.scenes.runs.steady import equilibria_of
from wheelrail.scenes.schema.scene import load_scene
from wheelrail.vehicle.track.constant_curve import ConstantCurve

FRICTION, K, RADIUS, SPEED = 0.3, 5e-4, 0.46, 1.0
PAIR = Ellipse((RADIUS, 0.3), 60e3)
ARCHARD = Archard(k=K)
CREEPAGES = ((5e-4, 0.0, 0.0), (1e-3, 0.0, 0.0), (3e-3, 0.0, 0.0), (5e-4, -7e-4, 0.4))
LOAD = 60e3  # N, of a wheel
SCENES = Path(__file__).parents[2] / "scenes"
CURVES = {  # speed m/s, radius m, cant rad
    "R1200, 35 m/s": (35.0, 1200.0, 0.06),
    "R1200, 30 m/s": (30.0, 1200.0, 0.06),
    "R600, 25 m/s": (25.0, 600.0, 0.10),
    "R600, 20 m/s": (20.0, 600.0, 0.10),
    "straight": (45.0, np.inf, 0.0),
}
RUNNING = {  # y m, yaw rad
    "straight": (0.0, 0.0),
    "R1200": (3.5e-3, 1e-3),
    "R600": (6.0e-3, 3e-3),
    "flange": (6.9e-3, 6e-3),
}


@cache
def rolling_pair(creepages: tuple[float, float, float], strips: int, cells: int, pair: Ellipse = PAIR) -> ContactResult:
    """A pair on half-spaces under its load with creepages (1, 1, 1/m)."""
    model = hertz_model(
        pair, frictional(FRICTION), pair.size(across=16), bodies="half-space", strips=strips, cells=cells
    )
    return hertz_under_load(
        model, rolling(*creepages, speed=SPEED), pair.load, expected=pair.exact.approach, rtol=1e-7
    ).results[0]


def lateral_grid(half_width: float, cells: int, per_passage: float) -> ProfileGrid:
    """Cells across a Hertz pair."""
    return ProfileGrid("wheel", np.linspace(-half_width, half_width, cells + 1), np.full(cells, per_passage))


def full_sliding() -> Iterator[Check]:
    """Depth over the width, and volume, of a pair that slides.

    The outer strips, which reach beyond the contact, carry too little load, which falls with the square of their width.
    """
    xi, (a, b), peak = 5e-2, PAIR.exact.semi_axes, PAIR.exact.peak
    grid = lateral_grid(8e-3, 32, 2 * np.pi * RADIUS)
    inside = np.clip(grid.bounds, -b, b)
    exact = np.diff(K * xi / HARDNESS * peak * np.pi / 2 * a * (inside - inside**3 / (3 * b * b))) / grid.per_passage
    outer = []
    for count in (14, 28):
        strips = worn(rolling_pair((xi, 0.0, 0.0), count, 12))
        error = np.abs(profile_rates(strips, grid).removed - exact) / exact.max()
        whole = np.abs(grid.bounds[:-1] + grid.bounds[1:]) / 2 < b - 2.0 * strips.width[0]
        outer.append(error.max())
        yield Check(
            f"depth of full sliding over its peak, {count} strips, within the outer two", error[whole].max(), 1e-2
        )
    yield Check("the same with the outer ones, 28 strips", outer[1], 1e-2)
    yield Check(f"fall of {outer[0]:.3g} with 14 strips", outer[0] / outer[1], 3.0, at_least=True)
    yield Check("volume", abs(float(strips.volume.sum()) * HARDNESS / (K * PAIR.load * xi) - 1.0), 1e-4)


def worn(result: ContactResult, law: WearLaw = ARCHARD) -> WornStrips:
    return worn_strips(result, law, FRICTION, SPEED)


def identity() -> Iterator[Check]:
    """Volume of Archard's law as k T-gamma / mu H, stick or slip, from the forces; convergence of sums over cells."""
    for creepages in CREEPAGES:
        result = rolling_pair(creepages, 14, 12)
        (patch,) = result.patches
        about = result.moment[2] - patch.x * result.force[1]
        t_gamma = -(np.array([*patch.tangential_force, about]) @ patch.creepage)
        volume = worn(result).volume.sum()
        name = f"volume at creepages {creepages}"
        yield Check(name, abs(volume * FRICTION * HARDNESS / (K * t_gamma) - 1.0), 1e-4)
    for creepages in CREEPAGES[:3]:
        errors = []
        for cells in (10, 20, 40):
            strips = worn(rolling_pair(creepages, 14, cells))
            errors.append(1.0 - float(strips.unbalanced.sum() / strips.t_gamma.sum()))
        for cells, one, other in zip((20, 40), errors[:-1], errors[1:], strict=True):
            text = f"fall of the unbalanced error {one:.3g} at {creepages[0]:g} by {cells} cells"
            yield Check(text, one / other, 2.5, at_least=True)


def rolling_cylinder() -> Iterator[Check]:
    """Energy per length in the middle half of a long ellipse, beside Carter's."""
    along, load, ratio = RADIUS, 6e6, 0.05  # m, N/m
    a = np.sqrt(4 * load * along / (np.pi * modulus((STEEL.E, STEEL.nu), (STEEL.E, STEEL.nu))))
    pair = Ellipse.of_ratio(ratio, along, 4 / 3 * load * a / ratio, STEEL)
    (half, width), peak = pair.exact.semi_axes, pair.exact.peak
    for xi in (4.8219369435996526e-4, 1.0541645000026955e-3, 1.799571366440728e-3):
        strips = worn(rolling_pair((xi, 0.0, 0.0), 12, 40, pair))
        middle = np.abs(strips.wheel_s) < 0.5 * width
        exact = []
        for level in np.sqrt(1.0 - (strips.wheel_s[middle] / width) ** 2):
            at = carter(half * level, peak * level, friction=FRICTION, creepage=xi, radius=along)
            exact.append(abs(at.force) * FRICTION * np.pi / 2 * at.peak * at.half_width * xi)
        error = np.abs((strips.energy / strips.width)[middle] / exact - 1.0).max()
        yield Check(f"Carter's energy at creepage {xi:.3g}, a/b = {ratio}, 40 cells", error, 1e-2)


@cache
def wheelset(model: str) -> WheelsetContact:
    """S1002 on UIC60 by strips or by the standard contact."""
    laws = frictional(FRICTION)
    strips = wheelset_model(PairTrack(STEEL), laws, 1e-3, bodies="half-space", strips=14, cells=12)
    if model == "strips":
        return strips
    profiles = load_profile("S1002", "wheel"), load_profile("UIC60-benchmark", "rail")
    normal = "hertz" if model == "hertz" else "kik-piotrowski"
    return replace(strips, model=StandardContact(RigidWheelRail(*profiles, RADIUS), laws, normal=normal))


@cache
def running(model: str, case: str, side: Side) -> ContactResult:
    """A wheel under its load in a case."""
    y, yaw = RUNNING[case]
    state = WheelsetState(y=y, yaw=yaw, speed=20.0, pitch_rate=20.0 / RADIUS)
    return wheel_under_load(wheelset(model), state, side, LOAD, expected=1e-4).results[side]


def energy() -> Iterator[Check]:
    """Energy on the profile beside the frictional power, on wheel and rail."""
    wheel, rail = load_profile("S1002", "wheel"), load_profile("UIC60-benchmark", "rail")
    for model in ("strips", "standard", "hertz"):
        worst = 0.0
        for case in RUNNING:
            result = running(model, case, "left")
            strips = worn_strips(result, ARCHARD, FRICTION, 20.0)
            t_gamma = sum(patch.frictional_power for patch in result.patches) / 20.0
            for grid in (ProfileGrid.wheel(wheel, RADIUS), ProfileGrid.rail(rail)):
                rates = profile_rates(strips, grid)
                worst = max(worst, abs(float(rates.energy @ grid.per_passage) / t_gamma - 1.0))
        yield Check(f"energy over both profiles beside T-gamma, {model}", worst, 1e-9)


def mild_wear() -> Iterator[Check]:
    """USFD's mild branch beside Archard's law with the coefficient that makes them equal."""
    result = rolling_pair((1e-3, 0.0, 0.0), 14, 12)
    grid = lateral_grid(8e-3, 32, 2 * np.pi * RADIUS)
    laws: tuple[Any, ...] = (Usfd(), Archard(k=5.3e-9 * FRICTION * HARDNESS / DENSITY))
    one, other = (profile_rates(worn(result, law), grid).removed for law in laws)
    yield Check("depth by USFD, mild, beside Archard", float(np.abs(one - other).max() / other.max()), 1e-9)


@cache
def steady_curve(elastic: bool, case: str) -> float:
    """T-gamma N of all wheels of the Manchester vehicle in a steady curve, by strips or by the standard contact."""
    speed, radius, cant = CURVES[case]
    scene = load_scene(SCENES / ("vehicle_elastic.toml" if elastic else "vehicle.toml"))
    curve = ConstantCurve(speed, 1.0 / radius, cant)
    (found,) = equilibria_of(scene, SCENES / "manchester_vehicle.toml", [speed], curve)
    results = [result for sides in found.contacts.values() for result in sides.values()]
    return sum(patch.frictional_power for result in results for patch in result.patches) / speed


def models_agree() -> Iterator[Check]:
    """T-gamma of a vehicle in steady curves by strips on finite bodies and by the standard contact."""
    for case in CURVES:
        one, other = (steady_curve(elastic, case) for elastic in (True, False))
        tolerance = 0.3 if case == "straight" else 0.05
        text = f"T-gamma {one:.3g} N by strips, {other:.3g} N by the standard contact, {case}"
        yield Check(text, abs(other / one - 1.0), tolerance)
