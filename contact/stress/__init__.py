"""Stress and displacement below the surface, and shakedown.

`LoadedBody` gives the stress below the patches of a result, `BodyFields` displacement and stress of a whole
section.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
