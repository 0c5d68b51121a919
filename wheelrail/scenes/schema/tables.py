"""The tables of a scene: bodies, track, wheelset, vehicle, solver, output."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    Strict,
    ValidationInfo,
    field_validator,
    model_validator,
)

from wheelrail.scenes.schema import quantities as q
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.override import overridden
from wheelrail.vehicle.track.piecewise import SHORTEST

if TYPE_CHECKING:
    from wheelrail.vehicle.track.speed_profile import SpeedProfile
    from wheelrail.vehicle.wagon.wagon import Wagon


class SceneTable(BaseModel):
    """A table of a scene: strict types, no unknown keys, immutable."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)


class BodyTable(SceneTable):
    """A body of a Hertz pair: principal radii (in x, in y) in m and its material."""

    radii: Annotated[tuple[q.Radius, q.Radius], Strict(False)]
    E: q.Young
    nu: q.Poisson


class FallingTable(SceneTable):
    """Friction decreases with the slip velocity, at a rate, s/m, to a share of its static value (Polach 2005)."""

    share: q.Share
    rate: q.FallingRate


class StressTable(SceneTable):
    """Stress in wheel and rail at depths, m, below every patch, along the normal through its resultant."""

    body: Literal["wheel", "rail", "both"] = "both"
    depths: Annotated[tuple[q.Depth, ...], Strict(False), Field(min_length=1), q.AtMost(1000)]

    @property
    def bodies(self) -> tuple[str, ...]:
        return ("wheel", "rail") if self.body == "both" else (self.body,)


class BlockStressTable(SceneTable):
    """The same in the bodies of a Hertz pair."""

    body: Literal["upper", "lower", "both"] = "both"
    depths: Annotated[tuple[q.Depth, ...], Strict(False), Field(min_length=1), q.AtMost(1000)]

    @property
    def bodies(self) -> tuple[str, ...]:
        return ("upper", "lower") if self.body == "both" else (self.body,)


class PadsTable(SceneTable):
    """Stiffness of one pad with its fastening, N/m: vertical, lateral and along the rail, by default as lateral; and
    the spacing of the sleepers, m. Pads are linear and do not lift; without the table sleepers they are spread along
    the rail.
    """

    vertical: q.PadStiffness = 100e6
    lateral: q.PadStiffness = 40e6
    longitudinal: q.PadStiffness | None = None
    spacing: q.PadSpacing = 0.6


class SleepersTable(SceneTable):
    """Discrete sleepers: length of a pad along the rail, m, and place of the wheelset, in a run at its start, along the
    track from a sleeper, m.
    """

    length: q.PadLength = 0.18
    position: q.SleeperPlace = 0.0


class BallastTable(SceneTable):
    """Sleepers that move on ballast: mass of half a sleeper, kg, vertical and lateral stiffness of the ballast under
    it, N/m, vertical damping of one pad and of the ballast under half a sleeper, N s/m, and length of a sleeper, m. In
    a run rails and sleepers have their masses.
    """

    sleeper_mass: q.SleeperMass = 150.0
    vertical: q.BallastStiffness = 80e6
    lateral: q.BallastStiffness = 40e6
    pad_damping: q.TrackDamping = 30e3
    damping: q.TrackDamping = 60e3
    length: q.SleeperLength | Literal["halves"] = 2.6


class ElasticAxleTable(SceneTable):
    """An axle that bends: a typical one of a diameter, m, or one by its drawing: steps (end from the middle, diameter),
    ends of the journal from the middle, and bore, m; weight: whether the wheelset's own weight bends it.
    """

    diameter: q.Diameter | None = None
    steps: (
        Annotated[
            tuple[Annotated[tuple[q.AxlePlace, q.Diameter], Strict(False)], ...],
            Strict(False),
            Field(min_length=1),
            q.AtMost(100),
        ]
        | None
    ) = None
    journal: Annotated[tuple[q.AxlePlace, q.AxlePlace], Strict(False)] | None = None
    bore: q.Bore = 0.0
    weight: bool = True

    @model_validator(mode="after")
    def _by_diameter_or_drawing(self) -> ElasticAxleTable:
        if self.steps is not None and self.diameter is not None:
            raise q.reject("must not be combined with steps", "diameter")
        if (self.steps is None) != (self.journal is None):
            raise q.reject("steps and journal are required together", "journal")
        return self


