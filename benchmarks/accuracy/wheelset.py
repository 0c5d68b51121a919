"""S1002 on UIC60 compared with CONTACT: 57 kN on each wheel without yaw, and case A-2.2 of the Manchester benchmark."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.accuracy.contact_frames import FrameDifference, difference, state, wheel_force
from benchmarks.common.models import PairTrack, carrying, frictional, frictionless, wheelset_model
from benchmarks.common.reference_table import Measure, TableSection, measure, reference
from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.laws.material import Material
from wheelrail.contact.loading.load_search import LoadError
from wheelrail.contact.loading.wheelset import wheel_under_load
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array

Say = Callable[[str], None]
SIZE = 6e-4  # m; 57 kN: some 300 points on the tread
POSITIONS = (0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 4.5, 5.0, 6.0)  # mm, of those that the reference has
QUICK = (0.0, 2.0, 5.0)
SMALL = 4e-4  # m, for 10 kN
TREAD = 4.5  # mm, largest y at which half-spaces are accurate
RTOL = 1e-5  # of the load
EXPECTED = 5e-5  # m
COLUMNS = ("y mm", "points", "patches", "place mm", "area %", "peak MPa", "peak %")
FORCES = ("Fx N", "Fx % of mu F", "Fy N", "Fy % of mu F")


@dataclass(frozen=True)
class WheelComparison:
    """One wheel: displacement mm, side, result, difference, friction bound mu F N (0 frictionless), and the forces
    (variants, 2) N on the wheel by CONTACT's variants.
    """

    y: float
    side: Side
    result: ContactResult
    differs: FrameDifference
    bound: float
    variants: Array | None = None

    @property
    def forces(self) -> tuple[float, float]:
        """In % of the bound."""
        return (100 * self.differs.forces[0] / self.bound, 100 * self.differs.forces[1] / self.bound)

    @property
    def outside(self) -> Array:
        """Distance from the range of CONTACT's variants, and that range (2, 2), in % of the bound."""
        assert self.variants is not None
        low, high, force = self.variants.min(axis=0), self.variants.max(axis=0), self.result.force[:2]
        apart = np.maximum(low - force, 0) + np.maximum(force - high, 0)
        return np.asarray(100 * np.stack([apart, high - low]) / self.bound)


def loaded_wheel(
    track: PairTrack, friction: float, initial: WheelsetState, side: Side, load: float, size: float, **options: Any
) -> ContactResult:
    """One wheel under its load at a given roll; with friction at the height of the frictionless solution."""
    frictionless_model = wheelset_model(track, frictionless(), size, **options)
    equilibrium = wheel_under_load(
        frictionless_model, initial, side, load, expected=EXPECTED, rtol=RTOL if friction == 0 else 1e-3
    )
    if friction == 0:
        return equilibrium.results[side]
    frictional_model = wheelset_model(track, frictional(friction), size, **options)
    return wheel_under_load(frictional_model, equilibrium.state, side, load, expected=EXPECTED, rtol=RTOL).results[side]


def track_of(inputs: dict[str, float]) -> PairTrack:
    """The track and bodies of a reference, mm and MPa."""
    return PairTrack(
        Material(1e6 * inputs["E"], inputs["nu"]),
        *(1e-3 * inputs[name] for name in ("gauge", "gauge_height", "wheel_y", "radius")),
    )


def row_of(comparison: WheelComparison) -> list[Any]:
    """Cells of the tables."""
    d, result = comparison.differs, comparison.result
    row = [
        f"{comparison.y:g} {comparison.side}",
        carrying(result),
        "{} / {}".format(*d.patches),
        1e3 * d.position,
        100 * d.area,
    ]
    row += [1e-6 * max(patch.max_pressure for patch in result.patches), 100 * d.peak]
    if comparison.bound:
        row += [float(result.force[0]), comparison.forces[0], float(result.force[1]), comparison.forces[1]]
    else:
        row += [""] * len(FORCES)
    return [*row, 100 * d.load_fraction]


def measures(kind: str, cases: Iterable[WheelComparison], *, targets: bool) -> list[Measure]:
    """Errors of all cases of a kind."""
    comparisons = list(cases)
    if not comparisons:
        return []

    def of(name: str, unit: str, values: Iterable[float], worst: float) -> Measure:
        return measure(f"{name}, {kind}", unit, values, worst=worst if targets else None)

    errors = [
        of("position", "mm", (1e3 * c.differs.position for c in comparisons), 0.3),
        of("wrong number of patches", "fraction", (float(not c.differs.same_patches) for c in comparisons), 0.0),
        of("area", "%", (100 * c.differs.area for c in comparisons), 3.0),
        of("peak pressure", "%", (100 * c.differs.peak for c in comparisons), 2.0),
    ]
    if comparisons[0].bound:
        errors += [
            of("longitudinal force", "% of mu F_n", (c.forces[0] for c in comparisons), 1.5),
            of("lateral force", "% of mu F_n", (c.forces[1] for c in comparisons), 1.5),
        ]
    return errors


