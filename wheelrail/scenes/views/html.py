"""Export of a plotter as an image or as a self-contained HTML page with an interactive 3D view."""

from __future__ import annotations

import html
import json
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

VIEWS = (".png", ".html")


def save_view(plotter: Any, file: Path) -> None:
    """Save an image (.png) or an interactive 3D view (.html). Raises ValueError for another file ending."""
    if file.suffix.lower() not in VIEWS:
        raise ValueError(f"{file}: must end in {' or '.join(VIEWS)}")
    if file.suffix.lower() == ".png":
        plotter.screenshot(str(file))
    else:
        file.write_text(view_html(plotter), encoding="utf-8")


def view_html(plotter: Any) -> str:
    """HTML page with viewer, scene and the title of the plotter, as the viewer draws no text."""
    _with_lenses()
    with _without_downloads(), _ctrl_c_kept():
        page: str = plotter.trame.export_html(None).getvalue()
    text = html.escape(plotter.title)
    head, tail = page.split("</title>", 1)
    page = head[: head.rindex("<title>")] + f"<title>{text}</title>" + tail
    style = (
        "position:fixed;z-index:9;top:0;left:0;padding:.4em .8em;pointer-events:none;white-space:pre-line;"
        "font:13px sans-serif;background:rgba(255,255,255,.85)"
    )
    # outside the body element, which the viewer empties
    banner = (
        "<script>{const d=document.createElement('div');"
        f"d.style='{style}';d.textContent={_literal(plotter.title)};document.documentElement.append(d)}}</script>"
    )
    return page.replace("<body>", f"<body>{banner}", 1)


def _with_lenses() -> None:
    """Export view angle and projection of the cameras, too; the defaults are 30 degrees and perspective."""
    from trame_vtk.modules.vtk.serializers import initialize
    from trame_vtk.modules.vtk.serializers.registry import register_instance_serializer
    from trame_vtk.modules.vtk.serializers.render_windows import camera_serializer

    def whole(parent: Any, camera: Any, *arguments: Any) -> Any:
        serialized = camera_serializer(parent, camera, *arguments)
        serialized["properties"] |= {
            "viewAngle": camera.GetViewAngle(),
            "parallelProjection": camera.GetParallelProjection(),
            "parallelScale": camera.GetParallelScale(),
        }
        return serialized

    initialize.camera_serializer = whole  # used by the first page of a process; later ones use the registry
    for kind in ("vtkCamera", "vtkOpenGLCamera"):
        register_instance_serializer(kind, whole)


@contextmanager
def _without_downloads() -> Iterator[None]:
    """Prevent the exporter from downloading the WebAssembly viewer, which is not needed."""
    name = "trame.widgets.vtklocal"
    module = sys.modules.get(name)
    sys.modules[name] = None  # type: ignore[assignment]
    try:
        yield
    finally:
        del sys.modules[name]
        if module is not None:
            sys.modules[name] = module


@contextmanager
def _ctrl_c_kept() -> Iterator[None]:
    """Restore Ctrl-C afterwards: the exporter starts a server whose handler ignores it."""
    handler = signal.getsignal(signal.SIGINT)
    try:
        yield
    finally:
        if handler is not None and threading.current_thread() is threading.main_thread():
            signal.signal(signal.SIGINT, handler)


def _literal(text: str) -> str:
    """JavaScript string literal that cannot end the enclosing script element."""
    return json.dumps(text).replace("<", "\\u003c")
