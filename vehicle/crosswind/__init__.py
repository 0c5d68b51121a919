"""Crosswind: aerodynamic loads, gusts, and the wind that unloads the wheels of a vehicle."""
