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
# Declarations that the header and cffi share; "elements" are numbers from wheelrail_open.
FUNCTIONS = """\
/* Version of the interface that the library has, WHEELRAIL_VERSION of its header. */
int wheelrail_version(void);
/* Number of a new element, 0 for a failure. options: JSON object, "friction", "left_friction" and "right_friction" are
 * coefficients. Without Python "scene" is an exported file in the folder, by default contact.wheelset in that of the
 * library; with Python it is a scene, the folder by default the working directory, and other options are arguments of
 * wheelrail.Wheelset. */
int wheelrail_open(const char *options, const char *folder);
int wheelrail_close(int element);
/* Inputs of the scene's state. */
int wheelrail_start(int element, double inputs[]);
/* Forces of a trial state, from the last accepted one; NaN on a side that failed. */
int wheelrail_solve(int element, const double inputs[], double outputs[]);
/* The last solved state stands: the next solves start from it. */
int wheelrail_accept(int element);
/* Derivatives of the first WHEELRAIL_FORCES outputs by one input at the last solved state. */
int wheelrail_tangent(int element, int input, double derivatives[]);
/* WHEELRAIL_PATCH_VALUES values of the left, then as many of the right side, at the last solved state. */
int wheelrail_patches(int element, double values[]);
/* Store the accepted state at a place of your choice, and return to it. */
int wheelrail_save(int element, int place);
int wheelrail_restore(int element, int place);
/* Number of an input or output by name, -1 for an unknown one. */
int wheelrail_input(const char *name);
int wheelrail_output(const char *name);
/* Text of the last failure of an element, or of wheelrail_open for element 0; cut to size - 1 characters. */
int wheelrail_error(int element, char *text, int size);
"""


def c_header() -> str:
    """Text of wheelrail.h."""
    body = "\n".join(line for table in _TABLES for line in _enumeration(*table))
    return (
        _resource("wheelrail.h.in")
        .replace("@VERSION@", str(INTERFACE))
        .replace("@FORCES@", str(len(FORCES)))
        .replace("@TABLES@", body)
        .replace("@FUNCTIONS@", FUNCTIONS.rstrip())
    )


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
    """Positions from 1, as arrays have them in Fortran."""
    yield f"  ! {text}"
    for number, variable in enumerate(variables, 1):
        yield f"  integer, parameter :: {prefix}_{variable.name} = {number}  ! {variable.unit}"
    yield f"  integer, parameter :: {_count(prefix).lower()} = {len(variables)}"


def _count(prefix: str) -> str:
    return {"IN": "WHEELRAIL_INPUTS", "OUT": "WHEELRAIL_OUTPUTS", "PATCH": "WHEELRAIL_PATCH_VALUES"}[prefix]


def _resource(name: str) -> str:
    return files("wheelrail.export").joinpath(name).read_text(encoding="utf-8")
