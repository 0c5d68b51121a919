"""The programs in `benchmarks/`, by what their first lines say."""

from __future__ import annotations

import ast
from pathlib import Path

from extensions.plain import plain

FOLDER = Path(__file__).parents[2] / "benchmarks"


def programs() -> dict[str, str]:
    """First paragraph of the docstring of every file that is a program."""
    found = {}
    for file in sorted(FOLDER.glob("*.py")):
        text = file.read_text(encoding="utf-8")
        if 'if __name__ == "__main__"' in text:
            doc = ast.get_docstring(ast.parse(text)) or ""
            found[file.stem] = " ".join(doc.split("\n\n")[0].split())
    return found


def benchmark_list() -> str:
    """Markdown: a table of programs."""
    rows = [f"| `python -m benchmarks.{name}` | {plain(text)} |" for name, text in programs().items()]
    return "\n".join(["| program | what |", "|---|---|", *rows])
