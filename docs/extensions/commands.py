"""The commands of `wheelrail`, as their own help texts have them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from extensions.plain import plain


def commands() -> str:
    """Markdown: a section for every command, with its arguments and options."""
    from typer.main import get_command

    from wheelrail.cli.main import app

    group: Any = get_command(app)
    return "\n".join(line for name in group.commands for line in _command(name, group.commands[name]))


def _command(name: str, command: Any) -> Iterator[str]:
    arguments = [p for p in command.params if p.param_type_name == "argument"]
    options = [p for p in command.params if p.param_type_name == "option" and p.name != "help"]
    usage = [p.metavar or p.name.upper() for p in arguments]
    usage = [text if p.required else f"[{text}]" for text, p in zip(usage, arguments, strict=True)]
    yield from (f"## {name}", "", "```sh")
    yield " ".join(["wheelrail", name, *usage, *(["[OPTIONS]"] if options else [])])
    yield from ("```", "", plain(command.help or ""), "")
    for p, text in zip(arguments, usage, strict=True):
        yield from _entry(text, p)
    for p in options:
        value = "" if p.is_flag else f" {p.metavar or p.name.upper()}"
        yield from _entry(", ".join([*p.opts, *p.secondary_opts]) + value, p)


def _entry(name: str, p: Any) -> Iterator[str]:
    default = p.default if p.default not in (None, False, ()) and not callable(p.default) else None
    default_text = "" if p.required or default is None or str(default) == "Ellipsis" else f" Default: `{default}`."
    yield from (f"`{name}`", f": {plain(p.help or '')}{default_text}", "")
