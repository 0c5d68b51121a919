"""Plain text from the code inside Markdown."""

from __future__ import annotations

import re


def plain(text: str) -> str:
    """The text on one line, `code` as it is, everything else that Markdown would take for its own escaped."""
    parts = re.split(r"(`[^`]+`)", " ".join(text.split()))
    return "".join(part if i % 2 else re.sub(r"([\\*_<>\[\]|$#])", r"\\\1", part) for i, part in enumerate(parts))
