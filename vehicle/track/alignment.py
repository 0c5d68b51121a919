"""Track alignment as a sequence of segments: tangents, transitions and arcs, with cant and gradients."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from math import copysign, inf
from typing import Literal, NamedTuple, get_args

from wheelrail.vehicle.track.piecewise import PiecewiseFunction, Shape

Kind = Literal["tangent", "transition", "arc"]


class AlignmentError(ValueError):
    """A sequence of segments that is not a valid alignment.

    Parameters:
        index: of the invalid segment, from 0.
        key: of the invalid value.
        allowed: what is allowed.
    """

    def __init__(self, index: int, key: str, allowed: str) -> None:
        super().__init__(f"segment {index}, counted from 0, {key}: {allowed}")
        self.index, self.key, self.allowed = index, key, allowed


@dataclass(frozen=True)
class Segment:
    """A segment of the alignment.

    Parameters:
        kind: "tangent", "transition" or "arc".
        length: m along the track.
        curvature: of an arc, 1/m, positive to the left; of a transition that is followed by another one, its end value.
        cant: of an arc, m, positive raises the outer rail (the right one without curvature); of a transition as for
            curvature.
        widening: of the gauge on an arc, m, half of it by each rail; of a transition as for curvature.
        shape: of a transition from the values of the previous to those of the next segment (straight track if there is
            none).
        gradient: rad, positive uphill; None: that of the previous segment, level at first.
        vertical_radius: m, of the vertical curve where the gradient changes, centred on the start of this segment: the
            gradient varies linearly with distance, except for the ends, rounded as those of a clothoid.
    """

    kind: Kind
    length: float
    curvature: float | None = None
    cant: float | None = None
    widening: float | None = None
    shape: Shape = "quintic"
    gradient: float | None = None
    vertical_radius: float | None = None


class CurveValues(NamedTuple):
    """Curvature 1/m, positive to the left; superelevation m, the height of the right rail above the left; widening of
    the gauge m.
    """

    curvature: float
    superelevation: float
    widening: float

    def __str__(self) -> str:
        cant = f"{self.superelevation * copysign(1.0, self.curvature):g} m of cant"
        return f"{self.curvature:g} 1/m with {cant}" + (f", {self.widening:g} m of widening" if self.widening else "")


STRAIGHT = CurveValues(0.0, 0.0, 0.0)


class TrackFunctions(NamedTuple):
    """Functions of distance: curvature 1/m, superelevation m, gradient rad, widening of the gauge m."""

    curvature: PiecewiseFunction
    superelevation: PiecewiseFunction
    gradient: PiecewiseFunction
    widening: PiecewiseFunction


def track_functions(segments: Sequence[Segment], *, corner: float = 3.0) -> TrackFunctions:
    """Functions along the segments, constant before the first and beyond the last.

    Parameters:
        segments: in order, from s = 0.
        corner: m, as in `PiecewiseFunction`.

    Raises AlignmentError for invalid segments, or values that are not continuous.
    """
    if not segments:
        raise AlignmentError(0, "kind", "missing: an alignment must have one segment at least")
    for index, segment in enumerate(segments):
        _check(index, segment, corner)
    boundaries = list(accumulate((segment.length for segment in segments), initial=0.0))
    ends = _ends(segments)
    stations, values, shapes = list[float](), list[CurveValues](), list[Shape]()
    for index, segment in enumerate(segments):
        if segment.kind != "transition":
            continue
        if not stations or stations[-1] < boundaries[index]:
            shapes += ["quintic"] if stations else []  # between equal values
            stations.append(boundaries[index])
            values.append(ends[index - 1] if index else STRAIGHT)
        stations.append(boundaries[index + 1])
        values.append(ends[index])
        shapes.append(segment.shape)

    def function(part: Literal["curvature", "superelevation", "widening"]) -> PiecewiseFunction:
        if not stations:
            return PiecewiseFunction.constant(getattr(ends[0], part))
        return PiecewiseFunction(
            tuple(stations), tuple(getattr(value, part) for value in values), shape=tuple(shapes), corner=corner
        )

    gradient = _gradient(segments, boundaries, corner)
    return TrackFunctions(function("curvature"), function("superelevation"), gradient, function("widening"))


def _check(index: int, segment: Segment, corner: float) -> None:
    """Raises AlignmentError for an invalid segment."""
    for key, choices in (("kind", get_args(Kind)), ("shape", get_args(Shape))):
        if getattr(segment, key) not in choices:
            raise AlignmentError(index, key, f"must be one of {', '.join(choices)}")
    for key in ("length", "vertical_radius"):
        value = getattr(segment, key)
        if value is not None and not 0.0 < value < inf:
            raise AlignmentError(index, key, "must be greater than 0 m")
    if segment.kind == "arc" and segment.curvature is None:
        raise AlignmentError(index, "curvature", "must be given for an arc")
    if not 0.0 <= (segment.widening or 0.0) < inf:
        raise AlignmentError(index, "widening", "must not be negative")
    for key in ("curvature", "cant", "widening"):
        if segment.kind == "tangent" and getattr(segment, key):
            raise AlignmentError(index, key, "must be 0 or left out for a tangent")
    if segment.kind == "transition" and segment.shape == "clothoid" and not 0.0 < corner <= 0.5 * segment.length:
        raise AlignmentError(index, "length", f"must have room for two rounded corners of {corner:g} m (more than 0 m)")


def _ends(segments: Sequence[Segment]) -> list[CurveValues]:
    """Values at the end of each segment. Raises AlignmentError where they are not continuous."""
    values = [_own(segment) for segment in segments]
    ends: list[CurveValues] = []
    for index, segment in enumerate(segments):
        last = index + 1 == len(segments)
        followed = segments[index + 1].kind != "transition" if not last else False
        end = values[index]
        if segment.kind != "transition":
            if ends and ends[-1] != end:
                text = f"jumps from {ends[-1]} to {end}: must have a transition in between"
                raise AlignmentError(index, _differing(ends[-1], end), text)
        elif segment.curvature is None and segment.cant is None and segment.widening is None:
            if not (last or followed):
                raise AlignmentError(index, "curvature", "must be given for a transition into another one")
            end = values[index + 1] if followed else STRAIGHT
        elif followed and end != values[index + 1]:
            text = f"must end with the {values[index + 1]} of the next segment, not with {end}"
            raise AlignmentError(index, _differing(end, values[index + 1]), text)
        ends.append(end)
    return ends


def _own(segment: Segment) -> CurveValues:
    curvature = segment.curvature or 0.0
    return CurveValues(curvature, (segment.cant or 0.0) * copysign(1.0, curvature), segment.widening or 0.0)


def _differing(a: CurveValues, b: CurveValues) -> str:
    if a.curvature != b.curvature:
        return "curvature"
    return "cant" if a.superelevation != b.superelevation else "widening"


def _gradient(segments: Sequence[Segment], boundaries: list[float], corner: float) -> PiecewiseFunction:
    """Gradient along the track. Raises AlignmentError for a change without radius, or overlapping vertical curves."""
    slopes = [0.0]
    for segment in segments:
        slopes.append(slopes[-1] if segment.gradient is None else segment.gradient)
    slopes[0] = slopes[1]
    stations, values, shortest = list[float](), list[float](), inf
    for index, (before, after) in enumerate(pairwise(slopes)):
        if before == after:
            continue
        radius = segments[index].vertical_radius
        if radius is None:
            raise AlignmentError(index, "vertical_radius", "must be given where the gradient changes")
        half = 0.5 * radius * abs(after - before)
        start, end, free = boundaries[index] - half, boundaries[index] + half, stations[-1] if stations else 0.0
        if start < free or end > boundaries[-1]:
            text = f"gives a curve from {start:g} to {end:g} m; must lie between {free:g} and {boundaries[-1]:g} m"
            raise AlignmentError(index, "vertical_radius", text)
        if start > free or not stations:
            stations.append(start)
            values.append(before)
        stations.append(end)
        values.append(after)
        shortest = min(shortest, half)
    if not stations:
        return PiecewiseFunction.constant(slopes[0])
    return PiecewiseFunction(tuple(stations), tuple(values), shape="clothoid", corner=min(corner, 0.5 * shortest))
