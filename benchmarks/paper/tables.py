"""Tables 5 to 7 as Markdown: our runs, one per row, and the paper's rows."""

from __future__ import annotations

from typing import Any

from benchmarks.paper.error import Ran
from benchmarks.paper.published import TABLES
from benchmarks.paper.variants import PaperVariant

HEAD = (
    "variant|contact model|part s|#cps R|#cps L|#New R|#New L|New/cp|lin/New|RHS|steps|time s|ms/cp|"
    "error y mm|error force %|note"
)


def line(cells: list[Any]) -> str:
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def markdown(head: str, rows: list[list[Any]]) -> str:
    """A table; columns of the head are separated by |."""
    titles = head.split("|")
    return "\n".join(line(cells) for cells in (titles, ["---"] * len(titles), *rows))


def row(variant: PaperVariant, ran: Ran, seconds: float) -> list[Any]:
    """One variant of a table."""
    form = [variant.name, variant.body.name, f"{seconds:g}"]
    cost, steps = ran.cost, ran.cost.steps
    if not ran.solves:
        return [*form, *[""] * 12, ran.failure]
    sides = cost.contact["right"], cost.contact["left"]
    note = "; ".join(filter(None, [ran.failure, ran.note, f"{steps.failed} failed steps" if steps.failed else ""]))
    errors = ["", ""] if ran.failure or ran.note else [f"{1e3 * ran.lateral:.2g}", f"{100 * ran.force:.2g}"]
    return [
        *form,
        *(side.solves for side in sides),
        *(side.newton for side in sides),
        f"{ran.newton:.2f}",
        f"{ran.linear:.2f}" if any(side.linear for side in sides) else "",
        steps.evaluations,
        f"{steps.accepted} + {steps.rejected}",
        f"{cost.seconds:.3g}",
        f"{1e3 * sum(side.seconds for side in sides) / ran.solves:.3g}",
        *errors,
        note,
    ]


def printed(name: str) -> str:
    """The paper's own table."""
    rows = [
        [
            published.name,
            *("not legible" if value is None else value for value in published.problems),
            *published.newton,
            *(published.linear or ("", "")),
            f"{published.seconds // 3600:.0f} h {published.seconds % 3600 // 60:.0f} min",
        ]
        for published in TABLES[name]
    ]
    return markdown("paper|#cps R|#cps L|#New R|#New L|#BiCGS R|#BiCGS L|time", rows)
