"""Values of a dataclass replaced by those of a table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any

from scenes.quantities import refuse


def overridden(part: Any, values: Mapping[str, Any], prefix: str = "") -> Any:
    """A frozen dataclass with some of its values replaced, tables in it likewise.

    Raises the error of a scene's check for a value that it does not have, of another type, or that it refuses.
    """
    names = [field.name for field in fields(part)]
    new: dict[str, Any] = {}
    for key, value in values.items():
        if key not in names:
            raise refuse(
                f"unknown key; allowed are speed and {', '.join(names)}"
                if not prefix
                else f"unknown key; allowed are {', '.join(names)}",
                prefix + key,
            )
        old = getattr(part, key)
        if is_dataclass(old):
            if not isinstance(value, Mapping):
                raise refuse("must be a table", prefix + key)
            new[key] = overridden(old, value, f"{prefix}{key}.")
        elif isinstance(old, tuple):
            if not isinstance(value, list) or not all(_number(item) for item in value):
                raise refuse("must be an array of numbers", prefix + key)
            new[key] = tuple(map(float, value))
        elif _number(value):
            new[key] = float(value)
        else:
            raise refuse("must be a number", prefix + key)
    try:
        return replace(part, **new)
    except ValueError as error:
        raise refuse(str(error), prefix + next(iter(new))) from None


def _number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
