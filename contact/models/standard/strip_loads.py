"""Force of strips of pressure and of FASTSIM or Polach's tractions on them, without storing their cells."""

from __future__ import annotations

import numpy as np

from wheelrail.contact.geometry.interpenetration import PenetrationRegions
from wheelrail.contact.kinematics.rigid_velocities import RigidVelocities, creepages
from wheelrail.contact.models.standard.creep_coefficients import PairElasticity
from wheelrail.contact.models.standard.fastsim import strip_sums
from wheelrail.contact.models.standard.forces import (
    FASTSIM,
    NO_FRICTION,
    POLACH,
    RollingPatch,
    StripFrames,
    half_ellipse_means,
    polach_force,
    rolling_patch,
)
from wheelrail.contact.models.standard.normal import StripPressures
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled

Friction = tuple[int, float, tuple[float, float], int]  # method, coefficient, factors of Polach's formula, cells


@compiled
def strip_loads(
    strips: StripPressures,
    zones: PenetrationRegions,
    middles: StripFrames,
    peaks: StripFrames,
    v: RigidVelocities,
    elastic: PairElasticity,
    friction: Friction,
    force: Array,
    moment: Array,
) -> float:
    """Smallest rolling speed m/s of a contact; force and moment (3,), about the rail's origin, are added to.

    Parameters:
        strips, zones: pressures on the interpenetration regions.
        middles, peaks: frames in the middles of the strips and at the maxima of the penetration.
        v: rigid motion of wheel and rail.
        elastic: constants of both bodies.
        friction: method (see `StripFriction`), coefficient, factors of Polach's formula, and cells along each strip.
        force, moment: N and N m.

    The sums over all cells of `wheelrail.contact.models.standard.forces.strip_forces`.
    """
    method, mu, reduction, cells = friction
    dome, slowest, start = half_ellipse_means(cells)[1], np.inf, 0
    for c in range(len(zones.peak)):
        stop = start
        while stop < len(strips.s) and strips.contact[stop] == c:
            stop += 1
        patch = rolling_patch(strips, c, start, stop, peaks, v, elastic)
        slowest = min(slowest, patch.speed)
        rolls = method != NO_FRICTION and patch.speed > 0.0
        creep_force = (0.0, 0.0)
        if rolls and method == POLACH:
            creep_force = polach_force(patch, elastic.G, mu, reduction)
        for i in range(start, stop):
            half, size = strips.half[i], strips.width[i] * zones.weight[c]
            normal = 0.5 * np.pi * strips.scale[i] * half * half * size
            along, across, turn = 0.0, 0.0, 0.0
            if rolls and method == FASTSIM:
                creepage = creepages(v, middles.point[i], middles.axes[i], patch.speed)
                along, across, turn = fastsim_sums(patch, half, creepage, mu, dome)
                area = 2.0 * half * size
                along, across, turn = area * along, area * across, area * turn
            elif rolls:
                along, across = creep_force[0] * normal / patch.load, creep_force[1] * normal / patch.load
            add_load(middles, i, (along, across, normal, turn), force, moment)
        start = stop
    return slowest


@compiled
def fastsim_sums(
    patch: RollingPatch, half: float, creepage: tuple[float, float, float], mu: float, dome: Array
) -> tuple[float, float, float]:
    """`strip_sums` of a strip of a patch; parameters of `wheelrail.contact.models.standard.forces.fastsim_strip`."""
    (xi, eta, _), (wx, wy, spin) = patch.creepages, creepage
    top = mu * patch.paraboloid * half * half
    return strip_sums(half, (xi, eta), (wx - xi, wy - eta, spin), patch.flexibility, top, dome)


@compiled
def add_load(frames: StripFrames, i: int, load: tuple[float, float, float, float], force: Array, moment: Array) -> None:
    """Add the load of strip i: longitudinal, lateral and pressing force N, and moment N m about the inward normal."""
    point, axes, (x, y, p, turn) = frames.point[i], frames.axes[i], load
    fx = x * axes[0, 0] + y * axes[1, 0] - p * axes[2, 0]
    fy = x * axes[0, 1] + y * axes[1, 1] - p * axes[2, 1]
    fz = x * axes[0, 2] + y * axes[1, 2] - p * axes[2, 2]
    force[0] += fx
    force[1] += fy
    force[2] += fz
    moment[0] += point[1] * fz - point[2] * fy - turn * axes[2, 0]
    moment[1] += point[2] * fx - point[0] * fz - turn * axes[2, 1]
    moment[2] += point[0] * fy - point[1] * fx - turn * axes[2, 2]
