"""A run as a film: the wheelset on its rails, and both contacts close up."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.kinematics.wheelset_state import Mounting
from wheelrail.scenes.plots.style import PRESSURE_MAP
from wheelrail.scenes.plots.style import SIDES as SIDE_STYLE
from wheelrail.scenes.views.plotter import plotter, pyvista
from wheelrail.scenes.views.whole_bodies import rail_body, wheel_body, wheelset_body
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.meshes.profiles.profile import Profile


FILMS = (".mp4", ".gif")
SCALE = 20.0  # of the wheelset's displacements in the upper pane
BESIDE = 0.5  # m behind the contacts that forces are drawn
ARROW = 0.55  # m that the largest force is drawn as
TRACK = 1.6  # m of rail that is shown
STEEL, RAIL = "#b8bec6", "#8d867c"
NEAR = 0.055  # m, half the height of a close-up
BELOW, ABOVE = 0.06, 0.075  # m below and above the top of the rail that bodies are drawn to close up


def animate_run(
    data: Dataset,
    file: Path,
    *,
    wheel: Profile,
    rail: Profile,
    mounting: Mounting,
    frames: int = 120,
    fps: float = 20.0,
    scale: float = SCALE,
    progress: Callable[[int, int], None] | None = None,
) -> None:
    """Write a film (.mp4, .gif) of a run's data, see `wheelrail.scenes.datasets.run`, at so many times evenly over the
    run.

    Above the wheelset seen from behind, its y, z and roll scaled, and forces on the wheels; below both contacts in true
    measures, the patches as ellipses coloured by load. progress is told frames done and their number. Raises
    ValueError for another ending, without samples, and for fewer than one frame.
    """
    if file.suffix.lower() not in FILMS:
        raise ValueError(f"{file} must end in {' or '.join(FILMS)}")
    if frames < 1 or not fps > 0 or not scale > 0:
        raise ValueError(f"frames, fps and scale must be positive, not {frames}, {fps:g} and {scale:g}")
    if data.sizes["time"] == 0:
        raise ValueError("a run without samples has nothing to show")
    film = Animation(data, wheel, rail, mounting, scale)
    time = data["time"].values
    shown = np.searchsorted(time, np.linspace(time[0], time[-1], frames)).clip(0, len(time) - 1)
    view = film.view
    try:
        if file.suffix.lower() == ".mp4":
            view.open_movie(str(file), framerate=fps, quality=7)
        else:
            view.open_gif(str(file), fps=fps)
        for count, index in enumerate(shown):
            film.show(int(index))
            view.write_frame()
            if progress is not None:
                progress(count + 1, frames)
    finally:
        view.close()


@dataclass
class Animation:
    """The plotter of a film, its bodies made once; `show` moves them to a sample of the data."""

    data: Dataset
    wheel: Profile
    rail: Profile
    mounting: Mounting
    scale: float = SCALE
    view: Any = field(init=False)

    def __post_init__(self) -> None:
        self.view = plotter("1/2", size=(1024, 768), off_screen=True)
        values = {name: self.data[name].values for name in ("vertical_force", "lateral_force", "patch_normal_force")}
        largest = [float(np.nanmax(np.abs(v), initial=1.0)) for v in values.values()]
        self._force, self._load = max(largest[:2]), largest[2]
        self._wheels: dict[str, Any] = {}
        self._whole()
        for pane, side in zip((0, 1), SIDES, strict=True):
            self._close(pane, side)

    def show(self, index: int) -> None:
        """Move everything to a sample."""
        now = self.data.isel(time=index)
        y, z, roll = (float(now[f"wheelset_{name}"]) for name in ("y", "z", "roll"))
        pitch = float(now["wheelset_pitch"])
        s, m = self.scale, self.mounting
        self._axle.user_matrix = _pose(s * y, m.radius + s * z, s * roll, pitch)
        distance = float(self.data["distance"].values[index])
        self._sleepers.position = (-(distance % 0.6), 0.0, 0.0)
        for side in SIDES:
            sign = 1.0 if side == "left" else -1.0
            self._wheels[side].user_matrix = _pose(y, m.radius + z, roll, 0.0)
            force = now.sel(side=side)
            foot = np.array([-BESIDE, sign * m.rail_y, 0.03])
            self._arrow(f"Q {side}", foot, np.array([0.0, 0.0, float(force["vertical_force"])]))
            self._arrow(f"Y {side}", foot, np.array([0.0, float(force["lateral_force"]), 0.0]))
            self._patches(side, sign, force)
            forces = [1e-3 * float(force[f"{axis}_force"]) for axis in ("vertical", "lateral")]
            self._say(side, f"{side} wheel, true to scale    Q {forces[0]:6.1f} kN    Y {forces[1]:6.1f} kN")
        curve = float(now["curvature"])
        track = "straight" if abs(curve) < 1e-9 else f"radius {1 / abs(curve):.0f} m {'left' if curve > 0 else 'right'}"
        self._say(
            "whole",
            f"{float(self.data['time'].values[index]):7.2f} s   {distance:8.1f} m   {float(now['speed']):5.1f} m/s   "
            f"{track}\nwheelset {1e3 * y:+.2f} mm to the left, roll {1e3 * roll:+.3f} mrad, drawn x {s:g}",
        )
        self.view.render()

    def _whole(self) -> None:
        view, m = self.view, self.mounting
        view.subplot(2)
        body = wheelset_body(self.wheel, m.radius, wheel_y=m.wheel_y)
        self._axle = view.add_mesh(body, color=STEEL, smooth_shading=True, split_sharp_edges=True)
        for sign in (1.0, -1.0):
            rail = rail_body(self.rail, length=TRACK, right=sign < 0).translate((0.0, sign * m.rail_y, 0.0))
            view.add_mesh(rail, color=RAIL)
        boxes = [pyvista().Box((x - 0.13, x + 0.13, -1.3, 1.3, -0.39, -0.18)) for x in np.arange(-0.6, 1.3, 0.6)]
        self._sleepers = view.add_mesh(pyvista().merge(boxes), color="#d8d4cc")
        view.camera_position = [(-4.6, 0.3, 1.3), (0.0, 0.0, 0.42), (0.0, 0.0, 1.0)]
        view.camera.view_angle = 20.0
        self._say("whole", " ")

    def _close(self, pane: int, side: str) -> None:
        view, m = self.view, self.mounting
        sign = 1.0 if side == "left" else -1.0
        view.subplot(pane)
        rail = rail_body(self.rail, length=0.2, right=side == "right").translate((0.0, sign * m.rail_y, 0.0))
        view.add_mesh(rail.clip_closed_surface("z", origin=(0.0, 0.0, -BELOW)), color=RAIL)
        body = wheel_body(self.wheel, m.radius, right=side == "right", sector=0.35)
        body = body.clip("z", origin=(0.0, 0.0, ABOVE - m.radius)).translate((0.0, sign * m.wheel_y, 0.0))
        self._wheels[side] = view.add_mesh(body, color=STEEL, opacity=0.45, smooth_shading=True)
        middle = np.array([0.0, sign * m.rail_y, 0.0])
        view.camera_position = [middle + np.array([-1.0, 0.0, 0.12]), middle, (0.0, 0.0, 1.0)]
        view.camera.parallel_projection = True
        view.camera.parallel_scale = NEAR
        self._say(side, " ")

    def _arrow(self, name: str, foot: Array, force: Array) -> None:
        """An arrow along a force on the wheel, beside where it acts."""
        self.view.subplot(2)
        size = float(np.linalg.norm(force)) / self._force * ARROW
        if size < 1e-3:
            self.view.remove_actor(name)
            return
        way = force / np.linalg.norm(force)
        mesh = pyvista().Arrow(
            start=foot,
            direction=way,
            tip_length=min(0.5, 0.1 / size),
            tip_radius=0.03 / size,
            shaft_radius=0.012 / size,
            scale=size,
        )
        side = name.split()[1]
        self.view.add_mesh(mesh, color=SIDE_STYLE[side]["color"], name=name, reset_camera=False, render=False)

    def _patches(self, side: str, sign: float, now: Dataset) -> None:
        """Ellipses of the second moments of pressure on the rail, one for every patch."""
        load = now["patch_normal_force"].values
        self.view.subplot(SIDES.index(side))  # type: ignore[arg-type]
        found = []
        for k in np.flatnonzero(np.isfinite(load)):
            own = now.isel(patch=k)
            a, b = float(own["patch_semi_axis_x"]), float(own["patch_semi_axis_y"])
            turn = np.linspace(0, 2 * np.pi, 49)[:-1]
            place = self.rail.point(float(own["rail_s"]))
            c, s = np.cos(float(own["patch_contact_angle"])), np.sin(float(own["patch_contact_angle"]))
            y, z = sign * (self.mounting.rail_y + place[0]), place[1]
            points = np.column_stack(
                [float(own["patch_x"]) + a * np.cos(turn), y + c * b * np.sin(turn), z + s * b * np.sin(turn)]
            )
            disc = pyvista().PolyData(points + np.array([0.0, -s, c]) * 3e-4, np.array([48, *range(48)])).triangulate()
            disc["load [kN]"] = np.full(len(points), 1e-3 * load[k])
            found.append(disc)
        name = f"patches {side}"
        if not found:
            self.view.remove_actor(name)
            return
        self.view.add_mesh(
            pyvista().merge(found),
            scalars="load [kN]",
            clim=(0.0, 1e-3 * self._load),
            cmap=PRESSURE_MAP,
            lighting=False,
            name=name,
            reset_camera=False,
            render=False,
            show_scalar_bar=side == "right",
            scalar_bar_args={
                "title": "load of a patch [kN]",
                "color": "black",
                "fmt": "%.0f",
                "n_labels": 3,
                "width": 0.4,
                "height": 0.09,
                "position_x": 0.56,
                "position_y": 0.03,
            },
        )

    def _say(self, pane: str, text: str) -> None:
        self.view.subplot(2 if pane == "whole" else SIDES.index(pane))  # type: ignore[arg-type]
        self.view.add_text(text, name=f"text {pane}", font_size=9, color="black", position="upper_left", render=False)


def _pose(y: float, z: float, roll: float, pitch: float) -> Array:
    """Matrix (4, 4) that turns by the pitch about y, by the roll about x, and moves."""
    c, s, cp, sp = np.cos(roll), np.sin(roll), np.cos(pitch), np.sin(pitch)
    matrix = np.eye(4)
    matrix[:3, :3] = np.array([[1, 0, 0], [0, c, -s], [0, s, c]]) @ [[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]]
    matrix[:3, 3] = 0.0, y, z
    return matrix
