"""Dynamics of a plane wagon on a track; any contact model can be used. Needs no dolfinx.

`Wagon` and `Track` hold the data, `Dynamics` the equations of motion; `simulate` integrates them, `equilibrium`,
`curving` and `modes` compute steady states and linear modes.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
