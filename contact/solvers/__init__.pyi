from .options import NewtonOptions as NewtonOptions
from .options import NotConverged as NotConverged
from .tractions import solve_tractions as solve_tractions
