"""Profiles of wheel and rail in a scene: one pair for both sides, or one for each."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import PrivateAttr, Strict, ValidationInfo, field_validator, model_validator

from wheelrail.scenes.schema import quantities as q
from wheelrail.scenes.schema.laws import FrictionKey
from wheelrail.scenes.schema.messages import nearest_name
from wheelrail.scenes.schema.tables import SceneTable
from wheelrail.support.text_file import present

if TYPE_CHECKING:
    from wheelrail.meshes.profiles.profile import Kind, Profile

Side = Literal["left", "right"]
SIDES: tuple[Side, Side] = ("left", "right")
BODIES: tuple[Kind, Kind] = ("wheel", "rail")
OF_POINTS = ("section", "scale", "shift", "mirror", "flip")  # of the points of a file, after the name of the body
OF_FILES: dict[str, tuple[Kind, ...]] = {  # keys on reading a file, and the bodies that they are for
    "noise": BODIES,
    "rolling_circle": ("wheel",),
    **{f"{body}_{key}": (body,) for body in BODIES for key in OF_POINTS},
}
Shift = Annotated[tuple[q.PointShift, q.PointShift], Strict(False)]


class PairTable(SceneTable):
    """Profiles of a wheel and its rail, a name or a file each.

    laying_angle: inclination of the rail, rad. noise: RMS distance of the smoothed curves from the points of files, m,
    0 interpolates; by default the noise that is estimated from the points. rolling_circle: y of the rolling circle in
    the file of the wheel, m. wheel_section, rail_section: number of the section of a file with several ones.
    wheel_scale, ...: changes of its points, in this order: a factor, a shift of (y, z), m, and whether the signs of y
    (mirror) and z (flip) change, by default as recognised.
    """

    wheel: str | None = None
    rail: str | None = None
    laying_angle: q.Angle | None = None
    noise: q.Noise | None = None
    rolling_circle: q.RollingCircle | None = None
    wheel_section: q.Section | None = None
    rail_section: q.Section | None = None
    wheel_scale: q.PointScale | None = None
    rail_scale: q.PointScale | None = None
    wheel_shift: Shift | None = None
    rail_shift: Shift | None = None
    wheel_mirror: bool | None = None
    rail_mirror: bool | None = None
    wheel_flip: bool | None = None
    rail_flip: bool | None = None

    @field_validator("wheel", "rail")
    @classmethod
    def _exists(cls, value: str, info: ValidationInfo) -> str:
        """A standard name unchanged; a file, relative to the scene's folder, as its full path.

        The name of a profile passed as an object (`given` in the context) is not checked.
        """
        from wheelrail.meshes.profiles.named import NAMES

        context = info.context or {}
        names = [name for name, kind in NAMES.items() if kind == info.field_name]
        if value in names or value in context.get("given", ()):
            return value
        file = Path(context.get("folder", "."), value)
        if not present(file):
            near = nearest_name(value, names)
            hint = f"; did you mean {near}?" if near else ""
            raise q.reject(f"must be {' or '.join(names)}, or an existing file, relative to the scene's folder{hint}")
        return str(file.absolute())


class SideTable(PairTable):
    """Profiles, radius and friction of one side where different; other keys are those of both sides.

    radius: of the rolling circle of this wheel, m. friction: as for the scene.
    """

    radius: q.WheelRadius | None = None
    friction: FrictionKey | None = None


class ProfilesTable(PairTable):
    """Profiles of wheel and rail for both sides, with overrides in the tables left and right.

    y of every profile is positive to its field side; the right-hand pair is the mirror image of a left-hand one.
    """

    left: SideTable | None = None
    right: SideTable | None = None
    _given: dict[str, Any] = PrivateAttr(default_factory=dict)

    @model_validator(mode="after")
    def _usable(self, info: ValidationInfo) -> ProfilesTable:
        self._given.update((info.context or {}).get("given", {}))
        for key in ("wheel", "rail", "laying_angle"):
            if any(getattr(self.of(side), key) is None for side in SIDES):
                raise q.reject("required, here or in both profiles.left and profiles.right", key)
        for side in SIDES:
            own: SideTable = getattr(self, side) or SideTable()
            for body in BODIES:
                try:
                    self.profile(side, body)
                except ValueError as error:
                    raise q.reject(str(error), body if getattr(own, body) is None else f"{side}.{body}") from None
        self._check_keys_of_files()
        return self

    def _check_keys_of_files(self) -> None:
        """Raises a validation error for a key on reading files where no file is read."""
        pairs = {side: self.of(side) for side in SIDES}
        own = {f"{side}.": (getattr(self, side) or SideTable(), (pairs[side],)) for side in SIDES}
        for place, (table, on_sides) in {"": (self, tuple(pairs.values())), **own}.items():
            for key, bodies in OF_FILES.items():
                read = any(Path(str(getattr(pair, body))).is_absolute() for pair in on_sides for body in bodies)
                if getattr(table, key) is not None and not read:
                    raise q.reject(f"allowed only with a file of the {' or '.join(bodies)}", place + key)

    def of(self, side: Side) -> SideTable:
        """All keys of one side."""
        own: SideTable = getattr(self, side) or SideTable()
        shared = {key: getattr(self, key) for key in PairTable.model_fields}
        return own.model_copy(update={key: value for key, value in shared.items() if getattr(own, key) is None})

    def profile(self, side: Side, body: Kind) -> Profile:
        """Profile of a body of one side; a rail is not inclined yet.

        Raises ValueError for a file that cannot be read, and for one that is too rough.
        """
        from wheelrail.meshes.profiles.library import load_profile
        from wheelrail.meshes.profiles.measurement import require_usable

        pair = self.of(side)
        name = str(getattr(pair, body))
        profile: Profile | None = self._given.get(name)
        if profile is None:
            options = {key: getattr(pair, f"{body}_{key}") for key in OF_POINTS}
            circle = pair.rolling_circle if body == "wheel" else None
            profile = load_profile(name, body, noise=pair.noise, rolling_circle=circle, **options)
        require_usable(profile.measurement)
        return profile
