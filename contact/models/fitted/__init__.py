"""Strips of cells fitted to the patch: a free-boundary problem on the compliance of strips.

`FittedContact` is the model, `Resolution` its numbers of strips and cells.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
