"""Masses, suspension parameters, force laws and force elements of the wagon.

`Wagon` holds the data; `Suspension` computes the forces between its bodies.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
