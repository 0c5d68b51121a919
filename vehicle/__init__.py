"""Dynamics of railway vehicles on a track; any contact model can be used. Needs no dolfinx.

`Wagon` and `Track` hold the data of a plane wagon, `Dynamics` the equations of motion; `simulate` integrates them,
`equilibrium`, `curving` and `modes` compute steady states and linear modes. `multibody` has vehicles in three
dimensions.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
