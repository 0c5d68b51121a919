"""What pages of all kinds say about where their results come from."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from itertools import takewhile
from typing import Any

from wheelrail.scenes.html_report.elements import PageNote, PagePicture, Part


def opening(text: str) -> str:
    """The comment that a scene starts with, without lines that are set in, which show commands."""
    lines = takewhile(lambda line: line.startswith("#"), text.splitlines())
    return " ".join(line[1:].strip() for line in lines if not line[1:].startswith("   ") and line[1:].strip())


def origin(attrs: Mapping[str, Any]) -> dict[str, str]:
    """When, where and by which versions."""
    return {
        "computed": date(str(attrs.get("created", ""))),
        "machine": str(attrs.get("machine", "not known: results of an earlier version")),
        "versions": str(attrs.get("versions", "not known")),
        **({"commit": str(attrs["commit"])} if attrs.get("commit") else {}),
    }


def date(iso: str) -> str:
    """Day, time and offset from UTC of a date in ISO 8601."""
    try:
        found = datetime.fromisoformat(iso)
    except ValueError:
        return iso or "not known"
    return f"{found:%Y-%m-%d %H:%M} {found.tzname() or ''}".strip()


def seconds(value: float) -> str:
    """A duration in s, in minutes and hours besides where it is long."""
    if value < 120:
        return f"{value:.3g} s"
    hours, rest = divmod(round(value), 3600)
    minutes, left = divmod(rest, 60)
    said = f"{hours} h {minutes} min" if hours else f"{minutes} min {left} s"
    return f"{value:.0f} s ({said})"


def pictures(found: list[PagePicture | None], missing: str) -> list[Part]:
    """Those that there are, or a note."""
    there: list[Part] = [one for one in found if one is not None]
    return there or [PageNote(missing)]
