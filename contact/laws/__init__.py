"""Contact laws of the interface, written once in UFL, and materials.

Normal: unilateral contact or a penalty pressure. Tangential: Coulomb friction, exact or regularised, constant or
depending on slip velocity and pressure. A law is a frozen dataclass with one method in UFL; all contact models use its
expression: `full` in its forms, the others as compiled functions generated from it and its derivatives (`pointwise`).
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
