"""A plane wagon on a track, driven by any contact model through one call. NumPy and SciPy only.

`Wagon` and `Track` are the data, `Dynamics` the equations of motion; `simulate` integrates them, `equilibrium`,
`curving` and `modes` are about steady states.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
