"""Contact of both wheels of a wheelset with their rails."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from wheelrail.api.arguments import check_keys, keys_of, replaced, scene_of, with_names
from wheelrail.api.solution import Solution, solved
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.scenes.builders.wheelset import (
    SideProfiles,
    element_contact,
    mounted,
    side_profiles,
    wheelset_contact,
    wheelset_state,
)
from wheelrail.scenes.contacts.solve import solve_sides
from wheelrail.scenes.schema.profiles import ProfilesTable
from wheelrail.scenes.schema.scene import WheelsetScene
from wheelrail.scenes.schema.tables import TrackTable
from wheelrail.scenes.schema.tables import WheelsetTable as Position
from wheelrail.scenes.schema.wheelset_defaults import LOADS, PROFILES, SCENE, TRACK, WHEELSET, inclination
from wheelrail.support.threads import one_more

if TYPE_CHECKING:
    from wheelrail.api.elements.wheelset_element import WheelsetElement
    from wheelrail.contact.geometry.first_contact import RigidWheelset
    from wheelrail.contact.kinematics.wheelset_state import Mounting
    from wheelrail.contact.laws.friction import FrictionLaw
    from wheelrail.contact.models.wheelset import WheelsetContact
    from wheelrail.scenes.contacts.side_solution import SideSolution
    from wheelrail.scenes.contacts.solve import Starts

SECTIONS = {"profiles": keys_of(ProfilesTable), "track": keys_of(TrackTable), "wheelset": keys_of(Position)}
OWN = [key for key in keys_of(WheelsetScene) if key not in ("kind", *SECTIONS)]
ALLOWED = [*OWN, *(key for section in SECTIONS.values() for key in section)]
GROUPS = (LOADS, ("speed", "pitch_rate"))
PLACED = {"z": 0.0, "roll": 0.0}  # an arbitrary pose, for the bodies alone


class Wheelset:
    """Both wheels of a wheelset on the rails of a track; one contact model serves two sides that are alike.

    Parameters:
        wheel, rail: name of a standard profile ("S1002"; "UIC60" or "60E1", "UIC60-benchmark"), a file, or a profile
            from `wheelrail.profile`.
        friction: coefficient of friction, 0 skips the tangential problem; or a law of `wheelrail.contact.laws` or of
            your own.
        E: Young's modulus of both bodies, Pa.
        nu: Poisson's ratio of both bodies.
        surface_size: spacing of the compliance of the bodies on the surface, m.
        laying_angle: inclination of the rail towards the track centre, rad; by default 1/40 for UIC60 and 60E1, 0 for
            all others, whose profiles are taken as inclined.
        gauge: distance between the rails, m.
        gauge_height: distance of the gauge below the top of the rails, m.
        flange_back_distance: between the wheels, m.
        flange_back: lateral position of the flange back on the wheel profile, from the rolling circle, m.
        radius: of the rolling circle, m.
        curvature: of the track, 1/m, positive to the left.
        more: further keys of a wheelset scene: model ("condensed", "full", "standard", "table"), table, laws ("exact",
            "paper"), bodies, points, strips, cells, falling, ...; left and right, {"wheel", "rail", "radius",
            "friction", ...} of one side where it differs; noise, rolling_circle, wheel_section, rail_section,
            wheel_mirror, ... of profiles from files; and defaults for the arguments of `solve`.
            axle: True for an axle of 160 mm that bends, or {"diameter", "steps", "journal", "bore", "weight"}; pads:
            True for rails on pads, or {"vertical", "lateral", "longitudinal", "spacing"}. Without them the wheels do
            not tilt against each other, and the rails are clamped at their feet. sleepers: True for pads on discrete
            sleepers, the wheelset over one of them, or {"length", "position"}; ballast: True for sleepers on ballast,
            or {"sleeper_mass", "vertical", "lateral", "pad_damping", "damping"}.

    The compliance of the bodies is computed at the first solve, and cached. Raises SceneError, a ValueError, naming
    the argument, its value and what is allowed.
    """

    def __init__(
        self,
        wheel: str | Path | Profile = PROFILES["wheel"],
        rail: str | Path | Profile = PROFILES["rail"],
        *,
        friction: float | FrictionLaw = SCENE["friction"],
        E: float = SCENE["E"],
        nu: float = SCENE["nu"],
        surface_size: float | None = None,
        laying_angle: float | None = None,
        gauge: float = TRACK["gauge"],
        gauge_height: float = TRACK["gauge_height"],
        flange_back_distance: float = WHEELSET["flange_back_distance"],
        flange_back: float = WHEELSET["flange_back"],
        radius: float = WHEELSET["radius"],
        curvature: float = TRACK["curvature"],
        **more: Any,
    ) -> None:
        check_keys("Wheelset", more, ALLOWED)
        if laying_angle is None:
            laying_angle = usual_inclination(rail)
            for side in more.keys() & {"left", "right"}:
                if isinstance(more[side], Mapping) and "rail" in more[side]:
                    more[side] = {"laying_angle": usual_inclination(more[side]["rail"]), **more[side]}
        names, self.given = with_names("Wheelset", {"wheel": wheel, "rail": rail, **more})
        self.arguments: dict[str, Any] = {
            "wheel": names.pop("wheel"),
            "rail": names.pop("rail"),
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
            **names,
        }
        self._scene({})
        self._begun = False

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
        yaw_rate: float | None = None,
        sides: Sequence[str] | None = None,
        error_estimate: bool | None = None,
        stress: Mapping[str, Any] | None = None,
    ) -> Solution:
        """Solve the contact of each wheel for a position of the wheelset and a load or a height.

        Parameters:
            y: lateral position, m, positive to the left; 0 by default.
            yaw, roll: rad; 0 by default. roll = "solve": one height and roll at which both wheels carry wheel_load;
                otherwise each wheel has its own height. With axle or pads "solve" is the default.
            wheel_load: on each wheel, N; or
            axle_load: on both wheels together, N; or
            z: height above the nominal one, m.
            speed: m/s, 10 by default.
            pitch_rate: rad/s, positive when rolling forward; pure rolling by default.
            y_rate, z_rate: m/s.
            roll_rate, yaw_rate: rad/s.
            sides: ("left",), ("right",) or both.
            error_estimate: whether to estimate errors from two solves on half as many strips and cells.
            stress: {"depths": [...] in m, "body": "wheel", "rail" or "both"}: stress below the patches.

        A load that cannot be carried gives the side status "failed: ..." and no exception. Raises SceneError.
        """
        arguments = {
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
            "yaw_rate": yaw_rate,
            "sides": sides,
            "error_estimate": error_estimate,
            "stress": stress,
        }
        return self.solved(arguments)

    def solved(self, arguments: Mapping[str, Any], near: Starts | None = None) -> Solution:
        """Solution for arguments of `solve`.

        Parameters:
            arguments: None for defaults.
            near: of `wheelrail.scenes.contacts.solve.starts`; the last digits depend on them.
        """
        scene, sides = self.solved_sides(arguments, near)
        return solved(scene, sides, self.side_profiles, replaced(self.arguments, arguments, GROUPS))

    def solved_sides(
        self, arguments: Mapping[str, Any], near: Starts | None = None
    ) -> tuple[WheelsetScene, dict[str, SideSolution]]:
        """Scene of arguments of `solve`, and the solution of each side, without a dataset. Raises SceneError."""
        scene, threads = self._scene(arguments), one_more() if self._begun else None
        sides = dict(solve_sides(scene, model=self._contact, profiles=self.side_profiles, threads=threads, near=near))
        self._begun = True  # the model's tables exist
        return scene, sides

    def element(self, *, host: Sequence[Literal["axle", "wheels", "rails"]] = ()) -> WheelsetElement:
        """Contact element for a time integration; bodies and tables are shared with this wheelset.

        Arguments of `WheelsetElement.solve` that are not given are those of this wheelset; y, z, roll and yaw are 0 m
        and 0 rad unless given here.

        Parameters:
            host: bodies whose motions the program knows and gives to `solve`: "axle", rigid wheels on its own axle, by
                the motion of their hubs; "wheels", its own flexible wheels, by the motion of their rims, which is taken
                out of the compliance of the contact; "rails", its own track, by the mean motion of the rail's section,
                which is taken out likewise.

        Raises SceneError for other names, for bodies that are also this wheelset's own, and with bodies = "solid".
        """
        from wheelrail.api.elements.wheelset_element import WheelsetElement

        position = {key: self.arguments.get(key) for key in PLACED}
        placed = {key: value if isinstance(value, float | int) else 0.0 for key, value in position.items()}
        scene = self._scene(placed)
        contact, state = element_contact(scene, self._contact, self.side_profiles, host), wheelset_state(scene)
        if host:
            from wheelrail.contact.loading.flexible_state import FlexibleState

            state = FlexibleState(**vars(state))
        return WheelsetElement(contact, self._contact.mounting.radius, state, scene.track.curvature)

    @cached_property
    def profiles(self) -> tuple[Profile, Profile]:
        """Profiles of wheel and rail of the left-hand side, the rail inclined."""
        return self.side_profiles["left"]

    @cached_property
    def side_profiles(self) -> SideProfiles:
        """Profiles of wheel and rail by side, the rails inclined."""
        return side_profiles(self._scene(PLACED))

    @cached_property
    def mounting(self) -> Mounting:
        """Positions of the wheels on the axle and of the rails in the track, m."""
        return mounted(self._scene(PLACED), self.profiles[1])

    @cached_property
    def rigid(self) -> RigidWheelset:
        """Rigid profiles of both sides and their mounting."""
        from wheelrail.scenes.builders.wheelset import rigid_wheelset

        return rigid_wheelset(self._scene(PLACED), self.side_profiles)

    @cached_property
    def _contact(self) -> WheelsetContact:
        return wheelset_contact(self._scene(PLACED), self.side_profiles)

    def _scene(self, arguments: Mapping[str, Any]) -> WheelsetScene:
        keys = replaced(self.arguments, arguments, GROUPS)
        scene = scene_of("Wheelset", "wheelset", keys, SECTIONS, self.given)
        assert isinstance(scene, WheelsetScene)
        return scene

    def __repr__(self) -> str:
        arguments = ", ".join(f"{key}={value!r}" for key, value in self.arguments.items() if value is not None)
        return f"Wheelset({arguments})"


def usual_inclination(rail: str | Path | Profile) -> float:
    """Default inclination rad of a rail: that of tracks for a standard profile that is not inclined yet."""
    if isinstance(rail, Profile):
        return inclination(rail.new or rail.name) if rail.placement.angle == 0.0 else 0.0
    return inclination(str(rail))
