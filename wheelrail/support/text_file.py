"""Text files from outside the project: regular files of a bounded size, in UTF-8."""

from __future__ import annotations

import os
import re
import stat
from pathlib import Path

MB = 1_000_000
KINDS = {stat.S_ISDIR: "a folder", stat.S_ISFIFO: "a pipe", stat.S_ISCHR: "a device", stat.S_ISBLK: "a device"}
LONGEST_QUOTE = 200  # characters
LONGEST_WORD = re.compile(rf"\S{{{LONGEST_QUOTE + 1},}}")
LONGEST_LINE, MOST_LINES = 1000, 10


class FileRefused(ValueError):
    """A rejected file: path, line, reason, and what is allowed."""


def read_text(path: str | Path, most: float, *, foreign: bool = False) -> str:
    """Text of a file.

    Parameters:
        path: of the file.
        most: largest size, MB.
        foreign: replace bytes of other encodings, for files of numbers, where they are in comments.

    Raises FileRefused for anything but a regular file, a file that is too large, UTF-16, and binary files.
    """
    content = _content(path, most)
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise FileRefused(f"{path}: a text in UTF-16; allowed: text in UTF-8")
    if (zero := content.find(b"\0")) >= 0:
        raise FileRefused(f"{path}, line {_line(content, zero)}: a zero byte, not a text file; allowed: text in UTF-8")
    try:
        return content.decode("utf-8-sig", errors="replace" if foreign else "strict")
    except UnicodeDecodeError as error:
        where = f"{path}, line {_line(content, error.start)}"
        raise FileRefused(f"{where}: byte 0x{content[error.start]:02x}, not UTF-8; allowed: text in UTF-8") from None


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


def _content(path: str | Path, most: float) -> bytes:
    allowed = f"allowed: a text file of at most {most:g} MB"
    try:
        status = os.stat(path)
        if not stat.S_ISREG(status.st_mode):
            kind = next((name for test, name in KINDS.items() if test(status.st_mode)), "no regular file")
            raise FileRefused(f"{path}: cannot be read: {kind}; {allowed}")
        if status.st_size > most * MB:
            raise FileRefused(f"{path}: cannot be read: {status.st_size / MB:.3g} MB; {allowed}")
        with open(path, "rb") as file:
            return file.read(int(most * MB))
    except OSError as error:
        raise FileRefused(f"{path}: cannot be read: {error.strerror or error}; {allowed}") from None


def _line(content: bytes, place: int) -> int:
    return content.count(b"\n", 0, place) + 1
