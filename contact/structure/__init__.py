"""Structural compliance of wheelset and track: the axle's bending moves the hubs, the pads let the rail move.

Both are motions of a wheel or a rail as a whole, on top of which the bodies of `wheelrail.contact.elasticity` (clamped
at the bore, at the foot) deform. `hub_compliance` takes an axle by its drawing, `rail_compliance` the pads, and
`sleeper_compliance` pads at discrete sleepers, `co_running_track` sleepers on ballast, and the masses of the track,
`sleeper_track` both.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
