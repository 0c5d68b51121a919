"""Exit codes of the command `wheelrail`; 0 is success."""

from __future__ import annotations

FAILED = 1
BAD_INPUT = 2
INTERRUPTED = 130
