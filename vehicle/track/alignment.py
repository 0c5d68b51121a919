"""A track as a list of what follows one upon the other: tangents, transitions and arcs, with cant and gradients."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from math import copysign, inf
from typing import Literal, NamedTuple, get_args

from wheelrail.vehicle.track.piecewise import PiecewiseFunction, Shape

Kind = Literal["tangent", "transition", "arc"]


class AlignmentError(ValueError):
    """Segments that make no track: index of the one at fault, from 0, and the key of its value."""

    def __init__(self, index: int, key: str, says: str) -> None:
        super().__init__(f"segment {index}, counted from 0, {key}: {says}")
        self.index, self.key, self.says = index, key, says


@dataclass(frozen=True)
class Segment:
    """A piece of track, length m along it.

    curvature 1/m of an arc, positive to the left; cant m of an arc, positive raises the outer rail (the right one where
    nothing curves). A transition takes both from the segment before to the one after, in its shape, from and to
    straight track where there is none; between two transitions the first says what it ends with. gradient rad, positive
    uphill, that of the segment before unless given, level at first; where it changes, a vertical curve of
    vertical_radius m, half before and half behind the beginning of this segment, is a circle (its gradient changes
    evenly along the track) but for its ends, which are rounded like those of a clothoid.
    """

    kind: Kind
    length: float
    curvature: float | None = None
    cant: float | None = None
    shape: Shape = "quintic"
    gradient: float | None = None
    vertical_radius: float | None = None


class VerticalCurve(NamedTuple):
    """Curvature 1/m, positive to the left, and lift m of the right rail over the left."""

    curvature: float
    lift: float

    def __str__(self) -> str:
        return f"{self.curvature:g} 1/m with {self.lift * copysign(1.0, self.curvature):g} m of cant"


STRAIGHT = VerticalCurve(0.0, 0.0)


class TrackFunctions(NamedTuple):
    curvature: PiecewiseFunction
    lift: PiecewiseFunction
    gradient: PiecewiseFunction


def courses(segments: Sequence[Segment], *, corner: float = 3.0) -> TrackFunctions:
    """Curvature, lift and gradient along the segments, constant before the first and behind the last.

    corner m: as in `PiecewiseFunction`. Raises LayoutError where segments make no sense or do not meet.
    """
    if not segments:
        raise AlignmentError(0, "kind", "missing: a layout has one segment at least")
    for index, segment in enumerate(segments):
        _check(index, segment, corner)
    joints = list(accumulate((segment.length for segment in segments), initial=0.0))
    ends = _ends(segments)
    at, bends, shapes = list[float](), list[VerticalCurve](), list[Shape]()
    for index, segment in enumerate(segments):
        if segment.kind != "transition":
            continue
        if not at or at[-1] < joints[index]:
            shapes += ["quintic"] if at else []  # between equal values
            at.append(joints[index])
            bends.append(ends[index - 1] if index else STRAIGHT)
        at.append(joints[index + 1])
        bends.append(ends[index])
        shapes.append(segment.shape)

    def course(part: Literal["curvature", "lift"]) -> PiecewiseFunction:
        if not at:
            return PiecewiseFunction.constant(getattr(ends[0], part))
        return PiecewiseFunction(
            tuple(at), tuple(getattr(bend, part) for bend in bends), shape=tuple(shapes), corner=corner
        )

    return TrackFunctions(course("curvature"), course("lift"), _gradient(segments, joints, corner))


def _check(index: int, segment: Segment, corner: float) -> None:
    """Raises LayoutError for what is wrong with a segment by itself."""
    for key, choices in (("kind", get_args(Kind)), ("shape", get_args(Shape))):
        if getattr(segment, key) not in choices:
            raise AlignmentError(index, key, f"must be one of {', '.join(choices)}")
    for key in ("length", "vertical_radius"):
        value = getattr(segment, key)
        if value is not None and not 0.0 < value < inf:
            raise AlignmentError(index, key, "must be greater than 0 m")
    if segment.kind == "arc" and segment.curvature is None:
        raise AlignmentError(index, "curvature", "must be given for an arc")
    for key in ("curvature", "cant"):
        if segment.kind == "tangent" and getattr(segment, key):
            raise AlignmentError(index, key, "must be 0 or left out for a tangent")
    if segment.kind == "transition" and segment.shape == "clothoid" and not 0.0 < corner <= 0.5 * segment.length:
        raise AlignmentError(index, "length", f"must have room for two rounded corners of {corner:g} m (more than 0 m)")


def _ends(segments: Sequence[Segment]) -> list[VerticalCurve]:
    """What each segment ends with. Raises LayoutError where two do not meet."""
    own = [_own(segment) for segment in segments]
    ends: list[VerticalCurve] = []
    for index, segment in enumerate(segments):
        last = index + 1 == len(segments)
        meets = segments[index + 1].kind != "transition" if not last else False
        end = own[index]
        if segment.kind != "transition":
            if ends and ends[-1] != end:
                text = f"must go on from {ends[-1]}, not jump to {end}: put a transition in between"
                raise AlignmentError(index, _apart(ends[-1], end), text)
        elif segment.curvature is None and segment.cant is None:
            if not (last or meets):
                raise AlignmentError(index, "curvature", "must be given for a transition into another one")
            end = own[index + 1] if meets else STRAIGHT
        elif meets and end != own[index + 1]:
            text = f"must end with the {own[index + 1]} of the next segment, not with {end}"
            raise AlignmentError(index, _apart(end, own[index + 1]), text)
        ends.append(end)
    return ends


def _own(segment: Segment) -> VerticalCurve:
    curvature = segment.curvature or 0.0
    return VerticalCurve(curvature, (segment.cant or 0.0) * copysign(1.0, curvature))


def _apart(one: VerticalCurve, other: VerticalCurve) -> str:
    return "cant" if one.curvature == other.curvature else "curvature"


def _gradient(segments: Sequence[Segment], joints: list[float], corner: float) -> PiecewiseFunction:
    """Raises LayoutError for a change without a radius, or a vertical curve without room."""
    slopes = [0.0]
    for segment in segments:
        slopes.append(slopes[-1] if segment.gradient is None else segment.gradient)
    slopes[0] = slopes[1]
    at, values, shortest = list[float](), list[float](), inf
    for index, (before, after) in enumerate(pairwise(slopes)):
        if before == after:
            continue
        radius = segments[index].vertical_radius
        if radius is None:
            raise AlignmentError(index, "vertical_radius", "must be given where the slope changes")
        half = 0.5 * radius * abs(after - before)
        start, end, free = joints[index] - half, joints[index] + half, at[-1] if at else 0.0
        if start < free or end > joints[-1]:
            text = (
                f"gives a vertical curve from {start:g} to {end:g} m; there is room from {free:g} to {joints[-1]:g} m"
            )
            raise AlignmentError(index, "vertical_radius", text)
        if start > free or not at:
            at.append(start)
            values.append(before)
        at.append(end)
        values.append(after)
        shortest = min(shortest, half)
    if not at:
        return PiecewiseFunction.constant(slopes[0])
    return PiecewiseFunction(tuple(at), tuple(values), shape="clothoid", corner=min(corner, 0.5 * shortest))
