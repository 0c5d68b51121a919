"""Tractions on the cells of strips, and their resultants, from strip pressures and rigid velocities."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.kinematics.rigid_velocities import RigidVelocities, creepages, rolling_speed
from wheelrail.contact.models.standard.creep_coefficients import PairElasticity, coefficients
from wheelrail.contact.models.standard.fastsim import ElasticFoundation, foundation, strip_tractions
from wheelrail.contact.models.standard.normal import StripPressures
from wheelrail.contact.models.standard.polach import effective, polach
from wheelrail.support.arrays import Array, Mask
from wheelrail.support.compiled import borrowing, compiled

NO_FRICTION, FASTSIM, POLACH = 0, 1, 2
PARABOLA = 0.375 * np.pi  # peak of a parabola over that of a half ellipse of the same area and length


class StripFriction(NamedTuple):
    """Tangential method and friction coefficients for compiled code.

    Parameters:
        method: NO_FRICTION, FASTSIM or POLACH.
        of_cells: (n m,), for FASTSIM.
        of_contacts: (k,), for Polach's formula.
        reduction: factors k_A and k_S of Polach's formula.
    """

    method: int
    of_cells: Array
    of_contacts: Array
    reduction: tuple[float, float]


class StripFrames(NamedTuple):
    """Points (n, 3) m on the wheel's surface and axes (n, 3, 3) there, rows longitudinal, lateral and outward."""

    point: Array
    axes: Array


class RollingPatch(NamedTuple):
    """Rolling contact of one patch.

    Parameters:
        speed: rolling speed, m/s.
        creepages: longitudinal, lateral, and spin 1/m, means of the strips by their normal forces.
        semi_axes: along and across, of the ellipse with the pressure's second moments, m.
        load: normal force, N.
        kalker: coefficients C11, C22, C23.
        flexibility: of the elastic foundation.
    """

    speed: float
    creepages: tuple[float, float, float]
    semi_axes: tuple[float, float]
    load: float
    kalker: tuple[float, float, float]
    flexibility: ElasticFoundation


