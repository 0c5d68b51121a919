"""Runs in time: stepping, recording, checkpoints, costs, energy balance.

`simulate.simulate` returns a `History`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
