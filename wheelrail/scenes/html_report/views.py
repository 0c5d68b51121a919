"""Views to turn: the hardest moment of a run, a contact of a study."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.html_report.elements import PageNote, PageView, number
from wheelrail.scenes.html_report.figures import view
from wheelrail.scenes.plots.runs import named
from wheelrail.scenes.schema.errors import RunFailed, SceneError
from wheelrail.scenes.studies.tables import dimensions

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.scenes.studies.plan import StudyCase

CHEAP = 30.0  # s that a case of a study may have taken to be solved once more for its view
FEW = "No three-dimensional view"


def moment(data: Dataset, file: Path, name: str = "") -> PageView | PageNote:
    """The sample of the largest lateral force; file: the results, beside which the scene's files are looked for."""
    from wheelrail.scenes.views.view import bodies_of_run

    return _or_why_not(lambda: _moment(data, bodies_of_run(data, file), name))


def _moment(data: Dataset, bodies: dict[str, Any], name: str) -> PageView:
    from wheelrail.scenes.views.run_snapshot import hardest, moment_view

    index = hardest(data)
    said = _said(data, index, name)
    plotter = moment_view(data, index, **bodies, title=said.split(":")[0])
    caption = (
        f"{said}. Above: the wheelset on its rails, seen from behind; arrows: vertical and lateral force on the "
        "left wheel (blue) and on the right one (orange). Below: both contacts, patches as ellipses coloured by "
        "their load. Everything true to scale, displacements included."
    )
    return view(plotter, caption, f"The wheelset on its rails with forces and contact patches. {said}.")


def case(data: Dataset, file: Path) -> PageView | PageNote:
    """One of a study; file: the results. Of runs that whose data are kept, the one with the largest peak pressure; of
    single contacts one that was solved quickly, the middle one of these by its time, which is solved once more.
    """
    return _or_why_not(lambda: _run(data, file) if data.attrs.get("scene_kind") == "run" else _contact(data))


def _run(data: Dataset, file: Path) -> PageView:
    from wheelrail.scenes.datasets.netcdf import read
    from wheelrail.scenes.schema.scene import RunScene
    from wheelrail.scenes.views.view import bodies_of_scene

    if "kept_run" not in data.attrs:
        raise SceneError("the data of none of its runs were kept; wheelrail report shows that of a single one")
    chosen = _cases(data)[tuple(map(int, np.atleast_1d(data.attrs["kept_case"])))]
    assert isinstance(chosen.scene, RunScene)
    run = read(file.parent / str(data.attrs["kept_run"]))
    return _moment(run, bodies_of_scene(chosen.scene), f"run with the largest peak pressure, {chosen}")


def _contact(data: Dataset) -> PageView:
    from wheelrail.scenes.schema.scene import RunScene
    from wheelrail.scenes.views.view import view_scene

    dims = dimensions(data)
    taken = data["seconds"].transpose(*dims).values
    good = (data["status"].transpose(*dims).values == "converged") & (taken <= CHEAP)
    if not good.any():
        raise SceneError(f"no case converged within {CHEAP:g} s")
    cases = _cases(data)
    places = sorted(zip(*np.nonzero(good), strict=True), key=lambda place: (taken[place], place))
    elastic = [place for place in places if cases[place].scene.model != "standard"]
    if not elastic:
        raise SceneError('model = "standard" knows no bodies that deform, whose displacement and stress could be shown')
    chosen = cases[elastic[len(elastic) // 2]]
    assert not isinstance(chosen.scene, RunScene)
    plotter = view_scene(chosen.scene, title=str(chosen))
    caption = (
        f"The case {chosen}, solved once more. Left: both bodies moved apart, displacements enlarged as the view "
        "says, pressure on the patch. Right: von Mises stress on cuts along and across, below the patch."
    )
    return view(plotter, caption, f"Both bodies deformed and the stress below their contact, of the case {chosen}.")


def _cases(data: Dataset) -> dict[tuple[int, ...], StudyCase]:
    """Of the study that gave these results, by their places."""
    from wheelrail.scenes.studies.plan import plan
    from wheelrail.scenes.studies.schema import check_study

    study = json.loads(data.attrs["study"])
    given = {key: value for key, value in study.items() if value is not None and key not in ("set", "without")}
    path = Path(study["scene"] if isinstance(study["scene"], str) else "study")  # files are looked for beside it
    planned = plan(check_study({**given, "scene": json.loads(data.attrs["scene"])}, path), path)
    return {case.place: case for case in planned.cases}


def _said(data: Dataset, index: int, name: str) -> str:
    """The moment in words: where, displacements, forces."""
    now = data.isel(time=index)
    y, roll = (1e3 * float(now[f"wheelset_{axis}"]) for axis in ("y", "roll"))
    forces = "; ".join(
        f"{named(str(side), data)} wheel Y = {number(1e-3 * now['lateral_force'].sel(side=side), 3)} kN, "
        f"Q = {number(1e-3 * now['vertical_force'].sel(side=side), 3)} kN"
        for side in data["side"].values
    )
    return (
        f"Largest lateral force{f', {name}' if name else ''}, at {float(now['distance']):.1f} m: wheelset {y:+.2f} mm "
        f"to the left, roll {roll:+.3f} mrad; {forces}"
    )


def _or_why_not(draw: Callable[[], PageView]) -> PageView | PageNote:
    """A view must not cost the page: without one there is the reason."""
    try:
        return draw()
    except (ImportError, OSError, RunFailed, ValueError) as error:
        said = (str(error).splitlines() or [type(error).__name__])[0]
        return PageNote(f"{FEW}: {said.rstrip('.')}.")
