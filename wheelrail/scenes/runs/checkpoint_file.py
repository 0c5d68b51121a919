"""Checkpoints of a run in one file, to which every new one is appended: see
`wheelrail.scenes.runs.checkpoint_format`.
"""

from __future__ import annotations

import fcntl
import json
import os
import pickle
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import IO, Any

from wheelrail.scenes.runs.checkpoint_format import digest, record, records
from wheelrail.vehicle.simulation.checkpoint import Checkpoint
from wheelrail.vehicle.simulation.recorder import Row


class StillRunning(OSError):
    """Another process goes on with this run."""


@dataclass
class Journal:
    """The file of a run, which `head` describes; it comes into being with the first checkpoint, in one stroke.

    A checkpoint that cannot be written is told, and the run goes on; what it holds is part of the next one.
    """

    file: Path
    head: Mapping[str, Any]
    tell: Callable[[str], None]
    stream: IO[bytes] | None = field(default=None, init=False)
    end: int = field(default=0, init=False)
    rows: int = field(default=0, init=False)
    digest: bytes = field(default=b"", init=False)

    def keep(self, at: Checkpoint) -> None:
        """Append a checkpoint; it is on disk when this returns."""
        new = at.rows[self.rows :]
        try:
            self.digest = self._write(pickle.dumps(replace(at, rows=new)))
        except OSError as error:
            self.tell(f"{self.file}: no checkpoint at {at.time:.6g} s: {error.strerror or error}; the run goes on")
        else:
            self.rows += len(new)

    def latest(self) -> Checkpoint | None:
        """The last checkpoint that is whole, with all rows up to it; those to come go after it.

        None when there is none. Raises OSError when the file cannot be read and written, StillRunning when another
        process does so, Unreadable for checkpoints of other classes.
        """
        stream = open(self.file, "r+b", buffering=0)  # noqa: SIM115 - it stays open, which holds the lock
        if not _locked(stream):
            stream.close()
            raise StillRunning("the run goes on in another process")
        found: Checkpoint | None = None
        rows: list[Row] = []
        for end, seal, part in records(stream.read()):
            found, self.end, self.digest = part, end, seal
            rows += part.rows
        if found is None:
            stream.close()
            return None
        self.stream, self.rows = stream, len(rows)
        return replace(found, rows=rows)

    def remove(self) -> None:
        self.file.unlink(missing_ok=True)

    def _write(self, payload: bytes) -> bytes:
        """The digest of what is on disk now."""
        if self.stream is not None:
            data, seal = record(self.digest, payload)
            _put(self.stream, data, self.end)
            self.end += len(data)
            return seal
        line = json.dumps(self.head).encode() + b"\n"
        data, seal = record(digest(line), payload)
        handle, temporary = tempfile.mkstemp(prefix=f".{self.file.name}.", dir=self.file.parent)
        stream = open(handle, "r+b", buffering=0)  # noqa: SIM115 - as above
        try:
            _locked(stream)
            _put(stream, line + data, 0)
            os.replace(temporary, self.file)
        except BaseException:
            stream.close()
            Path(temporary).unlink(missing_ok=True)
            raise
        self.stream, self.end = stream, len(line) + len(data)
        return seal


def head_of(file: Path) -> dict[str, Any] | None:
    """What run a file is of; None when there is no file, or no journal in it."""
    try:
        with file.open("rb") as stream:
            found = json.loads(stream.readline())
    except (FileNotFoundError, ValueError):
        return None
    return found if isinstance(found, dict) and {"scene", "versions"} <= set(found) else None


def _locked(stream: IO[bytes]) -> bool:
    """Whether no other process has the file, from now on and as long as this process lives or the stream is open."""
    try:
        fcntl.lockf(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        return False
    except OSError:  # a file system without locks
        return True
    return True


def _put(stream: IO[bytes], data: bytes, at: int) -> None:
    while data:
        count = os.pwrite(stream.fileno(), data, at)
        data, at = data[count:], at + count
    os.fsync(stream.fileno())
