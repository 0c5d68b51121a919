from .shakedown import shakedown_limit as shakedown_limit
from .subsurface import LoadedBody as LoadedBody
from .subsurface import SubsurfaceStress as SubsurfaceStress
