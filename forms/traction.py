"""The contact law at a point and its virtual work, eqs. (4) and (6).

z = (d, s): penetration d [m] of the deformed bodies and slip s [-] over the rolling speed; the traction has the same
components, along the wheel's outward normal and along the two tangents.
"""

from __future__ import annotations

import ufl
from ufl.core.expr import Expr


def penalty_pressure(d: Expr, K: float | Expr) -> Expr:
    """pₙ = K max(d, 0), K in N/m³, eq. (4)."""
    return K * ufl.max_value(d, 0)


def regularised_coulomb(s: Expr, p: Expr, μ: float | Expr, ε: float | Expr) -> Expr:
    """pₜ = -μ pₙ s / max(|s|, ε): viscous below the creepage ε, Coulomb above, eq. (6)."""
    return -μ * p * s / ufl.sqrt(ufl.max_value(ufl.dot(s, s), ε * ε))


def falling_friction(s: Expr, μ: float | Expr, A: float | Expr, B: float | Expr, ε: float | Expr) -> Expr:
    """μ(s) = μ ((1 - A) exp(-B s) + A) of the slip s = max(|s| - ε, 0), Polach 2005, doi:10.1016/j.wear.2004.03.046.

    B is the rate of falling times the rolling speed; ε the slip added by a multiplier, else 0.
    """
    length = ufl.sqrt(ufl.max_value(ufl.dot(s, s), 1e-30))
    return μ * ((1 - A) * ufl.exp(-B * ufl.max_value(length - ε, 0)) + A)


def traction(z: Expr, K: float | Expr, μ: float | Expr, ε: float | Expr) -> Expr:
    """Traction on the wheel (-pₙ, pₜ) from z = (d, s₁, s₂)."""
    p = penalty_pressure(z[0], K)
    pt = regularised_coulomb(slip(z), p, μ, ε)
    return ufl.as_vector([-p, pt[0], pt[1]])


def slip(z: Expr) -> Expr:
    """(s₁, s₂) of z = (d, s₁, s₂)."""
    return ufl.as_vector([z[1], z[2]])


def frictionless_traction(d: Expr, K: float | Expr) -> Expr:
    """Traction -pₙ on the wheel along its normal from the penetration d, without tangential components."""
    return -penalty_pressure(d, K)


def virtual_work(t: Expr, v: Expr, measure: ufl.Measure) -> ufl.Form:
    """∫ t · v dA over the contact surface, v the test function in the local axes, eq. (3)."""
    return ufl.inner(t, v) * measure
