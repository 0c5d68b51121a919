"""Entry point of the command `wheelrail`: Ctrl-C while modules load ends it with one line and an exit code."""

from __future__ import annotations

import os
import sys
from io import TextIOWrapper

from wheelrail.cli.output import BAD_INPUT, INTERRUPTED


def main() -> None:
    open_standard_streams()
    try:
        from wheelrail.support.interrupts import deferred_interrupts

        with deferred_interrupts():  # an interrupted import leaves C extensions half initialised
            from wheelrail.cli.main import main as command
        command()
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(INTERRUPTED)


def open_standard_streams() -> None:
    """Open closed standard input and error on the null device, and print characters that the locale does not have as
    escapes; exits with one line if standard output is closed.

    Else the first files that are opened would have their numbers, and receive what is written to them.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # has the lowest free number
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w")  # noqa: SIM115 - until the end of the process
    if sys.stdout is None:
        print("standard output: closed; must be open, if only on /dev/null", file=sys.stderr)
        sys.exit(BAD_INPUT)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # what an encoding like ASCII does not have
            stream.reconfigure(errors="backslashreplace")
