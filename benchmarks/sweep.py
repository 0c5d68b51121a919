"""Lateral sweep of a wheel across its rail at constant load: is the contact a smooth function of the pose?

python -m benchmarks.sweep [--step MM] [--from MM] [--to MM] [--friction MU] [--yaw MRAD] [--bodies half-space]
                           [--resolution STRIPSxCELLS] [--tolerance T] [--tangents EVERY] [--finer STRIPSxCELLS]
                           [--picture FILE] [--beside FILE] [--json FILE]

One wheel of a wheelset (the other is its mirror image) under 57 kN from y = -8 to 8 mm, roll 0, rolling. Output for
every force and moment, relative to the load (moments: to the load on one nominal radius): the largest change between
positions; the largest second difference, that over eight times the distance divided by 64 (the curvature of the
function), and the largest ratio of the former to three times the latter nearby plus 2e-5 of the load; with --finer
these ratios once more, where they are above one, with the second differences of a finer contact nearby as the
curvature of the function, which may change within less than eight times the distance; the largest
difference between solves that start from earlier results and from none; and, at every n-th position, changes of force
and moment over some distances to either side along every coordinate, against the integral of the tangent between, over
the largest entry of its row. It is evaluated at 4, 16, 64 or 256 places, until it agrees: cells that begin to slip or
to stick bend the tangent.
"""

from __future__ import annotations

import argparse
import json
import math
from dataclasses import dataclass, field, replace
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

import numpy as np
from scipy.ndimage import maximum_filter1d
from scipy.special import roots_legendre

from benchmarks.common.machine import machine_description
from benchmarks.common.models import STEEL, PairTrack, lattice_resolution, wheelset_model
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array

LOAD = 57e3  # N
NAMES = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
SPEED = 10.0  # m/s
RTOL = 1e-7  # of the load
SEARCH = 60  # solves for the depth under the load
DEEPER, RELEASE = 2e-5, 1e-4  # m, largest steps of the depth: on a flange the force grows within micrometres
WIDE = 8  # distance of the differences from which the curvature is taken, in steps
ALLOWED = 2e-5  # of the load
NEAR = 4  # positions: of second differences of a finer contact
DISTANCES = 2e-7, 2e-6  # m and rad, over which the tangent is integrated
PLACES, WEIGHTS = roots_legendre(4)
PANELS = 1, 4, 16, 64  # of four places each: cells that begin to slip or to stick bend the tangent at places unknown
EXACT = 1e-4  # of the largest entry of a row: no more panels
RATES = SPEED  # m/s and rad/s over m and rad in them: equal creepages


class Unsolved(RuntimeError):
    """No solution at a position."""


