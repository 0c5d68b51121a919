"""Schema of scene files: tables, units and ranges, and validation messages."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
