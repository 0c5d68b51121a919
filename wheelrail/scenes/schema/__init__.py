"""What a scene file may say: tables, units and ranges, and the messages for what is wrong."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