class StripTractions(NamedTuple):
    """Tractions of k contacts on n cells, strip by strip from the trailing end, and their resultants.

    Parameters:
        force, moment: (3,) N and N m, about the origin.
        speed: (k,) m/s, rolling speed of the contacts.
        point: (n, 3) m.
        length: (n,) m.
        area: (n,) m2, times the weight of the contact.
        pressure: (n,) Pa.
        traction: (n, 2) Pa.
        slip: (n, 2) over the rolling speed.
        sticks: (n,), whether the slip is zero.
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


@borrowing
def mean_creepages(
    strips: StripPressures,
    own: tuple[int, int],
    middles: StripFrames,
    v: RigidVelocities,
    speed: float,
    creepage: Array,
) -> tuple[float, float, float]:
    """Means of longitudinal and lateral creepage and of spin 1/m over a patch, by the normal forces of its strips.

    Parameters:
        strips: pressures.
        own: first strip of the patch, and one past the last.
        middles: frames in the middles of the strips.
        v: rigid motion of wheel and rail.
        speed: rolling speed, m/s.
        creepage: (n, 3), of the strips, those of this patch are filled.

    A surface is curved across a wide patch. Where it sticks, the force of a strip is in proportion to its creepage and
    to the square of its length, as its normal force is, so that the force of the patch is that of the mean.
    """
    total, xi, eta, phi = 0.0, 0.0, 0.0, 0.0
    for i in range(*own):
        load = strips.half[i] * strips.half[i] * strips.width[i]
        wx, wy, spin = creepages(v, middles.point[i], middles.axes[i], speed)
        creepage[i, 0], creepage[i, 1], creepage[i, 2] = wx, wy, spin
        total, xi, eta, phi = total + load, xi + load * wx, eta + load * wy, phi + load * spin
    return xi / total, eta / total, phi / total


@borrowing
def rolling_patch(
    strips: StripPressures,
    contact: int,
    own: tuple[int, int],
    frames: tuple[StripFrames, StripFrames],
    v: RigidVelocities,
    elastic: PairElasticity,
    creepage: Array,
) -> RollingPatch:
    """Rolling contact of a patch; frames at the strips, and at the maxima of the penetration, where the rolling speed
    is taken; other parameters are those of `mean_creepages`.
    """
    middles, peaks = frames
    speed = rolling_speed(v, peaks.point[contact], peaks.axes[contact, 0])
    a, b, load = strips.along[contact], strips.across[contact], strips.load[contact]
    kalker = coefficients(elastic.table, a / b)
    return RollingPatch(
        speed,
        mean_creepages(strips, own, middles, v, speed, creepage),
        (a, b),
        load,
        kalker,
        foundation(a, b, elastic.G, kalker),
    )


@compiled
def half_ellipse_means(cells: int) -> Array:
    """Means (m,) over m equal cells from -1 to 1 of sqrt(1 - t^2)."""
    arch = np.empty(cells)
    for j in range(cells):
        low, high = 2.0 * j / cells - 1.0, 2.0 * (j + 1) / cells - 1.0
        arch[j] = (
            0.25
            * cells
            * (
                high * np.sqrt(max(1.0 - high * high, 0.0))
                + np.arcsin(min(high, 1.0))
                - low * np.sqrt(max(1.0 - low * low, 0.0))
                - np.arcsin(low)
            )
        )
    return arch


@compiled
def parabola_means(cells: int) -> Array:
    """Means (m,) over m equal cells from -1 to 1 of 1 - t^2."""
    dome = np.empty(cells)
    for j in range(cells):
        low, high = 2.0 * j / cells - 1.0, 2.0 * (j + 1) / cells - 1.0
        dome[j] = 1.0 - (high * high + high * low + low * low) / 3.0
    return dome


@borrowing
def fill_cells(
    strips: StripPressures, i: int, frames: StripFrames, share: float, arch: Array, cells: StripTractions
) -> None:
    """Fill points, sizes and pressures of the cells of strip i, with the area times a weight (share)."""
    m, half = len(arch), strips.half[i]
    length = 2.0 * half / m
    for j in range(m):
        q, x = i * m + j, half * ((2.0 * j + 1.0) / m - 1.0)
        cells.length[q], cells.area[q] = length, length * strips.width[i] * share
        cells.pressure[q] = strips.scale[i] * half * arch[j]
        for d in range(3):
            cells.point[q, d] = frames.point[i, d] + x * frames.axes[i, 0, d]


@compiled
def fastsim_strip(
    patch: RollingPatch,
    half: float,
    peak: float,
    creepage: tuple[float, float, float],
    friction: Array,
    dome: Array,
    traction: Array,
    slip: Array,
) -> None:
    """Fill tractions (m, 2) Pa and slips (m, 2) of a strip by FASTSIM.

    Parameters:
        patch: of the strip.
        half, peak: half length m, and largest pressure Pa.
        creepage: longitudinal, lateral, and spin 1/m, in the middle of the strip.
        friction: (m,), coefficients.
        dome: (m,), means of 1 - t^2 over the cells.
        traction, slip: filled.
    """
    m = len(dome)
    xi, eta, _ = patch.creepages
    bounds = np.empty(m)
    for j in range(m):
        bounds[j] = friction[j] * PARABOLA * peak * dome[j]
    strip_tractions(half, (xi, eta), creepage, patch.flexibility, bounds, traction, slip)


@compiled
def slip_velocities(
    strips: StripPressures, contacts: int, middles: StripFrames, peaks: StripFrames, v: RigidVelocities, m: int
) -> tuple[Array, Array]:
    """Rigid slip velocities on the m cells of n strips (n m,), and of the contacts as a whole (contacts,), m/s."""
    n, stop = len(strips.s), 0
    cells, whole, creepage = np.zeros(n * m), np.zeros(contacts), np.empty((n, 3))
    for c in range(contacts):
        start = stop
        while stop < n and strips.contact[stop] == c:
            stop += 1
        speed = rolling_speed(v, peaks.point[c], peaks.axes[c, 0])
        if not speed > 0.0:
            continue
        xi, eta, phi = mean_creepages(strips, (start, stop), middles, v, speed, creepage)
        whole[c] = speed * np.hypot(xi, effective(eta, phi, strips.along[c]))
        for i in range(start, stop):
            for j in range(m):
                x = strips.half[i] * ((2.0 * j + 1.0) / m - 1.0)
                cells[i * m + j] = speed * np.hypot(creepage[i, 0], creepage[i, 1] + creepage[i, 2] * x)
    return cells, whole


@borrowing
def polach_force(patch: RollingPatch, G: float, friction: float, reduction: tuple[float, float]) -> tuple[float, float]:
    """Longitudinal and lateral force N on a patch by Polach's formula, for a friction coefficient."""
    return polach(patch.creepages, patch.semi_axes, friction * patch.load, G, patch.kalker, reduction)


