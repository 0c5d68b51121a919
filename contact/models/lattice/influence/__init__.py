"""Compliance of strips of a lattice: tables of pairs of strips, shape functions, and the operator on all unknowns."""
