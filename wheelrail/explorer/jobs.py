"""Jobs of the explorer's worker processes: solve and describe the pictures; nothing of the page is known here."""

from __future__ import annotations

import logging
import warnings
from collections import OrderedDict
from collections.abc import Sequence
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Any, ClassVar

from wheelrail.support.worker_process import single_thread

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.api.hertz import Hertz
    from wheelrail.api.solution import Solution
    from wheelrail.api.wheelset import Wheelset
    from wheelrail.explorer.subject import Calls
    from wheelrail.explorer.views import Panel
    from wheelrail.meshes.profiles.profile import Profile

KEPT = 4  # contacts with their compliance, and as many contact geometries
GEOMETRY = ("wheel", "rail", "laying_angle", "gauge", "gauge_height", "flange_back_distance", "flange_back", "radius")


class Kept:
    """Contacts, geometries, profiles and animations that a worker process keeps from one job to the next."""

    contacts: ClassVar[OrderedDict[str, Wheelset | Hertz]] = OrderedDict()
    geometries: ClassVar[OrderedDict[str, Dataset]] = OrderedDict()
    profiles: ClassVar[dict[str, Profile]] = {}
    animations: ClassVar[dict[str, Any]] = {}  # of runs, by file
    latest: ClassVar[tuple[Calls, Solution, bool] | None] = None  # on the page, and whether settled


class Messages(logging.Handler):
    """Sends log messages of this package to the page's process."""

    def __init__(self, to: Connection) -> None:
        super().__init__(logging.INFO)
        self.to = to

    def emit(self, record: logging.LogRecord) -> None:
        self.to.send(record.getMessage())


def prepare(messages: Connection) -> None:
    """First call of a worker process; imports what the first solve would have to wait for."""
    single_thread()
    from wheelrail.explorer import subject, views  # noqa: F401
    from wheelrail.support.terminal import LOGGER

    logger = logging.getLogger(LOGGER)
    logger.addHandler(Messages(messages))
    logger.setLevel(logging.INFO)
    logger.propagate = False


def keep_profiles(profiles: dict[str, Profile]) -> None:
    """Know the profiles that are not in the library, by name."""
    Kept.profiles.update(profiles)


def solve(calls: Calls, views: Sequence[str], moving: bool = False) -> dict[str, Any]:
    """Solution of a contact for the page: status, table, values, pictures, and whether it is settled.

    Parameters:
        calls: arguments of the contact and of its `solve`.
        views: names of the pictures.
        moving: whether the solution before may serve as a start. The result is then not settled: it differs from that
            of `solve` in its last digits.

    Raises SceneError and ValueError for arguments that are not allowed.
    """
    from wheelrail.explorer.views import panels

    with warnings.catch_warnings(record=True) as unusual:
        warnings.simplefilter("always", UserWarning)
        solution, settled = _next(calls) if moving else (_solution(calls), True)
    Kept.latest = calls, solution, settled
    remarks = [str(warning.message) for warning in unusual if issubclass(warning.category, UserWarning)]
    described = _described(solution, panels(solution.data, views) if solution.ok else [], remarks)
    return {**described, "settled": settled}


def stress(calls: Calls) -> dict[str, Any]:
    """Solution with the stress below the patches."""
    from dataclasses import replace

    from wheelrail.explorer.views import DEPTHS, stress_panels

    solution = _solution(replace(calls, solve={**calls.solve, "stress": {"depths": list(DEPTHS)}}))
    return _described(solution, stress_panels(solution.data) if solution.ok else [])


def bodies(calls: Calls, folder: str) -> list[tuple[str, str]]:
    """Interactive 3D view of each side in contact: its name and HTML page.

    Parameters:
        calls: arguments.
        folder: for files meanwhile.

    Raises ValueError without contact.
    """
    from pathlib import Path

    solution = _solution(calls)
    pages = []
    for side, result in solution.results.items():
        if result.status == "converged":
            file = Path(folder, f"{side}.html")
            solution.view(side, file=file).close()
            pages.append((side, file.read_text()))
            file.unlink()
    if not pages:
        raise ValueError(f"nothing to show: {solution.status}")
    return pages


