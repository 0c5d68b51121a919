"""Files from outside the project: regular files of a bounded size; texts in UTF-8."""

from __future__ import annotations

import json
import os
import re
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

MB = 1_000_000
CHUNK = 1 << 20  # bytes
DEEPEST = 32  # tables and arrays inside each other, of TOML and JSON
KINDS = {stat.S_ISDIR: "a folder", stat.S_ISFIFO: "a pipe", stat.S_ISCHR: "a device", stat.S_ISBLK: "a device"}
WIDE = (b"\xff\xfe", b"\xfe\xff")  # marks of UTF-16
LONGEST_QUOTE = 200  # characters
LONGEST_WORD = re.compile(rf"\S{{{LONGEST_QUOTE + 1},}}")
LONGEST_LINE, MOST_LINES = 1000, 10


class FileRefused(ValueError):
    """A rejected file: path, line, reason, and what is allowed."""


def check_regular(path: str | Path, most: float, what: str) -> None:
    """Raise FileRefused for anything but an existing regular file of a bounded size.

    Parameters:
        path: of the file.
        most: largest size, MB.
        what: is allowed, for the message.
    """
    allowed = f"allowed: {what} of at most {most:g} MB"
    with _refusals(path, allowed):
        status = os.stat(path)
    if not stat.S_ISREG(status.st_mode):
        kind = next((name for test, name in KINDS.items() if test(status.st_mode)), "no regular file")
        raise FileRefused(f"{path}: cannot be read: {kind}; {allowed}")
    if status.st_size > most * MB:
        raise FileRefused(f"{path}: cannot be read: {status.st_size / MB:.3g} MB; {allowed}")


def read_bytes(path: str | Path, most: float, what: str) -> bytes:
    """Content of a file; parameters and errors as for `check_regular`."""
    check_regular(path, most, what)
    with _refusals(path, f"allowed: {what} of at most {most:g} MB"):
        return _bounded(path, int(most * MB))


def read_text(path: str | Path, most: float, *, foreign: bool = False) -> str:
    """Text of a file.

    Parameters:
        path: of the file.
        most: largest size, MB.
        foreign: of other software, with numbers: bytes of other encodings, which are in comments, are replaced, and
            UTF-16 is read.

    Raises FileRefused for anything but a regular file, a file that is too large, other encodings, and binary files.
    """
    content = read_bytes(path, most, "a text file")
    if foreign and content[:2] in WIDE:
        return content.decode("utf-16", errors="replace")
    if content[:2] in WIDE:
        raise FileRefused(f"{path}: a text in UTF-16; allowed: text in UTF-8")
    if (zero := content.find(b"\0")) >= 0:
        raise FileRefused(f"{path}, line {_line(content, zero)}: a zero byte, not a text file; allowed: text in UTF-8")
    try:
        return content.decode("utf-8-sig", errors="replace" if foreign else "strict")
    except UnicodeDecodeError as error:
        where = f"{path}, line {_line(content, error.start)}"
        raise FileRefused(f"{where}: byte 0x{content[error.start]:02x}, not UTF-8; allowed: text in UTF-8") from None


def json_value(text: str | bytes) -> Any:
    """Value of a JSON text. Raises ValueError for another text, also for brackets in many levels."""
    try:
        value = json.loads(text)
    except RecursionError:
        raise ValueError("brackets nested hundreds of levels deep") from None
    if any(depth > DEEPEST for _, _, depth in entries({"": value})):
        raise ValueError(f"brackets nested more than {DEEPEST} levels deep")
    return value


def entries(data: dict[str, Any]) -> Iterator[tuple[str, Any, int]]:
    """All values with the key of the outermost table and their depth."""
    waiting = [(name, value, 1) for name, value in data.items()]
    while waiting:
        name, value, depth = waiting.pop()
        yield name, value, depth
        if isinstance(value, dict | list) and depth <= DEEPEST:
            inner = value.values() if isinstance(value, dict) else value
            waiting += [(name, item, depth + 1) for item in inner]


def present(path: Path) -> bool:
    """Whether there is a file or folder of that name, which may be too long for one, or have a zero byte."""
    try:
        return path.exists()
    except (OSError, ValueError):
        return False


def abridged(message: str) -> str:
    """A message that quotes input, with long words, long lines and further lines cut off."""
    lines = [LONGEST_WORD.sub(lambda word: f"{word[0][: LONGEST_QUOTE - 3]}...", line) for line in message.splitlines()]
    if len(lines) > MOST_LINES:
        lines[MOST_LINES:] = [f"and {len(lines) - MOST_LINES} more"]
    return "\n".join(line if len(line) <= LONGEST_LINE else f"{line[: LONGEST_LINE - 3]}..." for line in lines)


@contextmanager
def _refusals(path: str | Path, allowed: str) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise FileRefused(f"{path}: cannot be read: {error.strerror or error}; {allowed}") from None
    except ValueError as error:  # a zero byte in the name
        raise FileRefused(f"{path}: cannot be read: {error}; {allowed}") from None


def _bounded(path: str | Path, most: int) -> bytes:
    """Content of a file; raises OSError for more bytes than allowed, and where a file of the system has none yet."""
    parts, left = [], most + 1
    file = os.open(path, os.O_RDONLY | os.O_NONBLOCK)  # files of /proc may wait for events, or have no end
    try:
        while left > 0 and (part := os.read(file, min(left, CHUNK))):
            parts.append(part)
            left -= len(part)
    finally:
        os.close(file)
    if left == 0:
        raise OSError("the file has no end")
    return b"".join(parts)


def _line(content: bytes, place: int) -> int:
    return content.count(b"\n", 0, place) + 1