@borrowing
def polach_strip(
    force: tuple[float, float],
    load: float,
    half: float,
    creepage: tuple[float, float, float],
    pressure: Array,
    traction: Array,
    slip: Array,
) -> None:
    """Fill tractions (m, 2) Pa of a strip, proportional to the pressure (m,) Pa, and rigid slips (m, 2).

    Parameters:
        force: longitudinal and lateral, of the patch, N.
        load: of the patch, N.
        half: half length, m.
        creepage: longitudinal, lateral, and spin 1/m, in the middle of the strip.
        pressure: (m,) Pa.
        traction, slip: filled.
    """
    m = len(pressure)
    for j in range(m):
        x = half * ((2.0 * j + 1.0) / m - 1.0)
        traction[j, 0], traction[j, 1] = force[0] * pressure[j] / load, force[1] * pressure[j] / load
        slip[j, 0], slip[j, 1] = creepage[0], creepage[1] + creepage[2] * x


@borrowing
def integrate_tractions(cells: StripTractions, axes: Array) -> None:
    """Fill force and moment from tractions and pressures of the cells, axes (n, 3, 3) of their strips."""
    force, moment, place = cells.force, cells.moment, cells.point
    m = len(cells.area) // len(axes)
    for q in range(len(cells.area)):
        f, l, u = axes[q // m, 0], axes[q // m, 1], axes[q // m, 2]
        area, pressure, tx, ty = cells.area[q], cells.pressure[q], cells.traction[q, 0], cells.traction[q, 1]
        px = area * (tx * f[0] + ty * l[0] - pressure * u[0])
        py = area * (tx * f[1] + ty * l[1] - pressure * u[1])
        pz = area * (tx * f[2] + ty * l[2] - pressure * u[2])
        force[0] += px
        force[1] += py
        force[2] += pz
        moment[0] += place[q, 1] * pz - place[q, 2] * py
        moment[1] += place[q, 2] * px - place[q, 0] * pz
        moment[2] += place[q, 0] * py - place[q, 1] * px


@compiled
def strip_forces(
    strips: StripPressures,
    share: Array,
    middles: StripFrames,
    peaks: StripFrames,
    v: RigidVelocities,
    elastic: PairElasticity,
    tangential: StripFriction,
    m: int,
) -> StripTractions:
    """Tractions of k contacts on the cells of n strips.

    Parameters:
        strips: pressures.
        share: (k,), weights of the contacts' areas.
        middles: frames in the middles of the n strips.
        peaks: frames at the k maxima of the penetration, where the contacts' rolling speeds are taken.
        v: rigid motion of wheel and rail.
        elastic: constants of both bodies.
        tangential: method and friction coefficients.
        m: cells along each strip.

    Contacts with a rolling speed that is not positive have no tangential tractions.
    """
    n, k = len(strips.s), len(share)
    cells = StripTractions(
        np.zeros(3),
        np.zeros(3),
        np.zeros(k),
        np.empty((n * m, 3)),
        np.empty(n * m),
        np.empty(n * m),
        np.empty(n * m),
        np.zeros((n * m, 2)),
        np.zeros((n * m, 2)),
        np.zeros(n * m, dtype=np.bool_),
    )
    arch, dome = half_ellipse_means(m), parabola_means(m)
    start, all_creepages = 0, np.empty((n, 3))
    for c in range(k):
        stop = start
        while stop < n and strips.contact[stop] == c:
            stop += 1
        patch = rolling_patch(strips, c, (start, stop), (middles, peaks), v, elastic, all_creepages)
        cells.speed[c] = patch.speed
        rolls = tangential.method != NO_FRICTION and patch.speed > 0.0
        force = (0.0, 0.0)
        if rolls and tangential.method == POLACH:
            force = polach_force(patch, elastic.G, tangential.of_contacts[c], tangential.reduction)
        for i in range(start, stop):
            fill_cells(strips, i, middles, share[c], arch, cells)
            if not rolls:
                continue
            own, half = slice(i * m, (i + 1) * m), strips.half[i]
            traction, slip = cells.traction[own], cells.slip[own]
            creepage = all_creepages[i, 0], all_creepages[i, 1], all_creepages[i, 2]
            if tangential.method == FASTSIM:
                fastsim_strip(
                    patch, half, strips.scale[i] * half, creepage, tangential.of_cells[own], dome, traction, slip
                )
            else:
                polach_strip(force, patch.load, half, creepage, cells.pressure[own], traction, slip)
            for q in range(i * m, (i + 1) * m):
                cells.sticks[q] = cells.slip[q, 0] == 0.0 and cells.slip[q, 1] == 0.0
        start = stop
    integrate_tractions(cells, middles.axes)
    return cells
