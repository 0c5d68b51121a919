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
PLACES = (0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 4.5, 5.0, 6.0)  # mm, of those that the reference has
QUICK = (0.0, 2.0, 5.0)
SMALL = 4e-4  # m, for 10 kN
TREAD = 4.5  # mm: up to here a half-space is right
RTOL = 1e-5  # of the load
EXPECTED = 5e-5  # m
COLUMNS = ("y mm", "points", "patches", "place mm", "area %", "peak MPa", "peak %")
FORCES = ("Fx N", "Fx % of mu F", "Fy N", "Fy % of mu F")


@dataclass(frozen=True)
class Compared:
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


def seated(
    track: PairTrack, friction: float, at: WheelsetState, side: Side, load: float, size: float, **options: Any
) -> ContactResult:
    """One wheel under its load at a given roll; with friction at the height of the frictionless solution."""
    free = wheelset_model(track, frictionless(), size, **options)
    seat = wheel_under_load(free, at, side, load, expected=EXPECTED, rtol=RTOL if friction == 0 else 1e-3)
    if friction == 0:
        return seat.results[side]
    held = wheelset_model(track, frictional(friction), size, **options)
    return wheel_under_load(held, seat.state, side, load, expected=EXPECTED, rtol=RTOL).results[side]


def track_of(given: dict[str, float]) -> PairTrack:
    """The track and bodies of a reference, mm and MPa."""
    return PairTrack(
        Material(1e6 * given["E"], given["nu"]),
        *(1e-3 * given[name] for name in ("gauge", "gauge_height", "wheel_y", "radius")),
    )


def row_of(one: Compared) -> list[Any]:
    """Cells of the tables."""
    d, result = one.differs, one.result
    row = [f"{one.y:g} {one.side}", carrying(result), "{} / {}".format(*d.patches), 1e3 * d.place, 100 * d.area]
    row += [1e-6 * max(patch.max_pressure for patch in result.patches), 100 * d.peak]
    if one.bound:
        row += [float(result.force[0]), one.forces[0], float(result.force[1]), one.forces[1]]
    else:
        row += [""] * len(FORCES)
    return [*row, 100 * d.share]


def measures(kind: str, cases: Iterable[Compared], *, targets: bool) -> list[Measure]:
    """Errors of all cases of a kind."""
    known = list(cases)
    if not known:
        return []

    def of(name: str, unit: str, values: Iterable[float], worst: float) -> Measure:
        return measure(f"{name}, {kind}", unit, values, worst=worst if targets else None)

    found = [
        of("position", "mm", (1e3 * c.differs.place for c in known), 0.3),
        of("wrong number of patches", "share", (float(not c.differs.same_patches) for c in known), 0.0),
        of("area", "%", (100 * c.differs.area for c in known), 3.0),
        of("peak pressure", "%", (100 * c.differs.peak for c in known), 2.0),
    ]
    if known[0].bound:
        found += [
            of("longitudinal force", "% of mu F_n", (c.forces[0] for c in known), 1.5),
            of("lateral force", "% of mu F_n", (c.forces[1] for c in known), 1.5),
        ]
    return found


def half_space_section(quick: bool, say: Say) -> TableSection:
    """The same on half-spaces, whose differences are not due to finite bodies."""
    return wheelset_section(quick, say, bodies="half-space")


def wheelset_section(quick: bool, say: Say, size: float = SIZE, bodies: str = "waveguide") -> TableSection:
    """y = 0 to 6 mm, frictionless and rolling."""
    data = reference("wheelset")
    given, series = data["input"], data["series"]
    track = track_of(given)
    section = TableSection(
        "wheelset" if bodies == "waveguide" else bodies,
        f"S1002 on UIC60, bodies {bodies}, 57 kN on each wheel, {1e3 * size:g} mm: differences from CONTACT (0.2 mm)",
        (*COLUMNS, *FORCES, "share of heaviest %"),
    )
    variants = [
        {case["y"]: case for case in series[name]} for name in ("rolling", "grid_check_dx0.1", "rolling_conformal")
    ]
    for name, friction in (("normal_only", 0.0), ("rolling", given["mu"])):
        found = []
        for case in series[name]:
            if case["y"] not in (QUICK if quick else PLACES):
                continue
            at = state(case, speed=given["speed"], pitch_rate=given["pitch_rate"])
            for side in SIDES:
                say(f"wheelset, {name}, y {case['y']:g} mm {side}")
                result = seated(track, friction, at, side, given["load"], size, bodies=bodies)
                known = [wheel_force(v[case["y"]][side]["force"])[:2] for v in variants if case["y"] in v]
                differs = difference(result, case[side], side)
                one = Compared(case["y"], side, result, differs, friction * given["load"], np.array(known))
                found.append(one)
                section.count(carrying(result))
                section.rows.append(row_of(one))
        kind = "rolling" if friction else "frictionless"
        section.measures += measures(f"{kind}, y to {TREAD:g}", (c for c in found if c.y <= TREAD), targets=True)
        section.measures += measures(f"{kind}, y beyond", (c for c in found if c.y > TREAD), targets=False)
        if friction:
            for name, here in ((f"y to {TREAD:g}", True), ("y beyond", False)):
                apart = np.array([c.outside for c in found if (c.y <= TREAD) == here])
                for k, which in enumerate(("longitudinal", "lateral")):
                    section.measures += [
                        measure(f"{which} force outside CONTACT's variants, {name}", "% of mu F_n", apart[:, 0, k]),
                        measure(f"{which} span of CONTACT's variants, {name}", "% of mu F_n", apart[:, 1, k]),
                    ]
    section.notes = [
        "the reference's roll is imposed, the height of each wheel is sought; first frictionless rows",
        "CONTACT's variants: planar, elements of 0.1 mm where known, and conformal, which alone sees a curved patch",
    ]
    return section


def manchester_section(quick: bool, say: Say, size: float = SMALL) -> TableSection:
    """Case A-2.2 up to y = 6 mm; beyond it one wheel is in flange contact."""
    data = reference("manchester")
    given = data["input"]
    track = track_of(given)
    section = TableSection(
        "manchester",
        f"Manchester benchmark A-2.2, 10 kN on each wheel, {1e3 * size:g} mm: differences from CONTACT (0.2 mm)",
        (*COLUMNS, *FORCES, "share of heaviest %"),
    )
    found, failed = [], []
    for case in data["cases"]:
        if case["y"] > (4.0 if quick else 10.0) or (quick and case["y"] % 2):
            continue
        side: Side = "left" if case["side"] == "left" else "right"
        say(f"Manchester, y {case['y']:g} mm {side}")
        at = state(case, speed=case["speed"], pitch_rate=case["pitch_rate"], yaw=case["yaw"])
        try:
            result = seated(track, given["mu"], at, side, given["load"], size)
        except LoadError as error:
            failed.append(f"y {case['y']:g} mm {side}: {error}")
            continue
        one = Compared(case["y"], side, result, difference(result, case, side), given["mu"] * given["load"])
        found.append(one)
        section.count(carrying(result))
        section.rows.append(row_of(one))
    section.measures = [
        *measures(f"y to {TREAD:g}", (c for c in found if c.y <= TREAD), targets=True),
        *measures("y 5 to 6", (c for c in found if TREAD < c.y <= 6.0), targets=False),
        *measures("y beyond 6", (c for c in found if c.y > 6.0), targets=False),
    ]
    section.notes = [f"no result: {line}" for line in failed]
    return section
