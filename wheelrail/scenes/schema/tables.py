"""The tables of a scene: bodies, profiles, track, wheelset, vehicle, solver, output."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, Strict, ValidationInfo, field_validator, model_validator

from wheelrail.scenes.schema import quantities as q
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.override import overridden

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
    """Friction falls with the slip velocity, at a rate in s/m, to a share of what it is without slip (Polach 2005)."""

    share: q.Share
    rate: q.FallingRate


class StressTable(SceneTable):
    """Stress inside wheel and rail at depths m below every patch, along its normal under its resultant."""

    body: Literal["wheel", "rail", "both"] = "both"
    depths: Annotated[tuple[q.Depth, ...], Strict(False), Field(min_length=1)]

    @property
    def bodies(self) -> tuple[str, ...]:
        return ("wheel", "rail") if self.body == "both" else (self.body,)


class BlockStressTable(SceneTable):
    """The same inside the bodies of a Hertz pair."""

    body: Literal["upper", "lower", "both"] = "both"
    depths: Annotated[tuple[q.Depth, ...], Strict(False), Field(min_length=1)]

    @property
    def bodies(self) -> tuple[str, ...]:
        return ("upper", "lower") if self.body == "both" else (self.body,)


class ProfilesTable(SceneTable):
    """Cross-sections of wheel and rail, a name or a file each; laying_angle turns the rail to the track's centre."""

    wheel: str
    rail: str
    laying_angle: q.Angle

    @field_validator("wheel", "rail")
    @classmethod
    def _exists(cls, value: str, info: ValidationInfo) -> str:
        """A known name as it is; a file, relative to the scene's folder, as its full path.

        Whoever has a profile at hand says so in the context: then this is its name and no more.
        """
        from wheelrail.meshes.profiles.named import NAMES

        context = info.context or {}
        names = [name for name, kind in NAMES.items() if kind == info.field_name]
        if value in names or info.field_name in context.get("at_hand", ()):
            return value
        file = Path(context.get("folder", "."), value)
        if not file.exists():
            raise q.refuse(f"must be {' or '.join(names)}, or a file that exists, seen from the scene's folder")
        from wheelrail.meshes.profiles.library import load_profile

        try:
            load_profile(file.absolute(), "wheel" if info.field_name == "wheel" else "rail")
        except ValueError as error:
            raise q.refuse(str(error)) from None
        return str(file.absolute())


class RailsTable(SceneTable):
    """Position of the rails."""

    gauge: q.Gauge
    gauge_height: q.GaugeHeight


class TrackTable(RailsTable):
    """Position of the rails and curvature of the track."""

    curvature: q.Curvature


class AxleTable(SceneTable):
    """How the wheels sit on the axle, m."""

    flange_back_distance: q.FlangeBackDistance
    flange_back: q.FlangeBack
    radius: q.WheelRadius


class WheelsetTable(AxleTable):
    """Position and motion of a wheelset, and exactly one of wheel_load (N), axle_load (N) and z (m)."""

    y: q.Offset
    roll: q.Angle | Literal["solve"]
    yaw: q.Angle
    speed: q.Speed | None = None
    pitch_rate: q.Rate | None = None
    y_rate: q.Rate = 0.0
    z_rate: q.Rate = 0.0
    roll_rate: q.Rate = 0.0
    wheel_load: q.WheelLoad | None = None
    axle_load: q.AxleLoad | None = None
    z: q.Offset | None = None

    @model_validator(mode="after")
    def _one_condition(self) -> WheelsetTable:
        given = [key for key in ("wheel_load", "axle_load", "z") if getattr(self, key) is not None]
        if len(given) != 1:
            raise q.refuse(
                "exactly one of wheel_load, axle_load and z must be given", given[-1] if given else "wheel_load"
            )
        if self.roll == "solve" and given != ["wheel_load"]:
            raise q.refuse('"solve" needs wheel_load; with axle_load or z the roll must be a number in rad', "roll")
        return self

    @model_validator(mode="after")
    def _rolls(self) -> WheelsetTable:
        if self.speed is not None and self.pitch_rate is not None:
            full = self.speed / self.radius
            if not 0.0 <= self.pitch_rate <= 2.0 * full:
                text = f"must be from 0 to {2 * full:.6g} rad/s, twice pure rolling ({full:.6g} = speed / radius)"
                raise q.refuse(text, "pitch_rate")
        return self


