"""Animation of a wheelset in a run: on its rails, and close-ups of both contacts."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.kinematics.wheelset_state import Mounting
from wheelrail.scenes.plots.style import PRESSURE_MAP
from wheelrail.scenes.plots.style import SIDES as SIDE_STYLE
from wheelrail.scenes.views.plotter import colour_bar, plotter, pyvista
from wheelrail.scenes.views.vehicle_poses import body_rotation
from wheelrail.scenes.views.whole_bodies import rail_body, wheel_body, wheelset_body
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.meshes.profiles.profile import Profile


FORMATS = (".mp4", ".gif")
SCALE = 20.0  # displacement magnification factor in the upper pane
ARROW_OFFSET = 0.5  # m, of force arrows behind the contacts
ARROW = 0.55  # m, length of the arrow of the largest force
TRACK = 1.6  # m, length of the rails
STEEL, RAIL = "#b8bec6", "#8d867c"
NEAR = 0.055  # m, half the height of a close-up
BELOW, ABOVE = 0.06, 0.075  # m below and above the top of the rail, extent of the bodies in close-ups


@dataclass(frozen=True)
class RunBodies:
    """Bodies of the animation: left-hand side, and right-hand side if different.

    Parameters:
        wheel, rail: profiles, the rail inclined.
        mounting: positions of wheels on the axle and rails in the track.
        radius: of the rolling circle, m; None: that of the mounting.
        right: bodies of the right-hand side, as left-hand ones; None where both sides are alike.
        own: those of wheelsets with a contact of their own, by name.
    """

    wheel: Profile
    rail: Profile
    mounting: Mounting
    radius: float | None = None
    right: RunBodies | None = None
    own: Mapping[str, RunBodies] = field(default_factory=dict)

    def of(self, wheelset: str) -> RunBodies:
        """Bodies of a wheelset."""
        return self.own.get(wheelset, self)

    def on(self, side: str) -> RunBodies:
        """Bodies of one side, as left-hand ones."""
        return self.right if side == "right" and self.right is not None else self

    @property
    def rolling_radius(self) -> float:
        """Radius of the rolling circle, m."""
        return self.mounting.radius if self.radius is None else self.radius


def largest_force(data: Dataset) -> tuple[int, str]:
    """Index of the sample, and the wheelset, with the largest absolute lateral force on a wheel."""
    force = np.abs(data["lateral_force"].transpose("time", "wheelset", "side").values).max(axis=2)
    index, wheelset = np.unravel_index(np.argmax(np.where(np.isfinite(force), force, -1.0)), force.shape)
    return int(index), str(data["wheelset"].values[wheelset])


def check_options(file: Path, frames: int, fps: float, scale: float) -> None:
    """Raises ValueError for options of an animation that are not allowed."""
    if file.suffix.lower() not in FORMATS:
        raise ValueError(f"{file}: must end in {' or '.join(FORMATS)}")
    if frames < 1 or not fps > 0 or not scale > 0:
        raise ValueError(f"frames, fps and scale must be positive, not {frames}, {fps:g} and {scale:g}")


class Animated(Protocol):
    """A picture of a run at any time."""

    view: Any

    def show(self, time: float) -> None:
        """Draw the run at a time, s."""


def write_frames(
    animation: Animated, file: Path, times: Sequence[float], fps: float, progress: Callable[[int, int], None] | None
) -> None:
    """Draw the frames of an animation and write the file.

    Parameters:
        animation: of the run.
        file: .mp4 or .gif.
        times: of the frames, s.
        fps: frames per second.
        progress: called with frames done and their number.
    """
    view = animation.view
    try:
        if file.suffix.lower() == ".mp4":
            view.open_movie(str(file), framerate=fps, quality=7)
        else:
            view.open_gif(str(file), fps=fps)
        for count, time in enumerate(times):
            animation.show(time)
            view.write_frame()
            if progress is not None:
                progress(count + 1, len(times))
    finally:
        view.close()


@dataclass
class Animation:
    """Plotter of an animation; bodies are meshed once, and `show` moves them to the sample at a time or after it.

    Parameters:
        data: Dataset of the run, see `wheelrail.scenes.datasets.run`.
        bodies: profiles and mounting of wheel and rail.
        wheelset: its name.
        scale: displacement magnification factor in the upper pane; the rails move with the magnified wheelset, which
            stays on them as computed.
        view: the PyVista plotter.

    Upper pane: the wheelset from behind with forces on the wheels. Lower panes: both contacts to scale, patches as
    ellipses coloured by load.
    """

    data: Dataset
    bodies: RunBodies
    wheelset: str
    scale: float = SCALE
    view: Any = field(init=False)

    def __post_init__(self) -> None:
        self.view = plotter("1/2", size=(1024, 768), off_screen=True)
        self.data, self.bodies = (
            self.data.sel(wheelset=self.wheelset, body=self.wheelset),
            self.bodies.of(self.wheelset),
        )
        values = {name: self.data[name].values for name in ("vertical_force", "lateral_force", "patch_normal_force")}
        largest = [float(np.nanmax(np.abs(v), initial=1.0)) for v in values.values()]
        self._force, self._load = max(largest[:2]), largest[2]
        self._wheels: dict[str, Any] = {}
        self._rails: list[Any] = []
        self._whole()
        for pane, side in zip((0, 1), SIDES, strict=True):
            self._close(pane, side)

    def show(self, time: float) -> None:
        """Move bodies, forces and patches to the first sample at or after a time, s."""
        sample = self.data.isel(time=min(int(np.searchsorted(self.data["time"], time)), self.data.sizes["time"] - 1))
        y, z, roll, pitch, yaw = (float(sample[f"body_{name}"]) for name in ("y", "z", "roll", "pitch", "yaw"))
        scale, mounting, distance = self.scale, self.bodies.mounting, float(sample["distance"])
        turn = pitch + distance / float(self.data.attrs["nominal_radius"])
        self._axle.user_matrix = _pose(scale * y, mounting.radius + scale * z, scale * roll, turn, scale * yaw)
        magnification = magnified(y, mounting.radius + z, roll, yaw, scale, mounting.radius)
        for rail in self._rails:
            rail.user_matrix = magnification
        self._sleepers.position = (-(distance % 0.6), 0.0, 0.0)
        for side in SIDES:
            sign = 1.0 if side == "left" else -1.0
            self._wheels[side].user_matrix = _pose(y, mounting.radius + z, roll, 0.0, yaw)
            force = sample.sel(side=side)
            start = (magnification @ [-ARROW_OFFSET, sign * self.bodies.on(side).mounting.rail_y, 0.03, 1.0])[:3]
            self._arrow(f"Q {side}", start, np.array([0.0, 0.0, float(force["vertical_force"])]))
            self._arrow(f"Y {side}", start, np.array([0.0, float(force["lateral_force"]), 0.0]))
            self._patches(side, sign, force)
            forces = [1e-3 * float(force[f"{axis}_force"]) for axis in ("vertical", "lateral")]
            self._text(side, f"{side} wheel, to scale    Q {forces[0]:6.1f} kN    Y {forces[1]:6.1f} kN")
        self._text(
            "whole",
            f"{place(sample)}\n"
            f"wheelset y = {1e3 * y:+.2f} mm ({to_side(y)}), roll {1e3 * roll:+.3f} mrad, "
            f"{'to scale' if scale == 1.0 else f'magnified x {scale:g} with its rails'}",
        )
        self.view.render()

    def _whole(self) -> None:
        view, mounting = self.view, self.bodies.mounting
        view.subplot(2)
        sides = [self.bodies.on(side) for side in SIDES]
        wheels = [wheel_body(own.wheel, own.rolling_radius, right=k == 1) for k, own in enumerate(sides)]
        body = wheelset_body(wheels[0], wheels[1], wheel_y=mounting.wheel_y)
        self._axle = view.add_mesh(body, color=STEEL, smooth_shading=True, split_sharp_edges=True)
        for sign, own in zip((1.0, -1.0), sides, strict=True):
            rail = rail_body(own.rail, length=TRACK, right=sign < 0).translate((0.0, sign * own.mounting.rail_y, 0.0))
            self._rails.append(view.add_mesh(rail, color=RAIL))
        boxes = [pyvista().Box((x - 0.13, x + 0.13, -1.3, 1.3, -0.39, -0.18)) for x in np.arange(-0.6, 1.3, 0.6)]
        self._sleepers = view.add_mesh(pyvista().merge(boxes), color="#d8d4cc")
        view.camera_position = [(-4.6, 0.3, 1.3), (0.0, 0.0, 0.42), (0.0, 0.0, 1.0)]
        view.camera.view_angle = 20.0
        self._text("whole", " ")

    def _close(self, pane: int, side: str) -> None:
        view, own = self.view, self.bodies.on(side)
        mounting = own.mounting
        sign = 1.0 if side == "left" else -1.0
        view.subplot(pane)
        rail = rail_body(own.rail, length=0.2, right=side == "right").translate((0.0, sign * mounting.rail_y, 0.0))
        view.add_mesh(rail.clip_closed_surface("z", origin=(0.0, 0.0, -BELOW)), color=RAIL)
        body = wheel_body(own.wheel, own.rolling_radius, right=side == "right", sector=0.35)
        body = body.clip("z", origin=(0.0, 0.0, ABOVE - own.rolling_radius)).translate(
            (0.0, sign * mounting.wheel_y, 0.0)
        )
        self._wheels[side] = view.add_mesh(body, color=STEEL, opacity=0.45, smooth_shading=True)
        middle = np.array([0.0, sign * mounting.rail_y, 0.0])
        view.camera_position = [middle + np.array([-1.0, 0.0, 0.12]), middle, (0.0, 0.0, 1.0)]
        view.camera.parallel_projection = True
        view.camera.parallel_scale = NEAR
        self._text(side, " ")

    def _arrow(self, name: str, start: Array, force: Array) -> None:
        """Arrow of a force on the wheel, with an offset from its point of application."""
        self.view.subplot(2)
        size = float(np.linalg.norm(force)) / self._force * ARROW
        if size < 1e-3:
            self.view.remove_actor(name)
            return
        direction = force / np.linalg.norm(force)
        mesh = pyvista().Arrow(
            start=start,
            direction=direction,
            tip_length=min(0.5, 0.1 / size),
            tip_radius=0.03 / size,
            shaft_radius=0.012 / size,
            scale=size,
        )
        side = name.split()[1]
        self.view.add_mesh(mesh, color=SIDE_STYLE[side]["color"], name=name, reset_camera=False, render=False)

    def _patches(self, side: str, sign: float, sample: Dataset) -> None:
        """Ellipses on the rail from the second moments of pressure, one per patch."""
        load, own = sample["patch_normal_force"].values, self.bodies.on(side)
        self.view.subplot(SIDES.index(side))  # type: ignore[arg-type]
        discs = []
        for k in np.flatnonzero(np.isfinite(load)):
            patch = sample.isel(patch=k)
            a, b = float(patch["patch_semi_axis_x"]), float(patch["patch_semi_axis_y"])
            angle = np.linspace(0, 2 * np.pi, 49)[:-1]
            position = own.rail.point(float(patch["rail_s"]))
            c, s = np.cos(float(patch["patch_contact_angle"])), np.sin(float(patch["patch_contact_angle"]))
            y, z = sign * (own.mounting.rail_y + position[0]), position[1]
            points = np.column_stack(
                [float(patch["patch_x"]) + a * np.cos(angle), y + c * b * np.sin(angle), z + s * b * np.sin(angle)]
            )
            disc = pyvista().PolyData(points + np.array([0.0, -s, c]) * 3e-4, np.array([48, *range(48)])).triangulate()
            disc["load [kN]"] = np.full(len(points), 1e-3 * load[k])
            discs.append(disc)
        name = f"patches {side}"
        if not discs:
            self.view.remove_actor(name)
            return
        mesh = self.view.add_mesh(
            pyvista().merge(discs),
            scalars="load [kN]",
            clim=(0.0, 1e-3 * self._load),
            cmap=PRESSURE_MAP,
            lighting=False,
            name=name,
            reset_camera=False,
            render=False,
            show_scalar_bar=False,
        )
        if side == "right":
            colour_bar(self.view, mesh.mapper, "patch load [kN]", width=0.4, position_x=0.56)

    def _text(self, pane: str, text: str) -> None:
        self.view.subplot(2 if pane == "whole" else SIDES.index(pane))  # type: ignore[arg-type]
        self.view.add_text(text, name=f"text {pane}", font_size=9, color="black", position="upper_left", render=False)


def place(sample: Mapping[Any, Any]) -> str:
    """Time, distance, speed and curve at one time in words; sample: their values by name."""
    time, distance, speed, curve = (float(sample[name]) for name in ("time", "distance", "speed", "curvature"))
    track = "straight" if abs(curve) < 1e-9 else f"radius {1 / abs(curve):.0f} m {'left' if curve > 0 else 'right'}"
    return f"{time:7.2f} s   {distance:8.1f} m   {speed:5.1f} m/s   {track}"


def to_side(y: float) -> str:
    """Side to which a lateral displacement points."""
    return "to the left" if y >= 0.0 else "to the right"


def magnified(y: float, z: float, roll: float, yaw: float, scale: float, radius: float) -> Array:
    """Matrix (4, 4) that moves wheelset and rails from the computed place to the drawn one.

    Parameters:
        y, z, roll, yaw: of the wheelset, m and rad, z of its axle.
        scale: displacement magnification factor.
        radius: height of the undisplaced axle, m.
    """
    drawn = _pose(scale * y, radius + scale * (z - radius), scale * roll, 0.0, scale * yaw)
    return np.asarray(drawn @ np.linalg.inv(_pose(y, z, roll, 0.0, yaw)))


def _pose(y: float, z: float, roll: float, pitch: float, yaw: float) -> Array:
    """Matrix (4, 4): rotation by pitch about y, then by roll about x and yaw about z, and translation."""
    matrix = np.eye(4)
    matrix[:3, :3] = body_rotation(roll, pitch, yaw)
    matrix[:3, 3] = 0.0, y, z
    return matrix
