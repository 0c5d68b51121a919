"""A wheel that runs over discrete sleepers on ballast: the track that moves along beside a beam solved in time.

`python -m benchmarks.moving_wheel`: force at the sleeper passing frequency. Half a wheelset with its load and a linear
contact on an Euler beam, 60E1, on pads of 100 kN/mm and 30 kN s/m at points every 0.6 m, half sleepers of 150 kg and
ballast of 80 kN/mm and 60 kN s/m. The beam of 36 m in Hermite elements is integrated by Newmark's method.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import lu_factor, lu_solve

from wheelrail.contact.structure.ballast import CoRunningTrack
from wheelrail.contact.structure.ballasted_sleepers import loaded_tracks
from wheelrail.contact.structure.pads import RailCompliance, wavenumber_samples
from wheelrail.contact.structure.sleepers import Span, SpreadSupport, cosines
from wheelrail.support.arrays import Array

BENDING, RAIL = 2.1e11 * 3038.3e-8, 7850 * 76.70e-4  # N m2, kg/m: 60E1
PAD, BED, SLEEPER = 100e6, 80e6, 150.0  # N/m and kg, of one pad and half a sleeper
TIMES = 30e3 / PAD, 60e3 / BED  # s
INERTIA = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) / 420
WHEEL, LOAD, CONTACT = 906.5, 54.5e3, 1.07e9  # kg, N, N/m: half the wheelset of the Manchester wagon
SPACING, SPANS, STEPS = 0.6, 24, 120  # m; spans of a run; time steps a span
SPEEDS = (10.0, 20.0, 30.0, 45.0, 60.0, 80.0)  # m/s
COUNT = 61  # sleepers


@dataclass(frozen=True)
class DirectBeam:
    """A long beam on pads, sleepers and ballast, by Hermite elements of a fifth of a span at most, statically exact.

    Parameters:
        spacing: of the sleepers, m.
        place: of the load from a sleeper, m.
        shear: stiffness kappa G A, N; infinite: an Euler beam.
        springs: of a pad 0.18 m long; 1: at a point.
        ballast: stiffness under half a sleeper, N/m.
        count: of sleepers.
    """

    spacing: float
    place: float
    shear: float = np.inf
    springs: int = 1
    ballast: float = BED
    count: int = 41

    def matrices(self) -> tuple[Array, Array, Array, Array, int]:
        """Stiffness of beam, pads and ballast, mass, all with the sleepers last, and the coordinate of the load."""
        sleepers = self.spacing * (np.arange(self.count) - self.count // 2)
        seats = sleepers[:, None] + 0.18 * ((np.arange(self.springs) + 0.5) / self.springs - 0.5)
        fine = np.linspace(seats[0, 0], seats[-1, -1], 5 * (self.count - 1) + 1) if self.springs == 1 else seats.ravel()
        x = np.unique(np.round(np.concatenate([fine, seats.ravel(), [self.place]]), 10))
        size = 2 * len(x)
        K, P, B, M = np.zeros((4, size + self.count, size + self.count))
        for i, h in enumerate(np.diff(x)):
            scale, at, phi = np.array([1.0, h, 1.0, h]), slice(2 * i, 2 * i + 4), 12 * BENDING / self.shear / h**2
            f, g = 4 + phi, 2 - phi
            unit = np.array([[12, 6, -12, 6], [6, f, -6, g], [-12, -6, 12, -6], [6, g, -6, f]]) / (1 + phi)
            K[at, at] += BENDING / h**3 * unit * np.outer(scale, scale)
            M[at, at] += RAIL * h * INERTIA * np.outer(scale, scale)
        own = size + np.arange(self.count)
        for seat in seats.T:
            on = 2 * np.searchsorted(x, np.round(seat, 10))
            for first, second, sign in ((own, own, 1), (on, on, 1), (own, on, -1), (on, own, -1)):
                P[first, second] += sign * PAD / self.springs
        B[own, own], M[own, own] = self.ballast, SLEEPER
        return K, P, B, M, 2 * int(np.searchsorted(x, np.round(self.place, 10)))

    @staticmethod
    def damping(pads: Array, ballast: Array) -> Array:
        """Damping by the stiffness of pads and ballast."""
        return TIMES[0] * pads + TIMES[1] * ballast

    def receptance(self, frequency: float) -> complex:
        """Motion m/N under the load; frequency: Hz."""
        K, P, B, M, load = self.matrices()
        omega = 2 * np.pi * frequency
        dynamic = K + P + B + 1j * omega * self.damping(P, B) - omega**2 * M
        return complex(np.linalg.solve(dynamic, np.eye(len(K))[load])[load])

    def ritz(self) -> tuple[float, float, float]:
        """Masses kg of the beam and the sleepers, and stiffness N/m of the pads between beam and sleepers, by the shape
        under the load, sleepers interpolated there by sinc functions.
        """
        K, P, B, M, load = self.matrices()
        u = np.linalg.solve(K + P + B, np.eye(len(K))[load])
        sleepers = np.arange(len(K)) >= len(K) - self.count
        beam, beds = np.where(sleepers, 0.0, u), np.where(sleepers, u, 0.0)
        distance = np.arange(self.count) - self.count // 2 - self.place / self.spacing
        under = float(u[sleepers] @ np.sinc(distance))
        return beam @ M @ beam / u[load] ** 2, beds @ M @ beds / under**2, -(beam @ P @ beds) / u[load] / under


@cache
def beam_track(spacing: float = 0.6, length: float = 0.0) -> CoRunningTrack:
    """An Euler beam on the same layers, alike in all directions, that moves along; spacing, and length of a pad: m."""
    k, pads, bed = wavenumber_samples(), PAD / spacing, np.full(2, BED / spacing)
    compliance = (1 / (BENDING * k**4 + pads))[:, None, None]
    by_load = compliance * np.eye(2, 3)
    shapes = np.concatenate([np.eye(3, 2), np.eye(3)], axis=1)
    inertia = RAIL * compliance**2 * (shapes.T @ shapes)
    support = SpreadSupport(k, pads * np.eye(2), compliance * np.eye(2), by_load, inertia, np.ones(2), np.eye(2))
    span, winkler = Span(support, spacing, length, bed), (pads / (4 * BENDING)) ** 0.25 / (2 * pads)
    loaded = loaded_tracks(span, span.places(20), winkler * np.eye(3))
    mean, *varying = cosines(np.stack([at.compliance for at in loaded]))
    rail = RailCompliance(mean, np.zeros(2), 0.0, np.stack(varying), spacing)
    matrices, *others = cosines(np.stack([at.reduced(np.full(2, pads), bed, SLEEPER / spacing) for at in loaded]))
    return CoRunningTrack(rail, matrices, *TIMES, np.stack(others))


def hermite(s: float, h: float) -> Array:
    """Shape functions (4,) of an element of a length h m at the fraction s of it."""
    return np.array(
        [1 - 3 * s**2 + 2 * s**3, h * (s - 2 * s**2 + s**3), 3 * s**2 - 2 * s**3, h * (s**3 - s**2)], dtype=float
    )


def by_newmark(speed: float) -> tuple[Array, Array]:
    """Places (n,) in spans from a sleeper and forces (n,) N of a wheel on the direct beam; speed: m/s."""
    K, P, B, M, _ = DirectBeam(SPACING, 0.0, count=COUNT).matrices()
    C, whole, step = DirectBeam.damping(P, B), K + P + B, SPACING / speed / STEPS
    h, size = SPACING / 5.0, len(K)
    factors = lu_factor(M + 0.5 * step * C + 0.25 * step**2 * whole)

    def under(span: float) -> Array:
        """Displacement of the beam under the wheel by its coordinates."""
        element, s = divmod((span + COUNT // 2) * SPACING / h, 1.0)
        out = np.zeros(size)
        out[2 * int(element) : 2 * int(element) + 4] = hermite(s, h)
        return out

    spans = -0.5 * SPANS + np.arange(SPANS * STEPS + 1) / STEPS
    u, v, a = -np.linalg.solve(whole, under(spans[0])) * LOAD, np.zeros(size), np.zeros(size)
    z, vz, az = under(spans[0]) @ u - LOAD / CONTACT, 0.0, 0.0
    forces = np.full(len(spans), LOAD)
    for i, span in enumerate(spans[1:], start=1):
        place, quarter = under(span), 0.25 * step**2
        u, v, z, vz = u + step * v + quarter * a, v + 0.5 * step * a, z + step * vz + quarter * az, vz + 0.5 * step * az
        free, by_force = lu_solve(factors, np.column_stack([-C @ v - whole @ u, -place])).T
        gap = place @ (u + quarter * free) - z + quarter * LOAD / WHEEL
        forces[i] = CONTACT * gap / (1.0 - CONTACT * quarter * (place @ by_force - 1.0 / WHEEL))
        a, az = free + by_force * forces[i], (forces[i] - LOAD) / WHEEL
        u, v, z, vz = u + quarter * a, v + 0.5 * step * a, z + quarter * az, vz + 0.5 * step * az
    return spans, forces


def by_co_running(speed: float) -> tuple[Array, Array]:
    """The same on the track that moves along, in the variables of `wheelrail.contact.loading.co_running_structure`."""
    track, vertical = beam_track(SPACING), np.ix_([1, 4], [1, 4])
    mean = track.mass[vertical]

    def rate(time: float, state: Array) -> Array:
        here = track.at((-0.5 * SPANS + time * speed / SPACING) * SPACING)
        motion, momentum, (z, vz) = state[:2], state[2:4], state[4:]
        rates = np.linalg.solve(here.mass[vertical], mean @ momentum)
        force = CONTACT * (motion[0] - z)
        on_track = -here.stiffness[vertical] @ motion - here.damping[vertical] @ rates - [force, 0.0]
        return np.concatenate([rates, np.linalg.solve(mean, on_track), [vz, (force - LOAD) / WHEEL]])

    rest = np.linalg.solve(track.at(-0.5 * SPANS * SPACING).stiffness[vertical], [-LOAD, 0.0])
    state, duration = np.array([*rest, 0.0, 0.0, rest[0] - LOAD / CONTACT, 0.0]), SPANS * SPACING / speed
    longest = SPACING / speed / 40.0
    solution = solve_ivp(rate, (0.0, duration), state, method="Radau", rtol=1e-7, atol=1e-10, max_step=longest)
    return solution.t * speed / SPACING - 0.5 * SPANS, CONTACT * (solution.y[0] - solution.y[4])


def passing_force(spans: Array, forces: Array) -> float:
    """Amplitude N of the force at the sleeper passing frequency over the eight spans after the middle."""
    places = 8.0 * np.arange(1024) / 1024
    return float(2.0 * np.abs(np.fft.rfft(np.interp(places, spans, forces))[8]) / len(places))


def main() -> None:
    """Print the table, in Markdown."""
    print("| m/s | passing frequency, Hz | beam in time, N | track that moves along, N | difference |")
    print(f"|{'---|' * 5}")
    for speed in SPEEDS:
        exact, own = passing_force(*by_newmark(speed)), passing_force(*by_co_running(speed))
        cells = (
            f"{speed:.0f}",
            f"{speed / SPACING:.0f}",
            f"{exact:.0f}",
            f"{own:.0f}",
            f"{100 * (own / exact - 1):.0f} %",
        )
        print(f"| {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
