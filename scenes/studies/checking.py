"""Scenes that differ in a few values, checked one after the other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from scenes.complaint import SceneError
from scenes.scene import Scene, checked
from scenes.sections import Table


@dataclass(frozen=True)
class Checking:
    """Checks scenes in a file, or as if in it; a table in them that was found fine in one is not checked again."""

    file: Path
    fine: dict[tuple[str, str], Table] = field(default_factory=dict)

    def __call__(self, tables: Mapping[str, Any]) -> Scene:
        """Raises SceneError as `checked` does."""
        names = {name: (name, repr(table)) for name, table in tables.items() if isinstance(table, Mapping)}
        given = {name: self.fine.get(names[name], value) if name in names else value for name, value in tables.items()}
        try:
            scene = checked(given, self.file)
        except SceneError:
            return checked(tables, self.file)  # which has all words for it
        for name, text in names.items():
            if isinstance(table := getattr(scene, name, None), Table):
                self.fine[text] = table
        return scene
