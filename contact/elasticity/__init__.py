"""Compliance of the bodies: displacements of the surface by tractions on it.

Half-spaces in closed form, 3D finite elements (`solid_body`, `solid_compliance`), and bodies invariant along the track
or about their axle by 2.5D finite elements (`waveguide`). `Compliance` is the interface to the contact models.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
