"""The contact of multibody codes: Hertz or Kik and Piotrowski, FASTSIM or Polach.

`StandardContact` is the model; contact points come from the rigid search in `contact.geometry`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
