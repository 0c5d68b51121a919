"""Weak forms in UFL, and the one place that knows versions of dolfinx.

Elasticity of solids and by wavenumbers (`waveguide`), stress, and the traction of the contact; `compat` hides what
differs between dolfinx's versions.
"""
