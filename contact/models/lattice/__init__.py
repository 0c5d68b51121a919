"""Contact on a lattice of strips fixed on the upper body: one Newton's method, the force a function of the pose alone.

`LatticeContact` is the model, `LatticeResolution` its numbers of strips and cells.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
