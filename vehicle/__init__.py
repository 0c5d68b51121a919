"""Dynamics of railway vehicles on a track; any contact model can be used. Needs no dolfinx.

`multibody.Vehicle` or, of the plane model, `Wagon` and `Track` hold the data, `VehicleDynamics` or `wagon_dynamics` the
equations of motion; `simulate` integrates them, `equilibrium`, `curving` and `modes` compute steady states and linear
modes.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
