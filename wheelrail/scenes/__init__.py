"""Scene files and their use: validation, models, contact solves, runs, studies, figures, reports.

The example scenes are in `examples`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
