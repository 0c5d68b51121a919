"""Scenes with some values changed, as TOML again."""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Mapping
from typing import Any

from scenes.complaint import SceneError


def changed(tables: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """The tables with other values for keys that are named with dots: {"vehicle.speed": 30.0}; None removes a key.

    Raises SceneError for a key inside something that is no table; whether keys are known is checked with the scene.
    """
    found = copy.deepcopy(dict(tables))
    for name, value in changes.items():
        *path, last = name.split(".")
        inner = found
        for part in path:
            inner = inner.setdefault(part, {})
            if not isinstance(inner, dict):
                raise SceneError(f"{name}: {part} is no table")
        if value is None:
            inner.pop(last, None)
        else:
            inner[last] = value.tolist() if hasattr(value, "tolist") else value
    return found


def toml_text(tables: Mapping[str, Any]) -> str:
    """Tables of texts, numbers, truths, arrays and tables as TOML, which reads back as the same."""
    values = {key: value for key, value in tables.items() if not isinstance(value, Mapping)}
    lines = [f"{_key(key)} = {_value(value)}" for key, value in values.items()]
    for key, value in tables.items():
        if isinstance(value, Mapping):
            lines += ["", *_table(value, (key,))]
    return "\n".join(lines) + "\n"


def _table(table: Mapping[str, Any], path: tuple[str, ...]) -> list[str]:
    lines = [f"[{'.'.join(map(_key, path))}]"]
    lines += [f"{_key(key)} = {_value(value)}" for key, value in table.items() if not isinstance(value, Mapping)]
    for key, value in table.items():
        if isinstance(value, Mapping):
            lines += ["", *_table(value, (*path, key))]
    return lines


def _key(key: str) -> str:
    return key if key.isascii() and key.replace("_", "").replace("-", "").isalnum() else _text(key)


def _text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else str(value)
    if isinstance(value, int):
        return str(value)
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(key)} = {_value(item)}" for key, item in value.items()) + "}"
    return "[" + ", ".join(map(_value, value)) + "]"