@dataclass
class Sweep:
    """Contact of the left wheel under the load at one position after another.

    Parameters:
        contact: of the wheelset.
        yaw: rad.
        start: m, depth at which the first position is tried.
        slope: N/m, of the force by the depth, at the last position.
        path: the last positions and depths m, from which the next depth is extrapolated.
        last: result there, from which solves start.
    """

    contact: WheelsetContact
    yaw: float
    start: float = 0.0
    slope: float = 1e9
    path: list[tuple[float, float]] = field(default_factory=list)
    last: ContactResult | None = None

    def solved(self, state: WheelsetState, guess: ContactResult | None) -> ContactResult:
        result = self.contact(state, "left", guess)
        if not result.ok:
            raise Unsolved(f"y = {1e3 * state.y:.3f} mm, z = {1e3 * state.z:.5f} mm: {result.status}")
        return result

    def at(self, y: float, depth: float) -> WheelsetState:
        rolling = SPEED / self.contact.mounting.radius
        return WheelsetState(y=y, z=-depth, yaw=self.yaw, speed=SPEED, pitch_rate=rolling)

    def under_load(self, y: float) -> tuple[WheelsetState, ContactResult]:
        """State that carries the load, by secant steps within the bracket of depths, and its result from those before.
        Raises Unsolved.
        """
        before: tuple[float, float] | None = None
        low, high = -np.inf, np.inf  # depths under too small and too large a force
        depth, result = self._extrapolated(y), self.last
        for _ in range(SEARCH):
            result = self.solved(self.at(y, depth), result)
            force = float(result.force[2])
            if abs(force - LOAD) <= RTOL * LOAD:
                self.path = [*self.path[-2:], (y, depth)]
                return self.at(y, depth), result
            low, high = (max(low, depth), high) if force < LOAD else (low, min(high, depth))
            if before is not None and abs(depth - before[0]) > 1e-10:
                self.slope = max((force - before[1]) / (depth - before[0]), 1e7)
            before = depth, force
            depth += float(np.clip((LOAD - force) / self.slope, -RELEASE, DEEPER)) if force > 0 else DEEPER
            if not low < depth < high:
                depth = 0.5 * (low + high)
        raise Unsolved(f"y = {1e3 * y:.3f} mm: {LOAD:g} N not reached in {SEARCH} solves, {force:.0f} N at the last")

    def _extrapolated(self, y: float) -> float:
        """Depth m at a position, of the polynomial through those of the last ones."""
        if not self.path:
            return self.start
        return sum(
            depth * math.prod((y - other) / (own - other) for other, _ in self.path if other != own)
            for own, depth in self.path
        )

    def position(self, y: float) -> tuple[WheelsetState, ContactResult, float]:
        """State under the load at y m, result from no earlier one, and the largest difference to that from earlier
        ones, N (moments over the radius). Raises Unsolved.
        """
        state, warm = self.under_load(y)
        cold = self.solved(state, None)
        difference = np.abs(_wrench(warm) - _wrench(cold)) / np.repeat([1.0, self.contact.mounting.radius], 3)
        self.last = cold
        return state, cold, float(difference.max())

    def tangent_errors(self, y: float, state: WheelsetState, result: ContactResult) -> list[TangentError]:
        """Errors of the tangent near a state at y m along all coordinates. Raises Unsolved."""
        result = self.solved(state, result)  # once more: changes of force are down to 1e-6 of the load
        tangent = self.contact.tangent(state, "left", result)
        errors = []
        rates = np.array([name.endswith("rate") for name in state.coordinates])
        for k, name in enumerate(state.coordinates):
            largest = np.abs(tangent[:, rates == rates[k]]).max(axis=1)
            if not largest.any():  # without friction nothing depends on velocities
                continue
            for distance in DISTANCES:
                for h in np.array([-distance, distance]) * (RATES if rates[k] else 1.0):
                    panels, error = self._integrated(state, result, k, float(h), largest)
                    errors.append(TangentError(y, name, distance, float(h), panels, error))
        return errors

    def _integrated(
        self, state: WheelsetState, result: ContactResult, k: int, h: float, largest: Array
    ) -> tuple[int, float]:
        """Panels of the integral of column k of the tangent over the change h of its coordinate, and the largest
        difference of the mean tangent to that of force and moment, over the largest entries (6,) of the rows.
        """
        name, rows = state.coordinates[k], largest > 0

        def ahead(place: float) -> tuple[WheelsetState, ContactResult]:
            there = replace(state, **{name: getattr(state, name) + place * h})
            return there, self.solved(there, result)

        change = (_wrench(ahead(1.0)[1]) - _wrench(result)) / h
        for panels in PANELS:
            mean = np.zeros(6)
            for panel in range(panels):
                for place, weight in zip(PLACES, WEIGHTS, strict=True):
                    there, found = ahead((panel + 0.5 + 0.5 * place) / panels)
                    mean += 0.5 * weight / panels * self.contact.tangent(there, "left", found)[:, k]
            error = float((np.abs(change - mean)[rows] / largest[rows]).max())
            if error <= EXACT:
                break
        return panels, error


