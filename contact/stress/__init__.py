"""Stress and displacement below the surface, and shakedown.

`LoadedBody` returns the stress below the patches of a result; the fields of whole sections and solids are `BodyFields`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
