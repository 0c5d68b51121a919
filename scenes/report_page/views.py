"""Views to turn: the hardest moment of a run, a contact of a study."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from scenes.complaint import RunFailed, SceneError
from scenes.pictures.runs import named
from scenes.report_page.drawing import view
from scenes.report_page.parts import Note, View, number
from scenes.studies.tables import dimensions

if TYPE_CHECKING:
    from xarray import Dataset

CHEAP = 30.0  # s that a case of a study may have taken to be solved once more for its view
FEW = "No three-dimensional view"


def moment(data: Dataset, file: Path, name: str = "") -> View | Note:
    """The sample of the largest lateral force; file: the results, beside which the scene's files are looked for."""
    from scenes.pictures.moment import hardest, moment_view
    from scenes.view import bodies_of_run

    def drawn() -> View:
        index = hardest(data)
        said = _said(data, index, name)
        plotter = moment_view(data, index, **bodies_of_run(data, file), title=said.split(":")[0])
        caption = (
            f"{said}. Above: the wheelset on its rails, seen from behind; arrows: vertical and lateral force on the "
            "left wheel (blue) and on the right one (orange). Below: both contacts, patches as ellipses coloured by "
            "their load. Everything true to scale, displacements included."
        )
        return view(plotter, caption, f"The wheelset on its rails with forces and contact patches. {said}.")

    return _or_why_not(drawn)


def contact(data: Dataset) -> View | Note:
    """A case of a study of single contacts that was solved quickly, the middle one of these by its time."""

    def drawn() -> View:
        from scenes.scene import RunScene
        from scenes.studies.plan import plan
        from scenes.studies.study import check_study
        from scenes.view import view_scene

        if data.attrs.get("scene_kind") == "run":
            raise SceneError("its cases are vehicle runs; wheelrail report shows that of a single one")
        again = {**json.loads(data.attrs["study"]), "scene": json.loads(data.attrs["scene"]), "set": {}, "without": []}
        planned = plan(check_study({key: value for key, value in again.items() if value is not None}))
        cases = {case.place: case for case in planned.cases}
        dims = dimensions(data)
        taken = data["seconds"].transpose(*dims).values
        good = (data["status"].transpose(*dims).values == "converged") & (taken <= CHEAP)
        if not good.any():
            raise SceneError(f"no case converged within {CHEAP:g} s")
        places = sorted(zip(*np.nonzero(good), strict=True), key=lambda place: (taken[place], place))
        case = cases[tuple(int(k) for k in places[len(places) // 2])]
        assert not isinstance(case.scene, RunScene)
        plotter = view_scene(case.scene, title=str(case))
        caption = (
            f"The case {case}, solved once more. Left: both bodies moved apart, displacements enlarged as the view "
            "says, pressure on the patch. Right: von Mises stress on cuts along and across, below the patch."
        )
        return view(plotter, caption, f"Both bodies deformed and the stress below their contact, of the case {case}.")

    return _or_why_not(drawn)


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


def _or_why_not(draw: Callable[[], View]) -> View | Note:
    """A view must not cost the page: without one there is the reason."""
    try:
        return draw()
    except (ImportError, OSError, RunFailed, ValueError) as error:
        said = (str(error).splitlines() or [type(error).__name__])[0]
        return Note(f"{FEW}: {said.rstrip('.')}.")
