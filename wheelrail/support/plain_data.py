"""Nested dataclasses, containers, numbers and arrays as bytes that hold plain data only.

A line of JSON is followed by the arrays' elements, one array after another. The JSON has the classes (name and
fields), the arrays (type, shape and order) and the value, in which compounds are lists that begin with their kind.
Nothing in the bytes is executed: objects are made without calling their class, but for structures of the core, which
check their fields, and only of dataclasses, named tuples and structures of the packages that the reader admits. Numbers
keep every bit, also those of arrays; an array that occurs twice is stored once.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from importlib import import_module
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

JSON_TYPES = (type(None), bool, int, float, str)
ARRAY_TYPE = re.compile(r"[<>|][biufc]\d{1,2}")  # numbers and truth values, no objects
MODULE = re.compile(r"[a-z_0-9]+(\.[a-z_0-9]+)+")


class NotPlainData(ValueError):
    """Bytes not written by `encode`, or of unknown or forbidden classes."""


def encode(value: Any) -> bytes:
    """A value as bytes.

    Parameters:
        value: None, truth values, numbers, strings, arrays of numbers, and lists, tuples, mappings, dataclasses,
            named tuples and structures of the core of such values. Another sequence is stored as a tuple, another
            mapping as a dictionary.

    Raises TypeError for anything else.
    """
    writer = _Writer()
    tree = writer.tree(value)
    head = {"classes": writer.classes, "arrays": [_layout(array) for array in writer.arrays], "value": tree}
    return b"\n".join([json.dumps(head).encode(), b"".join(array.tobytes("A") for array in writer.arrays)])


def decode(data: bytes, packages: Sequence[str]) -> Any:
    """The value of bytes from `encode`.

    Parameters:
        data: the bytes.
        packages: whose classes are admitted, with the packages inside them.

    Raises NotPlainData. The fields of an object may have any of the types above: the caller checks those it relies on.
    """
    text, _, elements = data.partition(b"\n")
    try:
        head = json.loads(text)
        classes = [_admitted_class(entry, packages) for entry in head["classes"]]
        return _value(head["value"], classes, list(_arrays(head["arrays"], elements)))
    except (ValueError, TypeError, LookupError, AttributeError, ImportError, ArithmeticError, RecursionError) as error:
        raise NotPlainData(f"{type(error).__name__}: {str(error)[:200]}") from error


class _Writer:
    """Classes and arrays of a value, by number."""

    def __init__(self) -> None:
        self.classes: list[tuple[str, str, list[str]]] = []
        self.arrays: list[NDArray[Any]] = []
        self._class_numbers: dict[type, int] = {}
        self._array_numbers: dict[int, int] = {}

    def tree(self, value: Any) -> Any:
        """The value in the types of JSON."""
        kind: type = value.__class__  # that of objects computed at first access, too
        if kind in JSON_TYPES:
            return value
        if isinstance(value, np.ndarray):
            return ["array", self._array_number(value)]
        if isinstance(value, np.generic):
            return ["number", self._array_number(np.asarray(value))]
        if is_dataclass(kind):
            return self._object(kind, [(part.name, getattr(value, part.name)) for part in fields(kind)])
        if hasattr(kind, "_fields"):
            return self._object(kind, [(name, getattr(value, name)) for name in kind._fields])
        if isinstance(value, Mapping):
            return ["dict", *([self.tree(key), self.tree(item)] for key, item in value.items())]
        if isinstance(value, Sequence) and not isinstance(value, bytes | bytearray | memoryview | str):
            return ["list" if isinstance(value, list) else "tuple", *map(self.tree, value)]
        raise TypeError(f"a {kind.__module__}.{kind.__qualname__} is no plain data")

    def _object(self, kind: type, values: Sequence[tuple[str, Any]]) -> list[Any]:
        if kind not in self._class_numbers:
            self._class_numbers[kind] = len(self.classes)
            self.classes.append((kind.__module__, kind.__qualname__, [name for name, _ in values]))
        return ["object", self._class_numbers[kind], *(self.tree(value) for _, value in values)]

    def _array_number(self, array: NDArray[Any]) -> int:
        if not ARRAY_TYPE.fullmatch(array.dtype.str):
            raise TypeError(f"an array of {array.dtype} is no plain data")
        if id(array) not in self._array_numbers:
            self._array_numbers[id(array)] = len(self.arrays)
            self.arrays.append(array)  # which keeps its id from being used again
        return self._array_numbers[id(array)]


def _layout(array: NDArray[Any]) -> tuple[str, tuple[int, ...], str]:
    """Data type, shape and memory order of an array as written by `tobytes("A")`."""
    columns_first = array.flags.f_contiguous and not array.flags.c_contiguous
    return array.dtype.str, array.shape, "F" if columns_first else "C"


def _arrays(layouts: Sequence[tuple[str, list[int], str]], elements: bytes) -> Iterator[NDArray[Any]]:
    """The arrays, one after another in the elements."""
    start = 0
    for name, shape, order in layouts:
        if not ARRAY_TYPE.fullmatch(name) or order not in ("C", "F") or not all(length >= 0 for length in shape):
            raise ValueError(f"an array of type {name!s:.20}, shape {shape!s:.50} and order {order!s:.20}")
        element, count = np.dtype(name), prod(shape)
        stored: NDArray[Any] = np.frombuffer(elements[start : start + count * element.itemsize], element)
        if element.kind == "b":  # other bytes than 0 and 1 are no truth values
            stored = stored.view(np.uint8) != 0
        yield stored.reshape(shape, order=order).copy(order=order)  # type: ignore[call-overload]
        start += count * element.itemsize
    if start != len(elements):
        raise ValueError(f"{len(elements)} bytes of arrays, {start} expected")


def _admitted_class(entry: tuple[str, str, list[str]], packages: Sequence[str]) -> type:
    """The dataclass, named tuple or structure of an admitted package with this module, name and fields."""
    module, name, names = entry
    if not MODULE.fullmatch(module) or not module.startswith(tuple(f"{package}." for package in packages)):
        raise ValueError(f"{module!s:.100}.{name!s:.50} is not admitted")
    member = getattr(import_module(module), name)
    if not isinstance(member, type) or member.__module__ != module:  # defined there, not imported
        raise ValueError(f"{module}.{name} is not admitted")
    present = [part.name for part in fields(member)] if is_dataclass(member) else list(getattr(member, "_fields", ()))
    if present != names:
        raise ValueError(f"{module}.{name} has fields {present}, the data has {names!s:.100}")
    return member


def _value(tree: Any, classes: Sequence[type], arrays: Sequence[NDArray[Any]]) -> Any:
    if not isinstance(tree, list):
        if type(tree) not in JSON_TYPES:
            raise ValueError(f"a {type(tree).__name__}")
        return tree
    kind, *parts = tree
    if kind == "array":
        return arrays[parts[0]]
    if kind == "number":
        return arrays[parts[0]][()]
    if kind == "object":
        return _object(classes[parts[0]], [_value(part, classes, arrays) for part in parts[1:]])
    if kind == "dict":
        return {_value(key, classes, arrays): _value(item, classes, arrays) for key, item in parts}
    values = (_value(part, classes, arrays) for part in parts)
    if kind == "list":
        return list(values)
    if kind == "tuple":
        return tuple(values)
    raise ValueError(f"unknown kind {kind!s:.20}")


def _object(kind: Any, values: list[Any]) -> Any:
    """An object with given values of its fields, without a call of its class, but for structures of the core."""
    if hasattr(kind, "_fields"):
        return kind._make(values) if issubclass(kind, tuple) else kind(*values)
    made = object.__new__(kind)
    for part, value in zip(fields(kind), values, strict=True):
        object.__setattr__(made, part.name, value)
    return made