def _switched(value: Any) -> Any:
    """An optional table: true stands for all its defaults, false for none."""
    return {} if value is True else None if value is False else value


class SupportTable(SceneTable):
    """Pads of the rails (none: feet clamped) and sleepers, discrete, on ballast, or both."""

    pads: Annotated[PadsTable | None, BeforeValidator(_switched)] = None
    sleepers: Annotated[SleepersTable | None, BeforeValidator(_switched)] = None
    ballast: Annotated[BallastTable | None, BeforeValidator(_switched)] = None

    def require_pads(self) -> None:
        """Raises a validation error for sleepers and ballast without pads, and for pads that overlap."""
        for key in ("sleepers", "ballast"):
            if getattr(self, key) is not None and self.pads is None:
                raise q.reject("allowed only with pads, whose spacing it has", key)
        if self.sleepers is not None and self.pads is not None and self.sleepers.length > self.pads.spacing:
            raise q.reject(f"must be at most the spacing of the pads, {self.pads.spacing:g} m", "sleepers.length")


class RailsTable(SupportTable):
    """Rail positions and supports."""

    gauge: q.Gauge
    gauge_height: q.GaugeHeight

    @model_validator(mode="after")
    def _sleepers_under_pads(self) -> RailsTable:
        self.require_pads()
        return self


class OwnWheelsetTable(SupportTable):
    """Axle and track of one wheelset: missing keys are as for all wheelsets, `false` is none."""

    axle: Annotated[ElasticAxleTable | None, BeforeValidator(_switched)] = None


class TrackTable(RailsTable):
    """Position of the rails, and curvature of the track."""

    curvature: q.Curvature


class AxleTable(SceneTable):
    """Positions of the wheels on the axle, m, and the axle, rigid unless given."""

    flange_back_distance: q.FlangeBackDistance
    flange_back: q.FlangeBack
    radius: q.WheelRadius
    axle: Annotated[ElasticAxleTable | None, BeforeValidator(_switched)] = None


class WheelsetTable(AxleTable):
    """Position and motion of a wheelset, and exactly one of wheel_load, N, axle_load, N, and z, m."""

    y: q.Offset
    roll: q.Angle | Literal["solve"]
    yaw: q.Angle
    speed: q.Speed | None = None
    pitch_rate: q.Rate | None = None
    y_rate: q.Rate = 0.0
    z_rate: q.Rate = 0.0
    roll_rate: q.Rate = 0.0
    yaw_rate: q.Rate = 0.0
    wheel_load: q.WheelLoad | None = None
    axle_load: q.AxleLoad | None = None
    z: q.Offset | None = None

    @model_validator(mode="after")
    def _single_load_condition(self) -> WheelsetTable:
        conditions = [key for key in ("wheel_load", "axle_load", "z") if getattr(self, key) is not None]
        if len(conditions) != 1:
            raise q.reject(
                "exactly one of wheel_load, axle_load and z is required", conditions[-1] if conditions else "wheel_load"
            )
        if self.roll == "solve" and conditions != ["wheel_load"]:
            raise q.reject('"solve" requires wheel_load; with axle_load or z it must be a number in rad', "roll")
        return self

    @model_validator(mode="after")
    def _rolls(self) -> WheelsetTable:
        if self.speed is not None and self.pitch_rate is not None:
            rolling = self.speed / self.radius
            if not 0.0 <= self.pitch_rate <= 2.0 * rolling:
                text = f"must be from 0 to {2 * rolling:.6g} rad/s, twice pure rolling ({rolling:.6g} = speed / radius)"
                raise q.reject(text, "pitch_rate")
        return self


