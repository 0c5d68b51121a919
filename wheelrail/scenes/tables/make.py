"""Construction of a table of contact forces of a scene, with progress, in several processes."""

from __future__ import annotations

import hashlib
import json
import logging
from collections.abc import Sequence
from concurrent.futures import Executor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict, dataclass, field
from operator import itemgetter
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.tables.store import TaskStore, task_key
from wheelrail.scenes.builders.table import pair_identity
from wheelrail.scenes.builders.wheelset import mounted, side_profiles
from wheelrail.scenes.datasets.result_table import Column, Results, ResultTable
from wheelrail.scenes.runs.resume import sources
from wheelrail.scenes.schema.errors import RunFailed, SceneError
from wheelrail.scenes.schema.profiles import SIDES, Side
from wheelrail.scenes.schema.scene import RunScene, WheelsetScene
from wheelrail.scenes.schema.toml import read_text
from wheelrail.scenes.studies.workers import LOST, processes
from wheelrail.scenes.tables.work import sampler, task_rows
from wheelrail.support.terminal import ProgressTimer
from wheelrail.support.text_file import read_bytes

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.contact.models.table.force_table import ForceTable
    from wheelrail.contact.tables.errors import TableErrors
    from wheelrail.contact.tables.table_range import TableRange
    from wheelrail.contact.tables.tasks import Task
    from wheelrail.support.arrays import Array

MOST = 1000.0  # MB, of a file of the scene
log = logging.getLogger(__name__)


@dataclass(frozen=True)
class TableOrder:
    """Specification of a force table.

    Parameters:
        scene: of a wheelset or a run.
        file: of the scene.
        ranges: of the variables.
        tolerance: of the root mean square of the error over the vertical load.
        workers: number of processes.
    """

    scene: WheelsetScene | RunScene
    file: Path
    ranges: TableRange
    tolerance: float
    workers: int = 2

    @property
    def sides(self) -> tuple[Side, ...]:
        """Sides that need a table of their own."""
        return SIDES[:1] if self.scene.sides_alike else SIDES

    def check(self) -> None:
        """Raises SceneError for scenes whose contact is no function of pose and creepages."""
        if self.scene.model == "table":
            raise SceneError(f'{self.file}: model = "table": must be a model that solves')
        if self.scene.is_flexible:
            raise SceneError(f"{self.file}: elastic axle and pads are not allowed: forces depend on both wheels")


@dataclass
class TableWork:
    """Solution of the missing tasks of one side in worker processes.

    Parameters:
        order: scene.
        side: left or right.
        store: of results.
        executor: of the processes.
        solved: number of tasks solved here.
    """

    order: TableOrder
    side: Side
    store: TaskStore
    executor: Executor
    solved: int = field(init=False, default=0)

    def __call__(self, tasks: Sequence[Task], purpose: str) -> list[Array]:
        """Rows of tasks in their order."""
        keys = [task_key(self.side, task) for task in tasks]
        missing = {key: task for key, task in zip(keys, tasks, strict=True) if self.store.get(key) is None}
        if missing:
            log.info("%s: %s, %d to solve", self.side, purpose, len(missing))
            self._solve(missing, f"{self.side}: {purpose}")
        return [np.array(self.store.get(key)) for key in keys]

    def _solve(self, tasks: dict[str, Task], purpose: str) -> None:
        running = {
            self.executor.submit(task_rows, self.order.file, self.side, task): key for key, task in tasks.items()
        }
        progress = ProgressTimer(log, purpose)
        for count, future in enumerate(as_completed(running), 1):
            try:
                rows = future.result()
            except BrokenProcessPool:
                raise RunFailed(f"{LOST}; solves are stored, the same command continues") from None
            self.store.save(running[future], rows)
            self.solved += 1
            progress(count, len(running))


