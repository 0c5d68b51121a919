"""Frames, rigid motion, the state of a wheelset, creepages, and their derivatives.

Independent of bodies and laws: every contact model is called with a `Pose` and the `RigidMotion` of both bodies, two
`Twist`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
