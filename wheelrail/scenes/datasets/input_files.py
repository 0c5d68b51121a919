"""Files that a scene refers to, stored with its results: results can be drawn wherever they lie."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene, checked
from wheelrail.scenes.schema.toml import parse

if TYPE_CHECKING:
    from xarray import Dataset

FILES = "files"  # attribute of results: content by the name in the scene, JSON
KEYS = ("wheel", "rail", "wagon", "file")  # keys of a scene that name files of text
_FOLDERS: list[TemporaryDirectory[str]] = []  # kept until the end of the process


def packed(scenes: Iterable[tuple[Mapping[str, Any], Mapping[str, Any]]]) -> str:
    """Content of the files of scenes as JSON, byte by byte.

    Parameters:
        scenes: tables as they are written, and after validation, with full paths.
    """
    named = dict(entry for written, validated in scenes for entry in _named(written, validated))
    return json.dumps({name: path.read_bytes().decode("latin-1") for name, path in named.items()})


def _named(written: Mapping[str, Any], validated: Mapping[str, Any]) -> Iterator[tuple[str, Path]]:
    """Input files by their names in the tables."""
    for key, value in written.items():
        inner = validated.get(key)
        if isinstance(value, Mapping) and isinstance(inner, Mapping):
            yield from _named(value, inner)
        elif key in KEYS and isinstance(value, str) and isinstance(inner, str):
            path = Path(inner)
            if path.is_absolute() and path.is_file():
                yield value, path


def unpacked(tables: Mapping[str, Any], attributes: Mapping[str, Any], place: str | Path) -> dict[str, Any]:
    """Tables of a scene or a study, with the input files stored with its results.

    Parameters:
        tables: as they were written.
        attributes: of the results; without stored files, as by earlier versions, the tables are unchanged.
        place: file of the results, for errors.

    The files lie in a temporary folder until the process ends. A contact by a force table, which is not stored, becomes
    the standard one. Raises SceneError for damaged files.
    """
    if FILES not in attributes:
        return dict(tables)
    try:
        paths = _paths(str(attributes[FILES]))
    except (OSError, ValueError, AttributeError, TypeError, RecursionError) as error:
        raise SceneError(f"{place}: {FILES}: the stored files of the scene are damaged: {error}") from None
    with_files: dict[str, Any] = _with_paths(tables, paths)
    contacts = with_files.get("contacts", {})
    for own in (with_files, *(contacts.values() if isinstance(contacts, Mapping) else ())):
        if isinstance(own, dict) and own.pop("table", None) is not None:  # a large file, which no picture needs
            own["model"] = "standard"
    return with_files


def scene_of_run(data: Dataset, file: Path) -> RunScene:
    """Scene of a run with the files stored in its results.

    Parameters:
        data: Dataset of the run.
        file: results, for errors; of an earlier version, paths in the scene are relative to its folder.

    Raises SceneError if files of the scene are missing.
    """
    scene = checked(unpacked(parse(data.attrs["scene"], file), data.attrs, file), file)
    if not isinstance(scene, RunScene):
        raise SceneError(f"{file}: must contain results of a run, as run.nc of wheelrail run does")
    return scene


@cache
def _paths(content: str) -> dict[str, str]:
    """Paths of the unpacked files by their names in the scene."""
    folder = TemporaryDirectory(prefix="wheelrail-files-")
    _FOLDERS.append(folder)
    paths = {}
    for index, (name, text) in enumerate(json.loads(content).items()):
        path = Path(folder.name, str(index), Path(name).name)  # the endings of names tell their formats
        path.parent.mkdir()
        path.write_bytes(text.encode("latin-1"))
        paths[name] = str(path)
    return paths


def _with_paths(value: Any, paths: Mapping[str, str], named: bool = False) -> Any:
    """Value with paths in place of names, below keys that name files."""
    if isinstance(value, Mapping):
        return {key: _with_paths(item, paths, named or key.split(".")[-1] in KEYS) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_with_paths(item, paths, named) for item in value]
    return paths.get(value, value) if named and isinstance(value, str) else value
