"""Pyvista, ready to draw with and without a screen."""

from __future__ import annotations

import os
import sys
from typing import Any


def pyvista() -> Any:
    """The library; without an X server VTK is told to draw off screen before it looks for one and complains.

    Raises ImportError with a hint when it is not installed.
    """
    if not sys.platform.startswith("linux"):
        return _imported()
    if not os.environ.get("DISPLAY"):
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    flags = sys.getdlopenflags()
    # dolfinx 0.5 makes its symbols global for all libraries loaded later: VTK's, built with another C++ library, would
    # take C++'s regular expressions from it and crash at the first colour bar. Its own come first instead.
    sys.setdlopenflags(os.RTLD_NOW | os.RTLD_LOCAL | os.RTLD_DEEPBIND)
    try:
        return _imported()
    finally:
        sys.setdlopenflags(flags)


def _imported() -> Any:
    try:
        import pyvista
    except ImportError as error:
        raise ImportError('pictures in three dimensions need pyvista: pip install "wheelrail[view]"') from error
    return pyvista


def plotter(shape: tuple[int, int] | str = (1, 1), *, size: tuple[int, int], off_screen: bool | None = None) -> Any:
    """A white plotter of so many panes and pixels; off screen where there is none, unless said otherwise."""
    made = pyvista().Plotter(shape=shape, window_size=size, off_screen=off_screen, border=False)
    made.set_background("white")
    return made
