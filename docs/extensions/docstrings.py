"""Docstrings are plain text, in which *, | and _ mean themselves: nothing in them can break the build.

Their lists of parameters become tables. numpydoc does not apply: to it all text up to the next heading is parameters,
here paragraphs on results and exceptions follow, and types stand in the signature alone.
"""

from __future__ import annotations

import re
from inspect import cleandoc
from itertools import groupby
from typing import Any

from sphinx.application import Sphinx

ALIAS = re.compile(r"TypeAliasForwardRef\('([\w.]+)'\)")
HEADING = re.compile(r"Parameters[\w ]*:")
SPECIAL = re.compile(r"([*|_\\<>])")


def restructured(lines: list[str]) -> list[str]:
    """The lines in reStructuredText: `names` as code, indented blocks and sessions as they are, the rest as text."""
    result: list[str] = []
    for blank, group in groupby(cleandoc("\n".join(lines)).splitlines(), key=lambda line: not line.strip()):
        part = list(group)
        if blank:
            continue
        if HEADING.fullmatch(part[0]) and len(part) > 1:
            result += _table(part[0], part[1:])
        elif part[0].startswith((" ", ">>>")):
            result += ["::", "", *("    " + line for line in part), ""]
        elif part[0].startswith("- "):
            result += [*map(_escaped, part), ""]
        else:
            result += [*(_escaped(line.strip()) for line in part), ""]
    return result


def _table(heading: str, lines: list[str]) -> list[str]:
    """Table of the entries "name, name: text" below a heading; deeper lines continue an entry."""
    entries: list[list[str]] = []
    for line in cleandoc("\n".join(lines)).splitlines():
        name, colon, text = line.partition(":")
        if not line.startswith(" ") and colon:
            entries.append([name, text.strip()])
        else:
            entries[-1][1] += f" {line.strip()}"
    rows: list[str] = []
    for name, text in entries:
        rows += [f"   * - {', '.join(f'``{part.strip()}``' for part in name.split(','))}", f"     - {_escaped(text)}"]
    return [f"**{heading.removesuffix(':')}**", "", ".. list-table::", "   :class: parameters", "", *rows, ""]


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
