"""Files sealed by a hash of all preceding bytes, so that damage is detected before a library reads the file."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

MARK = b"\nSHA-256 of the bytes before this line, by wheelrail: "  # libraries of NetCDF pass over it
LENGTH = len(MARK) + 2 * hashlib.sha256().digest_size
CHUNK = 1 << 20  # bytes


class Damaged(ValueError):
    """Sealed file whose content does not match its hash."""


def seal(path: Path) -> None:
    """Append the hash to a file, on disk when this returns. Raises OSError."""
    checksum = _digest(path, path.stat().st_size)
    with path.open("ab") as file:
        file.write(MARK + checksum)
        file.flush()
        os.fsync(file.fileno())


def is_sealed(path: Path) -> bool:
    """Whether a file ends with its hash, which a program that rewrites the file drops. Raises Damaged, OSError."""
    size = path.stat().st_size - LENGTH
    if size < 0:
        return False
    with path.open("rb") as file:
        file.seek(size)
        end = file.read(LENGTH)
    if not end.startswith(MARK):
        return False
    if end[len(MARK) :] != _digest(path, size):
        raise Damaged(f"{path}: its content is not what was written: the file is damaged")
    return True


def _digest(path: Path, size: int) -> bytes:
    """Hash of the first bytes of a file, in hexadecimal digits."""
    checksum = hashlib.sha256()
    with path.open("rb") as file:
        while size > 0 and (part := file.read(min(size, CHUNK))):
            checksum.update(part)
            size -= len(part)
    return checksum.hexdigest().encode()
