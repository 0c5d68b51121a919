"""Contact models, ready to call; one module or folder per value of the scene keys `model` and `points`.

`LatticeContact` solves for tractions on strips of a lattice fixed on the upper body, `CondensedContact` on a grid with
the surface compliance, `FullContact` for all displacements of both bodies, `StandardContact` by the approximate
theories of multibody codes. `hertz_pair` and `wheel_rail_pair` build any of them; `WheelsetContact` is one model
applied to both wheels.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
