"""Derivatives by pose and motion: of the residual at fixed unknowns, and of force and moment."""
