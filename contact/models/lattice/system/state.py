"""Unknowns of the contact on a lattice: loaded strips with their tractions, pressure modes and ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.contact.models.lattice.influence.basis import MODES
from wheelrail.support.arrays import Array, Mask, Nodes
from wheelrail.support.compiled import borrowing, compiled

SHORTEST = 0.02  # of the squared half length, or of the load: the least that remains of it after one step
LARGE = 0.5  # step after which a negative load or squared length is no reason to leave
VANISHED = 5e-3  # half length over the largest one: of a penetration of some 1e-5 of the approach
LONGEST = 3.0  # largest relative growth of a squared half length in one step
SHRUNK = 0.7  # largest relative decrease of that of a long strip
LEAST_PRESSURE = 1e3  # Pa, to which steps are related at least


@dataclass(frozen=True)
class LatticeState:
    """S loaded strips.

    Parameters:
        strips: (S,) their numbers on the lattice, ascending.
        values: (S, 2 M + MODES + 2), strip by strip: tractions Pa of the cells along and across (none without
            friction), amplitudes Pa of the pressure modes, and ends m.
    """

    strips: Nodes
    values: Array

    @property
    def ends(self) -> Array:
        """Trailing and leading ends (S, 2) m along the rolling circle."""
        return self.values[:, -2:]

    @property
    def modes(self) -> Array:
        """Amplitudes (S, MODES) Pa."""
        return self.values[:, -2 - MODES : -2]

    @property
    def tractions(self) -> Array:
        """Tractions (S, 2, M) Pa; M = 0 without friction."""
        return self.values[:, : -2 - MODES].reshape(len(self.strips), 2, -1)

    @property
    def half(self) -> Array:
        """Half lengths (S,) m."""
        return np.asarray(0.5 * (self.values[:, -1] - self.values[:, -2]))

    @property
    def load(self) -> Array:
        """Amplitude times half length (S,) Pa m, proportional to the load per width."""
        return np.asarray(self.half * self.modes[:, 0])

    def at(self, chosen: Mask) -> LatticeState:
        """Those strips of a mask (S,)."""
        return LatticeState(self.strips[chosen], self.values[chosen])

    def joined(self, other: LatticeState) -> LatticeState:
        """These strips and others, in order."""
        strips = np.concatenate([self.strips, other.strips])
        order = np.argsort(strips)
        return LatticeState(strips[order], np.concatenate([self.values, other.values])[order])


@compiled
def moved(values: Array, step: Array, factor: float, whole: Array) -> Array:
    """Values (S, block) after a fraction of a step; whole (S,) Pa m, loads on the whole width.

    The steps are taken in the squared half length and in loads per width, or in their roots where a strip touches on a
    part of its width: these are nearly linear in the penetration in excess.
    """
    new = np.empty_like(values)
    last = values.shape[1] - 1
    first = last - 1 - MODES
    for i in range(len(values)):
        half, change = 0.5 * (values[i, last] - values[i, last - 1]), 0.5 * (step[i, last] - step[i, last - 1])
        load, rise = values[i, first] * half, factor * change / half
        middle = 0.5 * (values[i, last] + values[i, last - 1] + factor * (step[i, last] + step[i, last - 1]))
        if load < whole[i]:
            new_half = half * max(1.0 + rise, np.sqrt(SHORTEST))
            for k in range(last - 1):
                new[i, k] = values[i, k] + factor * step[i, k]
        else:
            new_half = half * np.sqrt(max(_remaining(1.0 + 2.0 * rise, load, whole[i]), SHORTEST))
            for k in range(last - 1):
                new[i, k] = (values[i, k] * (half + factor * change) + factor * step[i, k] * half) / new_half
            after = new[i, first] * new_half / load
            new[i, first] = load * _remaining(after, load, whole[i]) / new_half
        new[i, last - 1], new[i, last] = middle - new_half, middle + new_half
    return new


@borrowing
def _remaining(factor: float, load: float, whole: float) -> float:
    """Factor of a load that touches on the whole width: its square root falls where it ends up below that. Where the
    penetration does not vary across, whole is zero, and at least `SHORTEST` of the load remains.
    """
    if whole == 0.0:
        return max(factor, SHORTEST)
    if load * factor >= whole:
        return factor
    root = 0.5 + 0.5 * max(load * factor / whole, -1.0)
    return root * root * whole / load


@borrowing
def _scales(values: Array) -> tuple[float, float]:
    """Pressure Pa and length m to which steps are related: the largest amplitude and half length."""
    last = values.shape[1] - 1
    pressure, half = LEAST_PRESSURE, 0.0
    for i in range(len(values)):
        pressure = max(pressure, abs(values[i, last - 1 - MODES]))
        half = max(half, 0.5 * (values[i, last] - values[i, last - 1]))
    return pressure, half


@borrowing
def relative_size(values: Array, step: Array) -> tuple[float, float]:
    """Largest entry and norm of a step (S, block) over the largest amplitude of the pressure, or half length.

    For the largest one entries are multiplied by the half length of their strip over the largest, as they count in its
    load: those of strips of micrometres are uncertain by round-off.
    """
    last = values.shape[1] - 1
    pressure, half = _scales(values)
    largest, total = 0.0, 0.0
    for i in range(len(values)):
        weight = 0.5 * (values[i, last] - values[i, last - 1]) / half
        for k in range(last + 1):
            part = abs(step[i, k]) / (pressure if k < last - 1 else half)
            largest = max(largest, weight * part)
            total += part * part
    return largest if np.isfinite(total) else np.inf, np.sqrt(total)


@borrowing
def inner_product(values: Array, first: Array, second: Array) -> float:
    """That of two steps (S, block), of the norm of `relative_size`."""
    last = values.shape[1] - 1
    pressure, half = _scales(values)
    stresses, lengths = 0.0, 0.0
    for i in range(len(values)):
        for k in range(last - 1):
            stresses += first[i, k] * second[i, k]
        for k in range(last - 1, last + 1):
            lengths += first[i, k] * second[i, k]
    return stresses / (pressure * pressure) + lengths / (half * half)


@compiled
def leaving(values: Array, step: Array, size: float, whole: Array) -> Mask:
    """Strips (S,) that leave by a step of a relative size: with negative load or half length after a full step in the
    roots of `moved`, if it is a moderate one, as a step from a poor start overshoots, or if they have nearly vanished.
    """
    S, last = len(values), values.shape[1] - 1
    first, largest = last - 1 - MODES, 0.0
    for i in range(S):
        largest = max(largest, 0.5 * (values[i, last] - values[i, last - 1]))
    leaves = np.zeros(S, dtype=np.bool_)
    for i in range(S):
        half, change = 0.5 * (values[i, last] - values[i, last - 1]), 0.5 * (step[i, last] - step[i, last - 1])
        amplitude, more = values[i, first], step[i, first]
        load = amplitude * half
        if load < whole[i]:
            vanishes = amplitude + more <= 0.0 or half + change <= 0.0
        else:
            rest = min(load + more * half + amplitude * change, load * (1.0 + 2.0 * change / half))
            vanishes = rest <= -whole[i]
        leaves[i] = vanishes and (size < LARGE or half < VANISHED * largest)
    return leaves


@borrowing
def longest(values: Array, step: Array) -> float:
    """Largest fraction of a step at which no strip moves by more than its length or grows too much."""
    S, last = len(values), values.shape[1] - 1
    largest, limit = 0.0, 1.0
    for i in range(S):
        largest = max(largest, 0.5 * (values[i, last] - values[i, last - 1]))
    for i in range(S):
        half, change = 0.5 * (values[i, last] - values[i, last - 1]), 0.5 * (step[i, last] - step[i, last - 1])
        away = 0.5 * abs(step[i, last] + step[i, last - 1]) / largest
        growth = 2.0 * max(change / LONGEST, -change / SHRUNK) / half if half > 0.3 * largest else 0.0
        limit = max(limit, growth, away)
    return 1.0 / limit
