"""The wheels of a wheelset on their rails."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from wheelrail.api.arguments import keys_of, known, replaced, scene_of
from wheelrail.api.solution import Solution, solved
from wheelrail.meshes.profiles.library import load_profile
from wheelrail.meshes.profiles.profile import Kind, Profile
from wheelrail.scenes.builders.wheelset import mounted, wheelset_contact
from wheelrail.scenes.contacts.solve import solve_sides
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import WheelsetScene
from wheelrail.scenes.schema.tables import ProfilesTable, TrackTable
from wheelrail.scenes.schema.tables import WheelsetTable as Position

if TYPE_CHECKING:
    from wheelrail.contact.kinematics.wheelset_state import Mounting
    from wheelrail.contact.models.wheelset import WheelsetContact

SECTIONS = {"profiles": keys_of(ProfilesTable), "track": keys_of(TrackTable), "wheelset": keys_of(Position)}
OWN = [key for key in keys_of(WheelsetScene) if key not in ("kind", *SECTIONS)]
ALLOWED = [*OWN, *(key for section in SECTIONS.values() for key in section)]
GROUPS = (("wheel_load", "axle_load", "z"), ("speed", "pitch_rate"))
INCLINED = 0.025  # rad, 1/40: how rails are laid that are known as they stand upright
UPRIGHT = ("60E1", "UIC60")
PLACED = {"z": 0.0, "roll": 0.0}  # any pose will do where only the bodies are asked for


class Wheelset:
    """Both wheels of a wheelset on the rails of a track; one contact model serves both sides.

    wheel, rail: a standard profile's name ("S1002"; "UIC60" or "60E1", "UIC60-benchmark"), a file, or a profile from
    `wheelrail.profile`. laying_angle rad: turns the rail towards the track's centre; 1/40 for UIC60 and 60E1, 0 for
    all others, which are taken as laid, unless given. friction: coefficient, 0 skips all tangential work. E: Young's
    modulus Pa and nu: Poisson's ratio of both. surface_size m: spacing at which the compliance of the bodies is known.
    gauge m, between the rails, measured gauge_height m below their tops; flange_back_distance m, between the wheels;
    flange_back m, its place on the wheel's profile from the rolling circle; radius m of the rolling circle; curvature
    1/m of the track, positive to the left. Further arguments are the keys of a wheelset scene: model ("condensed",
    "full", "standard"), laws ("exact", "paper"), bodies, points, strips, cells, falling, merge_distance, ...; and those
    of `solve`, which then are its defaults.

    The bodies are computed when the first contact is asked for, and kept. Raises SceneError, a ValueError, naming the
    argument, its value and what is allowed.
    """

    def __init__(
        self,
        wheel: str | Path | Profile = "S1002",
        rail: str | Path | Profile = "UIC60",
        *,
        friction: float = 0.3,
        E: float = 2.1e11,
        nu: float = 0.3,
        surface_size: float | None = None,
        laying_angle: float | None = None,
        gauge: float = 1.435,
        gauge_height: float = 0.014,
        flange_back_distance: float = 1.360,
        flange_back: float = -0.070,
        radius: float = 0.46,
        curvature: float = 0.0,
        **more: Any,
    ) -> None:
        known("Wheelset", more, ALLOWED)
        if surface_size is None and more.get("model") != "standard":
            surface_size = 1e-3
        if laying_angle is None:
            laying_angle = INCLINED if _upright(rail) else 0.0
        self._at_hand: dict[Kind, Profile] = {}
        self.arguments: dict[str, Any] = {
            "wheel": self._named("wheel", wheel),
            "rail": self._named("rail", rail),
            "friction": friction,
            "E": E,
            "nu": nu,
            "surface_size": surface_size,
            "laying_angle": laying_angle,
            "gauge": gauge,
            "gauge_height": gauge_height,
            "flange_back_distance": flange_back_distance,
            "flange_back": flange_back,
            "radius": radius,
            "curvature": curvature,
            **more,
        }
        loaded = more.keys() & set(GROUPS[0])
        self._scene({} if loaded else {"wheel_load": 57e3})

    def solve(
        self,
        *,
        y: float | None = None,
        yaw: float | None = None,
        roll: float | Literal["solve"] | None = None,
        wheel_load: float | None = None,
        axle_load: float | None = None,
        z: float | None = None,
        speed: float | None = None,
        pitch_rate: float | None = None,
        y_rate: float | None = None,
        z_rate: float | None = None,
        roll_rate: float | None = None,
        sides: Sequence[str] | None = None,
        error_estimate: bool | None = None,
        stress: Mapping[str, Any] | None = None,
    ) -> Solution:
        """The contact of each wheel where the wheelset stands: y m to the left, yaw and roll rad (0 unless given).

        Exactly one of wheel_load N on each wheel, axle_load N on both together, and the height z m over the nominal
        one. roll = "solve": with wheel_load, one height and roll for both wheels; else every wheel has a height of its
        own. speed m/s, 10 unless given; pitch_rate rad/s, positive when rolling forward, that of pure rolling unless
        given; rates y_rate and z_rate m/s, roll_rate rad/s. sides: ("left",), ("right",) or both. error_estimate: solve
        once more on half as many cells. stress: {"depths": [...] m, "body": "wheel", "rail" or "both"} below patches.

        A load that cannot be carried is a status "failed: ..." of that side and no error. Raises SceneError.
        """
        given = {
            "y": y,
            "yaw": yaw,
            "roll": roll,
            "wheel_load": wheel_load,
            "axle_load": axle_load,
            "z": z,
            "speed": speed,
            "pitch_rate": pitch_rate,
            "y_rate": y_rate,
            "z_rate": z_rate,
            "roll_rate": roll_rate,
            "sides": sides,
            "error_estimate": error_estimate,
            "stress": stress,
        }
        scene = self._scene(given)
        found = dict(solve_sides(scene, model=self._contact, profiles=self.profiles))
        return solved(scene, found, self.profiles, replaced(self.arguments, given, GROUPS))

    @cached_property
    def profiles(self) -> tuple[Profile, Profile]:
        """Profiles of wheel and rail, the rail as laid."""
        scene = self._scene(PLACED)
        try:
            wheel = self._at_hand.get("wheel") or load_profile(scene.profiles.wheel, "wheel")
            rail = self._at_hand.get("rail") or load_profile(scene.profiles.rail, "rail")
        except ValueError as error:
            raise SceneError(f"Wheelset: {error}") from error
        return wheel, rail.laid(scene.profiles.laying_angle)

    @cached_property
    def mounting(self) -> Mounting:
        """How wheels sit on the axle and rails in the track, m."""
        return mounted(self._scene(PLACED), self.profiles[1])

    @cached_property
    def _contact(self) -> WheelsetContact:
        return wheelset_contact(self._scene(PLACED), self.profiles)

    def _named(self, kind: Kind, body: str | Path | Profile) -> str:
        """The name of a body's profile; an object is kept."""
        if not isinstance(body, Profile):
            return str(body)
        if body.kind != kind:
            raise SceneError(f"Wheelset: {kind} = {body!r}: must be the profile of a {kind}")
        self._at_hand[kind] = body
        return body.name

    def _scene(self, given: Mapping[str, Any]) -> WheelsetScene:
        keys = {"y": 0.0, "yaw": 0.0, "roll": 0.0, **replaced(self.arguments, given, GROUPS)}
        if keys["friction"] != 0.0:
            keys.setdefault("speed", 10.0)
        speed, radius = keys.get("speed"), keys["radius"]
        if (
            keys.get("pitch_rate") is None
            and isinstance(speed, float | int)
            and isinstance(radius, float | int)
            and radius
        ):
            keys["pitch_rate"] = speed / radius
        scene = scene_of("Wheelset", "wheelset", keys, SECTIONS, self._at_hand)
        assert isinstance(scene, WheelsetScene)
        return scene

    def __repr__(self) -> str:
        said = ", ".join(f"{key}={value!r}" for key, value in self.arguments.items() if value is not None)
        return f"Wheelset({said})"


def _upright(rail: str | Path | Profile) -> bool:
    """Whether a rail is a standard one that has not been laid yet."""
    if isinstance(rail, Profile):
        return rail.name in UPRIGHT and rail.placement.angle == 0.0
    return str(rail) in UPRIGHT
