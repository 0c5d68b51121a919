"""Track of a run in a scene: segments or their short form, and irregularities."""

from __future__ import annotations

from functools import cached_property
from itertools import pairwise
from math import atan
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, Strict, ValidationInfo, field_validator, model_validator

from wheelrail.scenes.schema import quantities as q
from wheelrail.scenes.schema.tables import RailsTable, SceneTable, Sides

if TYPE_CHECKING:
    from wheelrail.scenes.schema.irregularity_file import Measurement
    from wheelrail.vehicle.track.alignment import Segment
    from wheelrail.vehicle.track.irregularity import Irregularities
    from wheelrail.vehicle.track.track import Track

LONGEST = 1e5  # m
SUDDEN = 0.1  # m, shortest change of friction
MOST_WAVES = 1e5  # shortest wavelengths along a track; take half a minute
SHORT = ("curvature", "cant", "tangent", "transition_length", "curve")
Shape = Literal["quintic", "clothoid", "bloss"]


class SegmentTable(SceneTable):
    """Segment of a track; length: m.

    An arc has a radius, m, or a curvature, 1/m, positive to the left, and a cant, m; a transition has a shape, and end
    values only before another transition. widening: of the gauge, m, half of it by each rail; slope: rise over run, by
    default that of the previous segment; vertical_radius: of the vertical curve at the beginning of the segment, m.
    """

    kind: Literal["tangent", "transition", "arc"]
    length: q.Length
    radius: q.CurveRadius | None = None
    curvature: q.Curvature | None = None
    cant: q.Cant | None = None
    widening: q.Widening | None = None
    shape: Shape | None = None
    slope: q.Slope | None = None
    vertical_radius: q.VerticalRadius | None = None

    @model_validator(mode="after")
    def _consistent(self) -> SegmentTable:
        if self.radius is not None and self.curvature is not None:
            raise q.reject("must not be combined with curvature", "radius")
        if self.shape is not None and self.kind != "transition":
            raise q.reject('allowed only with kind = "transition"', "shape")
        return self

    def segment(self, shape: Shape) -> Segment:
        """Segment for `vehicle`; shape: default for a transition."""
        from wheelrail.vehicle.track.alignment import Segment

        return Segment(
            self.kind,
            self.length,
            curvature=1.0 / self.radius if self.radius is not None else self.curvature,
            cant=self.cant,
            widening=self.widening,
            shape=self.shape or shape,
            gradient=None if self.slope is None else atan(self.slope),
            vertical_radius=self.vertical_radius,
        )


class JointsTable(SceneTable):
    """Dipped joints at distances m: parabolas of a length m on either side that meet at an angle, rad; by sides."""

    at: Annotated[tuple[q.Distance, ...], Strict(False), Field(min_length=1), q.AtMost(1000)]
    angle: q.JointAngle = 4e-3
    length: q.JointLength = 1.0
    sides: Sides = ("left", "right")

    def irregularities(self, start: float = 0.0) -> Irregularities:
        """Joints beyond a distance start, m. Raises ValueError for one before that and for joints that overlap."""
        from wheelrail.vehicle.track.irregularity import JOINT_SAMPLES, MARGIN, Irregularities

        first = start + self.length * (1.0 + MARGIN / JOINT_SAMPLES)
        if self.at[0] < first:
            raise ValueError(f"the first joint must be at {first:.4g} m at least, so that a run starts in equilibrium")
        return Irregularities.joints(self.at, self.angle, self.length, self.sides)


