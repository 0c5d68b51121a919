"""Arguments of Python calls as the keys of a scene, checked by the same models."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping
from difflib import get_close_matches
from typing import Any

from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import Scene, checked
from wheelrail.scenes.schema.tables import SceneTable


def keys_of(*tables: type[SceneTable]) -> dict[str, None]:
    """Keys that tables of a scene have."""
    return {key: None for table in tables for key in table.model_fields}


def known(caller: str, given: Iterable[str], allowed: Iterable[str]) -> None:
    """Raises SceneError for a key that is not allowed."""
    allowed = list(allowed)
    for key in given:
        if key not in allowed:
            close = get_close_matches(key, allowed, n=1, cutoff=0.6)
            hint = f"did you mean {close[0]}?" if close else f"allowed are {', '.join(allowed)}"
            raise SceneError(f"{caller}: {key}: unknown argument; {hint}")


def scene_of(
    caller: str,
    kind: str,
    keys: Mapping[str, Any],
    sections: Mapping[str, Container[str]],
    at_hand: Container[str] = (),
) -> Scene:
    """The scene of flat keys, each put into the section that has it.

    Raises SceneError naming argument, value and what is allowed.
    """
    data: dict[str, Any] = {"kind": kind, **{section: {} for section in sections}}
    for key, value in keys.items():
        if value is None:
            continue
        home = next((section for section, its in sections.items() if key in its), None)
        (data if home is None else data[home])[key] = plain(value)
    return checked(data, caller, at_hand=at_hand, unnamed=sections)


def plain(value: Any) -> Any:
    """NumPy's numbers and arrays as Python's, tuples as lists."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return value


def replaced(base: Mapping[str, Any], given: Mapping[str, Any], groups: Iterable[tuple[str, ...]]) -> dict[str, Any]:
    """Base with what is given on top; of every group of which something is given, nothing of the base is left."""
    gone = {key for group in groups if any(given.get(key) is not None for key in group) for key in group}
    kept = {key: value for key, value in base.items() if key not in gone}
    return {**kept, **{key: value for key, value in given.items() if value is not None}}
