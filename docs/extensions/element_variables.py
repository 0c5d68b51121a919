"""Inputs and outputs of a wheelset's contact element, from the table that arrays, the C header and the FMU have."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wheelrail.api.elements.variables import Variable


def element_variables() -> str:
    """Markdown: a table for each list of variables."""
    from wheelrail.api.elements.variables import INPUTS, OUTPUTS, PARAMETERS, PATCH

    lists = {"Inputs": INPUTS, "Outputs": OUTPUTS, "Values of a patch": PATCH, "Parameters": PARAMETERS}
    return "\n".join(line for heading, variables in lists.items() for line in _table(heading, variables))


def _table(heading: str, variables: Sequence[Variable]) -> Iterator[str]:
    yield from (f"**{heading}**", "", "| number | name | unit | meaning |", "|---|---|---|---|")
    for number, variable in enumerate(variables):
        yield f"| {number} | `{variable.name}` | {variable.unit} | {variable.description} |"
    yield ""
