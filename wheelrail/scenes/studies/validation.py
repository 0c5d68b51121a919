"""Validation of many scenes that differ in few values."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from wheelrail.scenes.builders.vehicle_tables import VEHICLE_FILE, check_vehicle
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene, Scene, checked
from wheelrail.scenes.schema.tables import SceneTable


@dataclass(frozen=True)
class SceneChecker:
    """Validates scenes of a file; tables that were valid in an earlier scene are not validated again.

    Parameters:
        file: of the scenes, for errors and relative paths.
        valid: tables by name and content.
        vehicles: contents of valid tables of vehicles.
    """

    file: Path
    valid: dict[tuple[str, str], SceneTable] = field(default_factory=dict)
    vehicles: set[tuple[str, str]] = field(default_factory=set)

    def __call__(self, tables: Mapping[str, Any]) -> Scene:
        """Raises SceneError as `checked` does."""
        vehicle = tables.get(VEHICLE_FILE)
        if vehicle is not None:
            scene = self({key: value for key, value in tables.items() if key != VEHICLE_FILE})
            assert isinstance(scene, RunScene)
            if (content := (VEHICLE_FILE, repr(vehicle))) not in self.vehicles:
                check_vehicle(vehicle, "vehicle", scene)
                self.vehicles.add(content)
            return scene
        names = {name: (name, repr(table)) for name, table in tables.items() if isinstance(table, Mapping)}
        data = {name: self.valid.get(names[name], value) if name in names else value for name, value in tables.items()}
        try:
            scene = checked(data, self.file)
        except SceneError:
            return checked(tables, self.file)  # for complete messages
        for name, text in names.items():
            if isinstance(table := getattr(scene, name, None), SceneTable):
                self.valid[text] = table
        return scene


KEY = re.compile(r"[^\s:=]*")


def study_messages(
    error: Exception, locations: Mapping[str, str], *, file: Path, path: str | Path
) -> Iterator[tuple[str, bool]]:
    """Lines of a scene's error, each with a flag for values set by the study.

    Parameters:
        error: of the scene.
        locations: location in the study file by name of the parameter; replaces the key in the line.
        file: of the scene.
        path: of the study.
    """
    for message in str(error).splitlines():
        line = message.removeprefix(f"{file}: ").removeprefix(f"{path}: ")
        match = KEY.match(line)
        key = match.group() if match else ""
        dotted = key.replace("[", ".").replace("]", "")
        name = next((name for name in locations if f"{dotted}.".startswith(f"{name}.")), None)
        if name is None:
            yield line, False
        elif ": unknown key" in line:  # independent of its values
            yield f"{path}: {locations[name].partition('[')[0]}: unknown key{line.partition(': unknown key')[2]}", True
        else:
            inner = "".join(
                f"[{index}]" if index.isdigit() else f".{index}"
                for index in dotted[len(name) + 1 :].split(".")
                if index
            )
            yield f"{path}: {locations[name]}{inner}{line[len(key) :]}", True
