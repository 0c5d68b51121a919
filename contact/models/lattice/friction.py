"""Law of friction at a cell: residual of exact or regularised Coulomb friction, and its derivatives; compiled.

q = -b s / max(|s|, eps), |q| <= b = mu(|s| V) p, is equivalent to F = q - b y / max(|y|, b rho + eps) = 0 with
y = rho q - s, for any rho > 0: see `wheelrail.contact.solvers.tangential`. Slips s are over the rolling speed V.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled

TINY = 1e-300


class FrictionLaw(NamedTuple):
    """mu(w) = friction ((1 - share) exp(-rate w) + share) at slip velocity w m/s; regularisation: creepage eps."""

    friction: float
    share: float
    rate: float
    regularisation: float

    @classmethod
    def of(cls, laws: ContactLaws) -> FrictionLaw:
        falling = laws.falling
        share, rate = (1.0, 0.0) if falling is None else (falling.share, falling.rate)
        return cls(laws.friction, share, rate, laws.regularisation)


class FrictionSlopes(NamedTuple):
    """Derivatives of F: by_q and by_s as (11, 12, 21, 22), by_p, by_speed as (1, 2); whether the cell slides."""

    by_q: tuple[float, float, float, float]
    by_s: tuple[float, float, float, float]
    by_p: tuple[float, float]
    by_speed: tuple[float, float]
    slides: bool


@compiled
def coefficient(law: FrictionLaw, slip: float, speed: float) -> tuple[float, float, float]:
    """mu, and its derivatives by the slip over the speed and by the speed."""
    falls = law.friction * (1.0 - law.share) * np.exp(-law.rate * slip * speed)
    return law.friction * law.share + falls, -law.rate * speed * falls, -law.rate * slip * falls


@compiled
def coefficients(law: FrictionLaw, slip: Array, speed: float) -> Array:
    """mu (n,) at slips (n,)."""
    mu = np.empty(len(slip))
    for i in range(len(slip)):
        mu[i] = coefficient(law, slip[i], speed)[0]
    return mu


@compiled
def residual(
    law: FrictionLaw, q: tuple[float, float], s: tuple[float, float], p: float, rho: float, speed: float
) -> tuple[float, float]:
    """F (2,) Pa at traction q Pa, slip s, pressure p Pa and speed m/s; rho 1/Pa."""
    mu, _, _ = coefficient(law, np.sqrt(s[0] * s[0] + s[1] * s[1]), speed)
    bound = mu * max(p, 0.0)
    y0, y1 = rho * q[0] - s[0], rho * q[1] - s[1]
    longest = max(np.sqrt(y0 * y0 + y1 * y1), bound * rho + law.regularisation, TINY)
    return q[0] - bound * y0 / longest, q[1] - bound * y1 / longest


@compiled
def slopes(
    law: FrictionLaw, q: tuple[float, float], s: tuple[float, float], p: float, rho: float, speed: float
) -> FrictionSlopes:
    """Derivatives of `residual`."""
    size = np.sqrt(s[0] * s[0] + s[1] * s[1])
    mu, fall, fall_speed = coefficient(law, size, speed)
    bound = mu * max(p, 0.0)
    y0, y1 = rho * q[0] - s[0], rho * q[1] - s[1]
    length, limit = np.sqrt(y0 * y0 + y1 * y1), bound * rho + law.regularisation
    slides = length > limit
    longest = max(length, limit, TINY)
    part = bound / longest  # F = q - part y; d part y = along db + across dy
    if slides:
        u0, u1 = y0 / longest, y1 / longest
        along0, along1 = u0, u1
        xx, xy, yy = part * (1.0 - u0 * u0), -part * u0 * u1, part * (1.0 - u1 * u1)
    else:
        over = law.regularisation / (longest * longest)
        along0, along1 = y0 * over, y1 * over
        xx, xy, yy = part, 0.0, part
    pressed = 1.0 if p > 0.0 else 0.0
    drop = max(p, 0.0) * fall / max(size, TINY)  # db by s, times s
    return FrictionSlopes(
        (1.0 - rho * xx, -rho * xy, -rho * xy, 1.0 - rho * yy),
        (
            xx - along0 * drop * s[0],
            xy - along0 * drop * s[1],
            xy - along1 * drop * s[0],
            yy - along1 * drop * s[1],
        ),
        (-along0 * mu * pressed, -along1 * mu * pressed),
        (-along0 * max(p, 0.0) * fall_speed, -along1 * max(p, 0.0) * fall_speed),
        slides,
    )
