"""Compliance of bodies invariant along x or about an axle, by 2.5D finite elements over wavenumbers.

Only the cross-section is meshed. `profile_waveguide` and `block_waveguide` return the compliance and the grid of
contact points; for rail and wheel also the strip of the surface.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
