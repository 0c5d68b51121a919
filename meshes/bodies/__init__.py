"""Closed cross-sections of wheel, rail and block, their triangulation, and solids by extrusion or revolution."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