class TangentError(NamedTuple):
    """Error of a tangent.

    Parameters:
        y: m, position.
        coordinate: its name.
        distance, change: m or rad, nominal, and the signed change of the coordinate.
        panels: of the integral.
        error: of the mean tangent, over the largest entry of a row.
    """

    y: float
    coordinate: str
    distance: float
    change: float
    panels: int
    error: float


def _wrench(result: ContactResult) -> Array:
    return np.concatenate([result.force, result.moment])


@dataclass
class Record:
    """Results of all positions.

    Parameters:
        wrench: (m, 6) N and N m, NaN where there is no solution.
        height: (m,) m, of the wheelset, NaN likewise.
        patches: their numbers.
        difference: of warm and cold solves, N.
        seconds: of each position.
        tangents: errors by `Sweep.tangent_errors`.
        unsolved: positions without a solution, and why.
    """

    wrench: Array
    height: Array
    patches: list[int]
    difference: list[float]
    seconds: list[float]
    tangents: list[TangentError]
    unsolved: list[str]


def sweep(contact: WheelsetContact, positions: Array, yaw: float, tangents: int, height: float = 0.0) -> Record:
    """Results at positions (m,) m with a yaw angle rad, tangents at every n-th one (0: none); height: m, of the
    wheelset at the first one, if it is known about.
    """
    m = len(positions)
    run = Sweep(contact, yaw, start=-height)
    record = Record(np.full((m, 6), np.nan), np.full(m, np.nan), [], [], [], [], [])
    start = perf_counter()
    for i, y in enumerate(positions.tolist()):
        began = perf_counter()
        try:
            state, result, difference = run.position(y)
            record.wrench[i], record.height[i] = _wrench(result), state.z
            record.patches.append(len(result.patches))
            record.difference.append(difference)
            if tangents and i % tangents == 0:
                record.tangents += run.tangent_errors(y, state, result)
        except Unsolved as error:
            record.unsolved.append(str(error))
            print(f"  {error}", flush=True)
        record.seconds.append(perf_counter() - began)
        if i % 50 == 49:
            left = (perf_counter() - start) / (i + 1) * (len(positions) - i - 1)
            print(f"  {1e3 * y:6.2f} mm, {left:.0f} s left", flush=True)
    return record


def smoothness(wrench: Array) -> tuple[Array, Array, Array]:
    """Second differences (m, 6), those over `WIDE` times the distance as the curvature of the function, the largest
    nearby, and ratios of the former to what is allowed; relative values in and out, NaN where undefined.
    """
    second, wide = np.full(wrench.shape, np.nan), np.full(wrench.shape, np.nan)
    second[1:-1] = np.abs(np.diff(wrench, 2, axis=0))
    wide[WIDE:-WIDE] = np.abs(wrench[2 * WIDE :] - 2 * wrench[WIDE:-WIDE] + wrench[: -2 * WIDE]) / WIDE**2
    nearby = maximum_filter1d(np.nan_to_num(wide), 4 * WIDE + 1, axis=0)
    return second, nearby, second / (3 * nearby + ALLOWED)


def beyond(ratio: Array) -> list[tuple[int, int]]:
    """First and last position of each group with a ratio (m, 6) above one, at most `WIDE` apart."""
    places = np.flatnonzero(np.nan_to_num(ratio).max(axis=1) > 1.0)
    groups = np.split(places, np.flatnonzero(np.diff(places) > WIDE) + 1) if len(places) else []
    return [(int(group[0]), int(group[-1])) for group in groups]


