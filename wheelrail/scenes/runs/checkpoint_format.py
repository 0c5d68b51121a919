"""Format of a checkpoint file.

The first line is a header in JSON that describes the run. Entries follow: length of the payload (8 bytes, big-endian),
checksum, payload. The payload is a `Checkpoint` with the rows since the previous entry as plain data (see
`wheelrail.support.plain_data`), which keeps every bit and runs no code; the checksum is SHA-256 of the previous
checksum (of the header's for the first entry) and the payload. Reading ends at the first entry that is incomplete or
damaged, and the next entry overwrites it.
"""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Iterator

import numpy as np

from wheelrail.support.plain_data import NotPlainData, decode, encode
from wheelrail.vehicle.simulation.checkpoint import Checkpoint
from wheelrail.vehicle.simulation.history import RunCost
from wheelrail.vehicle.simulation.row import Row, is_array

LENGTH, CHECKSUM_SIZE = struct.Struct(">Q"), hashlib.sha256().digest_size
PACKAGES = ("wheelrail.bindings", "wheelrail.contact", "wheelrail.vehicle")  # of the classes in a checkpoint


class Unreadable(OSError):
    """An undamaged checkpoint that this version cannot read."""


def entries(content: bytes) -> Iterator[tuple[int, bytes, Checkpoint]]:
    """End (offset in bytes), checksum and checkpoint of every undamaged entry of a file; raises Unreadable."""
    end = content.find(b"\n") + 1
    previous = checksum_of(content[:end])
    while end and end + LENGTH.size + CHECKSUM_SIZE <= len(content):
        start = end + LENGTH.size + CHECKSUM_SIZE
        end = start + LENGTH.unpack_from(content, end)[0]
        payload, checksum = content[start:end], content[start - CHECKSUM_SIZE : start]
        if end > len(content) or checksum != checksum_of(previous, payload):
            return
        previous = checksum
        yield end, checksum, _checkpoint(payload)


def entry(previous: bytes, checkpoint: Checkpoint) -> tuple[bytes, bytes]:
    """Bytes and checksum of an entry that follows the one, or the header, with the previous checksum."""
    payload = encode(checkpoint)
    checksum = checksum_of(previous, payload)
    return LENGTH.pack(len(payload)) + checksum + payload, checksum


def checksum_of(*parts: bytes) -> bytes:
    return hashlib.sha256(b"".join(parts)).digest()


def _checkpoint(payload: bytes) -> Checkpoint:
    """The checkpoint of a payload; raises Unreadable where values have other types or shapes than those of a run."""
    try:
        checkpoint = decode(payload, PACKAGES)
    except NotPlainData as error:
        raise Unreadable(f"unreadable checkpoint: {error}") from error
    if not isinstance(checkpoint, Checkpoint) or not _usable(checkpoint):
        raise Unreadable("unreadable checkpoint: its values are not those of a run")
    return checkpoint


def _is_instant(value: object, shape: tuple[int, ...]) -> bool:
    return isinstance(value, tuple) and len(value) == 2 and isinstance(value[0], float) and is_array(value[1], shape)


def _usable(at: Checkpoint) -> bool:
    numbers = (at.time, at.error, *(() if at.step is None else (at.step,)))
    shape = np.shape(at.state)
    return (
        all(isinstance(number, float) and np.isfinite(number) for number in numbers)
        and is_array(at.state, shape)
        and len(shape) == 1
        and isinstance(at.cost, RunCost)
        and (at.before is None or _is_instant(at.before, shape))
        and isinstance(at.guess, dict | None)
        and (at.solved is None or (is_array(at.solved[0], shape) and isinstance(at.solved[1], dict | None)))
        and isinstance(at.rows, list)
        and all(isinstance(row, Row) and row.is_valid(shape) for row in at.rows)
    )
