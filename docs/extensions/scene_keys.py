"""Every key that a scene or a study may have, from the pydantic models that validate them."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from math import isinf
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from extensions.plain import plain

SENTENCES = Path(__file__).parents[1] / "reference" / "keys.toml"


@dataclass(frozen=True)
class Kind:
    """What a value may be, in words; its unit; the tables that it is made of."""

    allowed: str
    unit: str = ""
    tables: tuple[type[BaseModel], ...] = ()


def kind(annotation: Any, metadata: tuple[Any, ...] = ()) -> Kind:
    """Of a type annotation, and what pydantic has taken off it."""
    if get_origin(annotation) is Annotated:
        inner, *more = get_args(annotation)
        return kind(inner, (*metadata, *more))
    for item in metadata:
        if hasattr(item, "unit") and hasattr(item, "low"):  # a range
            return Kind(str(item) + (", whole" if annotation is int else ""), item.unit)
    origin, parts = get_origin(annotation), get_args(annotation)
    if origin is Literal:
        return Kind(" or ".join(map(toml, parts)))
    if origin in (Union, UnionType):
        kinds = [kind(part) for part in parts if part is not NoneType]
        return Kind(" or ".join(k.allowed for k in kinds), _unit(kinds), _tables(kinds))
    if origin in (tuple, list):
        kinds = [kind(part) for part in parts if part is not Ellipsis]
        if origin is list or (len(parts) == 2 and parts[1] is Ellipsis):
            (one,) = kinds
            text = "tables" if one.tables else f"a list, each {one.allowed}"
            return Kind(text, one.unit, one.tables)
        same = len({k.allowed for k in kinds}) == 1
        text = f"{len(kinds)} times {kinds[0].allowed}" if same else ", ".join(k.allowed for k in kinds)
        return Kind(f"[{text}]", _unit(kinds), _tables(kinds))
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return Kind("a table", "", (annotation,))
    if origin is dict:
        each = kind(parts[1])
        return Kind(f"a table of names, each {each.allowed}", each.unit, each.tables)
    plain = {bool: "true or false", str: "a text", int: "a whole number", float: "a number"}
    return Kind(plain.get(annotation, "a value"))


def _unit(kinds: list[Kind]) -> str:
    return ", ".join(dict.fromkeys(k.unit for k in kinds if k.unit))


def _tables(kinds: list[Kind]) -> tuple[type[BaseModel], ...]:
    return tuple(table for k in kinds for table in k.tables)


def toml(value: Any) -> str:
    """A value as code, as it is written in a scene."""
    return f"`{_bare(value)}`"


def _bare(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, float) and isinf(value):
        return "inf" if value > 0 else "-inf"
    if isinstance(value, (tuple, list)):
        return "[" + ", ".join(map(_bare, value)) + "]"
    return f"{value:g}" if isinstance(value, float) else str(value)


def default(field: FieldInfo) -> str:
    """What is taken where a key is left out."""
    if field.is_required():
        return "must be given"
    value = field.get_default(call_default_factory=True)
    if value is None or value is PydanticUndefined:
        return ""
    return "that of its keys" if isinstance(value, BaseModel) else toml(value)


def sentence(model: type[BaseModel], key: str) -> str:
    """Description of a key: of the model, or in keys.toml under the class that defines it."""
    sentences = tomllib.loads(SENTENCES.read_text(encoding="utf-8"))
    description = model.model_fields[key].description
    return description or next(
        (sentences[c.__name__][key] for c in model.__mro__ if key in sentences.get(c.__name__, {})), ""
    )


def own_keys(model: type[BaseModel]) -> list[str]:
    """Keys that a class itself adds, or gives another default."""
    # not by __annotations__, to which autodoc adds those of base classes
    above = {key: f for base in model.__bases__ if issubclass(base, BaseModel) for key, f in base.model_fields.items()}
    return [
        key
        for key, f in model.model_fields.items()
        if key not in above or (f.annotation, f.default) != (above[key].annotation, above[key].default)
    ]


def models(roots: tuple[type[BaseModel], ...]) -> list[type[BaseModel]]:
    """The classes of these models and of all tables in them that have keys of their own, each once."""
    classes: dict[type[BaseModel], None] = {}
    for root in roots:
        bases = [c for c in reversed(root.__mro__) if issubclass(c, BaseModel) and c is not BaseModel and own_keys(c)]
        classes |= dict.fromkeys(bases)
    tables = [table for model in classes for key in own_keys(model) for table in _of(model, key).tables]
    new = tuple(table for table in dict.fromkeys(tables) if table not in classes)
    return [*classes, *(m for m in models(new) if m not in classes)] if new else list(classes)


def _of(model: type[BaseModel], key: str) -> Kind:
    field = model.model_fields[key]
    return kind(field.annotation, tuple(field.metadata))


def table_headings(
    model: type[BaseModel], path: str = "", brackets: str = "[]"
) -> Iterator[tuple[type[BaseModel], str]]:
    """Every class of a model and of the tables in it, with the heading that it has in a file."""
    for c in model.__mro__ if path else ():
        if issubclass(c, BaseModel):
            yield c, f"`{brackets[: len(brackets) // 2]}{path}{brackets[len(brackets) // 2 :]}`"
    for key in model.model_fields:
        k = _of(model, key)
        for inner in k.tables:
            name = f"{path}.{key}" if path else key
            yield from table_headings(
                inner,
                name + (".NAME" if "table of names" in k.allowed else ""),
                "[[]]" if k.allowed == "tables" else "[]",
            )


def table(model: type[BaseModel], headings: list[str]) -> Iterator[str]:
    """Markdown section of a table: headings, docstring of its class, and its own keys."""
    yield from (f"## {model.__name__}", "")
    if headings:
        yield from (", ".join(headings), "")
    yield from ("\n\n".join(map(plain, (model.__doc__ or "").strip().split("\n\n"))), "")
    yield from ("| key | allowed | unit | default | meaning |", "|---|---|---|---|---|")
    for key in own_keys(model):
        k = _of(model, key)
        links = ", ".join(f"[{t.__name__}](#{t.__name__.lower()})" for t in k.tables)
        allowed = (k.allowed + (f": {links}" if links else "")).replace("|", r"\|")
        yield f"| `{key}` | {allowed} | {k.unit} | {default(model.model_fields[key])} | {sentence(model, key)} |"
    yield ""


def scene_keys() -> str:
    """Markdown: all tables of all kinds of scenes."""
    from wheelrail.scenes.schema.scene import KINDS

    return _tables_of(*KINDS.values())


def study_keys() -> str:
    """Markdown: all tables of a study."""
    return _tables_of(*study_models())


def wear_keys() -> str:
    """Markdown: all tables of a wear file."""
    return _tables_of(*wear_models())


def wear_models() -> tuple[type[BaseModel], ...]:
    """What checks wear files, in versions that have them."""
    if find_spec("wheelrail.scenes.wear") is None:
        return ()
    return (import_module("wheelrail.scenes.wear.schema").WearTable,)


def study_models() -> tuple[type[BaseModel], ...]:
    """What checks studies, in versions that have them."""
    if find_spec("wheelrail.scenes.studies") is None:
        return ()
    return (import_module("wheelrail.scenes.studies.schema").StudyTable,)


def _tables_of(*roots: type[BaseModel]) -> str:
    where: dict[type[BaseModel], dict[str, None]] = {}
    for root in roots:
        for model, heading in table_headings(root):
            where.setdefault(model, {})[heading] = None
    return "\n".join(line for model in models(roots) for line in table(model, list(where.get(model, {}))))
