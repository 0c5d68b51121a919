"""Points of profile files: Simpack .prr and .prw, MiniProf .ban and .whl, columns of text."""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from wheelrail.meshes.profiles.profile import Kind
from wheelrail.support.arrays import Array
from wheelrail.support.text_file import read_text

MAX_SIZE = 4.0  # MB
KIND_OF_SUFFIX: dict[str, Kind] = {
    **{".prr": "rail", ".ban": "rail", ".rail": "rail"},
    **{".prw": "wheel", ".whl": "wheel", ".wheel": "wheel"},
}
NUMBER = re.compile(r"[-+]?(\d|\.\d|(nan|inf)\b)", re.IGNORECASE)  # start of a line of numbers
UNITS = {"m": 1.0, "mm": 1e-3, "in": 25.4e-3}


class ProfileError(ValueError):
    """A profile file that cannot be used: file, line, value, and what is allowed."""

    def __init__(self, path: Path, line: int | None, problem: str, allowed: str) -> None:
        where = str(path) if line is None else f"{path}, line {line}"
        super().__init__(f"{where}: {problem}; allowed: {allowed}")
        self.path, self.line = path, line


@dataclass(frozen=True)
class RawProfile:
    """Points of a profile file.

    Parameters:
        path: of the file.
        points: (n, 2) m, y to the field side and z up (wheel: away from the axle).
        lines: (n,), line of the file of each point.
        oriented: False where the format does not define the signs, which then follow from the shape.
        text: lines of text, number and content, that are neither header nor comment.
        remarks: on the reading of the file.
    """

    path: Path
    points: Array
    lines: NDArray[np.intp]
    oriented: bool = True
    text: tuple[tuple[int, str], ...] = ()
    remarks: tuple[str, ...] = ()


def read_points(path: Path, kind: Kind) -> RawProfile:
    """Points of a file in the format of its suffix. Raises ProfileError, or FileRefused if the file cannot be read."""
    formats = {".prr": simpack, ".prw": simpack, ".ban": miniprof, ".whl": miniprof}
    formats |= dict.fromkeys((".txt", ".csv", ".dat", ".rail", ".wheel"), plain)
    suffix = path.suffix.lower()
    if suffix not in formats:
        raise ProfileError(path, None, f"suffix {path.suffix!r}", ", ".join(formats))
    belongs = KIND_OF_SUFFIX.get(suffix, kind)
    if belongs != kind:
        raise ProfileError(path, None, f"{suffix} holds a {belongs} and a {kind} is asked for", f"a file of a {kind}")
    return formats[suffix](path, kind)


def _lines(path: Path) -> list[str]:
    return read_text(path, MAX_SIZE, foreign=True).splitlines()


def _text(lines: list[str], comment: str) -> Iterator[tuple[int, str]]:
    """Numbered lines without comments and outer blanks."""
    for number, line in enumerate(lines, start=1):
        yield number, re.split(comment, line, maxsplit=1)[0].strip()


def _words(path: Path, number: int, line: str) -> list[str]:
    """Words between blanks, commas or semicolons; decimal commas are rejected."""
    if re.search(r"\d,\d", line) and re.search(r";|\d\s+[-+.\d]", line):
        raise ProfileError(path, number, f"{shortened(line)} has decimal commas", "a decimal point")
    return re.split(r"[\s,;]+", line)


def shortened(text: str) -> str:
    """At most 40 characters of a text, quoted."""
    return repr(text if len(text) <= 40 else text[:37] + "...")


def _floats(path: Path, number: int, words: list[str], least: int) -> list[float]:
    """Floats of the first words; text after them is left out."""
    try:
        values = [float(word) for word in words[:least]]
    except ValueError:
        values = []
    if len(values) < least or not all(map(math.isfinite, values)):
        raise ProfileError(path, number, shortened(" ".join(words)), f"{least} or more finite numbers")
    return values


def _raw(
    path: Path,
    rows: list[tuple[int, float, float]],
    oriented: bool = True,
    text: Iterable[tuple[int, str]] = (),
) -> RawProfile:
    table = np.array(rows, dtype=float).reshape(-1, 3)
    return RawProfile(path, table[:, 1:], table[:, 0].astype(int), oriented, tuple(text))


