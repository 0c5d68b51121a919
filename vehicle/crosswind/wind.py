"""Wind on a body: aerodynamic coefficients over the yaw angle, relative wind, and its forces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, hypot, pi, sin
from pathlib import Path

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.support.text_file import FileRefused, read_text
from wheelrail.vehicle.loads.applied_loads import AppliedLoads, BodyForce
from wheelrail.vehicle.loads.load_table import LoadTable

NAMES = ("cFx", "cFy", "cFz", "cMx", "cMy", "cMz")
NEEDED = ("yaw", "cFy", "cMx")
LARGEST = 100.0  # of a coefficient; a larger value is a force
MOST = 1.0  # MB
LEVER = 1.0  # m, of the couples that stand for moments


class WindTableError(FileRefused):
    """Invalid coefficients of wind, or yaw angles that do not reach the relative wind."""


@dataclass(frozen=True)
class WindCoefficients:
    """Coefficients of force over 1/2 rho A V^2 and of moment over 1/2 rho A d V^2, linear between yaw angles.

    Parameters:
        yaw: (n,) rad, between direction of travel and relative wind, increasing, from 0 to pi/2.
        values: (n, 6) forces forwards, to leeward, upwards; moments that lower the leeward side, lower the front, turn
            the front to leeward, about the point below the body's centre at top of rail.
        area: A, m2.
        length: d, m.
        density: rho of the air, kg/m3.
        source: of the table, for messages.
    """

    yaw: Array
    values: Array
    area: float = 10.0
    length: float = 3.0
    density: float = 1.225
    source: str = "wind"

    def at(self, yaw: float) -> Array:
        """Coefficients (6,) at a yaw angle, rad, within the table."""
        return np.array([np.interp(yaw, self.yaw, column) for column in self.values.T])


def read_coefficients(path: str | Path, area: float, length: float) -> WindCoefficients:
    """Coefficients of a text file with columns yaw (deg) and any of cFx to cMz, named in its first row.

    Lines that begin with # are comments; columns left out are zero, cFy and cMx are required. Raises FileRefused
    naming file, row and value.
    """
    lines = [line.strip() for line in read_text(path, MOST, foreign=True).splitlines()]
    rows = [
        (number, [cell.strip() for cell in line.split(";" if ";" in line else ",")])
        for number, line in enumerate(lines, start=1)
        if line and not line.startswith("#")
    ]
    number, names = rows.pop(0) if rows else (1, [])
    unknown = [name for name in names if name not in ("yaw", *NAMES) or names.count(name) > 1]
    missing = [name for name in NEEDED if name not in names]
    if unknown or missing:
        what = f"{unknown[0]!r}" if unknown else f"column {missing[0]} is missing"
        allowed = f"must have yaw (deg), {', '.join(NAMES)}, each once; {', '.join(NEEDED)} are required"
        raise WindTableError(f"{path}: row {number}: {what}: {allowed}")
    table = np.array([_numbers(path, row, cells, names) for row, cells in rows]).reshape(-1, len(names))
    yaw = table[:, names.index("yaw")]
    if len(rows) < 2:
        raise WindTableError(f"{path}: {len(rows)} rows of numbers: must be at least 2")
    for k in np.flatnonzero(np.diff(yaw) <= 0.0)[:1] + 1:
        text = f"must be greater than {yaw[k - 1]:g}, the previous"
        raise WindTableError(f"{path}: row {rows[k][0]}, yaw = {yaw[k]:g}: {text}")
    values = [table[:, names.index(name)] if name in names else np.zeros(len(table)) for name in NAMES]
    return WindCoefficients(np.radians(yaw), np.stack(values, axis=1), area, length, source=str(path))


def _numbers(path: str | Path, row: int, cells: Sequence[str], names: Sequence[str]) -> list[float]:
    if len(cells) != len(names):
        raise WindTableError(f"{path}: row {row}: {len(cells)} values, must be {len(names)}: {', '.join(names)}")
    numbers = []
    for cell, name in zip(cells, names, strict=True):
        low, high = (0.0, 90.0) if name == "yaw" else (-LARGEST, LARGEST)
        try:
            value = float(cell)
        except ValueError:
            value = float("nan")
        if not low <= value <= high:
            text = f"must be a number with a decimal point from {low:g} to {high:g}{' deg' * (name == 'yaw')}"
            raise WindTableError(f"{path}: row {row}, {name} = {cell!r}: {text}")
        numbers.append(value)
    return numbers


def relative_wind(speed: float, wind: float, angle: float = 0.5 * pi) -> tuple[float, float]:
    """Speed m/s of the air relative to a vehicle, and yaw angle, rad.

    Parameters:
        speed: of the vehicle, m/s.
        wind: m/s.
        angle: between track and wind, rad; 0: against the direction of travel.
    """
    along, across = speed + wind * cos(angle), wind * sin(angle)
    return hypot(along, across), float(np.arctan2(across, along))


@dataclass(frozen=True)
class Crosswind:
    """Wind from one side on a body of a vehicle.

    Parameters:
        coefficients: of the body.
        body: its name.
        x: m, of its centre forward of the vehicle's reference point.
        angle: between track and wind, rad.
        from_left: whether the left side is windward; otherwise the right one.
    """

    coefficients: WindCoefficients
    body: str
    x: float
    angle: float = 0.5 * pi
    from_left: bool = False

    def wrench(self, speed: float, wind: float) -> Array:
        """Forces and moments (6,) N, N m along x forwards, y left, z up about the point at top of rail.

        Parameters:
            speed: of the vehicle, m/s.
            wind: m/s.

        Raises WindTableError.
        """
        c, (air, yaw) = self.coefficients, relative_wind(speed, wind, self.angle)
        if not c.yaw[0] - 1e-9 <= yaw <= c.yaw[-1] + 1e-9:
            low, high = np.degrees(c.yaw[[0, -1]]).tolist()
            text = f"wind of {wind:.3g} m/s at a speed of {speed:g} m/s has a yaw angle of {np.degrees(yaw):.3g} deg"
            raise WindTableError(f"{c.source}: {text}: must be within the table's {low:g} to {high:g} deg")
        fx, fy, fz, mx, my, mz = (0.5 * c.density * c.area * air**2 * c.at(yaw)).tolist()
        lee = -1.0 if self.from_left else 1.0
        moments = -lee * c.length * mx, c.length * my, lee * c.length * mz
        return np.array([fx, lee * fy, fz, *moments])

    def loads(self, speed: float, winds: float | Array, distances: Array | None = None) -> AppliedLoads:
        """Forces on the body, whose pairs stand for the moments.

        Parameters:
            speed: of the vehicle, m/s.
            winds: m/s, or (n,) at distances that the vehicle has run.
            distances: (n,) m, increasing.

        Raises WindTableError.
        """
        fx, fy, fz, mx, my, mz = np.stack([self.wrench(speed, wind) for wind in np.ravel(winds).tolist()], axis=1)

        def load(values: Array) -> float | LoadTable:
            if distances is None:
                return float(values[0])
            return LoadTable(tuple(zip(distances.tolist(), values.tolist(), strict=True)), by_distance=True)

        arm = 2.0 * LEVER
        forces = [
            BodyForce(self.body, (self.x + s * LEVER, 0.0, 0.0), 0.0, load(fy / 2 + s * mz / arm), load(-s * my / arm))
            for s in (1.0, -1.0)
        ]
        forces += [
            BodyForce(self.body, (self.x, s * LEVER, 0.0), load(fx / 2), 0.0, load(fz / 2 + s * mx / arm))
            for s in (1.0, -1.0)
        ]
        return AppliedLoads(forces=tuple(forces))
