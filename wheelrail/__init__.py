"""Detailed wheel-rail contact by finite elements, inside a vehicle simulation: what a notebook or a script needs."""
