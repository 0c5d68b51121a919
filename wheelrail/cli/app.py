"""The command group, and the exit codes of its commands."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from wheelrail.cli.exit_codes import FAILED, INTERRUPTED


class Commands(TyperGroup):
    """Group of all commands; Ctrl-C and a closed standard output end with one line and an exit code."""

    def invoke(self, ctx: Any) -> Any:
        try:
            done = super().invoke(ctx)
            sys.stdout.flush()
        except KeyboardInterrupt:
            print("interrupted", file=sys.stderr)
            raise typer.Exit(INTERRUPTED) from None
        except OSError as error:
            print(f"standard output: {error.strerror or error}", file=sys.stderr)
            with suppress(OSError, ValueError):  # otherwise Python flushes the buffer again at exit
                os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            raise typer.Exit(FAILED) from None
        return done


app = typer.Typer(
    cls=Commands,
    help="Elastic wheel-rail contact for railway vehicle dynamics.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


def _print_version(wanted: bool) -> None:
    if wanted:
        from wheelrail.support.version import release

        print(f"wheelrail {release()}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_print_version, is_eager=True, help="Print version and commit, and exit."),
    ] = False,
    laws: Annotated[
        list[str] | None,
        typer.Option(
            "--laws",
            metavar="MODULE",
            help='Allow scenes to use laws "MODULE:Class" of your Python module; repeatable.',
        ),
    ] = None,
) -> None:
    """Detailed wheel-rail contact by finite elements, inside a vehicle simulation."""
    if laws:
        from wheelrail.contact.laws.registry import allow

        allow(*laws)
