"""The command group, and the exit codes of its commands."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from functools import cache
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from wheelrail.cli.output import FAILED, INTERRUPTED, Output
from wheelrail.support.terminal import set_verbosity

QUIET = "Print results and errors only: no progress, no messages."
JSON = "Print results as one JSON object with schema and units, in SI units."
VERBOSE = "Print details of the solvers and warnings of libraries, too."


class Commands(TyperGroup):
    """Group of all commands; Ctrl-C and a closed standard output end with one line and an exit code."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        set_verbosity()
        Output.json = False
        return list(super().parse_args(ctx, args))

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """The command, with the options of all commands."""
        command: Any = super().get_command(ctx, cmd_name)
        if command is not None:
            command.params += [option for option in _shared_options() if option not in command.params]
        return command

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


def _set_quiet(given: bool) -> None:
    if given:
        set_verbosity(quiet=True)


def _set_verbose(given: bool) -> None:
    if given:
        set_verbosity(verbose=True)


def _set_json(given: bool) -> None:
    Output.json |= given


Quiet = Annotated[bool, typer.Option("--quiet", "-q", callback=_set_quiet, expose_value=False, help=QUIET)]
Verbose = Annotated[bool, typer.Option("--verbose", "-v", callback=_set_verbose, expose_value=False, help=VERBOSE)]
Json = Annotated[bool, typer.Option("--json", callback=_set_json, expose_value=False, help=JSON)]


@cache
def _shared_options() -> list[Any]:
    """Options of all commands."""
    shared = typer.Typer(add_completion=False)

    @shared.command()
    def output(json: Json = False, quiet: Quiet = False, verbose: Verbose = False) -> None: ...

    command: Any = typer.main.get_command(shared)
    return [parameter for parameter in command.params if parameter.name in ("json", "quiet", "verbose")]


app = typer.Typer(
    cls=Commands,
    help="Elastic wheel-rail contact for railway vehicle dynamics.",
    no_args_is_help=True,
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
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
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
