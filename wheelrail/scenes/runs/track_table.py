"""Table of the track alignment of a run."""

from __future__ import annotations

from itertools import accumulate
from math import tan
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.table import Table

    from wheelrail.scenes.schema.scene import RunScene
    from wheelrail.vehicle.track.speed_profile import SpeedProfile
    from wheelrail.vehicle.track.track import Track


def cant_deficiency(track: Track, speed_profile: SpeedProfile, gravity: float, stations: list[float]) -> list[float]:
    """Cant deficiency (n,), m: additional cant for zero lateral acceleration in the plane of the rails.

    Parameters:
        track: alignment and base.
        speed_profile: speed profile.
        gravity: m/s2.
        stations: (n,) distances along the track, m.

    Positive for a left-hand curve with too little cant, or a right-hand one with too much.
    """
    speeds = [speed_profile(speed_profile.time_at(s)).speed for s in stations]
    return [
        track.base * v * v * track.curvature(s)[0] / gravity - track.superelevation(s)[0]
        for s, v in zip(stations, speeds, strict=True)
    ]


def segment_table(scene: RunScene) -> Table:
    """Table with one row per segment: its range, and the values at its end."""
    from rich.table import Table

    from wheelrail.scenes.builders.vehicle import wagon
    from wheelrail.vehicle.track.speed_profile import SpeedProfile

    alignment, speed_profile = scene.track, SpeedProfile.of(scene.vehicle.speed_profile)
    track, gravity = alignment.track(), wagon(scene).gravity
    view = Table(title="Track; radius, cant, gradient, speed and cant deficiency at the end of each segment")
    for name in ("segment", "from m", "to m", "radius m", "cant mm", "gradient ‰", "speed m/s", "cant deficiency mm"):
        view.add_column(name, justify="left" if name == "segment" else "right")
    ends = list(accumulate((segment.length for segment in alignment.layout), initial=0.0))
    for segment, start, end in zip(alignment.layout, ends, ends[1:], strict=False):
        curvature, sign = track.curvature(end)[0], 1.0 if track.curvature(end)[0] >= 0.0 else -1.0
        deficiency = sign * cant_deficiency(track, speed_profile, gravity, [end])[0]
        view.add_row(
            f"{segment.kind}, {segment.shape}" if segment.kind == "transition" else segment.kind,
            f"{start:.1f}",
            f"{end:.1f}",
            f"{1.0 / curvature:.1f}" if curvature else "",
            f"{1e3 * sign * track.superelevation(end)[0]:.0f}",
            f"{1e3 * tan(track.gradient(end)[0]):.1f}",
            f"{speed_profile(speed_profile.time_at(end)).speed:.1f}",
            f"{1e3 * deficiency:.0f}",
        )
    return view
