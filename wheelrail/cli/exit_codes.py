"""Exit codes of the command."""

from __future__ import annotations

FAILED, BAD_INPUT = 1, 2  # exit codes


INTERRUPTED = 130  # exit code
