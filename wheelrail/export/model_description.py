"""modelDescription.xml of a functional mock-up unit (FMI 2.0), from the tables of inputs, outputs and parameters."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from wheelrail.api.elements.variables import FORCES, INPUTS, OUTPUTS, PARAMETERS, PATCH
from wheelrail.contact.kinematics.frames import SIDES

OUT, PARAMETER, FIRST_PATCH = 100, 200, 300  # numbers of the first variable of a kind, as in fmi2.c
UNITS: dict[str, dict[str, int]] = {  # exponents of the base units
    "m": {"m": 1},
    "m2": {"m": 2},
    "rad": {"rad": 1},
    "m/s": {"m": 1, "s": -1},
    "rad/s": {"rad": 1, "s": -1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "N.m": {"kg": 1, "m": 2, "s": -2},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
}


@dataclass(frozen=True)
class UnitModel:
    """What is particular to a unit.

    Parameters:
        identifier: of the model, a C identifier.
        guid: of the unit.
        version: of this package.
        start: (17,) start values of the inputs.
        friction: (2,) start values of the parameters; empty for a friction law, which cannot be set.
        has_tangent: whether the model has directional derivatives.
    """

    identifier: str
    guid: str
    version: str
    start: Sequence[float]
    friction: Sequence[float]
    has_tangent: bool


def model_description(unit: UnitModel) -> str:
    """Text of modelDescription.xml."""
    root = Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=unit.identifier,
        guid=unit.guid,
        description="Contact of a wheelset with its rails: state in, forces on the wheels out",
        version=unit.version,
        generationTool=f"wheelrail {unit.version}",
        variableNamingConvention="flat",
        numberOfEventIndicators="0",
    )
    can = {"canNotUseMemoryManagementFunctions": "true", "canGetAndSetFMUstate": "true"}
    can["providesDirectionalDerivative"] = str(unit.has_tangent).lower()
    SubElement(root, "ModelExchange", {"modelIdentifier": unit.identifier, **can})
    step = {"canHandleVariableCommunicationStepSize": "true"}
    SubElement(root, "CoSimulation", {"modelIdentifier": unit.identifier, **step, **can})
    definitions = SubElement(root, "UnitDefinitions")
    for name, exponents in UNITS.items():
        base = {base: str(exponent) for base, exponent in exponents.items()}
        SubElement(SubElement(definitions, "Unit", name=name), "BaseUnit", base)
    categories = SubElement(root, "LogCategories")
    SubElement(categories, "Category", name="logStatusError", description="reasons of failed solves and refused values")
    variables = SubElement(root, "ModelVariables")
    for attributes, real in _variables(unit):
        SubElement(SubElement(variables, "ScalarVariable", attributes), "Real", real)
    structure = SubElement(root, "ModelStructure")
    for part in ("Outputs", "InitialUnknowns"):
        unknowns = SubElement(structure, part)
        for number in range(len(FORCES)):
            SubElement(unknowns, "Unknown", index=str(len(INPUTS) + number + 1))
    indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, encoding="unicode") + "\n"


def _variables(unit: UnitModel) -> Iterator[tuple[dict[str, str], dict[str, str]]]:
    """Attributes of every scalar variable and of its number."""
    for number, variable in enumerate(INPUTS):
        yield _scalar(variable, number, "input"), _real(variable.unit, start=repr(float(unit.start[number])))
    for number, variable in enumerate(OUTPUTS):
        causality = "output" if number < len(FORCES) else "local"
        yield _scalar(variable, OUT + number, causality), _real(variable.unit)
    for number, (variable, value) in enumerate(zip(PARAMETERS, unit.friction, strict=False)):
        attributes = {**_scalar(variable, PARAMETER + number, "parameter"), "variability": "fixed"}
        yield attributes, _real(variable.unit, start=repr(float(value)))
    for number, (side, variable) in enumerate((side, variable) for side in SIDES for variable in PATCH):
        attributes = _scalar(variable, FIRST_PATCH + number, "local")
        text = f"{side} side, most loaded patch: {variable.description}"
        yield {**attributes, "name": f"{side}_patch_{variable.name}", "description": text}, _real(variable.unit)


def _scalar(variable: Any, number: int, causality: str) -> dict[str, str]:
    return {
        "name": variable.name,
        "valueReference": str(number),
        "description": variable.description,
        "causality": causality,
        "variability": "continuous",
    }


def _real(unit: str, **more: str) -> dict[str, str]:
    return {**({} if unit == "1" else {"unit": unit}), **more}
