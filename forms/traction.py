"""The contact law at a point and its virtual work, eqs. (3), (4) and (6).

z = (d, s): penetration d [m] of the deformed bodies and slip s [-] over the rolling speed V; the traction has the same
components, along the wheel's outward normal and along the two tangents. The laws of `wheelrail.contact.laws` define
the pressure p(d) and the friction coefficient μ(w, p) of the slip velocity w = |s| V; the friction bound is b = μ p.
"""

from __future__ import annotations

from typing import Protocol

import ufl
from ufl.core.expr import Expr

LEAST = 1e-300  # of squared lengths: the square root has no derivative at zero


class Pressure(Protocol):
    """Normal law: pressure Pa from the penetration d m."""

    def pressure(self, d: Expr, /) -> Expr: ...


class Friction(Protocol):
    """Friction law: coefficient from the slip velocity w m/s and the pressure p Pa."""

    def coefficient(self, w: Expr, p: Expr, /) -> Expr: ...


def larger(f: Expr | float, g: Expr | float) -> Expr:
    """max(f, g); unlike that of ufl.max_value, its derivative is finite where the smaller one has none."""
    return ufl.conditional(ufl.gt(f, g), f, g)


def length(v: Expr) -> Expr:
    """|v| with a finite derivative at zero."""
    return ufl.sqrt(larger(ufl.dot(v, v), LEAST))


def projected(q: Expr, s: Expr, b: Expr, ρ: Expr, ε: Expr | float) -> Expr:
    """F = q - b y / max(|y|, b ρ + ε), y = ρ q - s: zero where q is the friction traction, for any ρ > 0 [1/Pa].

    The projection on the disc of radius b; ε = 0 is Coulomb's law, ε > 0 eq. (6).
    """
    y = ρ * q - s
    return q - b * y / larger(length(y), larger(b * ρ + ε, LEAST))


def mean_projected(q: Expr, s: Expr, bounds: tuple[Expr, Expr], ρ: Expr, ε: Expr | float) -> Expr:
    """Mean of `projected` over a cell whose bound varies linearly between two values, at a constant q and s.

    F = q - m y / |y| with t = |y| / (ρ + ε / b), b the mean bound, and m the mean of the lesser of t and the bound: t
    below the lower bound, b above the upper one, t - (t - b₁)² / 2 (b₂ - b₁) between. Its slopes have no jumps.
    """
    y, b = ρ * q - s, 0.5 * (bounds[0] + bounds[1])
    rises = ufl.lt(bounds[0], bounds[1])
    lower, upper = ufl.conditional(rises, *bounds), ufl.conditional(rises, *reversed(bounds))
    stiffness, size = b / larger(b * ρ + ε, LEAST), length(y)
    t = stiffness * size
    between = t - (t - lower) ** 2 / (2 * larger(upper - lower, LEAST))
    mean = ufl.conditional(ufl.gt(t, upper), b, between)
    return q - ufl.conditional(ufl.lt(t, lower), stiffness, mean / size) * y


def regularised(s: Expr, b: Expr, ε: Expr | float) -> Expr:
    """pₜ = -b s / max(|s|, ε): viscous below the creepage ε > 0, Coulomb above, eq. (6)."""
    return -b * s / larger(length(s), ε)


def traction(
    z: Expr, normal: Pressure, friction: Friction, *, speed: Expr, ε: Expr | float, gained: Expr | float = 0.0
) -> Expr:
    """Traction on the wheel (-pₙ, pₜ) from z = (d, s₁, s₂).

    Parameters:
        z: penetration m and slip.
        normal, friction: laws.
        speed: rolling speed m/s.
        ε: regularising creepage.
        gained: slip added by a multiplier at sliding points, which the slip velocity omits.
    """
    d, s = z[0], ufl.as_vector([z[1], z[2]])
    p = normal.pressure(d)
    w = larger(length(s) - gained, 0.0) * speed
    pt = regularised(s, friction.coefficient(w, p) * p, ε)
    return ufl.as_vector([-p, pt[0], pt[1]])


def frictionless_traction(d: Expr, normal: Pressure) -> Expr:
    """Traction -pₙ on the wheel along its normal from the penetration d, without tangential components."""
    return -normal.pressure(d)


def virtual_work(t: Expr, v: Expr, measure: ufl.Measure) -> ufl.Form:
    """∫ t · v dA over the contact surface, v the test function in the local axes, eq. (3)."""
    return ufl.inner(t, v) * measure