def half_space_section(quick: bool, say: Say) -> TableSection:
    """The same on half-spaces, whose differences are not due to finite bodies."""
    return wheelset_section(quick, say, bodies="half-space")


def wheelset_section(quick: bool, say: Say, size: float = SIZE, bodies: str = "waveguide") -> TableSection:
    """y = 0 to 6 mm, frictionless and rolling."""
    data = reference("wheelset")
    inputs, series = data["input"], data["series"]
    track = track_of(inputs)
    section = TableSection(
        "wheelset" if bodies == "waveguide" else bodies,
        f"S1002 on UIC60, bodies {bodies}, 57 kN on each wheel, {1e3 * size:g} mm: differences from CONTACT (0.2 mm)",
        (*COLUMNS, *FORCES, "load fraction of the largest patch %"),
    )
    variants = [
        {case["y"]: case for case in series[name]} for name in ("rolling", "grid_check_dx0.1", "rolling_conformal")
    ]
    for name, friction in (("normal_only", 0.0), ("rolling", inputs["mu"])):
        comparisons = []
        for case in series[name]:
            if case["y"] not in (QUICK if quick else POSITIONS):
                continue
            wheelset = state(case, speed=inputs["speed"], pitch_rate=inputs["pitch_rate"])
            for side in SIDES:
                say(f"wheelset, {name}, y {case['y']:g} mm {side}")
                result = loaded_wheel(track, friction, wheelset, side, inputs["load"], size, bodies=bodies)
                variant_forces = [wheel_force(v[case["y"]][side]["force"])[:2] for v in variants if case["y"] in v]
                differs = difference(result, case[side], side)
                comparison = WheelComparison(
                    case["y"], side, result, differs, friction * inputs["load"], np.array(variant_forces)
                )
                comparisons.append(comparison)
                section.count(carrying(result))
                section.rows.append(row_of(comparison))
        kind = "rolling" if friction else "frictionless"
        section.measures += measures(f"{kind}, y to {TREAD:g}", (c for c in comparisons if c.y <= TREAD), targets=True)
        section.measures += measures(f"{kind}, y beyond", (c for c in comparisons if c.y > TREAD), targets=False)
        if friction:
            for name, on_tread in ((f"y to {TREAD:g}", True), ("y beyond", False)):
                deviations = np.array([c.outside for c in comparisons if (c.y <= TREAD) == on_tread])
                for k, which in enumerate(("longitudinal", "lateral")):
                    section.measures += [
                        measure(
                            f"{which} force outside CONTACT's variants, {name}", "% of mu F_n", deviations[:, 0, k]
                        ),
                        measure(f"{which} span of CONTACT's variants, {name}", "% of mu F_n", deviations[:, 1, k]),
                    ]
    section.notes = [
        "the reference's roll is prescribed, the height of each wheel is computed; frictionless rows first",
        "CONTACT's variants: planar, elements of 0.1 mm where available, and conformal, with the patch's curvature",
    ]
    return section


def manchester_section(quick: bool, say: Say, size: float = SMALL) -> TableSection:
    """Case A-2.2 up to y = 6 mm; beyond it one wheel is in flange contact."""
    data = reference("manchester")
    inputs = data["input"]
    track = track_of(inputs)
    section = TableSection(
        "manchester",
        f"Manchester benchmark A-2.2, 10 kN on each wheel, {1e3 * size:g} mm: differences from CONTACT (0.2 mm)",
        (*COLUMNS, *FORCES, "load fraction of the largest patch %"),
    )
    comparisons, failed = [], []
    for case in data["cases"]:
        if case["y"] > (4.0 if quick else 10.0) or (quick and case["y"] % 2):
            continue
        side: Side = "left" if case["side"] == "left" else "right"
        say(f"Manchester, y {case['y']:g} mm {side}")
        wheelset = state(case, speed=case["speed"], pitch_rate=case["pitch_rate"], yaw=case["yaw"])
        try:
            result = loaded_wheel(track, inputs["mu"], wheelset, side, inputs["load"], size)
        except LoadError as error:
            failed.append(f"y {case['y']:g} mm {side}: {error}")
            continue
        comparison = WheelComparison(
            case["y"], side, result, difference(result, case, side), inputs["mu"] * inputs["load"]
        )
        comparisons.append(comparison)
        section.count(carrying(result))
        section.rows.append(row_of(comparison))
    section.measures = [
        *measures(f"y to {TREAD:g}", (c for c in comparisons if c.y <= TREAD), targets=True),
        *measures("y 5 to 6", (c for c in comparisons if TREAD < c.y <= 6.0), targets=False),
        *measures("y beyond 6", (c for c in comparisons if c.y > 6.0), targets=False),
    ]
    section.notes = [f"no result: {line}" for line in failed]
    return section
