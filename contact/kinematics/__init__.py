"""Frames, rigid motion, the state of a wheelset, creepages, and their derivatives.

It knows no bodies and no laws: `Pose`, `Twist` and the motion of both bodies are what every contact model is called
with.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
