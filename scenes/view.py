"""A contact scene, solved and looked at in three dimensions; a run's results as a film."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from scenes.complaint import RunFailed
from scenes.contact_scene import solve_sides
from scenes.models import laid_profiles, loaded_bodies, mounted
from scenes.scene import HertzScene, RunScene, SceneError, WheelsetScene


def view_scene(
    scene: HertzScene | WheelsetScene,
    *,
    title: str,
    body: str = "both",
    side: str | None = None,
    scale: float | None = None,
    say: Callable[[str], None] = lambda _: None,
) -> Any:
    """Solve a scene and draw one of its contacts, see `scenes.pictures.contact_view`; the plotter, off screen.

    body: "both", or one of them; side of a wheelset, its first without it; scale of the displacements, a round one
    without it. Stress and displacement are those of waveguide bodies under the tractions found, whatever the bodies
    that these were found with. Raises SceneError for what the scene has not, RunFailed when there is nothing to draw.
    """
    from contact.inside import look_inside
    from scenes.pictures.contact_view import SeenBody, contact_scene

    names = ("upper", "lower") if isinstance(scene, HertzScene) else ("wheel", "rail")
    if body not in (*names, "both"):
        raise SceneError(f"--body {body}: must be {', '.join(names)} or both")
    sides = ("contact",) if isinstance(scene, HertzScene) else scene.sides
    chosen = side or sides[0]
    if chosen not in sides:
        raise SceneError(f"--side {chosen}: must be {' or '.join(sides)}")
    if scene.model == "standard":
        raise SceneError('model = "standard": knows no bodies to look at, only with "condensed" or "full"')
    solved = dict(solve_sides(scene, say=say))[chosen]
    result, pose = solved.result, solved.pose
    if result.status != "converged" or pose is None:
        raise RunFailed(result.status)
    seen = []
    right = chosen == "right"  # which is solved as its mirror image
    for name, loaded in loaded_bodies(
        scene, pose.mirrored() if right else pose, names if body == "both" else (body,)
    ).items():
        say(f"displacement and stress in the {name}")
        inside = look_inside(loaded, result)
        main = max(range(len(result.patches)), key=lambda k: result.patches[k].normal_force)
        fields = [inside.strip(), inside.across(main), inside.along(main)]
        whole, *cuts = [found.mirrored() for found in fields] if right else fields
        seen.append(SeenBody(name, loaded.upper, whole, tuple(cuts)))
    say("drawing")
    load = 1e-3 * sum(patch.normal_force for patch in result.patches)
    where = title if chosen == "contact" else f"{title}, {chosen} wheel"
    return contact_scene(
        result, tuple(seen), title=f"{where}, {load:.4g} kN", scale=scale, mirrored=right, off_screen=True
    )


def animate_file(file: Path, out: Path, progress: Callable[[int, int], None] | None = None, **options: Any) -> None:
    """Write the film of a run's results, run.nc or its folder; options as for `scenes.pictures.animation.animate_run`.

    Raises OSError for files that cannot be read or written, SceneError for one that holds no run.
    """
    import xarray

    from scenes.pictures.animation import animate_run
    from scenes.scene import parse_scene

    found = file / "run.nc" if file.is_dir() else file
    if not found.is_file():
        raise SceneError(f"{found}: no such file; a run keeps its results in run.nc")
    try:
        data = xarray.load_dataset(found)
    except (ValueError, OSError) as error:
        raise SceneError(f"{found}: cannot be read as results of a run: {error}") from None
    if "scene" not in data.attrs or "wheelset_y" not in data:
        raise SceneError(f"{found}: holds no results of a run")
    scene = parse_scene(data.attrs["scene"], found)
    assert isinstance(scene, RunScene)
    wheel, rail = laid_profiles(scene)
    animate_run(data, out, wheel=wheel, rail=rail, mounting=mounted(scene, rail), progress=progress, **options)
