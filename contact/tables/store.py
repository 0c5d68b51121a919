"""Results of table tasks, appended to a file on completion, so that an interrupted table can be resumed."""

from __future__ import annotations

import hashlib
import json
import os
from dataclasses import dataclass, field
from pathlib import Path
from threading import Lock

from wheelrail.contact.tables.tasks import Task
from wheelrail.support.text_file import read_bytes

MOST = 10_000.0  # MB
Rows = list[list[float]]


@dataclass
class TaskStore:
    """Rows by task, in memory and in a file of lines: checksum, then JSON.

    Parameters:
        file: is created; lines that are cut off or damaged are ignored.
        header: of the scene, model and versions; a file with another one is replaced.
    """

    file: Path
    header: str
    _rows: dict[str, Rows] = field(init=False, default_factory=dict)
    _lock: Lock = field(init=False, default_factory=Lock)

    def __post_init__(self) -> None:
        """Raises FileRefused, OSError."""
        content = read_bytes(self.file, MOST, "a file of solves") if self.file.exists() else b""
        first, *lines = content.decode("utf-8", "replace").split("\n")
        if first != self.header:
            self.file.write_text(f"{self.header}\n", encoding="utf-8")
            return
        for line in lines:
            checksum, _, text = line.partition(" ")
            if text and checksum == _checksum(text):
                key, rows = json.loads(text)
                self._rows[key] = rows
        if lines and lines[-1]:  # cut off: the next line starts anew
            with self.file.open("a", encoding="utf-8") as stream:
                stream.write("\n")

    def __len__(self) -> int:
        return len(self._rows)

    def get(self, key: str) -> Rows | None:
        """Rows of a task, None if unsolved."""
        return self._rows.get(key)

    def save(self, key: str, rows: Rows) -> None:
        """Keep the rows of a task, on disk when this returns. Raises OSError."""
        text = json.dumps([key, rows])
        with self._lock, self.file.open("a", encoding="utf-8") as stream:
            stream.write(f"{_checksum(text)} {text}\n")
            stream.flush()
            os.fsync(stream.fileno())
        self._rows[key] = rows


def task_key(side: str, task: Task) -> str:
    """Key of a task of a side: a hash of all its numbers."""
    return hashlib.sha256(f"{side} {task!r}".encode()).hexdigest()[:24]


def _checksum(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:12]
