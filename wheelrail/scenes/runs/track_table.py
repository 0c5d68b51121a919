"""Table of the track alignment of a run."""

from __future__ import annotations

from itertools import accumulate
from math import tan
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.scenes.datasets.result_table import Column, ResultTable
from wheelrail.vehicle.track.measured_track import BANDS

if TYPE_CHECKING:
    from wheelrail.scenes.schema.scene import RunScene
    from wheelrail.vehicle.track.speed_profile import SpeedProfile
    from wheelrail.vehicle.track.track import Track


STATION = 0.25  # m, between samples of irregularities


def cants(track: Track, speed_profile: SpeedProfile, gravity: float, station: float) -> tuple[float, float]:
    """Cant and cant deficiency, m: the additional cant for zero lateral acceleration in the plane of the rails.

    Parameters:
        track: alignment and base.
        speed_profile: speed profile.
        gravity: m/s2.
        station: distance along the track, m.

    Both are positive where the outer rail is raised, or should be raised more, as in scenes; on a tangent, the right
    one.
    """
    curvature, superelevation = track.curvature(station)[0], track.superelevation(station)[0]
    speed = speed_profile(speed_profile.time_at(station)).speed
    sign = 1.0 if curvature >= 0.0 else -1.0
    return sign * superelevation, sign * (track.base * speed * speed * curvature / gravity - superelevation)


def segment_table(scene: RunScene) -> ResultTable:
    """Table with one row per segment: its range, and the values at its end."""
    from wheelrail.scenes.builders.vehicle import wagon
    from wheelrail.vehicle.track.speed_profile import SpeedProfile

    alignment, speed_profile = scene.track, SpeedProfile.of(scene.vehicle.speed_profile)
    track, gravity = alignment.track(), wagon(scene).gravity
    ends = list(accumulate((segment.length for segment in alignment.layout), initial=0.0))
    rows = []
    for segment, start, end in zip(alignment.layout, ends, ends[1:], strict=False):
        curvature, (cant, deficiency) = track.curvature(end)[0], cants(track, speed_profile, gravity, end)
        rows.append(
            {
                "segment": f"{segment.kind}, {segment.shape}" if segment.kind == "transition" else segment.kind,
                "start": start,
                "end": end,
                "radius": 1.0 / curvature if curvature else None,
                "cant": cant,
                "gradient": tan(track.gradient(end)[0]),
                "speed": speed_profile(speed_profile.time_at(end)).speed,
                "cant_deficiency": deficiency,
            }
        )
    title = "Track; radius, cant, gradient, speed and cant deficiency at the end of each segment"
    return ResultTable("segments", title, COLUMNS, rows)


def quality_tables(scene: RunScene) -> list[ResultTable]:
    """Standard deviations of the irregularities along the track of a run, and their classes; none on smooth rails."""
    from wheelrail.vehicle.track.speed_profile import SpeedProfile
    from wheelrail.vehicle.track.track_quality import quality

    irregularities = scene.track.track().irregularities
    if irregularities is None:
        return []
    profile = SpeedProfile.of(scene.vehicle.speed_profile)
    speed = max(profile.speeds.values)
    end = min(float(irregularities.stations[-1]), scene.track.length)
    stations = np.arange(max(float(irregularities.stations[0]), 0.0), end, STATION)
    rows = [
        {
            "start": own.start,
            "end": own.end,
            **{f"level_{name}": value for name, value in zip(BANDS, own.level.tolist(), strict=True)},
            "level_class": own.classes[0],
            **{f"alignment_{name}": value for name, value in zip(BANDS, own.alignment.tolist(), strict=True)},
            "alignment_class": own.classes[1],
        }
        for own in quality(stations, irregularities.at(stations), speed)
    ]
    title = (
        f"Standard deviations of the worse rail in D1, D2, D3; classes of EN 13848-6 at {speed:g} m/s (not confirmed)"
    )
    return [ResultTable("quality", title, QUALITY_COLUMNS, rows)]


QUALITY_COLUMNS = Column.items(
    ("start", "from", "m", 1),
    ("end", "to", "m", 1),
    *((f"level_{band}", f"level {band}", "mm", 2) for band in BANDS),
    ("level_class", "class", "", None),
    *((f"alignment_{band}", f"alignment {band}", "mm", 2) for band in BANDS),
    ("alignment_class", "class", "", None),
)
COLUMNS = Column.items(
    ("segment", "segment", "", None),
    ("start", "from", "m", 1),
    ("end", "to", "m", 1),
    ("radius", "radius", "m", 1),
    ("cant", "cant", "mm", 0),
    ("gradient", "gradient", "‰", 1),
    ("speed", "speed", "m/s", 1),
    ("cant_deficiency", "cant deficiency", "mm", 0),
)
