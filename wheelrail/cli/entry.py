"""Entry point of the command `wheelrail`: Ctrl-C while modules load ends it with one line and an exit code."""

from __future__ import annotations

import sys

from wheelrail.cli.exit_codes import INTERRUPTED


def main() -> None:
    try:
        from wheelrail.support.interrupts import deferred_interrupts

        with deferred_interrupts():  # an interrupted import leaves C extensions half initialised
            from wheelrail.cli.main import main as command
        command()
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(INTERRUPTED)
