from .equilibrium import Equilibrium as Equilibrium
