"""Wheel unloading of a vehicle on twisted track, and sway on canted track, from a scene of a run."""

from __future__ import annotations

from collections.abc import Sequence
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.scenes.datasets.result_table import Column, Results, ResultTable
from wheelrail.scenes.runs.steady import failures_as_run_failed, vehicle_dynamics
from wheelrail.vehicle.steady.twist_test import LIMIT

if TYPE_CHECKING:
    from wheelrail.scenes.schema.scene import RunScene
    from wheelrail.vehicle.steady.sway import Sway
    from wheelrail.vehicle.steady.twist_test import Twisted


class Twist(NamedTuple):
    """Vehicle on a twisted track; twists of body and bogie, 1; names of the wheelsets."""

    name: str
    body: float
    bogie: float
    found: Twisted
    wheelsets: tuple[str, ...]


def twists_of(scene: RunScene, file: Path, body: float | None, bogie: float | None) -> list[Twist]:
    """Vehicle on a track that twists its body, its first bogie, and both.

    Parameters:
        scene: of a run.
        file: vehicle file.
        body, bogie: twists, 1; None: of EN 14363.

    Raises RunFailed without an equilibrium, SceneError.
    """
    from wheelrail.vehicle.steady.twist_test import cross_levels, en_14363_twists, twisted

    dynamics = vehicle_dynamics(scene, file, scene.vehicle.first_speed)
    vehicle = dynamics.vehicle
    of_body, of_bogie = en_14363_twists(vehicle)
    body, bogie = (of_body if body is None else body), (of_bogie if bogie is None else bogie)
    cases = (("body", body, 0.0), ("bogie", 0.0, bogie), ("both", body, bogie))
    with failures_as_run_failed():
        return [
            Twist(name, b, g, twisted(dynamics, cross_levels(vehicle, b, g)), vehicle.wheelsets) for name, b, g in cases
        ]


def twist_results(twists: list[Twist]) -> Results:
    """Table of all wheelsets on every track, and the largest unloading with its limit."""
    rows, facts = [], []
    for own in twists:
        worst = float(own.found.unloading.max())
        facts.append({"track": own.name, "body_twist": own.body, "bogie_twist": own.bogie, "largest_unloading": worst})
        for k, name in enumerate(own.wheelsets):
            rows.append(
                {
                    "track": own.name,
                    "wheelset": name,
                    "cross_level": float(own.found.cross_level[k]),
                    "wheel_load": dict(zip(SIDES, own.found.load[k].tolist(), strict=True)),
                    "unloading": dict(zip(SIDES, own.found.unloading[k].tolist(), strict=True)),
                }
            )
    lines = [
        f"twist of {fact['track']}: largest unloading {100.0 * float(str(fact['largest_unloading'])):.1f} %"
        f" at {1e3 * own.body:.2f} per mille of the body, {1e3 * own.bogie:.2f} of the bogie"
        for fact, own in zip(facts, twists, strict=True)
    ]
    note = f"limit {100 * LIMIT:g} %; twists and limit of EN 14363 are not confirmed; no hysteresis, no curve"
    units = {"body_twist": "1", "bogie_twist": "1", "largest_unloading": "1", "limit": "1"}
    table = ResultTable("wheelsets", "Wheels on twisted track at walking pace", COLUMNS, rows, note=note)
    return Results("twist", ["\n".join(lines), table], {"tracks": facts, "limit": LIMIT}, units)


def sways_of(scene: RunScene, file: Path, cants: Sequence[float]) -> list[Sway]:
    """Attitudes of all bodies without wheels on canted track.

    Parameters:
        scene: of a run.
        file: vehicle file.
        cants: m.

    Raises RunFailed without an equilibrium, SceneError.
    """
    from wheelrail.vehicle.steady.sway import sway

    dynamics = vehicle_dynamics(scene, file, scene.vehicle.first_speed)
    vehicle = dynamics.vehicle
    bodies = [name for name in vehicle.names if name not in vehicle.wheelsets]
    with failures_as_run_failed():
        return sway(dynamics, cants, bodies)


def sway_results(sways: Sequence[Sway]) -> Results:
    """Table of all bodies at every cant."""
    columns = [
        Column("cant", "cant", attrgetter("cant"), "mm", 1),
        Column("body", "body", attrgetter("body")),
        Column("angle", "angle of the track", attrgetter("angle"), "mrad", 2),
        Column("roll", "roll to the lower side", attrgetter("roll"), "mrad", 3),
        Column("coefficient", "coefficient", attrgetter("coefficient"), "1", 4),
        Column("shift", "shift of the centre of mass", attrgetter("shift"), "mm", 2),
        Column("centre", "roll centre above top of rail", attrgetter("centre"), "m", 3),
    ]
    title = "Sway on canted track: roll of the bodies relative to the track over its angle"
    return Results("sway", [ResultTable("bodies", title, columns, sways)])


COLUMNS = Column.items(
    ("track", "twist of", "", None),
    ("wheelset", "wheelset", "", None),
    ("cross_level", "cross level", "mm", 2),
    ("wheel_load", "wheel load Q", "kN", 2),
    ("unloading", "unloading", "%", 1),
)
