"""Constitutive laws of the interface and materials, as data and pointwise functions.

Normal: unilateral contact or a penalty pressure. Tangential: Coulomb friction, exact or regularised, constant or
falling with the slip velocity.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
