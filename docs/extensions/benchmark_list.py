"""The programs in `benchmarks/`, with the first paragraph of their docstrings."""

from __future__ import annotations

import ast
from pathlib import Path

from extensions.plain import plain

FOLDER = Path(__file__).parents[2] / "benchmarks"


def programs() -> dict[str, str]:
    """First paragraph of the docstring of every program, by name.

    A program is a file that runs as a script, or a package with a `__main__.py`, described by its `report.py`. Other
    files of such a package that run as scripts are programs of their own.
    """
    sources = {file.parent.name: file.with_name("report.py") for file in FOLDER.glob("*/__main__.py")}
    sources |= {file.stem: file for file in FOLDER.glob("*.py") if _runs(file)}
    sources |= {
        f"{file.parent.name}.{file.stem}": file
        for package in FOLDER.glob("*/__main__.py")
        for file in package.parent.glob("*.py")
        if file.stem not in ("report", "__main__") and _runs(file)
    }
    return {name: _summary(sources[name]) for name in sorted(sources)}


def _runs(file: Path) -> bool:
    return 'if __name__ == "__main__"' in file.read_text(encoding="utf-8")


def _summary(file: Path) -> str:
    doc = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
    return " ".join(doc.split("\n\n")[0].split())


def benchmark_list() -> str:
    """Markdown: a table of programs."""
    rows = [f"| `python -m benchmarks.{name}` | {plain(text)} |" for name, text in programs().items()]
    return "\n".join(["| program | contents |", "|---|---|", *rows])
