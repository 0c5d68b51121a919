"""modelDescription.xml of a functional mock-up unit (FMI 2.0, 3.0), from the tables of its variables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from wheelrail.api.elements.variables import FORCES, INPUTS, OUTPUTS, PARAMETERS, PATCH, Variable
from wheelrail.contact.kinematics.frames import SIDES

Fmi = Literal["2.0", "3.0"]
OUT, PARAMETER, FIRST_PATCH, TIME = 100, 200, 300, 400  # numbers of the first variable of a kind, as in unit.c
UNITS: dict[str, dict[str, int]] = {  # exponents of the base units
    "s": {"s": 1},
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
    """Properties of a functional mock-up unit.

    Parameters:
        fmi: version of the interface.
        identifier: of the model, a C identifier.
        token: instantiation token, in FMI 2.0 the GUID.
        version: of this package.
        start: (17,) start values of the inputs.
        friction: (2,) start values of the parameters; empty for a friction law, which cannot be set.
        has_tangent: whether the model has directional derivatives.
    """

    fmi: Fmi
    identifier: str
    token: str
    version: str
    start: Sequence[float]
    friction: Sequence[float]
    has_tangent: bool


@dataclass(frozen=True)
class UnitVariable:
    """A variable of a unit.

    Parameters:
        variable: of the table.
        number: value reference.
        causality, variability: of FMI.
        start: value, None where there is none.
    """

    variable: Variable
    number: int
    causality: str
    variability: str = "continuous"
    start: float | None = None


def model_description(unit: UnitModel) -> str:
    """Text of modelDescription.xml."""
    root = Element(
        "fmiModelDescription",
        {"fmiVersion": unit.fmi, "modelName": unit.identifier, _token_name(unit): unit.token},
        description="Contact of a wheelset with its rails: state in, forces on the wheels out",
        version=unit.version,
        generationTool=f"wheelrail {unit.version}",
        variableNamingConvention="flat",
    )
    _interfaces(root, unit)
    definitions = SubElement(root, "UnitDefinitions")
    for name, exponents in UNITS.items():
        base = {base: str(exponent) for base, exponent in exponents.items()}
        SubElement(SubElement(definitions, "Unit", name=name), "BaseUnit", base)
    categories = SubElement(root, "LogCategories")
    SubElement(categories, "Category", name="logStatusError", description="reasons of failed solves and refused values")
    _variables_and_structure(root, unit)
    indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, encoding="unicode") + "\n"


def _token_name(unit: UnitModel) -> str:
    return "guid" if unit.fmi == "2.0" else "instantiationToken"


def _interfaces(root: Element, unit: UnitModel) -> None:
    """Elements for model exchange and co-simulation, with their capabilities."""
    derivatives = str(unit.has_tangent).lower()
    if unit.fmi == "2.0":
        root.set("numberOfEventIndicators", "0")
        can = {"canNotUseMemoryManagementFunctions": "true", "canGetAndSetFMUstate": "true"}
        can["providesDirectionalDerivative"], completed = derivatives, {}
    else:
        can = dict.fromkeys(("providesDirectionalDerivatives", "providesAdjointDerivatives"), derivatives)
        can["canGetAndSetFMUState"], completed = "true", {"needsCompletedIntegratorStep": "true"}
    SubElement(root, "ModelExchange", {"modelIdentifier": unit.identifier, **completed, **can})
    step = {"canHandleVariableCommunicationStepSize": "true"}
    SubElement(root, "CoSimulation", {"modelIdentifier": unit.identifier, **step, **can})


def _variables_and_structure(root: Element, unit: UnitModel) -> None:
    """All variables; forces and moments are outputs, also at the start."""
    parent, structure = SubElement(root, "ModelVariables"), Element("ModelStructure")
    unknowns: list[dict[str, str]] = []
    for index, item in enumerate(unit_variables(unit), 1):
        attributes = {
            "name": item.variable.name,
            "valueReference": str(item.number),
            "description": item.variable.description,
            "causality": item.causality,
            "variability": item.variability,
        }
        real = {} if item.variable.unit == "1" else {"unit": item.variable.unit}
        if item.start is not None:
            real["start"] = repr(float(item.start))
        if unit.fmi == "2.0":
            SubElement(SubElement(parent, "ScalarVariable", attributes), "Real", real)
        else:
            SubElement(parent, "Float64", {**attributes, **real})
        if item.causality == "output":
            unknowns.append({"index": str(index)} if unit.fmi == "2.0" else {"valueReference": str(item.number)})
    root.append(structure)
    if unit.fmi == "2.0":
        for part in ("Outputs", "InitialUnknowns"):
            group = SubElement(structure, part)
            for attributes in unknowns:
                SubElement(group, "Unknown", attributes)
    else:
        for part in ("Output", "InitialUnknown"):
            for attributes in unknowns:
                SubElement(structure, part, attributes)


def unit_variables(unit: UnitModel) -> Iterator[UnitVariable]:
    """All variables in their order."""
    if unit.fmi == "3.0":
        yield UnitVariable(Variable("time", "s", "time"), TIME, "independent")
    for number, variable in enumerate(INPUTS):
        yield UnitVariable(variable, number, "input", start=unit.start[number])
    for number, variable in enumerate(OUTPUTS):
        yield UnitVariable(variable, OUT + number, "output" if number < len(FORCES) else "local")
    for number, (variable, value) in enumerate(zip(PARAMETERS, unit.friction, strict=False)):
        yield UnitVariable(variable, PARAMETER + number, "parameter", "fixed", value)
    for number, (side, variable) in enumerate((side, variable) for side in SIDES for variable in PATCH):
        text = f"{side} side, most loaded patch: {variable.description}"
        named = Variable(f"{side}_patch_{variable.name}", variable.unit, text)
        yield UnitVariable(named, FIRST_PATCH + number, "local")
