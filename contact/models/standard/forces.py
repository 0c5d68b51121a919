"""From pressed strips and rigid velocities to tractions, forces and what every cell of the strips carries."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.models.standard.creep_coefficients import Elasticity, coefficients
from wheelrail.contact.models.standard.fastsim import bed, strip_tractions
from wheelrail.contact.models.standard.normal import Pressed
from wheelrail.contact.models.standard.polach import effective, polach
from wheelrail.support.arrays import Array, Mask
from wheelrail.support.compiled import compiled

NO_FRICTION, FASTSIM, POLACH = 0, 1, 2


class Friction(NamedTuple):
    """mu; share and rate s/m of `wheelrail.contact.laws.parameters.FallingFriction` (1 and 0: it does not fall);
    method, one of the above; reduction factors k_A and k_S of Polach's formula.
    """

    mu: float
    share: float
    rate: float
    method: int
    adhesion: float
    slip: float


class Velocities(NamedTuple):
    """Rigid motion of wheel and rail, as in `wheelrail.contact.kinematics.frames.Twist`."""

    wheel: Array
    wheel_turn: Array
    wheel_at: Array
    rail: Array
    rail_turn: Array
    rail_at: Array


class Cells(NamedTuple):
    """Force N and moment N m about the origin. By contact (k,): rolling speed m/s. By cell (n,), strip by strip from
    the trailing end: place (n, 3) m, length m; area m2 that counts; pressure and traction (n, 2) Pa; slip (n, 2) over
    the speed; whether it sticks.
    """

    force: Array
    moment: Array
    speed: Array
    point: Array
    length: Array
    area: Array
    pressure: Array
    traction: Array
    slip: Array
    sticks: Mask


@compiled
def flow(turn: Array, at: Array, velocity: Array, point: Array, axis: Array) -> float:
    """Velocity along an axis of a body's point."""
    x, y, z = point[0] - at[0], point[1] - at[1], point[2] - at[2]
    return float(
        (velocity[0] + turn[1] * z - turn[2] * y) * axis[0]
        + (velocity[1] + turn[2] * x - turn[0] * z) * axis[1]
        + (velocity[2] + turn[0] * y - turn[1] * x) * axis[2]
    )


@compiled
def slipping(v: Velocities, point: Array, axis: Array) -> float:
    """Velocity along an axis of the wheel against the rail, m/s."""
    return flow(v.wheel_turn, v.wheel_at, v.wheel, point, axis) - flow(v.rail_turn, v.rail_at, v.rail, point, axis)


@compiled
def turning(v: Velocities, axis: Array) -> float:
    """Rotation about the upward normal, against an outward axis, of the wheel against the rail, rad/s."""
    return float(
        -(v.wheel_turn[0] - v.rail_turn[0]) * axis[0]
        - (v.wheel_turn[1] - v.rail_turn[1]) * axis[1]
        - (v.wheel_turn[2] - v.rail_turn[2]) * axis[2]
    )


@compiled
def friction_at(law: Friction, velocity: float) -> float:
    """Friction coefficient at a slip velocity m/s."""
    return float(law.mu * ((1.0 - law.share) * np.exp(-law.rate * velocity) + law.share))


