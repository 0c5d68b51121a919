from .equilibrium import equilibrium as equilibrium
