"""The C header and the Fortran module of the contact element, from the tables of its inputs and outputs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from importlib.resources import files

from wheelrail.api.elements.variables import FORCES, INPUTS, OUTPUTS, PATCH, Variable
from wheelrail.bindings._contact import INTERFACE

_TABLES: tuple[tuple[str, str, Sequence[Variable]], ...] = (
    ("IN", "inputs of wheelrail_solve", INPUTS),
    ("OUT", "outputs of wheelrail_solve", OUTPUTS),
    ("PATCH", "values of the most loaded patch of a side", PATCH),
)


def c_header() -> str:
    """Text of wheelrail.h."""
    body = "\n".join(line for table in _TABLES for line in _enumeration(*table))
    return (
        _resource("wheelrail.h.in")
        .replace("@VERSION@", str(INTERFACE))
        .replace("@FORCES@", str(len(FORCES)))
        .replace("@TABLES@", body)
        .replace("@FUNCTIONS@", functions().rstrip())
    )


def functions() -> str:
    """Declarations of the functions of wheelrail.h, which the core and cffi read, too."""
    return _resource("functions.h")


def fortran_module() -> str:
    """Text of wheelrail.f90."""
    numbers = [line for table in _TABLES for line in _constants(*table)]
    numbers.append(f"  integer, parameter :: wheelrail_forces = {len(FORCES)}")
    return _resource("wheelrail.f90.in").replace("@TABLES@", "\n".join(numbers))


def _enumeration(prefix: str, text: str, variables: Sequence[Variable]) -> Iterator[str]:
    """An enumeration with a comment for every number; its last name is their count."""
    yield f"enum {{ /* {text} */"
    width = max(len(variable.name) for variable in variables) + len(prefix) + len("WHEELRAIL__,")
    for variable in variables:
        name = f"WHEELRAIL_{prefix}_{variable.name.upper()},"
        yield f"    {name:{width}} /* {variable.unit}: {variable.description} */"
    yield f"    {_count(prefix)}"
    yield "};"


def _constants(prefix: str, text: str, variables: Sequence[Variable]) -> Iterator[str]:
    """Fortran constants for positions in an array, counted from 1."""
    yield f"  ! {text}"
    for number, variable in enumerate(variables, 1):
        yield f"  integer, parameter :: {prefix}_{variable.name} = {number}  ! {variable.unit}"
    yield f"  integer, parameter :: {_count(prefix).lower()} = {len(variables)}"


def _count(prefix: str) -> str:
    return {"IN": "WHEELRAIL_INPUTS", "OUT": "WHEELRAIL_OUTPUTS", "PATCH": "WHEELRAIL_PATCH_VALUES"}[prefix]


def _resource(name: str) -> str:
    return files("wheelrail.export").joinpath(name).read_text(encoding="utf-8")
