from .equations import Dynamics as Dynamics