def make_table(order: TableOrder, out: Path) -> Dataset:
    """Compute a force table and write the file; the same call after an interruption continues.

    Parameters:
        order: what to make.
        out: file of results; the solves are stored beside it, in `out.solves`.

    Progress is logged. Raises SceneError, RunFailed, OSError.
    """
    from wheelrail.contact.tables.builder import NoSolution, TableBuilder
    from wheelrail.scenes.datasets.force_table import table_dataset
    from wheelrail.scenes.datasets.netcdf import provenance, write

    order.check()
    profiles, start = side_profiles(order.scene), monotonic()
    pairs = {
        side: pair_identity(order.scene, side, profiles[side], mounted(order.scene, profiles[side][1]))
        for side in order.sides
    }
    content = json.dumps(_content(order), sort_keys=True)
    store = TaskStore(solves_file(out), hashlib.sha256(f"{content} {sources()}".encode()).hexdigest())
    if len(store):
        log.info("%d tasks are already solved", len(store))
    tables: dict[str, ForceTable] = {}
    errors: dict[str, TableErrors] = {}
    solved = 0
    with processes(order.workers) as executor:
        for side in order.sides:
            work = TableWork(order, side, store, executor)
            builder = TableBuilder(sampler(order.scene, side), order.ranges, order.tolerance, work)
            try:
                tables[side], errors[side] = builder.build()
            except NoSolution as error:
                raise RunFailed(f"{side}: {error}; a narrower range may help") from None
            solved += work.solved
    attributes = {
        "title": "Table of wheel-rail contact forces",
        "pairs": json.dumps(pairs),
        "scene": read_text(order.file),
        **{key: json.dumps(value) for key, value in _content(order).items()},
        "tolerance": order.tolerance,
        "reached": int(all(own.rms <= order.tolerance for own in errors.values())),
        "seconds": monotonic() - start,
        "tasks": solved,
        **provenance(),
    }
    data = table_dataset(tables, errors, attributes)
    write(data, out)
    return data


def solves_file(out: Path) -> Path:
    """File of the solves of a table."""
    return out.with_name(f"{out.name}.solves")


def _content(order: TableOrder) -> dict[str, Any]:
    """Keys of the scene that forces depend on, text of its files, and ranges."""
    scene = order.scene.model_dump(
        mode="json", exclude={"vehicle", "solver", "output", "kick", "torque", "force", "stress", "sides"}
    )
    names = {str(value) for table in _tables(scene["profiles"]) for value in table.values()}
    files = {
        name: read_bytes(name, MOST, "a file").decode(errors="replace") for name in names if Path(name).is_absolute()
    }
    return {"model": scene, "files": files, "ranges": asdict(order.ranges)}


def _tables(profiles: dict[str, Any]) -> list[dict[str, Any]]:
    return [profiles, *(own for side in SIDES if isinstance(own := profiles.get(side), dict))]


def table_results(data: Dataset, file: Path) -> Results:
    """Nodes and errors of a table by side and component; file: where it is."""
    rows, lines, nodes = [], [], {}
    for side in str(data.attrs["sides"]).split():
        sizes = {kind: data[f"{side}_{kind}_values"].shape[:-1] for kind in ("normal", "friction")}
        shape, friction = (" x ".join(map(str, own)) for own in sizes.values())
        error = data[f"{side}_force_error"].values
        failed = int(np.isnan(error[:, 0]).sum())
        nodes[side] = {**sizes, "checked": len(error), "unsolved": failed}
        lines.append(f"{side}: {shape} nodes without friction, {friction} with friction")
        at = f"  at {len(error)} points between the nodes" + (f", {failed} of them not solved" if failed else "")
        lines.append(at)
        for name, column in zip(("Fx", "Fy", "Fz"), error.T, strict=True):
            rms, worst = float(np.sqrt(np.nanmean(column**2))), float(np.nanmax(np.abs(column)))
            rows.append({"side": side, "force": name, "rms": rms, "worst": worst})
    facts = {"file": file, "nodes": nodes, "reached": bool(data.attrs["reached"]), "seconds": data.attrs["seconds"]}
    lines.append(f"  {file}, {data.attrs['seconds']:.0f} s")
    table = ResultTable("errors", "Errors between the nodes, of the vertical load", _ERRORS, rows)
    return Results("table", [table, "\n".join(lines)], facts, {"nodes": "1", "seconds": "s"})


_ERRORS = (
    Column("side", "side", itemgetter("side")),
    Column("force", "force", itemgetter("force")),
    Column("rms", "RMS", itemgetter("rms"), "%", 2),
    Column("worst", "worst", itemgetter("worst"), "%", 2),
)
