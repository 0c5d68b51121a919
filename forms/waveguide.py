"""Elasticity of a body invariant along x, or in angle about an axle, by wavenumbers: forms on its cross-section.

With u = (-i U_0, U_1, U_2) e^{i k x} the phases cancel in the energy, which is real and symmetric in the amplitudes U:
K(k) = A_0 + k A_1 + k^2 A_2. Bodies of revolution likewise, with the harmonic number n for k and the energy per unit
angle.
"""

from __future__ import annotations

import ufl
from ufl.core.expr import Expr

Parts = tuple[Expr, Expr]


def prismatic_gradient(U: Expr) -> Parts:
    """G0 and G1 of the amplitude's gradient G0 + k G1; U = (along x, U_y, U_z) on the section (y, z).

    Rows are components, columns d/dx, d/dy, d/dz.
    """
    Ux, Uy, Uz = U
    D = ufl.grad(U)
    G0 = ufl.as_matrix([[0, D[0, 0], D[0, 1]], [0, D[1, 0], D[1, 1]], [0, D[2, 0], D[2, 1]]])
    G1 = ufl.as_matrix([[Ux, 0, 0], [-Uy, 0, 0], [-Uz, 0, 0]])
    return G0, G1


def revolved_gradient(U: Expr, r: Expr) -> Parts:
    """G0 and G1 of the amplitude's gradient G0 + n G1; U = (along the circle, U_y, U_r) on the section (y, r).

    Rows are components, columns d/(r dθ), d/dy, d/dr.
    """
    Uθ, Uy, Ur = U
    D = ufl.grad(U)
    G0 = ufl.as_matrix([[Ur / r, D[0, 0], D[0, 1]], [0, D[1, 0], D[1, 1]], [-Uθ / r, D[2, 0], D[2, 1]]])
    G1 = ufl.as_matrix([[Uθ / r, 0, 0], [-Uy / r, 0, 0], [-Ur / r, 0, 0]])
    return G0, G1


def density(G: Expr, H: Expr, λ: float | Expr, μ: float | Expr) -> Expr:
    """σ : ε of two gradients, σ = λ tr ε I + 2 μ ε."""
    ε, η = ufl.sym(G), ufl.sym(H)
    return λ * ufl.tr(ε) * ufl.tr(η) + 2 * μ * ufl.inner(ε, η)


def wavenumber_forms(
    U: Expr, V: Expr, λ: float | Expr, μ: float | Expr, *, radius: Expr | None = None, degree: int
) -> tuple[ufl.Form, ufl.Form, ufl.Form]:
    """A0, A1, A2 of a(U, V) = ∫ σ(U) : ε(V) dA, per unit length along x, or per unit angle when a radius is given.

    Parameters:
        U, V: trial and test function.
        λ, μ: Lamé's constants, Pa.
        radius: distance from the axle, m, of a body of revolution; None for a prismatic one.
        degree: of the displacements; the quadrature is exact for the prismatic body.
    """
    dA = ufl.dx(metadata={"quadrature_degree": 2 * degree})
    if radius is None:
        (U0, U1), (V0, V1), weight = prismatic_gradient(U), prismatic_gradient(V), 1
    else:
        (U0, U1), (V0, V1), weight = revolved_gradient(U, radius), revolved_gradient(V, radius), radius
    return (
        density(U0, V0, λ, μ) * weight * dA,
        (density(U0, V1, λ, μ) + density(U1, V0, λ, μ)) * weight * dA,
        density(U1, V1, λ, μ) * weight * dA,
    )
