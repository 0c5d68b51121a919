"""Torques and forces that act on a vehicle from outside its suspension, over time or distance: data only."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
