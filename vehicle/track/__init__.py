"""Alignment, cant, gradient and irregularities; the moving track frame; speed profiles.

`Track` gives the centre line and its derivatives at every arc length.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
