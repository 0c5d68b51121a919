"""Contact solvers on a compliance matrix: active set for the pressure, semi-smooth Newton for friction, tangent.

`solve_tractions` solves the normal and the tangential problem together; `NewtonOptions` are its tolerances.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