class IrregularityTable(SceneTable):
    """Irregularities from a file, from the spectrum ERRI B176 low or high with a seed, between two wavelengths, m, or
    of joints.

    They are faded in over the first `fade` m. A measured file: heads of its columns, the band of wavelengths that is
    kept, m, chord of the measurement or its parts behind and ahead, m, gaps of chainage, base of the twist, m.
    """

    file: str | None = None
    columns: dict[str, str] | None = None
    band: Literal["D1", "D2", "D3"] | Annotated[tuple[q.Wavelength, q.Wavelength], Strict(False)] | None = None
    chord: q.Chord | Annotated[tuple[q.Chord, q.Chord], Strict(False)] | None = None
    gaps: Literal["refuse", "close", "fade"] | None = None
    twist_base: q.Chord = 3.0
    spectrum: Literal["low", "high"] | None = None
    joints: JointsTable | None = None
    seed: q.Seed = 0
    wavelengths: Annotated[tuple[q.Wavelength, q.Wavelength], Strict(False)] = (3.0, 100.0)
    fade: q.Fade = 10.0

    @field_validator("file")
    @classmethod
    def _readable(cls, value: str | None, info: ValidationInfo) -> str | None:
        """The file, relative to the scene's folder, as its full path."""
        if value is None:
            return None
        from wheelrail.scenes.schema.irregularity_file import MOST
        from wheelrail.support.text_file import FileRefused, read_text

        file = Path((info.context or {}).get("folder", "."), value).resolve()
        try:
            read_text(file, MOST, foreign=True)
        except FileRefused as error:
            raise q.reject(str(error)) from None
        return str(file)

    @property
    def measurement(self) -> Measurement:
        """How the file is read."""
        from wheelrail.scenes.schema.irregularity_file import Measurement
        from wheelrail.vehicle.track.measured_track import BANDS

        band = BANDS[self.band] if isinstance(self.band, str) else self.band
        chord = (0.5 * self.chord, 0.5 * self.chord) if isinstance(self.chord, float) else self.chord
        return Measurement(band, chord, self.gaps, self.twist_base, self.fade, self.columns)

    @model_validator(mode="after")
    def _consistent(self) -> IrregularityTable:
        if sum(own is not None for own in (self.file, self.spectrum, self.joints)) != 1:
            raise q.reject("exactly one of file, spectrum and joints is required", "spectrum")
        for needed, keys in (
            ("spectrum", ("seed", "wavelengths")),
            ("file", ("columns", "band", "chord", "gaps", "twist_base")),
        ):
            for key in keys:
                if getattr(self, needed) is None and key in self.model_fields_set:
                    raise q.reject(f"allowed only with {needed}", key)
        if self.joints is not None and "fade" in self.model_fields_set:
            raise q.reject("allowed only with file or spectrum", "fade")
        for key in ("wavelengths", "band"):
            bounds = getattr(self, key)
            if isinstance(bounds, tuple) and not bounds[0] < bounds[1]:
                raise q.reject("must be in increasing order", key)
        if self.chord is not None and self.band is None:
            raise q.reject("needs band, the wavelengths in which it is corrected", "chord")
        if self.file is not None:
            from wheelrail.scenes.schema.irregularity_file import IrregularityFileError, read_irregularities

            try:
                read_irregularities(self.file, self.measurement)
            except IrregularityFileError as error:
                raise q.reject(str(error), "file") from None
        return self

    def irregularities(self, length: float, start: float = 0.0) -> Irregularities:
        """Irregularities along a track of a length m that begin at a distance start, m."""
        from wheelrail.scenes.schema.irregularity_file import read_irregularities
        from wheelrail.vehicle.track.irregularity import Irregularities
        from wheelrail.vehicle.track.irregularity_spectrum import ERRI

        if self.joints is not None:
            return self.joints.irregularities(start)
        if self.file is not None:
            return Irregularities.faded(*read_irregularities(self.file, self.measurement), start=start, fade=self.fade)
        assert self.spectrum is not None
        generate, end = ERRI[self.spectrum].irregularities, length + start + self.fade
        return generate(end, seed=self.seed, wavelengths=self.wavelengths, start=start, fade=self.fade)


class CheckRailTable(SceneTable):
    """Check rails beside the running rails, or walls of grooves, that the backs of flanges touch.

    flangeway: width of the gap to the gauge face, m; height: of the top above that of the running rail, m; rounding: of
    the upper edge, m; stiffness: of the check rail on its supports, N/m; friction: coefficient, by default that of the
    contact; back_height, back_rounding: end of the flange's plane back beyond the rolling circle and rounding there, m,
    by default those of a profile that begins on the back.
    """

    flangeway: q.Flangeway
    height: q.CheckRailHeight = 0.0
    rounding: q.EdgeRounding = 0.01
    stiffness: q.CheckRailStiffness = 40e6
    friction: q.Friction | None = None
    sides: Sides = ("left", "right")
    back_height: q.BackHeight | None = None
    back_rounding: q.EdgeRounding | None = None

    @model_validator(mode="after")
    def _consistent(self) -> CheckRailTable:
        if len(set(self.sides)) != len(self.sides):
            raise q.reject("must contain each side at most once", "sides")
        if (self.back_height is None) != (self.back_rounding is None):
            raise q.reject("back_height and back_rounding are required together", "back_rounding")
        return self


FrictionPoint = Annotated[tuple[q.Distance, q.FrictionFactor], Strict(False)]


