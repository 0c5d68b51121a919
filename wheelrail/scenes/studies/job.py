"""Job of a worker: the scene of a case with its files."""

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

from wheelrail.scenes.builders.vehicle_tables import VEHICLE_FILE
from wheelrail.scenes.schema.scene import Scene, checked
from wheelrail.scenes.studies.plan import StudyCase
from wheelrail.support.text_file import read_bytes

MOST = 1000.0  # MB, of a file of the scene
VEHICLE = "vehicle.toml"


@dataclass(frozen=True)
class Job:
    """A scene with its files, as sent to a worker.

    Parameters:
        table: tables of the scene; files are named by the hash of their content.
        files: content by name.
        histories: whether to return time histories of a run.
        computer: versions and sources, see `computer`.
        key: hash of the above; equal keys mean equal results.
        timed: whether computing times are compared; a process then solves its first case twice, the first time for
            loading and compiling, and every contact once more, for its warm time.
        folder: for checkpoints and data of a run, on machines that have it.
        compute: "run", or "curving" or "critical" of the vehicle.

    A run uses one process; the other ones are used by other cases.
    """

    table: Mapping[str, Any]
    files: Mapping[str, bytes]
    histories: bool
    computer: Mapping[str, str]
    key: str
    timed: bool = False
    folder: str = ""
    compute: str = "run"

    @classmethod
    def of(
        cls,
        case: StudyCase,
        *,
        histories: bool = False,
        timed: bool = False,
        folder: Path | None = None,
        compute: str = "run",
    ) -> Job:
        """Job of a case; folder: of completed cases. Raises OSError for a missing file."""
        files: dict[str, bytes] = {}
        table = _packed(dict(case.table), case.scene.model_dump(), files)
        if case.scene.kind == "run":
            table |= {"solver": {**table.get("solver", {}), "workers": 1}}
            table |= {"output": {**table.get("output", {}), "figures": False}}
        content = {"scene": table, "histories": histories, "timed": timed, "computer": computer()}
        content |= {} if compute == "run" else {"compute": compute}
        text = json.dumps(content, sort_keys=True, default=list)
        key = hashlib.sha256(text.encode()).hexdigest()[:24]
        place = str(folder.absolute()) if folder is not None and case.scene.kind == "run" else ""
        return cls(table, files, histories, computer(), key, timed, place, compute)

    @contextmanager
    def scene(self) -> Iterator[tuple[Scene, Path]]:
        """The validated scene, and a temporary folder with its files and vehicle.toml, which is removed at the end."""
        with tempfile.TemporaryDirectory(prefix="wheelrail-case-") as name:
            for path, content in self.files.items():
                file = Path(name, path)
                file.parent.mkdir(exist_ok=True)
                file.write_bytes(content)
            tables = {key: value for key, value in self.table.items() if key != VEHICLE_FILE}
            if VEHICLE_FILE in self.table:
                import tomli_w

                Path(name, VEHICLE).write_text(tomli_w.dumps(self.table[VEHICLE_FILE]), encoding="utf-8")
            yield checked(tables, Path(name, "case")), Path(name)


def unfinished(folder: Path, key: str) -> Path:
    """Checkpoint file of a run."""
    return folder / f"{key}.checkpoints"


def run_data(folder: Path, key: str) -> Path:
    """Data file of a run."""
    return folder / f"{key}.nc"


@cache
def computer() -> dict[str, str]:
    """Versions of libraries, and the hash of the sources of this package."""
    from wheelrail.scenes.runs.resume import sources
    from wheelrail.support.version import versions

    return versions() | {"sources": sources()}


def _packed(value: Any, checked: Any, files: dict[str, bytes]) -> Any:
    """Value with its files renamed and collected in `files`; checked: the same value with full paths."""
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
    """Name with the hash of the content, and content of a file; cached by its stamp."""
    content = read_bytes(path, MOST, "a file")
    return f"{hashlib.sha256(content).hexdigest()[:16]}/{Path(path).name}", content