def trace(calls: Calls, quantity: str) -> dict[str, float]:
    """Value of a quantity by side, for one place of a slider; NaN where the arguments are not allowed.

    Parameters:
        calls: arguments.
        quantity: name in `wheelrail.explorer.views.TRACED`.
    """
    from wheelrail.explorer.views import traced

    try:
        return traced(_solution(calls).data, quantity)
    except ValueError:
        return {}


def geometry(calls: Calls) -> str:
    """Pictures of the contact geometry, with the present place."""
    from wheelrail.api.contact_geometry import contact_geometry
    from wheelrail.explorer.subject import with_profiles
    from wheelrail.explorer.views import as_text, geometry_panels

    own = {key: value for key, value in calls.contact.items() if key in GEOMETRY}
    for side in {"left", "right"} & calls.contact.keys():
        own[side] = {key: value for key, value in calls.contact[side].items() if key in GEOMETRY}
    key = repr(own)  # profiles that are not in the library have names with their digest
    if key not in Kept.geometries:
        Kept.geometries[key] = contact_geometry(**with_profiles(own, Kept.profiles))
        _forget(Kept.geometries)
    return as_text(geometry_panels(Kept.geometries[key], calls.solve.get("y", 0.0)))


def _next(calls: Calls) -> tuple[Solution, bool]:
    """Solution begun, for wheels at heights of their own, from the page's present one, and whether settled."""
    from wheelrail.api.wheelset import Wheelset
    from wheelrail.scenes.contacts.solve import starts
    from wheelrail.scenes.schema.scene import WheelsetScene

    latest, contact = Kept.latest, _contact(calls)
    if latest and latest[0] == calls:  # another view
        return latest[1:]
    if latest and latest[0].key == calls.key and isinstance(contact, Wheelset):
        origin = latest[1].origin
        assert origin is not None
        assert isinstance(origin.scene, WheelsetScene)
        near = starts(origin.scene, origin.sides)
        if near and (solution := contact.solved(calls.solve, near)).ok:
            return solution, False
    return _solution(calls), True


def _solution(calls: Calls) -> Solution:
    return _contact(calls).solve(**calls.solve)


def _contact(calls: Calls) -> Wheelset | Hertz:
    from wheelrail.explorer.subject import CLASSES, with_profiles

    if calls.key not in Kept.contacts:
        Kept.contacts[calls.key] = CLASSES[calls.kind](**with_profiles(calls.contact, Kept.profiles))
        _forget(Kept.contacts)
    Kept.contacts.move_to_end(calls.key)
    return Kept.contacts[calls.key]


def _forget(kept: OrderedDict[str, Any]) -> None:
    while len(kept) > KEPT:
        kept.popitem(last=False)


def _described(solution: Solution, drawn: Sequence[Panel], remarks: Sequence[str] = ()) -> dict[str, Any]:
    from wheelrail.explorer.views import as_text
    from wheelrail.scenes.contacts.table import table as table_of

    data = solution.data
    table = table_of(data)
    return {
        "status": "; ".join([solution.status, *dict.fromkeys(remarks)]),
        "ok": solution.ok,
        "table": {"head": list(table.head), "rows": [list(row) for row in table.rows if row]},
        "values": {
            name: data[name].values.tolist() for name in ("longitudinal_force", "lateral_force", "vertical_force")
        },
        "seconds": float(data["contact_seconds"].sum()),
        "panels": as_text(drawn),
    }


def frame(file: str, time: float) -> str:
    """Picture of the vehicle of a run at a time, s, as a data URI.

    Raises SceneError for a file whose vehicle cannot be drawn, ImportError without PyVista.
    """
    import base64
    import io

    from PIL import Image

    if file not in Kept.animations:
        from pathlib import Path

        from wheelrail.scenes.datasets.run_file import read_run
        from wheelrail.scenes.views.view import animation

        Kept.animations[file] = animation(read_run(Path(file)), Path(file))
    drawn = Kept.animations[file]
    drawn.show(time)
    image = io.BytesIO()
    Image.fromarray(drawn.view.screenshot(return_img=True)).save(image, "jpeg", quality=85)
    return "data:image/jpeg;base64," + base64.b64encode(image.getvalue()).decode()