class TrackLine(RailsTable):
    """Segments in sequence; or, in short form, a tangent, a transition and a curve of constant curvature and cant.

    Lengths in m. slope: rise over run of the short form; transition: default shape; corner: length over which the ends
    of "clothoid" transitions and of vertical curves are rounded. friction: points [distance m, factor] on the
    coefficient of friction, constant before and after, smooth in between. check_rail: along the whole track.
    """

    curvature: q.Curvature | None = None
    cant: q.Cant | None = None
    cant_base: q.CantBase = 1.5
    slope: q.Slope | None = None
    transition: Shape = "quintic"
    corner: q.Length = 3.0
    tangent: q.Length | None = None
    transition_length: q.Length | None = None
    curve: q.Length | None = None
    segments: Annotated[tuple[SegmentTable, ...], Strict(False), Field(min_length=1), q.AtMost(1000)] | None = None
    irregularities: IrregularityTable | None = None
    check_rail: CheckRailTable | None = None
    friction: Annotated[tuple[FrictionPoint, ...], Strict(False), Field(min_length=1), q.AtMost(1000)] | None = None

    @cached_property
    def layout(self) -> list[Segment]:
        """All segments for `vehicle`."""
        tables = self._short if self.segments is None else self.segments
        return [table.segment(self.transition) for table in tables if table.length > 0.0 or self.segments]

    @property
    def _short(self) -> tuple[SegmentTable, ...]:
        assert self.tangent is not None
        assert self.transition_length is not None
        assert self.curve is not None
        return (
            SegmentTable(kind="tangent", length=self.tangent, slope=self.slope),
            SegmentTable(kind="transition", length=self.transition_length, slope=self.slope),
            SegmentTable(kind="arc", length=self.curve, curvature=self.curvature, cant=self.cant, slope=self.slope),
        )

    @property
    def sharpest(self) -> float:
        """Largest curvature of any segment, 1/m."""
        return max(abs(segment.curvature or 0.0) for segment in self.layout)

    @cached_property
    def length(self) -> float:
        return float(sum(segment.length for segment in self.layout))

    def track(self, start: float = 0.0) -> Track:
        """Track with irregularities that begin at a distance start, m. Raises ValueError where they are too short."""
        from wheelrail.vehicle.track.piecewise import PiecewiseFunction
        from wheelrail.vehicle.track.track import Track

        table = self.irregularities
        irregularities = table.irregularities(self.length, start) if table else None
        points = self.friction or ((0.0, 1.0),)
        friction = PiecewiseFunction(tuple(at for at, _ in points), tuple(factor for _, factor in points))
        return Track.of(
            self.layout, base=self.cant_base, corner=self.corner, irregularities=irregularities, friction=friction
        )

    @model_validator(mode="after")
    def _short_form_or_segments(self) -> TrackLine:
        for key in (*SHORT, "slope"):
            if self.segments is not None and getattr(self, key) is not None:
                raise q.reject("must not be combined with segments, which have their own", key)
            if self.segments is None and getattr(self, key) is None and key != "slope":
                raise q.reject("required without segments", key)
        return self

    @model_validator(mode="after")
    def _fits(self) -> TrackLine:
        distances = [distance for distance, _ in self.friction or ()]
        if any(after - before < SUDDEN for before, after in pairwise(distances)):
            raise q.reject(f"distances must increase by at least {SUDDEN:g} m", "friction")
        if self.segments is None:
            for key in ("transition_length", "curve"):
                if getattr(self, key) <= 0.0:
                    raise q.reject("must be greater than 0 m", key)
            assert self.transition_length is not None
            if self.transition == "clothoid" and not 0.0 < self.corner <= 0.5 * self.transition_length:
                raise q.reject("must be greater than 0 m and at most half of transition_length", "corner")
        for place, cant in [("", self.cant), *((f"segments.{i}.", s.cant) for i, s in enumerate(self.segments or ()))]:
            if abs(cant or 0.0) > 0.5 * self.cant_base:
                raise q.reject("must be at most half of cant_base", f"{place}cant")
        return self

    @model_validator(mode="after")
    def _meet(self) -> TrackLine:
        from wheelrail.vehicle.track.alignment import AlignmentError, track_functions

        if self.length > LONGEST:
            raise q.reject(
                f"must have a total length of at most {LONGEST:g} m", "segments" if self.segments else "curve"
            )
        if self.irregularities is not None and self.length > MOST_WAVES * self.irregularities.wavelengths[0]:
            text = f"the shortest must be at least {self.length / MOST_WAVES:.3g} m, for at most {MOST_WAVES:g} waves"
            raise q.reject(f"{text} along the track", "irregularities.wavelengths")
        try:
            track_functions(self.layout, corner=self.corner)
        except AlignmentError as error:
            segment = self.segments[error.index] if self.segments else None
            key = "radius" if error.key == "curvature" and segment and segment.radius is not None else error.key
            raise q.reject(error.allowed, f"segments.{error.index}.{key}") from None
        if self.irregularities is not None:
            try:
                if self.irregularities.spectrum is None:
                    first = self.irregularities.irregularities(self.length).stations[0]
                elif self.irregularities.fade > self.length:
                    raise ValueError(f"must be at most the track length of {self.length:g} m")
            except ValueError as error:
                key = "fade" if self.irregularities.joints is None else "joints.at"
                raise q.reject(str(error), f"irregularities.{key}") from None
            if self.irregularities.file is not None and first >= self.length:
                text = f"begins at {first:g} m, behind the track, which ends at {self.length:g} m"
                raise q.reject(f"{text}: stations count from its beginning", "irregularities.file")
        return self
