"""Undeformed surfaces: penetration and contact points of profiles and quadrics.

`QuadricPair` and `ProfilePair` return the contact points of a pose on a grid; `RigidWheelRail` and `RigidQuadrics`
return contact points and interpenetration regions for the standard model.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
