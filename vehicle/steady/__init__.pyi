from .critical_speed import modes_over_speed as modes_over_speed
from .equilibrium import Equilibrium as Equilibrium
