"""Force of strips of pressure and of FASTSIM or Polach's tractions on them, without storing their cells."""

from __future__ import annotations

import numpy as np

from wheelrail.contact.geometry.interpenetration import PenetrationRegions
from wheelrail.contact.kinematics.rigid_velocities import RigidVelocities
from wheelrail.contact.models.standard.creep_coefficients import PairElasticity
from wheelrail.contact.models.standard.forces import (
    FASTSIM,
    NO_FRICTION,
    PARABOLA,
    POLACH,
    StripFrames,
    parabola_means,
    polach_force,
    rolling_patch,
)
from wheelrail.contact.models.standard.normal import StripPressures
from wheelrail.contact.models.standard.strip_resultant import END, INCREMENTS, strip_increments, strip_resultants
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing, compiled

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
    dome, slowest, start = parabola_means(cells), np.inf, 0
    top = dome.max()
    bounds, increments, resultants = dome / top, np.empty((len(strips.s), INCREMENTS)), np.empty((len(strips.s), 3))
    lanes, creepage = np.empty(END), np.empty((len(strips.s), 3))
    for c in range(len(zones.peak)):
        stop = start
        while stop < len(strips.s) and strips.contact[stop] == c:
            stop += 1
        patch = rolling_patch(strips, c, (start, stop), (middles, peaks), v, elastic, creepage)
        slowest = min(slowest, patch.speed)
        rolls = method != NO_FRICTION and patch.speed > 0.0
        creep_force = (0.0, 0.0)
        if rolls and method == POLACH:
            creep_force = polach_force(patch, elastic.G, mu, reduction)
        if rolls and method == FASTSIM:
            for i in range(start, stop):
                half = strips.half[i]
                own = creepage[i, 0], creepage[i, 1], creepage[i, 2]
                bound, creep = mu * PARABOLA * strips.scale[i] * half * top, (patch.creepages[0], patch.creepages[1])
                strip_increments(patch.flexibility, creep, own, half, bound, increments[i])
            strip_resultants(increments[start:stop], bounds, resultants[start:stop], lanes)
        for i in range(start, stop):
            half, size = strips.half[i], strips.width[i] * zones.weight[c]
            normal = 0.5 * np.pi * strips.scale[i] * half * half * size
            along, across, turn = 0.0, 0.0, 0.0
            if rolls and method == FASTSIM:
                load = 1.5 * mu * top * normal
                along, across = load * resultants[i, 0], load * resultants[i, 1]
                turn = load * half * resultants[i, 2]
            elif rolls:
                along, across = creep_force[0] * normal / patch.load, creep_force[1] * normal / patch.load
            add_load(middles, i, (along, across, normal, turn), force, moment)
        start = stop
    return slowest


@borrowing
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
