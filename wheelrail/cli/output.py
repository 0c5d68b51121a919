"""Standard output of the commands, tables for readers or one JSON object for programs, and their exit codes."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

    from wheelrail.scenes.datasets.result_table import Results, TextTable

FAILED, BAD_INPUT, INTERRUPTED = 1, 2, 130  # exit codes; 0 is success


class Output:
    """Whether results are printed as JSON."""

    json = False


def print_results(results: Results) -> None:
    """Print the results of a command to standard output: texts and tables, or with --json one JSON object."""
    from wheelrail.scenes.datasets.result_table import ResultTable, json_text

    if Output.json:
        print(json_text(results.report))
        return
    for part in results.parts:
        if isinstance(part, str):
            print(part)
        else:
            _print_table(part.as_text if isinstance(part, ResultTable) else part)


def print_files(command: str, *files: Path) -> None:
    """Print the files that a command has written."""
    from wheelrail.scenes.datasets.result_table import Results

    print_results(Results(command, list(map(str, files)), {"files": files}))


def result_console() -> Console:
    """The console for tables: standard output, of any width when it is no terminal."""
    from rich.console import Console

    return Console(width=None if sys.stdout.isatty() else 1000, soft_wrap=True, markup=False, emoji=False)


def _print_table(table: TextTable) -> None:
    """Print a table; without lines when standard output is no terminal."""
    from rich.table import Table
    from rich.text import Text

    console = result_console()
    plain = {} if console.is_terminal else {"box": None, "pad_edge": False}
    shown = Table(**plain)  # type: ignore[arg-type]
    for index, head in enumerate(table.head):
        shown.add_column(Text(head), justify="right" if index in table.right else "left")
    for row in table.rows:
        if row:
            shown.add_row(*map(Text, row))
        else:
            shown.add_section()
    for piece in (table.title, shown, table.note):
        if piece:
            console.print(piece, highlight=False)
