"""Messages about a scene: file, key, value and what is allowed; warnings about what is allowed, but unusual."""

from __future__ import annotations

import json
import warnings
from collections.abc import Container, Iterable, Iterator, Mapping
from dataclasses import asdict
from difflib import get_close_matches
from itertools import chain, islice
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.override import WAGON
from wheelrail.scenes.schema.quantities import Range

Keys = tuple[int | str, ...]
MOST_ERRORS = 4
SYNONYMS = {  # key that users write: that of the scene, and its value
    "radius": ("curvature", " = 1/radius"),
    "diameter": ("radius", ", half of it"),
    "velocity": ("speed", ""),
    "mu": ("friction", ""),
    "load": ("wheel_load", ""),
}


def validation_error(
    error: ValidationError,
    model: type[BaseModel],
    data: Mapping[str, Any],
    path: str | Path,
    unnamed: Container[str] = (),
) -> SceneError:
    """One SceneError with a line for every invalid entry.

    Parameters:
        error: of pydantic.
        model: that rejected the data.
        data: tables of the scene.
        path: file, for messages.
        unnamed: tables to omit from the names of keys.
    """
    lines: dict[str, str] = {}
    meant = set[Keys]()
    items = sorted(error.errors(include_url=False, include_input=False), key=_order)
    for item in items[:MOST_ERRORS]:
        ctx = item.get("ctx", {})
        location = _in_data(item["loc"], data)
        if item["type"] == "extra_forbidden":
            hint, suggested = _nearest(location, model)
            key, text = location, f"unknown key; {hint}"
            meant.add(suggested)
        elif item["type"] == "missing" and location in meant:
            continue
        elif item["type"] == "scene":
            inner = (int(part) if part.isdigit() else part for part in str(ctx["key"]).split(".") if part)
            key = (*location, *inner)
            text = str(ctx["allowed"])
        elif item["type"] == "value_error":  # of what the entry describes
            key, text = location, str(ctx["error"])
        else:
            key, text = location, f"must be {allowed(model, location)}"
        name = _dotted(key[1:] if key and key[0] in unnamed else key)
        lines.setdefault(name, f"{name}{_value(key, data)}: {text}")
    # Of an entry with several types, the message about what is inside it is the exact one.
    outer = [name for name in lines if any(other.startswith((f"{name}.", f"{name}[")) for other in lines)]
    lines = {name: line for name, line in lines.items() if name not in outer}
    more = [f"{len(items) - MOST_ERRORS} more errors"] if len(items) > MOST_ERRORS else []
    return SceneError("\n".join(f"{path}: {line}" for line in (*lines.values(), *more)))


def _order(item: ErrorDetails) -> bool:
    """Unknown keys come first: what is missing is often there under another name."""
    return item["type"] != "extra_forbidden"


def entry_message(key: Keys, data: Mapping[str, Any], text: str) -> str:
    """Message about one entry: key, value and text."""
    return f"{_dotted(key)}{_value(key, data)}: {text}"


def allowed(model: type[BaseModel], location: Keys) -> str:
    """Allowed values of the entry at a location."""
    return _describe(_type_at(model, location))


def unit_of(model: type[BaseModel], location: Keys) -> str:
    """Unit of the number at a location; empty without one."""
    kind = _type_at(model, location)
    found = list(_ranges(kind))
    return found[-1].unit if found else ""


def _ranges(kind: Any) -> Iterator[Range]:
    """Ranges of a number, of one or of several types."""
    origin, arguments = get_origin(kind), get_args(kind)
    if origin is Annotated:
        own = [extra for extra in arguments[1:] if isinstance(extra, Range)]
        yield from own[-1:] or _ranges(arguments[0])
    elif origin in (Union, UnionType):
        for choice in arguments:
            yield from _ranges(choice)


def whole(model: type[BaseModel], location: Keys) -> bool:
    """Whether the entry at a location is an integer."""
    choices = list(_without_none(_type_at(model, location)))
    return all(c is int or (get_origin(c) is Literal and all(type(v) is int for v in get_args(c))) for c in choices)


def _describe(kind: Any) -> str:
    origin, arguments = get_origin(kind), get_args(kind)
    if origin is Annotated:
        ranges = [extra for extra in arguments[1:] if isinstance(extra, Range)]
        return str(ranges[-1]) if ranges else _describe(arguments[0])
    if origin is Literal:
        return " or ".join(json.dumps(choice) for choice in arguments)
    if origin in (Union, UnionType):
        return ", or ".join(_describe(choice) for choice in arguments if choice is not type(None))
    if origin is tuple and arguments[-1] is Ellipsis:
        return f"an array of {_describe(arguments[0])}"
    if origin is dict:
        return f"a table of {_describe(arguments[1])}"
    if origin is tuple:
        return f"an array of {len(arguments)}: " + "; ".join(_describe(item) for item in arguments)
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return "a table with the keys " + ", ".join(kind.model_fields)
    descriptions = {
        str: "a string",
        bool: "true or false",
        float: "a number",
        int: "a whole number",
        Any: "values, at least one",
    }
    return descriptions.get(kind, "of another type")


def _type_at(model: type[BaseModel], location: Keys) -> Any:
    """Annotation of the entry, including the range, which pydantic stores separately."""
    kind: Any = model
    for part in location:
        kind = _containing(kind, part)
        if isinstance(kind, type) and issubclass(kind, BaseModel) and part in kind.model_fields:
            field = kind.model_fields[str(part)]
            kind = Annotated[(field.annotation, *field.metadata)] if field.metadata else field.annotation
        elif get_origin(kind) is tuple and isinstance(part, int):
            arguments = get_args(kind)
            kind = arguments[0] if arguments[-1] is Ellipsis else arguments[min(part, len(arguments) - 1)]
        elif get_origin(kind) is dict:
            kind = get_args(kind)[1]
    return kind


