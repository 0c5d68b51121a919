"""Runs of a vehicle in time: stepping, recording, checkpoints, limits.

`simulate.simulate_vehicle` returns a `VehicleHistory`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
