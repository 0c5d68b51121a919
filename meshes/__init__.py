"""Profiles of wheel and rail, the cross-sections of the bodies, and their meshes."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
