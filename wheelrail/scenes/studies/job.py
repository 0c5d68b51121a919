"""A case as it is sent to a worker, on this machine or another one: a scene with the files that it names."""

from __future__ import annotations

import hashlib
import json
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

from wheelrail.scenes.schema.scene import Scene, checked
from wheelrail.scenes.studies.plan import StudyCase


@dataclass(frozen=True)
class Job:
    """A scene's table with files by names that say what they hold, these files, and what computes it: `computer`.

    key: hash of all that; the same key, the same results. timed: seconds are compared, so that a process solves its
    first case once before, which loads and compiles. A run keeps to one process: the cases fill the others.
    folder: where a run keeps its checkpoints, from which it goes on if it was stopped, and its data, on machines that
    have it.
    """

    table: Mapping[str, Any]
    files: Mapping[str, bytes]
    histories: bool
    computer: Mapping[str, str]
    key: str
    timed: bool = False
    folder: str = ""

    @classmethod
    def of(cls, case: StudyCase, *, histories: bool = False, timed: bool = False, folder: Path | None = None) -> Job:
        """folder: of finished cases. Raises OSError for a file that has gone meanwhile."""
        files: dict[str, bytes] = {}
        table = _packed(dict(case.table), case.scene.model_dump(), files)
        if case.scene.kind == "run":
            table |= {"solver": {**table.get("solver", {}), "workers": 1}}
            table |= {"output": {**table.get("output", {}), "figures": False}}
        what = {"scene": table, "histories": histories, "computer": computer()}
        text = json.dumps(what, sort_keys=True, default=list)
        key = hashlib.sha256(text.encode()).hexdigest()[:24]
        place = str(folder.absolute()) if folder is not None and case.scene.kind == "run" else ""
        return cls(table, files, histories, computer(), key, timed, place)

    @contextmanager
    def scene(self) -> Iterator[tuple[Scene, Path]]:
        """The scene, its files in a folder of their own that goes at the end, for whatever else there is to write."""
        with tempfile.TemporaryDirectory(prefix="wheelrail-case-") as name:
            for path, content in self.files.items():
                file = Path(name, path)
                file.parent.mkdir(exist_ok=True)
                file.write_bytes(content)
            yield checked(self.table, Path(name, "case")), Path(name)


def unfinished(folder: Path, key: str) -> Path:
    """The file of a run's checkpoints among finished cases."""
    return folder / f"{key}.checkpoints"


def run_data(folder: Path, key: str) -> Path:
    """The file of all that a run gave."""
    return folder / f"{key}.nc"


@cache
def computer() -> dict[str, str]:
    """Versions of what computes, the sources of this package by their hash."""
    from wheelrail.scenes.runs.resume import sources
    from wheelrail.support.version import versions

    return versions() | {"sources": sources()}


def _packed(value: Any, checked: Any, files: dict[str, bytes]) -> Any:
    """The value with the files in it by name, which go into files; checked is the same with their full paths."""
    if isinstance(value, Mapping) and isinstance(checked, Mapping):
        return {key: _packed(item, checked.get(key), files) for key, item in value.items()}
    if isinstance(value, list | tuple) and isinstance(checked, list | tuple):
        return [_packed(item, below, files) for item, below in zip(value, checked, strict=True)]
    if isinstance(value, str) and isinstance(checked, str) and Path(checked).is_absolute():
        stat = Path(checked).stat()
        name, content = _file(checked, (stat.st_dev, stat.st_ino, stat.st_mtime_ns, stat.st_size))
        files[name] = content
        return name
    return value


@lru_cache(maxsize=64)
def _file(path: str, stamp: tuple[int, ...]) -> tuple[str, bytes]:
    """A name that says what is in a file, and that; once for all cases, as long as the file stays as it is."""
    content = Path(path).read_bytes()
    return f"{hashlib.sha256(content).hexdigest()[:16]}/{Path(path).name}", content
