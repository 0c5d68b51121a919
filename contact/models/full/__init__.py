"""All displacements of both bodies as unknowns, by dolfinx and PETSc.

`FullContact` is the model; the Newton method is dolfinx's NewtonSolver with BiCGStab, as in the paper.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
