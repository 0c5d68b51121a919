"""Tables of forces that a run makes on demand: keys that are refused, what is kept, and what a run on them is."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from wheelrail.contact.models.table.tabulated import TabulatedContact
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.tables import samples
from wheelrail.contact.tables.builder import NoSolution, TableBuilder
from wheelrail.contact.tables.store import TaskStore
from wheelrail.scenes.builders.wheelset import run_contact
from wheelrail.scenes.example_scenes import example
from wheelrail.scenes.schema.errors import RunFailed, SceneError
from wheelrail.scenes.schema.scene import RunScene, checked
from wheelrail.scenes.schema.toml import parse

STRIPS: dict[str, Any] = {"model": "condensed", "laws": "exact", "bodies": "half-space", "strips": 4, "cells": 6}
NARROW = {"y": 1e-3, "roll": 5e-4, "yaw": 5e-4, "load": 1e5, "tolerance": 0.1}


def scene(**changes: object) -> RunScene:
    data = parse(example("vehicle"), "scene")
    found = checked({**data, "surface_size": 1e-3, **STRIPS, **changes})
    assert isinstance(found, RunScene)
    return found


@pytest.fixture
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("WHEELRAIL_CACHE", str(tmp_path))
    return tmp_path


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"laws": "paper", "bodies": "solid", "strips": None, "cells": None}, 'only with laws = "exact"'),
        ({"model": "standard", **dict.fromkeys(("bodies", "strips", "cells"))}, 'only with laws = "exact"'),
        ({"points": "grid", "bodies": "waveguide", "strips": None, "cells": None}, 'only with laws = "exact"'),
        (
            {"track": {**parse(example("vehicle"), "scene")["track"], "friction": [[5.0, 0.5]]}},
            "not allowed with track.friction",
        ),
        ({"falling": {"share": 0.4, "rate": 0.6}}, "only with a constant coefficient of friction"),
        ({"tabulated": {"y": 0.1}}, "tabulated.y = 0.1"),
        ({"tabulated": {"load": 10.0}}, "tabulated.load = 10"),
        ({"tabulated": {"height": 1.0}}, "tabulated.height"),
    ],
)
def test_what_cannot_be_tabulated_is_refused(changes: dict[str, Any], message: str) -> None:
    given = {"tabulated": {}, **changes}
    data = {**parse(example("vehicle"), "scene"), "surface_size": 1e-3, **STRIPS, **given}
    with pytest.raises(SceneError, match=message):
        checked({key: value for key, value in data.items() if value is not None})


def model(own: RunScene) -> TabulatedContact:
    contact, _ = run_contact(own, ["wheelset"])
    assert isinstance(contact, WheelsetContact)
    assert isinstance(contact.model, TabulatedContact)
    return contact.model


def test_a_table_is_made_once_for_each_contact(
    own_cache: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO, "wheelrail")
    own = scene(tabulated=NARROW)
    save, solved = TaskStore.save, list[str]()

    def interrupted(store: TaskStore, key: str, rows: Any) -> None:
        if len(solved) == 20:
            raise KeyboardInterrupt
        solved.append(key)
        save(store, key, rows)

    monkeypatch.setattr(TaskStore, "save", interrupted)
    with pytest.raises(KeyboardInterrupt):
        run_contact(own, ["wheelset"])
    assert len(list(own_cache.glob("forces_*.solves"))) == 1
    again = list[str]()
    monkeypatch.setattr(TaskStore, "save", lambda store, key, rows: (again.append(key), save(store, key, rows)))
    table = model(own).table
    assert again
    assert not set(again) & set(solved)
    assert not list(own_cache.glob("forces_*.solves"))
    assert "table: y from -0.001 to 0.001 m, roll from -0.0005 to 0.0005 rad" in caplog.text
    monkeypatch.setattr(samples.TableSampler, "normal_rows", None)  # not used: the table is known
    kept = model(own).table
    assert np.array_equal(kept.friction.values, table.friction.values)
    assert np.array_equal(kept.normal.values, table.normal.values)
    assert len(list(own_cache.glob("forces_*.npz"))) == 1


@pytest.mark.parametrize(
    "changes", [{"friction": 0.2}, {"strips": 5}, {"E": 2.0e11}, {"tabulated": {**NARROW, "y": 2e-3}}]
)
def test_another_contact_has_another_table(
    own_cache: Path, monkeypatch: pytest.MonkeyPatch, changes: dict[str, Any]
) -> None:
    names = list[str]()

    def no_table(builder: TableBuilder) -> None:
        raise NoSolution("none")

    monkeypatch.setattr(TableBuilder, "build", no_table)
    monkeypatch.setattr(TaskStore, "__post_init__", lambda store: names.append(store.file.name))
    for own in (scene(tabulated=NARROW), scene(**{"tabulated": NARROW, **changes})):
        with pytest.raises(RunFailed, match="table of forces: none; a narrower range may help"):
            run_contact(own, ["wheelset"])
    assert len(set(names)) == 2