def _containing(kind: Any, part: int | str) -> Any:
    """The first alternative of a type that can contain the part of a location."""
    choices = list(_without_none(kind))

    def contains(choice: Any) -> bool:
        if isinstance(choice, type) and issubclass(choice, BaseModel):
            return part in choice.model_fields
        return get_origin(choice) is (tuple if isinstance(part, int) else dict)

    return next(filter(contains, choices), choices[0])


def _without_none(kind: Any) -> Iterator[Any]:
    """Alternatives of a type without Annotated and None."""
    if get_origin(kind) is Annotated:
        kind = get_args(kind)[0]
    if get_origin(kind) in (Union, UnionType):
        for choice in get_args(kind):
            if choice is not type(None):
                yield from _without_none(choice)
    else:
        yield kind


def _in_data(location: Keys, data: Any) -> Keys:
    """Location without the parts that pydantic adds for the alternatives of a union."""
    keys: list[int | str] = []
    for place, part in enumerate(location):
        inside = part in data if isinstance(data, Mapping) else isinstance(data, list) and isinstance(part, int)
        if inside:
            data = data[part] if isinstance(data, Mapping) or part < len(data) else None  # type: ignore[operator, index]
            keys.append(part)
        elif place == len(location) - 1 and isinstance(data, Mapping | list) and "[" not in str(part):
            keys.append(part)  # the missing key itself
    return tuple(keys)


def _nearest(location: Keys, model: type[BaseModel]) -> tuple[str, Keys]:
    """Hint for an unknown key and the suggested key: a similar one of its table, or the same one in another table."""
    table = next(_without_none(_type_at(model, location[:-1])))
    wrong = str(location[-1])[:100]
    here = list(table.model_fields)
    similar, remark = SYNONYMS.get(wrong.lower(), ("", ""))
    if similar not in here:
        similar, remark = nearest_name(wrong, here), ""
    if similar:
        suggested = (*location[:-1], similar)
        return f"did you mean {_dotted(suggested)}{remark}?", suggested
    elsewhere = {name.split(".")[-1]: name for name in reversed([*_all_keys(model)])}
    if name := elsewhere.get(nearest_name(wrong, elsewhere, cutoff=0.8)):
        return f"did you mean {name}?", tuple(name.split("."))
    return f"allowed are {', '.join(here)}", location


def nearest_name(wrong: str, names: Iterable[str], cutoff: float = 0.6) -> str:
    """The name that is nearest to a wrong one, if any is nearer than the cutoff; upper and lower case are alike."""
    by_lower = {name.lower(): name for name in names}
    close = get_close_matches(wrong[:100].lower(), by_lower, n=1, cutoff=cutoff)
    return by_lower[close[0]] if close else ""


def _all_keys(model: type[BaseModel], prefix: str = "") -> Iterator[str]:
    for name, field in model.model_fields.items():
        yield prefix + name
        inner = next(_without_none(field.annotation))
        if isinstance(inner, type) and issubclass(inner, BaseModel):
            yield from _all_keys(inner, f"{prefix}{name}.")


def _dotted(keys: Keys) -> str:
    """Name of a key: profiles.wheel, upper.radii[0]."""
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in keys).lstrip(".") or "scene"


def _value(keys: Keys, data: Any) -> str:
    """The value as text, or ": missing"."""
    for part in keys:
        try:
            data = data[part]
        except (KeyError, IndexError, TypeError):
            return ": missing"
    if isinstance(data, dict):
        return ""
    text = json.dumps(data, default=str, ensure_ascii=False)
    return f" = {text if len(text) <= 60 else text[:57] + '...'}"


def warn_of_unusual(table: BaseModel, path: str | Path, unnamed: Container[str] = (), wagon: Any = None) -> None:
    """Warn of each unusual value of a validated file, at most four; only once in a process.

    Parameters:
        table: the file after validation; its defaults are not looked at.
        path: file, or name of a function, for the messages.
        unnamed: tables to omit from the names of keys.
        wagon: that of a run, if it is not the default one.
    """
    for keys, value, remark in islice(chain(_unusual(table), _unusual_of_wagon(wagon)), MOST_ERRORS):
        name = _dotted(keys[1:] if keys[0] in unnamed else keys)
        warnings.warn(f"{path}: {name} = {value:.6g}: {remark}", stacklevel=2)


def _unusual(table: BaseModel) -> Iterator[tuple[Keys, float, str]]:
    """Keys, value and remark of every unusual number."""
    for keys, value in _numbers(table.model_dump(exclude_unset=True)):
        for remark in [text for one in _ranges(_type_at(type(table), keys)) if (text := one.remark(value))][:1]:
            yield keys, value, remark


def _unusual_of_wagon(wagon: Any) -> Iterator[tuple[Keys, float, str]]:
    """The same of a wagon."""
    for keys, value in _numbers(None if wagon is None else asdict(wagon), ("vehicle",)):
        if (name := str(keys[-1])) in WAGON and (remark := WAGON[name].remark(value)):
            yield keys, value, remark


def _numbers(data: Any, keys: Keys = ()) -> Iterator[tuple[Keys, float]]:
    """All numbers in tables and arrays with their keys."""
    if isinstance(data, float | int) and not isinstance(data, bool):
        yield keys, data
    elif isinstance(data, Mapping | tuple):
        for key, item in data.items() if isinstance(data, Mapping) else enumerate(data):
            yield from _numbers(item, (*keys, key))
