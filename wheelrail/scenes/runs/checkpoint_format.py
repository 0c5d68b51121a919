"""What a file of checkpoints is made of.

A line of JSON that says what run this is, then records: length, SHA-256 of the record before and this one, and a
checkpoint with the rows since the record before, pickled. A record that was cut off or spoiled ends the file for
whoever reads it, so that the one before holds, and the next one is written over it. Pickle keeps every bit of
whatever rows are made of; what it may make is held to plain data, so that a file from elsewhere cannot do harm.
"""

from __future__ import annotations

import hashlib
import io
import pickle
import struct
from collections.abc import Iterator
from typing import Any

from wheelrail.vehicle.simulation.checkpoint import Checkpoint

LENGTH, DIGEST = struct.Struct(">Q"), hashlib.sha256().digest_size
OURS, ARRAYS = (
    ("wheelrail.contact.", "wheelrail.vehicle."),
    ("_reconstruct", "_frombuffer", "scalar", "ndarray", "dtype"),
)


class Unreadable(OSError):
    """A checkpoint that is whole, and is none of this version's."""


class Plain(pickle.Unpickler):
    """Makes objects of this package, and arrays."""

    def find_class(self, module: str, name: str) -> Any:
        if module.split(".")[0] == "numpy" and name in ARRAYS:
            return super().find_class(module, name)
        if module.startswith(OURS):
            found = super().find_class(module, name)
            if isinstance(found, type) and found.__module__.startswith(OURS):  # and not imported there
                return found
        raise pickle.UnpicklingError(f"{module}.{name} is no part of a checkpoint")


def records(content: bytes) -> Iterator[tuple[int, bytes, Checkpoint]]:
    """Where every whole record ends, its digest and what it holds."""
    at = content.find(b"\n") + 1
    before = digest(content[:at])
    while at and at + LENGTH.size + DIGEST <= len(content):
        start = at + LENGTH.size + DIGEST
        at = start + LENGTH.unpack_from(content, at)[0]
        payload, seal = content[start:at], content[start - DIGEST : start]
        if seal != digest(before, payload):
            return
        before = seal
        try:
            found = Plain(io.BytesIO(payload)).load()
        except (pickle.UnpicklingError, AttributeError, ImportError, TypeError) as error:
            raise Unreadable(f"a checkpoint that cannot be read: {error}") from error
        yield at, seal, found


def record(before: bytes, payload: bytes) -> tuple[bytes, bytes]:
    """A record that follows one of a digest, or the head's, and its own digest."""
    seal = digest(before, payload)
    return LENGTH.pack(len(payload)) + seal + payload, seal


def digest(*parts: bytes) -> bytes:
    return hashlib.sha256(b"".join(parts)).digest()