class VehicleTable(SceneTable):
    """Speed of the wagon, m/s, or pairs of time, s, and speed; and the wagon file, by default the Manchester wagon.

    free_speed: nothing holds the speed after the start; torques, forces and slopes change it. With a vehicle file.

    Any other key replaces the value of that name in the wagon.
    """

    model_config = ConfigDict(extra="allow")

    speed: q.RunSpeed | Annotated[tuple[q.TimeAndSpeed, ...], Strict(False), Field(min_length=1)]
    wagon: str | None = None
    free_speed: bool = False

    @field_validator("wagon")
    @classmethod
    def _readable(cls, value: str, info: ValidationInfo) -> str:
        """A file, relative to the scene's folder, as its full path."""
        from wheelrail.scenes.schema.wagon_file import load_wagon

        file = Path((info.context or {}).get("folder", "."), value)
        try:
            load_wagon(file)
        except SceneError as error:
            raise q.reject(str(error)) from None
        return str(file.resolve())

    @field_validator("speed")
    @classmethod
    def _increasing_times(
        cls, value: float | tuple[tuple[float, float], ...]
    ) -> float | tuple[tuple[float, float], ...]:
        if isinstance(value, tuple) and any(later - time < SHORTEST for (time, _), (later, _) in pairwise(value)):
            raise q.reject(f"times must increase, by at least {SHORTEST:g} s")
        return q.AtMost(10_000).check(value)

    @model_validator(mode="after")
    def _speed_at_the_start(self) -> VehicleTable:
        if self.free_speed and isinstance(self.speed, tuple):
            raise q.reject("must be a number with free_speed: the speed at the start", "speed")
        return self

    @property
    def speed_profile(self) -> float | SpeedProfile:
        """Speed or speed profile for `vehicle`."""
        if not isinstance(self.speed, tuple):
            return self.speed
        from wheelrail.vehicle.track.speed_profile import SpeedProfile

        times, speeds = zip(*self.speed, strict=True)
        return SpeedProfile.through(times, speeds)

    @property
    def first_speed(self) -> float:
        """Speed at time zero, m/s."""
        return self.speed[0][1] if isinstance(self.speed, tuple) else self.speed

    @model_validator(mode="after")
    def _wagon_keys_exist(self) -> VehicleTable:
        if self.model_extra:
            self.on(None)
        return self

    @property
    def changed(self) -> bool:
        """Whether the wagon differs from the Manchester wagon."""
        return bool(self.wagon or self.model_extra)

    def on(self, radius: float | None) -> Wagon:
        """The wagon; radius: of its wheels, m, unless its file or the scene sets another one."""
        from wheelrail.scenes.schema.wagon_file import load_wagon
        from wheelrail.vehicle.wagon.wagon import Wagon

        base = Wagon() if radius is None else _on_wheels(radius)
        wagon = base if self.wagon is None else load_wagon(self.wagon, base)
        changed: Wagon = overridden(wagon, self.model_extra or {}, also=("speed", "wagon", "free_speed"))
        return changed


@cache
def _on_wheels(radius: float) -> Wagon:
    """The Manchester wagon with another wheel radius, m."""
    from wheelrail.vehicle.wagon.wagon import Wagon

    changed: Wagon = overridden(Wagon(), {"wheelset": {"height": radius}})
    return changed


class SolverTable(SceneTable):
    """Time integration method and tolerances; workers: threads that solve the contacts."""

    method: Literal["ode23", "ode45", "rosenbrock", "rosenbrock_ends", "rosenbrock4"] = "ode23"
    rtol: q.Tolerance = 1e-3
    atol: q.Tolerance = 1e-6
    workers: q.Threads = 1


class TabulatedTable(SceneTable):
    """A table of the contact's forces, made on demand: largest y of a wheel on its rail, m, roll and yaw, rad, and
    vertical load, N, and its tolerance, the root mean square of the error over the load.
    """

    y: q.TableWidth = 5e-3
    roll: q.TableAngle = 5e-3
    yaw: q.TableAngle = 5e-3
    load: q.TableLoad = 200e3
    tolerance: q.TableTolerance = 0.02


class OutputTable(SceneTable):
    """Output: sampling interval, s (0: every accepted step), figures, and steps between checkpoints (0: none).

    shear_yield: of the steel, Pa, used only for the shakedown map.
    """

    interval: Annotated[q.Finite, q.Range(0.0, 10.0, "s")] = 0.0
    checkpoint: q.Steps = 50
    figures: bool = True
    shear_yield: q.ShearYield = 300e6


Sides = Annotated[tuple[Literal["left", "right"], ...], Strict(False), Field(min_length=1)]