def against_finer(finer: WheelsetContact, record: Record, positions: Array, yaw: float, scale: Array) -> None:
    """Print ratios above one beside those with the second differences of a finer contact at most `NEAR` positions away.

    Parameters:
        finer: contact on more strips and cells.
        record, positions: of the sweep, positions (m,) m.
        yaw: rad.
        scale: (6,) of forces and moments.
    """
    second, nearby, ratio = smoothness(record.wrench / scale)
    print("| from mm | to mm | | second difference % | ratio | of the finer one nearby % | ratio |")
    print("|---|---|---|---|---|---|---|")
    for first, last in beyond(ratio):
        start = max(first - NEAR - 1, 0)
        height = float(np.nan_to_num(record.height[start]))
        near = sweep(finer, positions[start : last + NEAR + 2], yaw, 0, height).wrench / scale
        curvature = np.full(second.shape, np.nan)
        curvature[start + 1 : start + len(near) - 1] = np.abs(np.diff(near, 2, axis=0))
        own = slice(first, last + 1)
        curvature = maximum_filter1d(np.nan_to_num(curvature), 2 * NEAR + 1, axis=0)[own]
        again = second[own] / (3 * np.maximum(curvature, nearby[own]) + ALLOWED)
        where = ratio[own] > 1.0
        i, k = np.unravel_index(np.nanargmax(np.where(where, again, np.nan)), again.shape)
        row = 100 * second[own][i, k], ratio[own][i, k], 100 * curvature[i, k], again[i, k]
        place = f"{1e3 * positions[first]:.3f} | {1e3 * positions[last]:.3f} | {NAMES[k]}"
        print(f"| {place} | {row[0]:.5f} | {row[1]:.2f} | {row[2]:.5f} | {row[3]:.2f} |", flush=True)


def picture(path: Path, y: Array, wrench: Array, second: Array, beside: Array) -> None:
    """Horizontal forces over the lateral position, and their second differences; beside: (m, 3) y m and Fx, Fy N of
    another version at equal steps, with m = 0 without.
    """
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, 1, figsize=(9, 6), sharex=True, layout="constrained")
    other = 100 / LOAD * np.abs(np.diff(beside[:, 1:], 2, axis=0))
    for k, (name, style) in enumerate(zip(NAMES[:2], ("-", "--"), strict=True)):  # the third one is the load
        if len(beside):
            axes[0].plot(1e3 * beside[:, 0], 1e-3 * beside[:, 1 + k], style, color="tab:orange", lw=2.5)
            axes[1].semilogy(1e3 * beside[1:-1, 0], other[:, k], style, color="tab:orange", lw=1.2)
        axes[0].plot(1e3 * y, 1e-3 * wrench[:, k], style, color="tab:blue", lw=1.2, label=name)
        axes[1].semilogy(1e3 * y, 100 * second[:, k], style, color="tab:blue", lw=0.8)
    if len(beside):
        axes[0].plot([], [], color="tab:orange", lw=2.5, label="other version")
    axes[0].set_ylabel("force on the left wheel [kN]")
    axes[1].set(
        ylabel="second difference [% of the load]", xlabel="lateral position y of the wheelset [mm] (to the left)"
    )
    axes[0].legend()
    axes[0].set_title(f"{LOAD / 1e3:g} kN on the left wheel")
    figure.savefig(path, dpi=110)


def rows_beside(name: str) -> Array:
    """Rows (m, 3) y m and Fx, Fy N of a sweep's JSON file. Raises ArgumentTypeError."""
    try:
        table = json.loads(Path(name).read_text())
        columns = [table["columns"].index(column) for column in ("y", *NAMES[:2])]
        return np.array(table["rows"], dtype=float)[:, columns]
    except (OSError, ValueError, LookupError, TypeError) as error:
        message = f"{name} is not the --json file of a sweep, with columns y, Fx and Fy: {error}"
        raise argparse.ArgumentTypeError(message) from error


