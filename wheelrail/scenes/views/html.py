"""A plotter as a picture, or as one HTML page that can be turned round and needs no network."""

from __future__ import annotations

import html
import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
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
    _with_lenses()
    with _without_downloads():
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


def _with_lenses() -> None:
    """Let the exporter write angle and projection of the cameras, too: pages would have 30 degrees and perspective."""
    from trame_vtk.modules.vtk.serializers import initialize
    from trame_vtk.modules.vtk.serializers.registry import register_instance_serializer
    from trame_vtk.modules.vtk.serializers.render_windows import camera_serializer

    def whole(parent: Any, camera: Any, *more: Any) -> Any:
        found = camera_serializer(parent, camera, *more)
        found["properties"] |= {
            "viewAngle": camera.GetViewAngle(),
            "parallelProjection": camera.GetParallelProjection(),
            "parallelScale": camera.GetParallelScale(),
        }
        return found

    initialize.camera_serializer = whole  # what its first page in a process takes; later ones ask the registry
    for kind in ("vtkCamera", "vtkOpenGLCamera"):
        register_instance_serializer(kind, whole)


@contextmanager
def _without_downloads() -> Iterator[None]:
    """Keep the exporter from fetching another viewer, WebAssembly, which these pages have no use for."""
    name = "trame.widgets.vtklocal"
    before = sys.modules.get(name)
    sys.modules[name] = None  # type: ignore[assignment]
    try:
        yield
    finally:
        del sys.modules[name]
        if before is not None:
            sys.modules[name] = before


def _literal(text: str) -> str:
    """A text as one of JavaScript's that cannot end the script it stands in."""
    return json.dumps(text).replace("<", "\\u003c")
