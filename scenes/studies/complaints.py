"""What is wrong with the cases of a study: each complaint once, at the place in the study that it comes from."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path

KEY = re.compile(r"[^\s:=]*")


def complaints(
    error: Exception, places: Mapping[str, str], *, file: Path, path: str | Path
) -> Iterator[tuple[str, bool]]:
    """The lines of a scene's error, and whether each is about a value of the study: about one whose name is in places,
    where its place takes that of the key, or about the scene in the file. path names the study.
    """
    for said in str(error).splitlines():
        line = said.removeprefix(f"{file}: ").removeprefix(f"{path}: ")
        found = KEY.match(line)
        key = found.group() if found else ""
        dotted = key.replace("[", ".").replace("]", "")
        name = next((name for name in places if f"{dotted}.".startswith(f"{name}.")), None)
        if name is None:
            yield line, False
        elif ": unknown key" in line:  # whatever its values are
            yield f"{path}: {places[name].partition('[')[0]}: unknown key{line.partition(': unknown key')[2]}", True
        else:
            inner = "".join(
                f"[{part}]" if part.isdigit() else f".{part}" for part in dotted[len(name) + 1 :].split(".") if part
            )
            yield f"{path}: {places[name]}{inner}{line[len(key) :]}", True
