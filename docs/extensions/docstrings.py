"""Docstrings are plain text, in which *, | and _ mean themselves: nothing in them can break the build."""

from __future__ import annotations

import re
from inspect import cleandoc
from itertools import groupby
from typing import Any

from sphinx.application import Sphinx

ALIAS = re.compile(r"TypeAliasForwardRef\('([\w.]+)'\)")
SPECIAL = re.compile(r"([*|_\\<>])")


def restructured(lines: list[str]) -> list[str]:
    """The lines in reStructuredText: `names` as code, indented blocks and sessions as they are, the rest as text."""
    result: list[str] = []
    for blank, group in groupby(cleandoc("\n".join(lines)).splitlines(), key=lambda line: not line.strip()):
        part = list(group)
        if blank:
            continue
        if part[0].startswith((" ", ">>>")):
            result += ["::", "", *("    " + line for line in part), ""]
        elif part[0].startswith("- "):
            result += [*map(_escaped, part), ""]
        else:
            result += [*(_escaped(line.strip()) for line in part), ""]
    return result


def _escaped(line: str) -> str:
    code = re.split(r"(`+[^`]+`+)", line)
    return "".join(
        f"``{part.strip('`')}``" if i % 2 else SPECIAL.sub(r"\\\1", part).replace("`", r"\`")
        for i, part in enumerate(code)
    )


def process(app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    lines[:] = restructured(lines)


def signature(
    app: Sphinx, what: str, name: str, thing: Any, options: Any, arguments: str | None, returned: str | None
) -> tuple[str | None, str | None]:
    """Names of type aliases, which Sphinx does not resolve inside other types."""
    return tuple(text and ALIAS.sub(r"\1", text) for text in (arguments, returned))  # type: ignore[return-value]


def skip(app: Sphinx, what: str, name: str, thing: Any, skipped: bool, options: Any) -> bool | None:
    """Skip the generated docstrings of fields of named tuples."""
    return True if str(getattr(thing, "__doc__", "")).startswith("Alias for field number") else None


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("autodoc-process-docstring", process)
    app.connect("autodoc-process-signature", signature)
    app.connect("autodoc-skip-member", skip)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
