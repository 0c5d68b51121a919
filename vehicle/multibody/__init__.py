"""Vehicles of rigid bodies: data, coordinates and equations of motion.

`Vehicle` holds the data, `VehicleDynamics` the equations of motion of all bodies, each in the track frame at its own
distance along the track. Coordinates may be held, as those of the plane wagon are (`plane_vehicle`).
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
