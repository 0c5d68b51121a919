"""Interactive 3D views: the largest lateral force of a run, a contact of a study."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.scenes.datasets.run_file import is_of_wagon, read_run
from wheelrail.scenes.html_report.elements import PageNote, PageView, number
from wheelrail.scenes.html_report.figures import view
from wheelrail.scenes.plots.runs import named
from wheelrail.scenes.schema.errors import RunFailed, SceneError
from wheelrail.scenes.studies.tables import dimensions

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.scenes.studies.plan import StudyCase

CHEAP = 30.0  # s, longest solve of a study case that is repeated for its view
NO_VIEW = "No 3D view"


def run_view(data: Dataset, file: Path, name: str = "") -> PageView | PageNote:
    """View of the plane wagon's wheelset at the largest lateral force, or of a vehicle at the largest guiding forces.

    Parameters:
        data: Dataset of the run.
        file: results, for errors; of an earlier version, paths in the scene are relative to its folder.
        name: of the run, for the caption.
    """
    if is_of_wagon(data):
        return _view_or_reason(lambda: _wheelset_view(data, file, name))
    return _view_or_reason(lambda: _vehicle_view(data, file))


def _wheelset_view(data: Dataset, file: Path, name: str) -> PageView:
    from wheelrail.scenes.views.animation import Animation, largest_force
    from wheelrail.scenes.views.view import bodies_of_run

    index, wheelset = largest_force(data)
    description = _description(data, data.isel(time=index).sel(wheelset=wheelset, body=wheelset), name)
    drawn = Animation(data, bodies_of_run(data, file), wheelset, scale=1.0)
    drawn.show(float(data["time"][index]))
    drawn.view.title = description.split(":")[0]
    caption = (
        f"{description}. Above: the wheelset on its rails from behind; arrows: vertical and lateral force on the "
        "left wheel (blue) and on the right wheel (orange). Below: both contacts, patches as ellipses coloured by "
        "load. Displacement magnification factor 1."
    )
    return view(drawn.view, caption, f"The wheelset on its rails with forces and contact patches. {description}.")


def _vehicle_view(data: Dataset, file: Path) -> PageView:
    from wheelrail.scenes.plots.runs import sample_of_largest_forces
    from wheelrail.scenes.views.view import whole_vehicle

    at = data.isel(time=sample_of_largest_forces(data))
    drawn = whole_vehicle(data, file)
    drawn.show(float(at["time"]))
    drawn.view.title = description = f"Largest guiding forces, at {float(at['distance']):.1f} m"
    caption = (
        f"{description}. Above: the vehicle from behind on the right, wheels coloured by their load, bodies on top as "
        f"boxes of their inertia; below: from above. Displacement magnification factor {drawn.scale:g}."
    )
    return view(drawn.view, caption, f"The vehicle on its track, wheels coloured by their load. {description}.")


def case(data: Dataset, file: Path) -> PageView | PageNote:
    """View of one case of a study.

    Parameters:
        data: Dataset of the study.
        file: results.

    For runs the stored one with the largest peak pressure; for single contacts the one of median computing time among
    those within 30 s, which is solved again.
    """
    return _view_or_reason(lambda: _run(data, file) if data.attrs.get("scene_kind") == "run" else _contact(data))


def _run(data: Dataset, file: Path) -> PageView:
    if "kept_run" not in data.attrs:
        raise SceneError("the study contains no data of single runs; use wheelrail report with a single run")
    chosen = _cases(data)[tuple(map(int, np.atleast_1d(data.attrs["kept_case"])))]
    kept = file.parent / str(data.attrs["kept_run"])
    return _wheelset_view(read_run(kept), kept, f"run with the largest peak pressure, {chosen}")


def _contact(data: Dataset) -> PageView:
    from wheelrail.scenes.schema.scene import RunScene
    from wheelrail.scenes.views.view import view_scene

    dims = dimensions(data)
    case_seconds = data["seconds"].transpose(*dims).values
    candidates = (data["status"].transpose(*dims).values == "converged") & (case_seconds <= CHEAP)
    if not candidates.any():
        raise SceneError(f"no case converged within {CHEAP:g} s")
    cases = _cases(data)
    indices = sorted(zip(*np.nonzero(candidates), strict=True), key=lambda index: (case_seconds[index], index))
    elastic = [index for index in indices if cases[index].scene.has_elements]
    if not elastic:
        raise SceneError(f'model = "{cases[indices[0]].scene.model}" has no elastic bodies')
    chosen = cases[elastic[len(elastic) // 2]]
    assert not isinstance(chosen.scene, RunScene)
    plotter = view_scene(chosen.scene, title=str(chosen))
    caption = (
        f"Case {chosen}, solved again. Left: deformed bodies, separated, with the displacement magnification factor "
        "in the view, and pressure on the patch. Right: von Mises stress on longitudinal and lateral cuts."
    )
    return view(plotter, caption, f"Deformed bodies and stress below the contact, case {chosen}.")


def _cases(data: Dataset) -> dict[tuple[int, ...], StudyCase]:
    """Cases of the study by index."""
    from wheelrail.scenes.datasets.input_files import unpacked
    from wheelrail.scenes.studies.plan import plan
    from wheelrail.scenes.studies.schema import check_study

    study = json.loads(data.attrs["study"])
    tables = {key: value for key, value in study.items() if value is not None and key not in ("set", "without")}
    path = Path(
        study["scene"] if isinstance(study["scene"], str) else "study"
    )  # paths in the scenes of earlier versions are relative to its folder
    written = unpacked({**tables, "scene": json.loads(data.attrs["scene"])}, data.attrs, path)
    planned = plan(check_study(written, path), path)
    return {case.index: case for case in planned.cases}


def _description(data: Dataset, sample: Dataset, name: str) -> str:
    """Distance, displacements and forces of a sample of a wheelset of a run."""
    y, roll = (1e3 * float(sample[f"body_{axis}"]) for axis in ("y", "roll"))
    forces = "; ".join(
        f"{named(str(side), data)} wheel Y = {number(1e-3 * sample['lateral_force'].sel(side=side), 3)} kN, "
        f"Q = {number(1e-3 * sample['vertical_force'].sel(side=side), 3)} kN"
        for side in sample["side"].values
    )
    return (
        f"Largest lateral force{f', {name}' if name else ''}, at {float(sample['distance']):.1f} m: wheelset y = "
        f"{y:+.2f} mm ({'to the left' if y >= 0.0 else 'to the right'}), roll {roll:+.3f} mrad; {forces}"
    )


def _view_or_reason(draw: Callable[[], PageView]) -> PageView | PageNote:
    """View, or a note with the reason for its absence."""
    try:
        return draw()
    except (ImportError, OSError, RunFailed, ValueError) as error:
        reason = (str(error).splitlines() or [type(error).__name__])[0]
        return PageNote(f"{NO_VIEW}: {reason.rstrip('.')}.")
