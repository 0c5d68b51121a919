"""Solves of a table in a worker process."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.builders.table import constant_friction
from wheelrail.scenes.builders.wheelset import wheelset_contact
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.profiles import Side
from wheelrail.scenes.schema.scene import RunScene, WheelsetScene, load_scene

if TYPE_CHECKING:
    from wheelrail.contact.tables.samples import TableSampler
    from wheelrail.contact.tables.store import Rows
    from wheelrail.contact.tables.tasks import Task


def sampler(scene: WheelsetScene | RunScene, side: Side) -> TableSampler:
    """Contact model of one side for a table. Raises SceneError for friction that is not constant."""
    from wheelrail.contact.models.table.force_table import TreadFrame
    from wheelrail.contact.tables.samples import TableSampler

    own = wheelset_contact(scene).of(side)
    frame = TreadFrame(scene.side(side).radius or own.mounting.radius, own.mounting.wheel_y - own.mounting.rail_y)
    return TableSampler(own.model, frame, constant_friction(scene, side))


@lru_cache(maxsize=2)
def _sampler_of_file(file: Path, side: Side) -> TableSampler:
    scene = load_scene(file)
    if not isinstance(scene, WheelsetScene | RunScene):
        raise SceneError(f'{file}: kind = "hertz": must be "wheelset" or "run"')
    return sampler(scene, side)


def task_rows(file: Path, side: Side, task: Task) -> Rows:
    """Rows of a task of one side of a scene file."""
    rows: Rows = task.rows(_sampler_of_file(file, side)).tolist()
    return rows
