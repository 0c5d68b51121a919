"""Linear elasticity: Navier's equations in weak form, eqs. (2) and (3)."""

from __future__ import annotations

import ufl
from ufl.core.expr import Expr


def lame(E: float, nu: float) -> tuple[float, float]:
    """Lamé's constants (λ, μ) [Pa] from Young's modulus [Pa] and Poisson's ratio."""
    return E * nu / (1 + nu) / (1 - 2 * nu), E / 2 / (1 + nu)


def strain(u: Expr) -> Expr:
    """ε(u) = sym ∇u."""
    return ufl.sym(ufl.grad(u))


def stress(u: Expr, λ: float | Expr, μ: float | Expr) -> Expr:
    """σ(u) = λ tr ε I + 2 μ ε."""
    ε = strain(u)
    return λ * ufl.tr(ε) * ufl.Identity(len(u)) + 2 * μ * ε


def stiffness(u: Expr, v: Expr, λ: float | Expr, μ: float | Expr) -> ufl.Form:
    """a(u, v) = ∫ σ(u) : ε(v) dx, eq. (3)."""
    return ufl.inner(stress(u, λ, μ), strain(v)) * ufl.dx
