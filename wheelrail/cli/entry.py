"""The way into the command: Ctrl-C while it is loaded is a line and an exit code, too."""

from __future__ import annotations

import sys

from wheelrail.cli.exit_codes import INTERRUPTED


def main() -> None:
    try:
        from wheelrail.support.interrupts import later

        with later():  # libraries in C do not load by halves
            from wheelrail.cli.main import main as command
        command()
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(INTERRUPTED)
