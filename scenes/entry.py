"""The way into the command: Ctrl-C while it is loaded is a line and an exit code, too."""

from __future__ import annotations

import sys

INTERRUPTED = 130  # exit code


def main() -> None:
    try:
        from contact.interrupts import later

        with later():  # libraries in C do not load by halves
            from scenes.cli import main as command
        command()
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(INTERRUPTED)
