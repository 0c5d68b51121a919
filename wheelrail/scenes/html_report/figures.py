"""Figures and 3D views embedded in a page."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable
from io import BytesIO
from typing import TYPE_CHECKING, Any

from wheelrail.scenes.html_report.elements import PagePicture, PageView
from wheelrail.scenes.plots.style import styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LARGE = 250_000  # bytes of an SVG figure, beyond which a PNG is smaller


def picture(draw: Callable[[], Figure | None], caption: str, alt: str) -> PagePicture | None:
    """Figure as SVG, or as PNG if the SVG is large; None if draw returns None."""
    with styled({"svg.hashsalt": "wheelrail"}):
        figure = draw()
        if figure is None:
            return None
        content, kind = _saved(figure, "svg"), "svg+xml"
        if len(content) > LARGE:
            content, kind = _saved(figure, "png"), "png"
    return PagePicture(_uri(content, kind), caption, alt)


def view(plotter: Any, caption: str, alt: str) -> PageView:
    """Interactive 3D view of a plotter with its initial still image; closes the plotter."""
    from matplotlib.image import imsave

    from wheelrail.scenes.views.html import view_html

    try:
        still = BytesIO()
        imsave(still, plotter.screenshot(None), format="png")
        return PageView(view_html(plotter), _uri(still.getvalue(), "png"), caption, alt)
    finally:
        plotter.close()


def _saved(figure: Figure, kind: str) -> bytes:
    stream = BytesIO()
    figure.savefig(stream, format=kind, metadata={"Date": None} if kind == "svg" else None)
    return stream.getvalue()


def _uri(content: bytes, kind: str) -> str:
    return f"data:image/{kind};base64,{b64encode(content).decode()}"