def simpack(path: Path, kind: Kind) -> RawProfile:
    """Simpack .prr or .prw: keywords, then y and z, after mirroring y to the field side and z down.

    Shift, bounds (points beyond are dropped), mirror and unit factor are applied in that order; a rotation is rejected;
    smoothing is by `noise` instead. Keywords as in CONTACT (Vtech CMCC).
    """
    header: dict[str, tuple[int, str]] = {}
    rows: list[tuple[int, float, float]] = []
    section: list[str] = []
    for number, line in _text(_lines(path), "[!%]"):
        if match := re.fullmatch(r"(\w+)\.(begin|end)", line):
            if match[2] == "begin":
                section.append(match[1])
            elif not section or section.pop() != match[1]:
                raise ProfileError(path, number, f"{line!r} closes no open section", "nested .begin and .end")
        elif "=" in line:
            key, value = (part.strip() for part in line.split("=", 1))
            header[".".join([*section, key])] = (number, value)
        elif line and section[-1:] == ["point"]:
            y, z = _floats(path, number, line.split(), 2)[:2]
            rows.append((number, y, z))
    if section:
        raise ProfileError(path, None, f"section {section[-1]!r} is not closed", f"a line {section[-1]}.end")

    def number_of(key: str, default: float) -> float:
        at, text = header.get(key, (0, str(default)))
        return _floats(path, at, [text.strip("'\"")], 1)[0]

    for key, allowed in (("header.type", float(kind == "wheel")), ("spline.rotate", 0.0)):
        if (header_value := number_of(key, allowed)) != allowed:
            raise ProfileError(path, header[key][0], f"{key} is {header_value:g}", f"{allowed:g} for a {kind}")
    if number_of("spline.approx.smooth", 0.0) > 0.0:
        warnings.warn(f"{path}: approx.smooth is not applied, give noise instead", stacklevel=4)
    raw = _raw(path, rows)
    points = raw.points + np.array([number_of("spline.shift.y", 0.0), number_of("spline.shift.z", 0.0)])
    keep = np.ones(len(points), dtype=bool)
    for axis, name in enumerate("yz"):
        low, high = number_of(f"spline.bound.{name}.min", 1.0), number_of(f"spline.bound.{name}.max", 0.0)
        if low < high:
            keep &= (points[:, axis] >= low) & (points[:, axis] <= high)
        if number_of(f"spline.mirror.{name}", 0.0):
            points[:, axis] *= -1.0
    per_metre = number_of("spline.units.len.f", 1.0)
    if not per_metre > 0.0:
        line_of_units = header["spline.units.len.f"][0]
        raise ProfileError(path, line_of_units, f"units.len.f is {per_metre:g}", "user units per metre")
    upwards = 1.0 if kind == "wheel" else -1.0  # downwards is away from a wheel's axle
    return replace(raw, points=points[keep] * (1.0, upwards) / per_metre, lines=raw.lines[keep])


def miniprof(path: Path, kind: Kind) -> RawProfile:
    """MiniProf .ban or .whl, mm: a header, an empty line, then columns by ColumnDef (X, Y first without it).

    X points to the gauge side of a rail; the direction of Y, and both for a wheel, follow from the shape. Text after
    the numbers of a line, or after the points, is left out.
    """
    header: dict[str, tuple[int, str]] = {}
    rows: list[tuple[int, float, float]] = []
    raw_lines = _lines(path)
    lines = list(_text(raw_lines, '["#%!]'))
    raw_blank = [not line.strip() for line in raw_lines]
    first = next((n for n, line in lines if NUMBER.match(line)), len(lines) + 1)
    start = raw_blank.index(True) + 1 if True in raw_blank[:first] else first - 1
    for number, line in lines[:start]:
        if "=" in line:
            key, value = line.split("=", 1)
            header[key.strip().lower()] = (number, value.strip())
    line_of_columns, definition = header.get("columndef", (0, "X,Y"))
    columns = [name.strip() for name in definition.split(",")]
    if not {"X", "Y"} <= set(columns):
        raise ProfileError(path, line_of_columns, f"ColumnDef is {definition!r}", "columns with X and Y")
    x, y = columns.index("X"), columns.index("Y")
    text: list[tuple[int, str]] = []
    for number, line in lines[start:]:
        if line and not NUMBER.match(line):
            text.append((number, line))
        elif line:
            values = _floats(path, number, _words(path, number, line), max(x, y) + 1)
            rows.append((number, values[x], values[y]))
    shift = []
    for key in ("xoffset", "yoffset"):
        at, value = header.get(key, (0, "0"))
        shift.append(_floats(path, at, [value or "0"], 1)[0])
    raw = _raw(path, rows, oriented=False, text=text)
    signs = (-1.0, 1.0) if kind == "rail" else (1.0, 1.0)
    return replace(raw, points=(raw.points + shift) * signs * UNITS["mm"])


def plain(path: Path, kind: Kind) -> RawProfile:
    """Columns y and z: y to the field side, z up (rail); y from the rolling circle, z away from the axle (wheel).

    Blanks, tabs, commas or semicolons between; # starts a comment; "# units: mm" (default), "m" or "in" may come
    before the points. Text before and after the points, or after the numbers of a line, is left out. In .rail and
    .wheel files the direction of z follows from the shape.
    """
    unit = "mm"
    rows: list[tuple[int, float, float]] = []
    text: list[tuple[int, str]] = []
    for number, line in enumerate(_lines(path), start=1):
        if match := re.match(r"\s*#\s*units\s*[:=]\s*(\S+)", line, re.IGNORECASE):
            unit = match[1].lower()
            if unit not in UNITS or rows:
                place = "after the first point" if rows else "not known"
                raise ProfileError(
                    path, number, f"units {match[1]!r} {place}", f"{', '.join(UNITS)}, before the points"
                )
            continue
        content = line.split("#", 1)[0].strip()
        if not NUMBER.match(content):
            if content and rows:
                text.append((number, content))
            continue
        y, z = _floats(path, number, _words(path, number, content), 2)
        rows.append((number, y, z))
    raw = _raw(path, rows, path.suffix.lower() not in (".rail", ".wheel"), text)
    return replace(raw, points=raw.points * UNITS[unit])