class VehicleTable(SceneTable):
    """The wagon's speed in m/s, or pairs of a time s and the speed then, and the file that it is read from, else it is
    the Manchester wagon.

    Any other key replaces the value of that name in it.
    """

    model_config = ConfigDict(extra="allow")

    speed: q.RunSpeed | Annotated[tuple[q.TimeAndSpeed, ...], Strict(False), Field(min_length=1)]
    wagon: str | None = None

    @field_validator("wagon")
    @classmethod
    def _readable(cls, value: str, info: ValidationInfo) -> str:
        """A file, relative to the scene's folder, as its full path."""
        from wheelrail.scenes.schema.wagon_file import load_wagon

        file = Path((info.context or {}).get("folder", "."), value)
        try:
            load_wagon(file)
        except SceneError as error:
            raise q.refuse(str(error)) from None
        return str(file.resolve())

    @field_validator("speed")
    @classmethod
    def _goes_on(cls, value: float | tuple[tuple[float, float], ...]) -> float | tuple[tuple[float, float], ...]:
        if isinstance(value, tuple) and any(later <= time for (time, _), (later, _) in pairwise(value)):
            raise q.refuse("times must rise strictly")
        return value

    @property
    def drive(self) -> float | SpeedProfile:
        """The speed in the words of `vehicle`."""
        if not isinstance(self.speed, tuple):
            return self.speed
        from wheelrail.vehicle.track.speed_profile import SpeedProfile

        times, speeds = zip(*self.speed, strict=True)
        return SpeedProfile.through(times, speeds)

    @property
    def first_speed(self) -> float:
        """At time zero, m/s."""
        return self.speed[0][1] if isinstance(self.speed, tuple) else self.speed

    @model_validator(mode="after")
    def _wagon_has_them(self) -> VehicleTable:
        if self.model_extra:
            self.on(None)
        return self

    @property
    def changed(self) -> bool:
        """Whether the wagon is another than the Manchester wagon."""
        return bool(self.wagon or self.model_extra)

    def on(self, radius: float | None) -> Wagon:
        """The wagon on wheels of a radius m, where neither its file nor the scene gives another one."""
        from wheelrail.scenes.schema.wagon_file import load_wagon
        from wheelrail.vehicle.wagon.wagon import Wagon

        base = Wagon() if radius is None else _on_wheels(radius)
        read = base if self.wagon is None else load_wagon(self.wagon, base)
        found: Wagon = overridden(read, self.model_extra or {}, also=("speed", "wagon"))
        return found


@cache
def _on_wheels(radius: float) -> Wagon:
    """The Manchester wagon on others than its own."""
    from wheelrail.vehicle.wagon.wagon import Wagon

    found: Wagon = overridden(Wagon(), {"wheelset": {"height": radius}})
    return found


class SolverTable(SceneTable):
    """Time stepper and its tolerances; with two workers, the right-hand contact is solved in a process of its own."""

    method: Literal["ode23", "ode45", "rosenbrock"] = "ode23"
    rtol: q.Tolerance = 1e-3
    atol: q.Tolerance = 1e-6
    workers: Literal[1, 2] = 1


class OutputTable(SceneTable):
    """What is kept: one sample per interval s (0 keeps every accepted step), and the pictures; and the number of steps
    from one checkpoint to the next, from which `--resume` goes on (0: none).

    shear_yield Pa of the steel places the patches on the shakedown map, and does nothing else.
    """

    interval: Annotated[q.Finite, q.Range(0.0, 10.0, "s")] = 0.0
    checkpoint: q.Steps = 50
    figures: bool = True
    shear_yield: q.ShearYield = 300e6


Sides = Annotated[tuple[Literal["left", "right"], ...], Strict(False), Field(min_length=1)]
