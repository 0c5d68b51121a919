"""The checkpoint file of a run, to which every checkpoint is appended; `wheelrail.scenes.runs.checkpoint_format` has
its format.

sqlite3 is not used, by measurement (SQLite 3.40, ext4). It needs the same checksums and would save about 30 of 188
lines: for 969 of 1000 files with one bit flipped it returned changed data without an error. It lost all entries of 983
of 1000 truncated files; here only those cut off are lost. An entry of scenes/curve.toml (0.19 MB) takes 12 ms with a
rollback journal and 4 ms with WAL, which leaves entries in a second file after a kill, and 3.4 ms here. (Payloads
were pickled then; as plain data 30 rows take 2 ms more.)
"""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import IO, Any

from wheelrail.scenes.runs.checkpoint_format import checksum_of, entries, entry
from wheelrail.support.atomic_file import atomic_file
from wheelrail.vehicle.simulation.checkpoint import Checkpoint
from wheelrail.vehicle.simulation.row import Row

HEADER_LIMIT = 10_000_000  # bytes; larger than that of any scene


class StillRunning(OSError):
    """Another process is computing this run."""


@dataclass
class CheckpointFile:
    """The checkpoint file of a run, which `header` describes; it is created atomically with the first checkpoint.

    A checkpoint that cannot be written is reported, and the run continues; the next one contains its rows.
    end: offset of the next entry, bytes; rows: their number in the file; checksum: of the last entry.
    """

    path: Path
    header: Mapping[str, Any]
    report: Callable[[str], None]
    stream: IO[bytes] | None = field(default=None, init=False)
    end: int = field(default=0, init=False)
    rows: int = field(default=0, init=False)
    checksum: bytes = field(default=b"", init=False)

    def append(self, checkpoint: Checkpoint) -> None:
        """Append a checkpoint; it is on disk when this returns."""
        new = checkpoint.rows[self.rows :]
        try:
            self._write(replace(checkpoint, rows=new))
        except OSError as error:
            cause, time = error.strerror or error, f"{checkpoint.time:.6g} s"
            self.report(f"{self.path}: checkpoint at {time} not written: {cause}; the run continues")
        else:
            self.rows += len(new)

    def latest(self) -> Checkpoint | None:
        """Last undamaged checkpoint, with all rows up to its time; the next one is appended after it.

        None when there is none. Raises OSError when the file cannot be read and written, StillRunning when another
        process has locked it, Unreadable for checkpoints of other classes or values.
        """
        checkpoint: Checkpoint | None = None
        rows: list[Row] = []
        with ExitStack() as failure:
            stream = failure.enter_context(open(self.path, "r+b", buffering=0))
            if not _lock(stream):
                raise StillRunning("another process is computing this run")
            for end, checksum, part in entries(stream.read()):
                checkpoint, self.end, self.checksum = part, end, checksum
                rows += part.rows
            if checkpoint is None:
                return None
            failure.pop_all()  # open from here on, which holds the lock
        self.stream, self.rows = stream, len(rows)
        return replace(checkpoint, rows=rows)

    def remove(self) -> None:
        self.path.unlink(missing_ok=True)

    def _write(self, checkpoint: Checkpoint) -> None:
        if self.stream is None:
            self._create(checkpoint)
            return
        data, checksum = entry(self.checksum, checkpoint)
        _write_at(self.stream, data, self.end)
        self.end, self.checksum = self.end + len(data), checksum

    def _create(self, checkpoint: Checkpoint) -> None:
        """Replace the file by a new one with header and first entry."""
        line = json.dumps(self.header).encode() + b"\n"
        data, checksum = entry(checksum_of(line), checkpoint)
        with ExitStack() as failure:
            with atomic_file(self.path) as part:
                stream = failure.enter_context(open(part, "r+b", buffering=0))
                _lock(stream)
                _write_at(stream, line + data, 0)
            failure.pop_all()  # open from here on, which holds the lock
        self.stream, self.end, self.checksum = stream, len(line) + len(data), checksum


def read_header(path: Path) -> dict[str, Any] | None:
    """The header of a checkpoint file; None when there is no regular file, or it is none of checkpoints."""
    try:
        if not path.is_file():
            return None
        with path.open("rb") as stream:
            header = json.loads(stream.readline(HEADER_LIMIT))
    except (FileNotFoundError, ValueError, RecursionError):
        return None
    tables = isinstance(header, dict) and all(isinstance(header.get(key), dict) for key in ("scene", "versions"))
    return header if tables else None


def _lock(stream: IO[bytes]) -> bool:
    """Lock a file until its closing or the end of this process; False when another process has locked it."""
    try:
        fcntl.lockf(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        return False
    except OSError:  # a file system without locks
        return True
    return True


def _write_at(stream: IO[bytes], data: bytes, offset: int) -> None:
    """Write all of the data and synchronise the file with the disk."""
    while data:
        count = os.pwrite(stream.fileno(), data, offset)
        data, offset = data[count:], offset + count
    os.fsync(stream.fileno())
