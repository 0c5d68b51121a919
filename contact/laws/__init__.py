"""Constitutive laws of the interface, as data and pointwise functions.

Unilateral contact or a penalty normal pressure, Coulomb friction, exact or regularised, constant or falling with the
slip velocity; and the material of the bodies.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
