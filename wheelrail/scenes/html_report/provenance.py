"""Provenance of results on all pages."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from typing import Any

from wheelrail.scenes.html_report.elements import PageNote, PagePicture, Part
from wheelrail.scenes.quantity import significant


def origin(attrs: Mapping[str, Any]) -> dict[str, str]:
    """Date, machine and versions."""
    return {
        "computed": date(str(attrs.get("created", ""))),
        "machine": str(attrs.get("machine", "unknown (results of an earlier version)")),
        "versions": str(attrs.get("versions", "unknown")),
        **({"commit": str(attrs["commit"])} if attrs.get("commit") else {}),
    }


def date(iso: str) -> str:
    """Day, time and offset from UTC of a date in ISO 8601."""
    try:
        moment = datetime.fromisoformat(iso)
    except ValueError:
        return iso or "unknown"
    return f"{moment:%Y-%m-%d %H:%M} {moment.tzname() or ''}".strip()


def seconds(value: float) -> str:
    """A duration in s, followed by hours and minutes for a long one."""
    if value < 120:
        return f"{significant(value)} s"
    hours, rest = divmod(round(value), 3600)
    minutes, left = divmod(rest, 60)
    text = f"{hours} h {minutes} min" if hours else f"{minutes} min {left} s"
    return f"{value:.0f} s ({text})"


def pictures(drawn: list[PagePicture | None], missing: str) -> list[Part]:
    """The figures that are not None, or a note with the text `missing`."""
    parts: list[Part] = [picture for picture in drawn if picture is not None]
    return parts or [PageNote(missing)]


def toml_text(table: dict[str, Any]) -> str:
    """Tables as TOML, without values that are None."""
    import tomli_w

    def plain(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: plain(item) for key, item in value.items() if item is not None}
        return [plain(item) for item in value if item is not None] if isinstance(value, list) else value

    return tomli_w.dumps(plain(table))
