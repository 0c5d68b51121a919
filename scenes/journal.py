"""Checkpoints of a run in one file, to which every new one is appended.

A line of JSON that says what run this is, then records: length, SHA-256 of the record before and this one, and a
checkpoint with the rows since the record before, pickled. A record that was cut off or spoiled ends the file for
whoever reads it, so that the one before holds, and the next one is written over it. Pickle keeps every bit of
whatever rows are made of; what it may make is held to plain data, so that a file from elsewhere cannot do harm.
"""

from __future__ import annotations

import fcntl
import hashlib
import io
import json
import os
import pickle
import struct
import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import IO, Any

from vehicle.checkpoint import Checkpoint
from vehicle.record import Row

LENGTH, DIGEST = struct.Struct(">Q"), hashlib.sha256().digest_size
OURS, ARRAYS = ("contact", "vehicle"), ("_reconstruct", "_frombuffer", "scalar", "ndarray", "dtype")


class StillRunning(OSError):
    """Another process goes on with this run."""


class Unreadable(OSError):
    """A checkpoint that is whole, and is none of this version's."""


class Plain(pickle.Unpickler):
    """Makes objects of this package, and arrays."""

    def find_class(self, module: str, name: str) -> Any:
        root = module.split(".")[0]
        if root in OURS or (root == "numpy" and name in ARRAYS):
            found = super().find_class(module, name)
            if isinstance(found, type) or root == "numpy":
                return found
        raise pickle.UnpicklingError(f"{module}.{name} is no part of a checkpoint")


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
        for end, digest, part in _records(stream.read()):
            found, self.end, self.digest = part, end, digest
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
            record, digest = _record(self.digest, payload)
            _put(self.stream, record, self.end)
            self.end += len(record)
            return digest
        line = json.dumps(self.head).encode() + b"\n"
        record, digest = _record(_digest(line), payload)
        handle, temporary = tempfile.mkstemp(prefix=f".{self.file.name}.", dir=self.file.parent)
        stream = open(handle, "r+b", buffering=0)  # noqa: SIM115 - as above
        try:
            _locked(stream)
            _put(stream, line + record, 0)
            os.replace(temporary, self.file)
        except BaseException:
            stream.close()
            Path(temporary).unlink(missing_ok=True)
            raise
        self.stream, self.end = stream, len(line) + len(record)
        return digest


def head_of(file: Path) -> dict[str, Any] | None:
    """What run a file is of; None when there is no file, or no journal in it."""
    try:
        with file.open("rb") as stream:
            found = json.loads(stream.readline())
    except (FileNotFoundError, ValueError):
        return None
    return found if isinstance(found, dict) and {"scene", "versions"} <= set(found) else None


def _records(content: bytes) -> Iterator[tuple[int, bytes, Checkpoint]]:
    """Where every whole record ends, its digest and what it holds."""
    at = content.find(b"\n") + 1
    before = _digest(content[:at])
    while at and at + LENGTH.size + DIGEST <= len(content):
        start = at + LENGTH.size + DIGEST
        at = start + LENGTH.unpack_from(content, at)[0]
        payload, digest = content[start:at], content[start - DIGEST : start]
        if digest != _digest(before, payload):
            return
        before = digest
        try:
            found = Plain(io.BytesIO(payload)).load()
        except (pickle.UnpicklingError, AttributeError, ImportError, TypeError) as error:
            raise Unreadable(f"a checkpoint that cannot be read: {error}") from error
        yield at, digest, found


def _record(before: bytes, payload: bytes) -> tuple[bytes, bytes]:
    digest = _digest(before, payload)
    return LENGTH.pack(len(payload)) + digest + payload, digest


def _digest(*parts: bytes) -> bytes:
    return hashlib.sha256(b"".join(parts)).digest()


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