@compiled
def strip_forces(
    strips: Pressed,
    share: Array,
    point: Array,
    axes: Array,
    peak: Array,
    peak_axes: Array,
    v: Velocities,
    elastic: Elasticity,
    law: Friction,
    m: int,
) -> Cells:
    """Cells, m to a strip, of contacts that count by a share (k,) each; points (n, 3) m and axes (n, 3, 3), rows
    longitudinal, lateral and outward from the wheel, of the strips' middles, and of the humps, which give creepages.

    A rolling speed that is not positive leaves its contact without tractions.
    """
    n, k = len(strips.s), len(share)
    force, moment = np.zeros(3), np.zeros(3)
    speed, creep = np.zeros(k), np.zeros(3)
    place, length, area = np.empty((n * m, 3)), np.empty(n * m), np.empty(n * m)
    pressure, traction, slip = np.empty(n * m), np.zeros((n * m, 2)), np.zeros((n * m, 2))
    sticks = np.zeros(n * m, dtype=np.bool_)
    bounds, arch, dome = np.empty(m), np.empty(m), np.empty(m)
    for j in range(m):  # means over equal cells of sqrt(1 - t^2) and of 1 - t^2
        low, high = 2.0 * j / m - 1.0, 2.0 * (j + 1) / m - 1.0
        arch[j] = (
            0.25
            * m
            * (
                high * np.sqrt(max(1.0 - high * high, 0.0))
                + np.arcsin(min(high, 1.0))
                - low * np.sqrt(max(1.0 - low * low, 0.0))
                - np.arcsin(low)
            )
        )
        dome[j] = 1.0 - (high * high + high * low + low * low) / 3.0
    start = 0
    for c in range(k):
        stop, volume = start, 0.0
        while stop < n and strips.contact[stop] == c:
            volume += 4.0 / 3.0 * strips.half[stop] ** 3 * strips.width[stop]
            stop += 1
        f, l, u = peak_axes[c, 0], peak_axes[c, 1], peak_axes[c, 2]
        V = -0.5 * (
            flow(v.wheel_turn, v.wheel_at, v.wheel, peak[c], f) + flow(v.rail_turn, v.rail_at, v.rail, peak[c], f)
        )
        speed[c] = V
        rolls = law.method != NO_FRICTION and V > 0.0
        a, b, parabola = strips.along[c], strips.across[c], strips.load[c] / volume
        flexible, fx, fy = bed(a, b, elastic.G, coefficients(elastic.table, a / b)), 0.0, 0.0
        creep[:] = 0.0
        if V > 0.0:
            creep[0], creep[1], creep[2] = (
                slipping(v, peak[c], f) / V,
                slipping(v, peak[c], l) / V,
                turning(v, u) / V,
            )
        xi, eta, phi = creep
        if rolls and law.method == POLACH:
            mu = friction_at(law, V * np.hypot(xi, effective(eta, phi, a)))
            fx, fy = polach(
                xi,
                eta,
                phi,
                a,
                b,
                mu * strips.load[c],
                elastic.G,
                coefficients(elastic.table, a / b),
                law.adhesion,
                law.slip,
            )
        for i in range(start, stop):
            own, half = slice(i * m, (i + 1) * m), strips.half[i]
            f, l, u = axes[i, 0], axes[i, 1], axes[i, 2]
            cell = 2.0 * half / m
            grows, wx, wy = 0.0, 0.0, 0.0
            if rolls:
                wx, wy, grows = slipping(v, point[i], f) / V, slipping(v, point[i], l) / V, turning(v, u) / V
                if law.method == FASTSIM:
                    for j in range(m):
                        x = half * ((2.0 * j + 1.0) / m - 1.0)
                        mu = friction_at(law, V * np.hypot(wx, wy + grows * x)) if law.rate > 0.0 else law.mu
                        bounds[j] = mu * parabola * half * half * dome[j]
                    strip_tractions(
                        half, (xi, eta), (wx - xi, wy - eta, grows), flexible, bounds, traction[own], slip[own]
                    )
            for j in range(m):
                q = i * m + j
                x = half * ((2.0 * j + 1.0) / m - 1.0)
                length[q], area[q] = cell, cell * strips.width[i] * share[c]
                pressure[q] = strips.scale[i] * half * arch[j]
                if law.method == POLACH and rolls:
                    traction[q, 0], traction[q, 1] = (
                        fx * pressure[q] / strips.load[c],
                        fy * pressure[q] / strips.load[c],
                    )
                    slip[q, 0], slip[q, 1] = wx, wy + grows * x
                sticks[q] = rolls and slip[q, 0] == 0.0 and slip[q, 1] == 0.0
                for d in range(3):
                    place[q, d] = point[i, d] + x * f[d]
                px = area[q] * (traction[q, 0] * f[0] + traction[q, 1] * l[0] - pressure[q] * u[0])
                py = area[q] * (traction[q, 0] * f[1] + traction[q, 1] * l[1] - pressure[q] * u[1])
                pz = area[q] * (traction[q, 0] * f[2] + traction[q, 1] * l[2] - pressure[q] * u[2])
                force[0] += px
                force[1] += py
                force[2] += pz
                moment[0] += place[q, 1] * pz - place[q, 2] * py
                moment[1] += place[q, 2] * px - place[q, 0] * pz
                moment[2] += place[q, 0] * py - place[q, 1] * px
        start = stop
    return Cells(force, moment, speed, place, length, area, pressure, traction, slip, sticks)
