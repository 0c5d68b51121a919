"""Arguments of Python calls as the keys of a scene, checked by the same models."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.messages import nearest_name
from wheelrail.scenes.schema.scene import Scene, checked, warned
from wheelrail.scenes.schema.tables import SceneTable

if TYPE_CHECKING:
    from wheelrail.meshes.profiles.profile import Profile


def keys_of(*tables: type[SceneTable]) -> dict[str, None]:
    """All keys of some tables of a scene."""
    return {key: None for table in tables for key in table.model_fields}


def check_keys(caller: str, keys: Iterable[str], allowed: Iterable[str]) -> None:
    """Raises SceneError for a key that is not allowed, naming caller, key and the nearest allowed one."""
    allowed = list(allowed)
    for key in keys:
        if key not in allowed:
            near = nearest_name(key, allowed)
            hint = f"did you mean {near}?" if near else f"allowed are {', '.join(allowed)}"
            raise SceneError(f"{caller}: {key}: unknown argument; {hint}")


def scene_of(
    caller: str,
    kind: str,
    keys: Mapping[str, Any],
    sections: Mapping[str, Container[str]],
    given: Mapping[str, Profile] | None = None,
) -> Scene:
    """Scene from flat keys, each put into its section.

    Parameters:
        caller: name of the function or class for error messages.
        kind: "hertz" or "wheelset".
        keys: values by key; None is left out.
        sections: keys by section.
        given: profiles passed as objects, by the names that the keys have in place of files.

    Warns of unusual values. Raises SceneError naming argument, value and what is allowed.
    """
    data: dict[str, Any] = {"kind": kind, **{section: {} for section in sections}}
    for key, value in keys.items():
        if value is None:
            continue
        section = next((name for name, own_keys in sections.items() if key in own_keys), None)
        (data if section is None else data[section])[key] = plain(value)
    return warned(checked(data, caller, given=given, unnamed=sections), caller, sections)


def with_names(caller: str, table: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Profile]]:
    """Profile keys with names in place of Profile objects, and the Profile objects by name.

    Parameters:
        caller: name of the function or class for error messages.
        table: keys of [profiles] of a scene; wheel and rail, there and in left and right, may be Profile objects.

    Raises SceneError for a profile of the other body.
    """
    from wheelrail.meshes.profiles.profile import Profile

    names: dict[str, Any] = dict(table)
    given: dict[str, Profile] = {}
    for key, value in table.items():
        if isinstance(value, Profile):
            if value.kind != key:
                raise SceneError(f"{caller}: {key} = {value!r}: must be a {key} profile")
            names[key] = f"{value.name} ({value.digest()[:8]})"
            given[names[key]] = value
        elif isinstance(value, Path):
            names[key] = str(value)
        elif key in ("left", "right") and isinstance(value, Mapping):
            names[key], own = with_names(caller, value)
            given |= own
    return names, given


def plain(value: Any) -> Any:
    """NumPy numbers and arrays as Python numbers and lists, tuples as lists, laws as tables."""
    if hasattr(value, "coefficient") or hasattr(value, "pressure"):
        from wheelrail.contact.laws.registry import law_table

        return law_table(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return value


def replaced(base: Mapping[str, Any], changes: Mapping[str, Any], groups: Iterable[tuple[str, ...]]) -> dict[str, Any]:
    """Base values with changes; None changes nothing.

    Parameters:
        base, changes: values by key.
        groups: keys that exclude each other: a change of one removes the others of its group from the base.
    """
    removed = {key for group in groups if any(changes.get(key) is not None for key in group) for key in group}
    remaining = {key: value for key, value in base.items() if key not in removed}
    return {**remaining, **{key: value for key, value in changes.items() if value is not None}}
