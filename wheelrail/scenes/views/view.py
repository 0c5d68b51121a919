"""A contact scene, solved and looked at in three dimensions; a run's results as a film."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wheelrail.scenes.builders.loaded_bodies import loaded_bodies
from wheelrail.scenes.builders.wheelset import laid_profiles, mounted
from wheelrail.scenes.contacts.solve import Say, solve_sides
from wheelrail.scenes.datasets.netcdf import read
from wheelrail.scenes.schema.errors import RunFailed, SceneError
from wheelrail.scenes.schema.scene import HertzScene, RunScene, WheelsetScene, parse_scene

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.meshes.profiles.profile import Profile
    from wheelrail.scenes.contacts.solve import SideSolution

NO_BODIES = 'model = "standard": knows no bodies to look at, only with "condensed" or "full"'


def view_scene(
    scene: HertzScene | WheelsetScene, *, title: str, side: str | None = None, say: Say = lambda _: None, **options: Any
) -> Any:
    """Solve a scene and draw one of its contacts; the plotter, off screen.

    side of a wheelset, its first without it; options as for `view_side`. Raises SceneError for what the scene has not,
    RunFailed when there is nothing to draw.
    """
    bodies_of(scene, options.get("body", "both"))
    sides = ("contact",) if isinstance(scene, HertzScene) else scene.sides
    chosen = side or sides[0]
    if chosen not in sides:
        raise SceneError(f"--side {chosen}: must be {' or '.join(sides)}")
    if scene.model == "standard":
        raise SceneError(NO_BODIES)
    solved = dict(solve_sides(scene, say=say))[chosen]
    return view_side(scene, chosen, solved, title=title, say=say, off_screen=True, **options)


def view_side(
    scene: HertzScene | WheelsetScene,
    side: str,
    solved: SideSolution,
    *,
    title: str,
    profiles: tuple[Profile, Profile] | None = None,
    body: str = "both",
    scale: float | None = None,
    off_screen: bool | None = None,
    say: Say = lambda _: None,
) -> Any:
    """Draw the contact of one side, see `wheelrail.scenes.views.contact_view`; the plotter.

    profiles of wheel and rail as laid, where they are not the scene's own; body: "both", or one of them; scale of the
    displacements, a round one without it. Stress and displacement are those of waveguide bodies under the tractions
    found, whatever the bodies that these were found with. Raises SceneError and RunFailed as `view_scene`.
    """
    from wheelrail.contact.stress.waveguide_fields import look_inside
    from wheelrail.scenes.views.contact_view import SeenBody, contact_scene

    names = bodies_of(scene, body)
    if scene.model == "standard":
        raise SceneError(NO_BODIES)
    result, pose = solved.result, solved.pose
    if result.status != "converged" or pose is None:
        raise RunFailed(result.status)
    seen = []
    right = side == "right"  # which is solved as its mirror image
    for name, loaded in loaded_bodies(scene, pose.mirrored() if right else pose, names, profiles).items():
        say(f"displacement and stress in the {name}")
        inside = look_inside(loaded, result)
        main = max(range(len(result.patches)), key=lambda k: result.patches[k].normal_force)
        fields = [inside.strip(), inside.across(main), inside.along(main)]
        whole, *cuts = [found.mirrored() for found in fields] if right else fields
        seen.append(SeenBody(name, loaded.upper, whole, tuple(cuts)))
    say("drawing")
    load = 1e-3 * sum(patch.normal_force for patch in result.patches)
    where = title if side == "contact" else f"{title}, {side} wheel"
    return contact_scene(
        result, tuple(seen), title=f"{where}, {load:.4g} kN", scale=scale, mirrored=right, off_screen=off_screen
    )


def bodies_of(scene: HertzScene | WheelsetScene, body: str) -> tuple[str, ...]:
    """Names of the bodies to be seen. Raises SceneError for one that the scene has not."""
    names = ("upper", "lower") if isinstance(scene, HertzScene) else ("wheel", "rail")
    if body not in (*names, "both"):
        raise SceneError(f"--body {body}: must be {', '.join(names)} or both")
    return names if body == "both" else (body,)


def animate_file(file: Path, out: Path, progress: Callable[[int, int], None] | None = None, **options: Any) -> None:
    """Write the film of a run's results, run.nc or its folder; options as for
    `wheelrail.scenes.views.animation.animate_run`.

    Raises OSError for files that cannot be written, SceneError for one that holds no run.
    """
    found = file / "run.nc" if file.is_dir() else file
    if not found.is_file():
        raise SceneError(f"{found}: no such file; a run keeps its results in run.nc")
    data = read_run(found)
    bodies = bodies_of_run(data, found)
    from wheelrail.scenes.views.animation import animate_run

    animate_run(data, out, progress=progress, **bodies, **options)


def read_run(file: Path) -> Dataset:
    """Raises SceneError for a file that holds no run."""
    data = read(file)
    if not isinstance(data.attrs.get("scene"), str) or not data.sizes.get("time") or "wheelset_y" not in data:
        raise SceneError(f"{file}: holds no results of a run, which wheelrail run keeps in run.nc")
    return data


def bodies_of_run(data: Dataset, file: Path) -> dict[str, Any]:
    """What to draw beside the data: profiles of wheel and rail, as laid, and the mounting, by the scene of the run.

    Raises SceneError where the scene's files are gone; file: the results, beside which they are looked for.
    """
    scene = parse_scene(data.attrs["scene"], file)
    if not isinstance(scene, RunScene):
        raise SceneError(f"{file}: holds no results of a run, which wheelrail run keeps in run.nc")
    return bodies_of_scene(scene)


def bodies_of_scene(scene: RunScene) -> dict[str, Any]:
    """The same by the scene itself."""
    wheel, rail = laid_profiles(scene)
    return {"wheel": wheel, "rail": rail, "mounting": mounted(scene, rail)}
