"""Scenes that differ in a few values, checked one after the other."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import Scene, checked
from wheelrail.scenes.schema.tables import SceneTable


@dataclass(frozen=True)
class Checking:
    """Checks scenes in a file, or as if in it; a table in them that was found fine in one is not checked again."""

    file: Path
    fine: dict[tuple[str, str], SceneTable] = field(default_factory=dict)

    def __call__(self, tables: Mapping[str, Any]) -> Scene:
        """Raises SceneError as `checked` does."""
        names = {name: (name, repr(table)) for name, table in tables.items() if isinstance(table, Mapping)}
        given = {name: self.fine.get(names[name], value) if name in names else value for name, value in tables.items()}
        try:
            scene = checked(given, self.file)
        except SceneError:
            return checked(tables, self.file)  # which has all words for it
        for name, text in names.items():
            if isinstance(table := getattr(scene, name, None), SceneTable):
                self.fine[text] = table
        return scene


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
