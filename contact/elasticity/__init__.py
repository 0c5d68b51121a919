"""Compliance of the bodies: displacements of the surface by tractions on it.

Half-spaces in closed form, 3D finite elements (`solid_body`, `solid_compliance`), and bodies that are invariant along
the track or about their axle by 2.5D finite elements (`waveguide`). `Compliance` is what the contact models call.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
