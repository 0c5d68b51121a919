"""Vehicles of rigid bodies in three dimensions: data, equations of motion, steady states, modes and runs.

`Vehicle` holds the data, `VehicleDynamics` the equations of motion of all bodies, each in the track frame at its own
distance along the track; `vehicle_equilibrium`, `vehicle_modes`, `critical_speed` and `simulate_vehicle` use them.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
