"""PyVista, with and without a display."""

from __future__ import annotations

import os
import sys
from typing import Any


def pyvista() -> Any:
    """The PyVista module; without an X server VTK renders off screen through EGL.

    Raises ImportError with a hint if it is not installed.
    """
    if not sys.platform.startswith("linux"):
        return _imported()
    if not os.environ.get("DISPLAY"):
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    flags = sys.getdlopenflags()
    # dolfinx 0.5 exports its symbols globally to all libraries loaded later. VTK, built with another C++ library, would
    # resolve std::regex from it and crash at the first colour bar. RTLD_DEEPBIND resolves its own symbols first.
    sys.setdlopenflags(os.RTLD_NOW | os.RTLD_LOCAL | os.RTLD_DEEPBIND)
    try:
        return _imported()
    finally:
        sys.setdlopenflags(flags)


def _imported() -> Any:
    try:
        import pyvista
    except ImportError as error:
        raise ImportError('3D views need pyvista: pip install "wheelrail[view]"') from error
    return pyvista


def plotter(shape: tuple[int, int] | str = (1, 1), *, size: tuple[int, int], off_screen: bool | None = None) -> Any:
    """Plotter with a white background.

    Parameters:
        shape: rows and columns of panes, or as a string of PyVista.
        size: width and height, pixels.
        off_screen: whether to render without a window; by default without a display only.
    """
    new_plotter = pyvista().Plotter(shape=shape, window_size=size, off_screen=off_screen, border=False)
    new_plotter.set_background("white")
    return new_plotter


def colour_bar(view: Any, mapper: Any, title: str, *, width: float = 0.5, position_x: float = 0.25) -> None:
    """Add a colour bar below a pane, or replace the one with the same title.

    Parameters:
        view: plotter; its current pane gets the bar.
        mapper: of the drawn mesh.
        title: of the bar.
        width, position_x: length and left end, fractions of the pane.

    One per pane, as the HTML viewer has a single position for them.
    """
    if title in view.scalar_bars:
        view.remove_scalar_bar(title, render=False)
    bar = view.add_scalar_bar(
        title,
        mapper=mapper,
        fmt="%.0f",
        n_labels=4,
        color="black",
        title_font_size=15,
        label_font_size=13,
        width=width,
        height=0.1,
        position_x=position_x,
        position_y=0.03,
        render=False,
    )
    bar.SetTitle(f"{title}\n")  # otherwise VTK writes the title into the tick labels