def report(record: Record, positions: Array, scale: Array) -> Array:
    """Print the tables; returns the second differences."""
    relative = record.wrench / scale
    change = np.abs(np.diff(relative, axis=0))
    second, nearby, ratio = smoothness(relative)
    print("| | largest change % | second difference % | at y mm | curvature nearby % | ratio to the allowed |")
    print("|---|---|---|---|---|---|")
    for k, name in enumerate(NAMES if len(positions) > 2 * WIDE else ()):
        i = int(np.nanargmax(ratio[:, k]))
        row = 100 * np.nanmax(change[:, k]), 100 * second[i, k], 1e3 * positions[i], 100 * nearby[i, k], ratio[i, k]
        print(f"| {name} | {row[0]:.4f} | {row[1]:.5f} | {row[2]:.3f} | {row[3]:.5f} | {row[4]:.2f} |")
    print(f"\npatches from {min(record.patches)} to {max(record.patches)}")
    print(f"{len(record.unsolved)} positions without a solution")
    print(f"warm and cold solves differ by at most {max(record.difference):.1e} N, {LOAD:g} N on the wheel")
    for distance in DISTANCES if record.tangents else ():
        found = [one for one in record.tangents if one.distance == distance]
        worst = max(found, key=lambda one: one.error)
        print(
            f"tangents over {distance:g} m: {len(found)} changes, largest error {worst.error:.1e} ({worst.coordinate}, "
            f"y = {1e3 * worst.y:.3f} mm), {sum(one.error > EXACT for one in found)} above {EXACT:g}, "
            f"{sum(one.panels > PANELS[0] for one in found)} on more than {len(PLACES)} places"
        )
    print(f"{1e3 * np.median(record.seconds):.0f} ms a position, {sum(record.seconds):.0f} s in all")
    return second


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--step", type=float, default=0.02)
    parser.add_argument("--from", dest="low", type=float, default=-8.0)
    parser.add_argument("--to", dest="high", type=float, default=8.0)
    parser.add_argument("--friction", type=float, default=0.3)
    parser.add_argument("--yaw", type=float, default=0.0)
    parser.add_argument("--bodies", choices=("waveguide", "half-space"), default="waveguide")
    parser.add_argument("--resolution", type=lattice_resolution, default=LatticeResolution(), metavar="STRIPSxCELLS")
    parser.add_argument("--tolerance", type=float, default=1e-9)
    parser.add_argument("--tangents", type=int, default=0)
    parser.add_argument("--finer", type=lattice_resolution, metavar="STRIPSxCELLS")
    parser.add_argument("--picture", type=Path)
    parser.add_argument("--beside", type=rows_beside, default=np.empty((0, 3)), metavar="FILE")
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    print(machine_description())
    laws = ContactLaws(friction=arguments.friction)
    contact = wheelset_model(PairTrack(STEEL), laws, 1e-3, points="lattice", bodies=arguments.bodies)
    asked = {"tolerance": arguments.tolerance, "resolution": arguments.resolution}
    contact = replace(contact, model=replace(contact.model, **asked))  # type: ignore[type-var]
    positions = 1e-3 * np.arange(arguments.low, arguments.high + 0.5 * arguments.step, arguments.step)
    record = sweep(contact, positions, 1e-3 * arguments.yaw, arguments.tangents)
    print(
        f"\n{len(positions)} positions, {arguments.step:g} mm apart, friction {arguments.friction:g}, yaw "
        f"{arguments.yaw:g} mrad, {arguments.bodies}, tolerance {arguments.tolerance:g}, "
        f"{arguments.resolution.strips} x {arguments.resolution.cells} strips and cells"
    )
    scale = np.array([1, 1, 1, *(3 * [contact.mounting.radius])]) * LOAD
    second = report(record, positions, scale)
    if arguments.finer:
        finer = replace(contact, model=replace(contact.model, resolution=arguments.finer))  # type: ignore[type-var]
        against_finer(finer, record, positions, 1e-3 * arguments.yaw, scale)
    if arguments.json:
        table = {
            "columns": ["y", "z", *NAMES],
            "rows": np.column_stack([positions, record.height, record.wrench]).tolist(),
        }
        arguments.json.write_text(json.dumps(table | {"unsolved": record.unsolved, "tangents": record.tangents}))
    if arguments.picture:
        picture(arguments.picture, positions, record.wrench, second, arguments.beside)


if __name__ == "__main__":
    main()
