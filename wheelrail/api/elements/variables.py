"""Numbers that a host program exchanges with the contact element of a wheelset, from the table of the core.

The order of a list is the order in arrays; a name is a valid identifier in C, Fortran and Python.
"""

from __future__ import annotations

from dataclasses import dataclass

from wheelrail.bindings._contact import input_variables, output_variables, parameter_variables, patch_variables
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.kinematics.wheelset_state import WheelsetState


@dataclass(frozen=True)
class Variable:
    """A number with its unit.

    Parameters:
        name: in all languages.
        unit: SI; "1" for numbers without unit.
        description: one sentence without full stop.
    """

    name: str
    unit: str
    description: str


INPUTS, OUTPUTS, PATCH, PARAMETERS = (
    tuple(Variable(*row) for row in rows())
    for rows in (input_variables, output_variables, patch_variables, parameter_variables)
)  # PATCH: of the patch with the largest normal force of a side
FORCES = OUTPUTS[: 6 * len(SIDES)]
assert tuple(variable.name for variable in INPUTS[: len(WheelsetState.coordinates)]) == WheelsetState.coordinates
