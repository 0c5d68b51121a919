"""3D view of a solved contact scene; animation of the results of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.builders.loaded_bodies import loaded_bodies
from wheelrail.scenes.builders.vehicle import vehicle_on
from wheelrail.scenes.builders.vehicle_file import parse_vehicle
from wheelrail.scenes.builders.wheelset import inclined_profiles, mounted
from wheelrail.scenes.contacts.solve import ReportProgress, solve_sides
from wheelrail.scenes.datasets.input_files import scene_of_run
from wheelrail.scenes.datasets.run_file import is_of_wagon, read_run
from wheelrail.scenes.quantity import significant
from wheelrail.scenes.schema.errors import RunFailed, SceneError
from wheelrail.scenes.schema.profiles import Side
from wheelrail.scenes.schema.scene import HertzScene, OnRails, RunScene, WheelsetScene
from wheelrail.scenes.views.plotter import pyvista

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.contact.stress.fields import BodyFields
    from wheelrail.scenes.contacts.side_solution import SideSolution
    from wheelrail.scenes.views.animation import Animated, RunBodies
    from wheelrail.scenes.views.vehicle_animation import VehicleAnimation
    from wheelrail.vehicle.multibody.vehicle import Vehicle


@dataclass(frozen=True)
class ViewOptions:
    """Options of a 3D view.

    Parameters:
        title: of the view.
        body: "both", or the name of one body.
        scale: displacement magnification factor; a round number by default.
        off_screen: whether to render without a window; by default without a display only.
        peak: upper end of the pressure's colours, MPa; the largest pressure by default.
    """

    title: str
    body: str = "both"
    scale: float | None = None
    off_screen: bool | None = None
    peak: float | None = None


NO_BODIES = 'model = "{}": contains no elastic bodies; must be "condensed" or "full"'


def view_scene(
    scene: HertzScene | WheelsetScene,
    *,
    title: str,
    side: str | None = None,
    report_progress: ReportProgress = lambda _: None,
    **options: Any,
) -> Any:
    """Solve a scene and draw one of its contacts in an off-screen plotter.

    Parameters:
        scene: to solve.
        title: of the view.
        side: "left" or "right" wheel; the first side of the scene by default.
        report_progress: called with a text at every stage.
        options: body and scale as of `ViewOptions`.

    Raises SceneError for a side or a body that the scene does not have, RunFailed without contact, ImportError without
    the extra `view`.
    """
    pyvista()  # if it is missing, it is missed before the scene is solved
    bodies_of(scene, options.get("body", "both"))
    sides = ("contact",) if isinstance(scene, HertzScene) else scene.sides
    chosen = side or sides[0]
    if chosen not in sides:
        raise SceneError(f"--side {chosen}: must be {' or '.join(sides)}")
    if not scene.has_elements:
        raise SceneError(NO_BODIES.format(scene.model))
    solved = dict(solve_sides(scene, report_progress=report_progress))
    view_options = ViewOptions(title, off_screen=True, peak=largest_pressure(solved.values()), **options)
    return view_side(scene, chosen, solved[chosen], view_options, report_progress=report_progress)


def view_side(
    scene: HertzScene | WheelsetScene,
    side: str,
    solved: SideSolution,
    options: ViewOptions,
    *,
    report_progress: ReportProgress = lambda _: None,
) -> Any:
    """Draw the contact of one side, see `wheelrail.scenes.views.contact_view`.

    Parameters:
        scene: of the contact.
        side: "left", "right" or "contact".
        solved: solution of the side.
        options: of the view.
        report_progress: called with a text at every stage.

    Stress and displacement are those of waveguide bodies under the computed tractions, for all models. Returns the
    plotter. Raises SceneError and RunFailed as `view_scene`.
    """
    from wheelrail.scenes.views.contact_view import DrawnBody, contact_scene

    names = bodies_of(scene, options.body)
    result, right = solved.result, side == "right"  # solved as its mirror image
    drawn_bodies = [
        DrawnBody(name, upper, whole, tuple(cuts))
        for name, upper, (whole, *cuts) in side_fields(scene, side, solved, names, report_progress)
    ]
    report_progress("drawing")
    load = 1e-3 * sum(patch.normal_force for patch in result.patches)
    heading = options.title if side == "contact" else f"{options.title}, {side} wheel"
    return contact_scene(
        result,
        tuple(drawn_bodies),
        title=f"{heading}, {significant(load, 4)} kN",
        scale=options.scale,
        mirrored=right,
        off_screen=options.off_screen,
        peak=options.peak,
    )


def largest_pressure(solved: Iterable[SideSolution]) -> float | None:
    """Largest pressure MPa of the cells on all sides, of which views have one scale; None without contact."""
    fields = [side.result.fields for side in solved if side.result.status == "converged"]
    return max((1e-6 * float(field.pressure.max()) for field in fields if field is not None), default=None)


def side_fields(
    scene: HertzScene | WheelsetScene,
    side: str,
    solved: SideSolution,
    names: tuple[str, ...],
    report_progress: ReportProgress = lambda _: None,
) -> Iterator[tuple[str, bool, list[BodyFields]]]:
    """Name of each body, flag of the upper one, and its fields: whole, on the lateral and longitudinal cut.

    Parameters as for `view_side`, and names of the bodies.
    Raises SceneError for the standard model, RunFailed without contact.
    """
    from wheelrail.contact.stress.waveguide_fields import internal_fields

    if not scene.has_elements:
        raise SceneError(NO_BODIES.format(scene.model))
    result, pose = solved.result, solved.pose
    if result.status != "converged" or pose is None:
        raise RunFailed(result.status)
    right = side == "right"  # solved as its mirror image
    own_pose = pose.mirrored() if right else pose
    for name, loaded in loaded_bodies(scene, own_pose, names, "right" if right else "left").items():
        report_progress(f"displacement and stress in the {name}")
        internal = internal_fields(loaded, result)
        main_patch = max(range(len(result.patches)), key=lambda k: result.patches[k].normal_force)
        fields = [internal.strip(), internal.across(main_patch), internal.along(main_patch)]
        yield name, loaded.upper, [field.mirrored() for field in fields] if right else fields


def bodies_of(scene: HertzScene | WheelsetScene, body: str) -> tuple[str, ...]:
    """Names of the bodies to draw. Raises SceneError for one that the scene does not have."""
    names = ("upper", "lower") if isinstance(scene, HertzScene) else ("wheel", "rail")
    if body not in (*names, "both"):
        raise SceneError(f"--body {body}: must be {', '.join(names)} or both")
    return names if body == "both" else (body,)


def animate_file(file: Path, out: Path, progress: Callable[[int, int], None] | None = None, **options: Any) -> None:
    """Write an animation of the results of a run.

    Parameters:
        file: run.nc or its folder.
        out: .mp4 or .gif.
        progress, options: as for `animate_data`.

    Raises OSError for a file that cannot be written, SceneError for one without results of a run.
    """
    results = file / "run.nc" if file.is_dir() else file
    animate_data(read_run(results), results, out, progress, **options)


def animate_data(
    data: Dataset,
    file: Path,
    out: Path,
    progress: Callable[[int, int], None] | None = None,
    *,
    frames: int = 120,
    fps: float = 20.0,
    scale: float | None = None,
) -> None:
    """Write an animation of a run: of the plane wagon its wheelset, of another vehicle all bodies.

    Parameters:
        data: its Dataset.
        file: results, for errors; of an earlier version, paths in the scene are relative to its folder.
        out: .mp4 or .gif.
        progress: called with frames done and their number.
        frames: their number, evenly spaced in time.
        fps: frames per second.
        scale: displacement magnification factor; None: 20 for the wheelset of the plane wagon, 10 for a vehicle.

    Raises SceneError if files of the scene are missing, ValueError for options that are not allowed.
    """
    from wheelrail.scenes.views.animation import check_options, write_frames

    check_options(out, frames, fps, 1.0 if scale is None else scale)
    drawn = animation(data, file, **({} if scale is None else {"scale": scale}))
    first, last = data["time"].values[[0, -1]].tolist()
    write_frames(drawn, out, np.linspace(first, last, frames).tolist(), fps, progress)


def animation(data: Dataset, file: Path, **options: float) -> Animated:
    """Picture of a run at any time: of the plane wagon its wheelset, of another vehicle all bodies.

    Parameters:
        data: Dataset of the run.
        file: results, as for `bodies_of_run`.
        options: scale, the displacement magnification factor.
    """
    from wheelrail.scenes.views.animation import Animation

    if is_of_wagon(data):
        return Animation(data, bodies_of_run(data, file), str(data["wheelset"].values[0]), **options)
    return whole_vehicle(data, file, **options)


def whole_vehicle(data: Dataset, file: Path, **options: float) -> VehicleAnimation:
    """All bodies of a run on their track.

    Parameters:
        data: Dataset of the run.
        file: results, as for `bodies_of_run`.
        options: scale of `VehicleAnimation`.
    """
    from wheelrail.scenes.views.vehicle_animation import VehicleAnimation

    scene = scene_of_run(data, file)
    return VehicleAnimation(data, bodies_of_scene(scene), vehicle_of_run(data, file), scene.track.track(), **options)


def vehicle_of_run(data: Dataset, file: Path) -> Vehicle:
    """Vehicle of a run, from its text in the results or the wagon of the scene; parameters and errors as
    `bodies_of_run`.
    """
    text = data.attrs["vehicle"]
    vehicle = parse_vehicle(text, file) if text else vehicle_on(scene_of_run(data, file))
    for name, own in (("body", vehicle.names), ("wheelset", vehicle.wheelsets)):
        if (expected := list(own)) != data[name].values.tolist():
            raise SceneError(f"{file}: {name}: must be those of its vehicle, {', '.join(expected)}")
    return vehicle


def bodies_of_run(data: Dataset, file: Path) -> RunBodies:
    """Profiles of wheel and inclined rail and the mounting; parameters and errors as for `scene_of_run`."""
    return bodies_of_scene(scene_of_run(data, file))


def bodies_of_scene(scene: RunScene) -> RunBodies:
    """The same from the scene itself."""
    own = {one: _bodies(contact) for contact in (scene.contacts or {}).values() for one in contact.wheelsets}
    return replace(_bodies(scene), own=own)


def _bodies(scene: OnRails) -> RunBodies:
    from wheelrail.scenes.views.animation import RunBodies

    def bodies(side: Side) -> RunBodies:
        wheel, rail = inclined_profiles(scene, side)
        return RunBodies(wheel, rail, mounted(scene, rail), scene.side(side).radius)

    return bodies("left") if scene.sides_alike else replace(bodies("left"), right=bodies("right"))
