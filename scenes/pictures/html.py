"""A plotter as a picture, or as one HTML page that can be turned round and needs no network."""

from __future__ import annotations

import html
import json
from pathlib import Path
from typing import Any

VIEWS = (".png", ".html")


def save_view(plotter: Any, file: Path) -> None:
    """Write a picture or a page, by the file's ending. Raises ValueError for another ending."""
    if file.suffix.lower() not in VIEWS:
        raise ValueError(f"{file} must end in {' or '.join(VIEWS)}")
    if file.suffix.lower() == ".png":
        plotter.screenshot(str(file))
    else:
        file.write_text(view_html(plotter), encoding="utf-8")


def view_html(plotter: Any) -> str:
    """The page: the viewer, the scene and the plotter's title, as the viewer itself draws no text, in one."""
    page: str = plotter.trame.export_html(None).getvalue()
    text = html.escape(plotter.title)
    head, tail = page.split("</title>", 1)
    page = head[: head.rindex("<title>")] + f"<title>{text}</title>" + tail
    style = (
        "position:fixed;z-index:9;top:0;left:0;padding:.4em .8em;pointer-events:none;white-space:pre-line;"
        "font:13px sans-serif;background:rgba(255,255,255,.85)"
    )
    # beside the body, which the viewer empties for itself
    banner = (
        "<script>{const d=document.createElement('div');"
        f"d.style='{style}';d.textContent={_literal(plotter.title)};document.documentElement.append(d)}}</script>"
    )
    return page.replace("<body>", f"<body>{banner}", 1)


def _literal(text: str) -> str:
    """A text as one of JavaScript's that cannot end the script it stands in."""
    return json.dumps(text).replace("<", "\\u003c")
