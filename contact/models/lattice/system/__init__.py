"""Equations of the contact on a lattice: unknowns, surfaces, friction, residual and Jacobian."""
