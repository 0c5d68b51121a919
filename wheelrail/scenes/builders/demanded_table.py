"""Table of the forces of a run's elastic contact, made on demand and kept in the cache."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.builders.table import pair_identity
from wheelrail.scenes.schema.errors import RunFailed
from wheelrail.scenes.schema.profiles import Side
from wheelrail.scenes.schema.scene import OnRails, RunScene
from wheelrail.support.cache import cache_folder, cached, digest, source_digest
from wheelrail.support.terminal import ProgressTimer
from wheelrail.support.threads import Threads

if TYPE_CHECKING:
    from wheelrail.contact.models.table.force_table import ForceTable
    from wheelrail.contact.models.wheelset import WheelsetContact
    from wheelrail.contact.tables.samples import TableSampler
    from wheelrail.contact.tables.tasks import Task
    from wheelrail.meshes.profiles.profile import Profile
    from wheelrail.support.arrays import Array

LEAST = 0.05  # smallest load with values of its own, over the largest
PACKAGES = ("support", "meshes", "contact")  # by which forces are computed
log = logging.getLogger(__name__)


def tabulated(
    scene: RunScene, named: OnRails, contact: WheelsetContact, profiles: Mapping[str, tuple[Profile, Profile]]
) -> WheelsetContact:
    """The elastic contact of a run with tables of its forces, one for each side that differs.

    Parameters:
        scene: of the run.
        named: it, or one of its contacts.
        contact: of both sides.
        profiles: of wheel and inclined rail by side.

    Raises RunFailed where the contact fails too often.
    """
    from wheelrail.contact.models.table.tabulated import TabulatedContact

    def on(side: Side) -> WheelsetContact:
        own = contact.of(side)
        identity: dict[str, Any] = {**pair_identity(named, side, profiles[side], own.mounting)}
        identity |= {"discretisation": asdict(named.discretisation), "laws": repr(own.model.laws)}  # type: ignore[attr-defined]
        table = _table(scene, own, identity)
        return replace(own, model=TabulatedContact(table, own.model), right=None)  # type: ignore[arg-type]

    return on("left") if contact.right is None else replace(on("left"), right=on("right"))


def _table(scene: RunScene, contact: WheelsetContact, identity: Mapping[str, Any]) -> ForceTable:
    """Table of a left-hand pair, from the cache or made."""
    from wheelrail.contact.models.table.force_table import ForceTable, FrictionTable, NormalTable, TreadFrame
    from wheelrail.contact.tables.builder import NoSolution, TableBuilder
    from wheelrail.contact.tables.samples import TableSampler
    from wheelrail.contact.tables.store import TaskStore
    from wheelrail.contact.tables.table_range import TableRange

    keys, mounting, friction = scene.tabulated, contact.mounting, float(identity["friction"])
    assert keys is not None
    y, roll, yaw = ((-end, end) for end in (keys.y, keys.roll, keys.yaw))
    ranges = TableRange(y, roll, yaw, (LEAST * keys.load, keys.load))
    frame = TreadFrame(float(identity["radius"]), mounting.wheel_y - mounting.rail_y)
    sources = source_digest(*(Path(__file__).parents[2] / package for package in PACKAGES))
    name = f"forces_{digest(ranges=asdict(ranges), tolerance=keys.tolerance, sources=sources, **identity)}"

    def build() -> dict[str, Array]:
        sampler = TableSampler(contact.model, frame, friction)
        file = cache_folder() / f"{name}.solves"
        file.parent.mkdir(parents=True, exist_ok=True)
        log.info("a table of forces is made and kept; an interrupted one is continued")
        threads = Threads(scene.solver.workers - 1)
        try:
            solve = partial(_solved, sampler, TaskStore(file, name), threads)
            table, errors = TableBuilder(sampler, ranges, keys.tolerance, solve).build()
        except NoSolution as error:
            raise RunFailed(f"table of forces: {error}; a narrower range may help") from None
        finally:
            threads.close()
        file.unlink(missing_ok=True)
        own = {f"{stage}_{key}": value for stage in STAGES for key, value in vars(getattr(table, stage)).items()}
        arrays = {key: value for key, value in own.items() if isinstance(value, np.ndarray)}
        return {**arrays, "errors": np.array([errors.rms, errors.worst])}

    names = [f"{stage}_{axis}" for stage, axes in STAGES.items() for axis in (*axes, "values")]
    arrays = cached(name, build, [*names, "errors"])
    normal, change = ({axis: arrays[f"{stage}_{axis}"] for axis in (*axes, "values")} for stage, axes in STAGES.items())
    table = ForceTable(frame, NormalTable(**normal), FrictionTable(**change, coefficient=friction))
    rms, worst = (100.0 * arrays["errors"]).tolist()
    log.info("%s; it errs by %.2g %% of the load RMS, %.2g %% at worst", table, rms, worst)
    if rms > 100.0 * keys.tolerance:
        log.warning("the table's tolerance of %g %% is not reached", 100.0 * keys.tolerance)
    return table


POSITIONS = ("y", "roll", "yaw", "level")
STAGES = {"normal": POSITIONS, "friction": (*POSITIONS, "longitudinal", "lateral")}  # parts of a table, and their axes


def _solved(sampler: TableSampler, store: Any, threads: Threads, tasks: Sequence[Task], purpose: str) -> list[Array]:
    """Rows of tasks, solved by threads unless a store has the rows."""
    from wheelrail.contact.tables.store import task_key

    keys = [task_key("left", task) for task in tasks]
    missing = {key: task for key, task in zip(keys, tasks, strict=True) if store.get(key) is None}
    progress, before = ProgressTimer(log, purpose), len(store)

    def solve(key: str, task: Task) -> None:
        store.save(key, task.rows(sampler).tolist())
        progress(len(store) - before, len(missing))

    left = list(missing.items())
    for key, task in left[:1]:  # alone: makes tables that all use
        solve(key, task)
    threads.each(solve, left[1:])
    return [np.array(store.get(key)) for key in keys]
