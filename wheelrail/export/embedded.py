"""Functions of the C header in the Python that the library starts."""

from __future__ import annotations

from typing import Any

import numpy as np

from wheelrail.api.elements.variables import FORCES, INPUTS, OUTPUTS, PATCH
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.export.host import DONE, FAILED, NOBODY, Host
from wheelrail.support.arrays import Array

INPUT_NUMBERS, OUTPUT_NUMBERS = (
    {variable.name: number for number, variable in enumerate(variables)} for variables in (INPUTS, OUTPUTS)
)
UNKNOWN = -1  # name
RETURNED_AFTER_EXCEPTION = {
    "python_open": NOBODY,
    **dict.fromkeys(
        ("close", "start", "solve", "load", "accept", "tangent", "patches", "save", "restore", "error"), FAILED
    ),
    **dict.fromkeys(("input", "output"), UNKNOWN),
}


def define(ffi: Any) -> None:
    """Define all functions of the header.

    Parameters:
        ffi: of the library, from cffi.
    """
    functions = LibraryFunctions(ffi)
    for name, value in RETURNED_AFTER_EXCEPTION.items():
        ffi.def_extern(name=f"wheelrail_{name}", error=value)(getattr(functions, name))


class LibraryFunctions:
    """The functions of the header with pointers as arguments, see wheelrail.h.

    Parameters:
        ffi: of the library, from cffi.
    """

    def __init__(self, ffi: Any) -> None:
        self.ffi, self.host = ffi, Host()

    def _text(self, characters: Any) -> str:
        return "" if characters == self.ffi.NULL else str(self.ffi.string(characters).decode("utf-8", "replace"))

    def _array(self, pointer: Any, size: int) -> Array:
        return np.frombuffer(self.ffi.buffer(pointer, 8 * size))

    def python_open(self, options: Any, folder: Any) -> int:
        return self.host.open(self._text(options), self._text(folder))

    def close(self, element: int) -> int:
        return self.host.close(element)

    def start(self, element: int, inputs: Any) -> int:
        return self.host.start(element, self._array(inputs, len(INPUTS)))

    def solve(self, element: int, inputs: Any, outputs: Any) -> int:
        return self.host.solve(element, self._array(inputs, len(INPUTS)), self._array(outputs, len(OUTPUTS)))

    def load(self, element: int, wheels: int, load: float, inputs: Any, outputs: Any) -> int:
        state, forces = self._array(inputs, len(INPUTS)), self._array(outputs, len(OUTPUTS))
        return self.host.load(element, wheels, load, state, forces)

    def accept(self, element: int) -> int:
        return self.host.accept(element)

    def tangent(self, element: int, number: int, derivatives: Any) -> int:
        return self.host.tangent(element, number, self._array(derivatives, len(FORCES)))

    def patches(self, element: int, values: Any) -> int:
        return self.host.patches(element, self._array(values, len(SIDES) * len(PATCH)))

    def save(self, element: int, place: int) -> int:
        return self.host.save(element, place)

    def restore(self, element: int, place: int) -> int:
        return self.host.restore(element, place)

    def input(self, name: Any) -> int:
        return INPUT_NUMBERS.get(self._text(name), UNKNOWN)

    def output(self, name: Any) -> int:
        return OUTPUT_NUMBERS.get(self._text(name), UNKNOWN)

    def error(self, element: int, characters: Any, size: int) -> int:
        if size < 1:
            return FAILED
        text = self.host.error(element).encode("utf-8")[: size - 1].decode("utf-8", "ignore").encode("utf-8")
        self.ffi.memmove(characters, text + b"\0", len(text) + 1)
        return DONE
