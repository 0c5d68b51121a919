"""Scene files and everything that is made of them: checks, models, solves, runs, studies, pictures, reports.

The example scenes are in `examples`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
