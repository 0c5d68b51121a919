"""Animation of a run: all bodies on the track with its curves and cant, wheels coloured by load."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.scenes.plots.style import PRESSURE_MAP
from wheelrail.scenes.plots.style import SIDES as SIDE_STYLE
from wheelrail.scenes.views.animation import RAIL, STEEL, RunBodies, place
from wheelrail.scenes.views.plotter import colour_bar, plotter, pyvista
from wheelrail.scenes.views.vehicle_poses import DrawnVehicle, body_rotation, equal_box
from wheelrail.scenes.views.whole_bodies import AXLE, wheel_body
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.vehicle.multibody.vehicle import Vehicle, VehicleBody
    from wheelrail.vehicle.track.track import Track

SCALE = 10.0  # displacement magnification factor
BEYOND = 4.0  # m of track before the first and behind the last wheelset
STATION = 0.4  # m between sections of the rails
SLEEPERS = 0.6  # m between sleepers
SLEEPER = np.array([[-0.13, -1.3, -0.36], [0.13, 1.3, -0.18]])  # m, corners from the middle of the track
BEAM = 0.18  # m, width and height of the beams of frames
FRAME, SHELL, TIES = "#5d7f9e", "#9db4c8", "#d8d4cc"
COORDINATES = ("x", "y", "z", "roll", "pitch", "yaw")
WHEEL_LOAD = "wheel load Q [kN]"


@dataclass
class VehicleAnimation:
    """Plotter of an animation of a vehicle; `show` moves bodies and track to a time.

    Parameters:
        data: Dataset of the run, see `wheelrail.scenes.datasets.run`.
        bodies: profiles and mounting of wheel and rail.
        vehicle, track: of the run.
        scale: displacement magnification factor.
        view: the PyVista plotter.

    Above: the vehicle from behind on the right; below: from above. Frames and shells stand for bodies, with the sizes
    of `equal_box`. Coordinates and forces are linear in time between samples of the data.
    """

    data: Dataset
    bodies: RunBodies
    vehicle: Vehicle
    track: Track
    scale: float = SCALE
    view: Any = field(init=False)

    def __post_init__(self) -> None:
        self.view = plotter("1/1", size=(1280, 960), off_screen=True)
        self.drawn = DrawnVehicle(self.vehicle, self.track, self.scale)
        places = [self.vehicle.bodies[name].x for name in self.vehicle.wheelsets]
        self._ends = min(places) - BEYOND, max(places) + BEYOND
        load = self.data["vertical_force"].values
        self._loads = 0.0, 1e-3 * float(np.nanmax(load, initial=1.0))
        self._time = self.data["time"].values
        self._coordinates = np.stack([self.data[f"body_{name}"].values for name in COORDINATES], axis=-1)
        self._actors: dict[str, list[Any]] = {name: [] for name in self.vehicle.bodies}
        self._wheels: dict[tuple[str, str], list[Any]] = {}
        self._outlines = {side: self._outline(side) for side in SIDES}
        self._rails = {side: self._rail(outline) for side, outline in self._outlines.items()}
        self._sleepers = pyvista().PolyData(np.zeros((8 * len(self._sleeper_places(0.0)), 3)), self._sleeper_faces())
        centre = 0.5 * (self._ends[0] + self._ends[1])
        half = 0.5 * (self._ends[1] - self._ends[0])
        for pane in (1, 0):  # above: from behind on the right; below: from above
            self.view.subplot(pane)
            self._draw_bodies(shell=pane == 1)
            if pane == 1:
                eye = [centre - 1.45 * half, -1.15 * half, 0.62 * half]
                self.view.camera_position = [eye, (centre - 0.06 * half, 0.0, 0.7), (0.0, 0.0, 1.0)]
                self.view.camera.view_angle = 28.0
            else:
                self.view.camera_position = [(centre, 0.0, 60.0), (centre, 0.0, 0.0), (0.0, 1.0, 0.0)]
                self.view.camera.parallel_projection = True
                self.view.camera.parallel_scale = 0.42 * half
            self.view.add_axes(viewport=(0.0, 0.02, 0.13, 0.28), line_width=3)
        self.view.subplot(1)
        mesh = next(iter(self._wheels.values()))[0]
        colour_bar(self.view, mesh.mapper, WHEEL_LOAD, width=0.3, position_x=0.66)

    def show(self, time: float) -> None:
        """Move everything to a time, s."""
        distance = float(np.interp(time, self._time, self.data["distance"].values))
        coordinates = self._at(time, self._coordinates)
        poses = self.drawn.poses(distance, coordinates)
        load, spin = 1e-3 * self._at(time, self.data["vertical_force"].values), distance / self.vehicle.radius
        for i, (name, body) in enumerate(self.vehicle.bodies.items()):
            matrix = np.eye(4)
            matrix[:3, :3], matrix[:3, 3] = poses.axes[i], poses.position[i]
            if body.wheelset:
                turn = np.eye(4)
                turn[:3, :3] = body_rotation(0.0, spin % (2 * np.pi), 0.0)
                matrix = matrix @ turn
            for actor in self._actors[name]:
                actor.user_matrix = matrix
        for k, name in enumerate(self.vehicle.wheelsets):
            for s, side in enumerate(SIDES):
                for actor in self._wheels[name, side]:
                    actor.mapper.dataset[WHEEL_LOAD][:] = load[k, s]
                    actor.mapper.dataset.Modified()
        self._move_track(distance)
        self._texts(time, distance, load)
        self.view.render()

    def _at(self, time: float, values: Array) -> Array:
        """Values at a time, linear between the samples."""
        k = int(np.clip(np.searchsorted(self._time, time) - 1, 0, max(len(self._time) - 2, 0)))
        if len(self._time) == 1:
            return np.asarray(values[0])
        part = (time - self._time[k]) / (self._time[k + 1] - self._time[k])
        return np.asarray((1.0 - part) * values[k] + part * values[k + 1])

    def _draw_bodies(self, *, shell: bool) -> None:
        """Add all bodies and the track to the present pane; shell: bodies on top as translucent boxes, else edges."""
        view, carried = self.view, {e.lower for e in self.vehicle.elements.values() if e.carries}
        for rail in self._rails.values():
            view.add_mesh(rail, color=RAIL)
        view.add_mesh(self._sleepers, color=TIES)
        for name, body in self.vehicle.bodies.items():
            if body.wheelset:
                self._draw_wheelset(name, body)
                continue
            length, width, height = equal_box(body)
            if name in carried:
                mesh = frame(length, self._beams(name, 0.5 * width))
                self._actors[name].append(view.add_mesh(mesh, color=FRAME))
                continue
            box = pyvista().Box((-length / 2, length / 2, -width / 2, width / 2, -height / 2, height / 2))
            if shell:
                self._actors[name].append(view.add_mesh(box, color=SHELL, opacity=0.3))
            edges = box.extract_all_edges()
            self._actors[name].append(view.add_mesh(edges, color="#44586b", line_width=1.5))

    def _beams(self, name: str, half_width: float) -> float:
        """Lateral distance m of the beams of a frame from its middle: that of its elements."""
        sides = [
            abs(e.point[1]) for e in self.vehicle.elements.values() if name in (e.upper, e.lower) and e.point[1] != 0.0
        ]
        return float(np.mean(sides)) if sides else half_width

    def _draw_wheelset(self, name: str, body: VehicleBody) -> None:
        view, wheel_y = self.view, self.bodies.mounting.wheel_y
        axle = pyvista().Cylinder(direction=(0.0, 1.0, 0.0), radius=AXLE, height=2 * wheel_y + 0.35, resolution=24)
        self._actors[name].append(view.add_mesh(axle, color=STEEL))
        for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
            own = self.bodies.of(name).on(side)
            mesh = wheel_body(own.wheel, own.rolling_radius, right=side == "right").translate((0, sign * wheel_y, 0))
            mesh[WHEEL_LOAD] = np.zeros(mesh.n_points)
            actor = view.add_mesh(mesh, scalars=WHEEL_LOAD, clim=self._loads, cmap=PRESSURE_MAP, show_scalar_bar=False)
            self._actors[name].append(actor)
            self._wheels.setdefault((name, side), []).append(actor)
            mark = pyvista().Box((-0.03, 0.03, -0.09, 0.09, 0.1, body.height - 0.06))  # shows that the wheel turns
            self._actors[name].append(view.add_mesh(mark.translate((0, sign * wheel_y, 0)), color="#30363c"))

    def _outline(self, side: str) -> Array:
        """Closed outline (m, 2) m of a rail from the middle of the track."""
        from wheelrail.meshes.bodies.outlines import rail_outline

        own, sign = self.bodies.on(side), 1.0 if side == "left" else -1.0
        outline = rail_outline(own.rail, chord_error=2e-3).polygon(0.02) * [sign, 1.0]
        return np.asarray(np.vstack([outline, outline[:1]]) + np.array([sign * own.mounting.rail_y, 0.0]))

    def _rail(self, outline: Array) -> Any:
        """Rail as a grid of its outline at stations along the track, which `show` places."""
        shape = len(self._stations()), len(outline), 1
        return pyvista().StructuredGrid(*(np.zeros(shape) for _ in range(3)))

    def _stations(self) -> Array:
        first, last = self._ends
        return np.linspace(first, last, int((last - first) / STATION) + 1, dtype=np.float64)

    def _sleeper_places(self, distance: float) -> Array:
        """Places m of the sleepers along the vehicle; their number is the same everywhere."""
        first, last = self._ends
        count = int((last - first) / SLEEPERS)
        start = np.ceil((distance + first) / SLEEPERS) * SLEEPERS - distance
        return np.asarray(start + SLEEPERS * np.arange(count))

    def _sleeper_faces(self) -> Array:
        corners = np.array(
            [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]], dtype=np.int64
        )
        faces = [np.hstack([np.full((6, 1), 4), corners + 8 * k]) for k in range(len(self._sleeper_places(0.0)))]
        return np.asarray(np.concatenate(faces).ravel())

    def _move_track(self, distance: float) -> None:
        stations = self.drawn.sections.at(distance + self._stations(), distance)
        for side, rail in self._rails.items():
            outline = np.column_stack([np.zeros(len(self._outlines[side])), self._outlines[side]])
            points = stations.position[:, None] + np.einsum("ncd,md->nmc", stations.axes, outline)
            rail.points = points.transpose(1, 0, 2).reshape(-1, 3)
        places = self.drawn.sections.at(distance + self._sleeper_places(distance), distance)
        corners = np.array(
            [[SLEEPER[i, 0], SLEEPER[j, 1], SLEEPER[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)]
        )
        self._sleepers.points = (places.position[:, None] + np.einsum("ncd,md->nmc", places.axes, corners)).reshape(
            -1, 3
        )

    def _texts(self, time: float, distance: float, load: Array) -> None:
        """State in words, and the names of the rails where the track ends."""
        size = "to scale" if self.scale == 1.0 else f"magnified x {self.scale:g}"
        names = ("distance", "speed", "curvature", "lift")
        now = {name: np.interp(time, self._time, self.data[name].values) for name in names} | {"time": time}
        self.view.subplot(1)
        self._text(
            "whole",
            f"{place(now)}, cant {1e3 * abs(float(now['lift'])):.0f} mm\n"
            f"displacements {size}; x forward, y to the left, z upwards; "
            f"wheel loads {np.nanmin(load):.1f} to {np.nanmax(load):.1f} kN",
        )
        front = self.drawn.sections.at(np.array([distance + self._ends[1]]), distance)
        y = self.bodies.mounting.rail_y
        for pane in (0, 1):
            self.view.subplot(pane)
            for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
                end = front.position[0] + front.axes[0] @ [0.3, sign * (y + 0.5), 0.1]
                self.view.add_point_labels(
                    end[None],
                    [side],
                    name=f"{side} {pane}",
                    text_color=SIDE_STYLE[side]["color"],
                    font_size=18,
                    shape=None,
                    show_points=False,
                    always_visible=True,
                    render=False,
                )
        self.view.subplot(0)
        self._text("plan", f"from above, the vehicle moves to the right; displacements {size}")

    def _text(self, name: str, text: str) -> None:
        self.view.add_text(text, name=f"text {name}", font_size=10, color="black", position="upper_left", render=False)


def frame(length: float, beams: float) -> Any:
    """Frame of two beams along x and one across.

    Parameters:
        length: of the beams, m.
        beams: m, lateral distance of the beams from the middle.
    """
    half = 0.5 * BEAM
    boxes = [pyvista().Box((-0.5 * length, 0.5 * length, y - half, y + half, -half, half)) for y in (beams, -beams)]
    return pyvista().merge([*boxes, pyvista().Box((-BEAM, BEAM, -beams, beams, -half, half))])
