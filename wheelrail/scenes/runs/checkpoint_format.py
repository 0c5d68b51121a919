"""Format of a checkpoint file.

The first line is a header in JSON that describes the run. Entries follow: length of the payload (8 bytes, big-endian),
checksum, payload. The payload is a pickled `Checkpoint` with the rows since the previous entry; the checksum is SHA-256
of the previous checksum (of the header's for the first entry) and the payload. Reading ends at the first entry that is
incomplete or damaged, and the next entry overwrites it. Pickle keeps every bit of the rows; the unpickler is restricted
to classes of this package and to arrays, so that a file from elsewhere cannot run code.
"""

from __future__ import annotations

import hashlib
import io
import pickle
import struct
from collections.abc import Iterator
from typing import Any

from wheelrail.vehicle.simulation.checkpoint import Checkpoint

LENGTH, CHECKSUM_SIZE = struct.Struct(">Q"), hashlib.sha256().digest_size
OURS = ("wheelrail.contact.", "wheelrail.vehicle.")
ARRAYS = ("_reconstruct", "_frombuffer", "scalar", "ndarray", "dtype")


class Unreadable(OSError):
    """An undamaged checkpoint that this version cannot unpickle."""


class RestrictedUnpickler(pickle.Unpickler):
    """Admits classes of this package and NumPy arrays only."""

    def find_class(self, module: str, name: str) -> Any:
        if module.split(".")[0] == "numpy" and name in ARRAYS:
            return super().find_class(module, name)
        if module.startswith(OURS):
            member = super().find_class(module, name)
            if isinstance(member, type) and member.__module__.startswith(OURS):  # defined there, not imported
                return member
        raise pickle.UnpicklingError(f"{module}.{name} is not allowed in a checkpoint")


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
        try:
            checkpoint = RestrictedUnpickler(io.BytesIO(payload)).load()
        except (pickle.UnpicklingError, AttributeError, ImportError, TypeError) as error:
            raise Unreadable(f"unreadable checkpoint: {error}") from error
        yield end, checksum, checkpoint


def entry(previous: bytes, payload: bytes) -> tuple[bytes, bytes]:
    """Bytes and checksum of an entry that follows the one, or the header, with the previous checksum."""
    checksum = checksum_of(previous, payload)
    return LENGTH.pack(len(payload)) + checksum + payload, checksum


def checksum_of(*parts: bytes) -> bytes:
    return hashlib.sha256(b"".join(parts)).digest()
