"""Weak forms in UFL, and compatibility with versions of dolfinx.

Elasticity of solids and by wavenumbers (`waveguide`), stress, and the contact traction; `compat` contains all code that
depends on the version of dolfinx.
"""
