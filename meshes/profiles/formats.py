"""Points of profile files: Simpack .prr and .prw, and columns of numbers in text, of MiniProf and all others."""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from wheelrail.meshes.profiles.profile import Kind
from wheelrail.meshes.profiles.text_table import TextTable, text_table
from wheelrail.support.arrays import Array
from wheelrail.support.text_file import read_text

MAX_SIZE = 4.0  # MB
MIN_POINTS, MAX_POINTS = 10, 20_000
KIND_OF_SUFFIX: dict[str, Kind] = {
    **dict.fromkeys((".prr", ".ban", ".rail", ".rpf"), "rail"),
    **dict.fromkeys((".prw", ".whl", ".wheel", ".wpf"), "wheel"),
}
NO_POINTS = {
    **dict.fromkeys((".xlsx", ".xls", ".ods"), "its sheet saved as .csv"),
    **dict.fromkeys((".slcs", ".slcw"), "one of the profiles that it lists"),
}
NUMBER = re.compile(r"[-+]?(\d|\.\d|(nan|inf)\b)", re.IGNORECASE)  # start of a line of numbers
UNITS = {
    **dict.fromkeys(("m", "meter", "meters", "metre", "metres"), 1.0),
    **dict.fromkeys(("mm", "millimeter", "millimeters", "millimetre", "millimetres"), 1e-3),
    **{"cm": 1e-2, "um": 1e-6, "µm": 1e-6, "micron": 1e-6, "microns": 1e-6},
    **dict.fromkeys(("in", "inch", "inches"), 25.4e-3),
}
DECLARED = re.compile(r"\W*(?:units?|length)\b[^\w]*([a-zµ]+)", re.IGNORECASE)  # "# units: mm", "LENGTH = 'mm'"
IN_TITLE = re.compile(r"[\[(_ ]([a-zµ]+)[\]) ]?(?![a-zµ])", re.IGNORECASE)  # "y [mm]", "y_mm"
LIKELY = {"m": (0.02, 0.4), "in": (0.8, 8.0), "mm": (20.0, 400.0), "µm": (2e4, 4e5)}  # width of a profile, by unit


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
        points: (n, 2) m, y to the field side and z up (wheel: away from the axle) as far as the format defines them.
        lines: (n,), line of the file of each point.
        defined: which of the signs of y and z the format defines; others follow from the shape where it shows them.
        text: lines of text, number and content, that are neither header nor comment.
        convention: what was recognised: format, separators, unit, signs, order and origin.
        remarks: on what was left out or mended.
    """

    path: Path
    points: Array
    lines: NDArray[np.intp]
    defined: tuple[bool, bool] = (True, True)
    text: tuple[tuple[int, str], ...] = ()
    convention: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()

    @property
    def ascending(self) -> bool:
        """Whether y grows along the points, but for a few that are out of order."""
        return bool(np.median(np.diff(self.points[:, 0])) >= 0.0)

    def chosen(self, kept: NDArray[np.intp] | NDArray[np.bool_] | slice, *remarks: str) -> RawProfile:
        """Some of the points, and further remarks."""
        return replace(
            self, points=self.points[kept], lines=self.lines[kept], remarks=(*self.remarks, *filter(None, remarks))
        )


def read_points(path: Path, kind: Kind) -> RawProfile:
    """Points of a file in the format of its suffix. Raises ProfileError, or FileRefused if the file cannot be read."""
    suffix = path.suffix.lower()
    if suffix in NO_POINTS:
        raise ProfileError(path, None, f"suffix {path.suffix!r} holds no points as text", NO_POINTS[suffix])
    belongs = KIND_OF_SUFFIX.get(suffix, kind)
    if belongs != kind:
        raise ProfileError(path, None, f"{suffix} holds a {belongs} and a {kind} is asked for", f"a file of a {kind}")
    return (simpack if suffix in (".prr", ".prw") else columns)(path, kind)


def _lines(path: Path) -> list[str]:
    return read_text(path, MAX_SIZE, foreign=True).splitlines()


def _text(lines: list[str], comment: str) -> Iterator[tuple[int, str]]:
    """Numbered lines without comments and outer blanks."""
    for number, line in enumerate(lines, start=1):
        yield number, re.split(comment, line, maxsplit=1)[0].strip()


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
    table = np.array(rows, dtype=float).reshape(-1, 3)
    points, lines = (
        table[:, 1:] + np.array([number_of("spline.shift.y", 0.0), number_of("spline.shift.z", 0.0)]),
        table[:, 0].astype(int),
    )
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
    convention = ("Simpack", f"{per_metre:g} per metre", "signs as defined by the format")
    return RawProfile(path, points[keep] * (1.0, upwards) / per_metre, lines[keep], convention=convention)


def columns(path: Path, kind: Kind) -> RawProfile:
    """Columns y and z in text, by their titles or the first two; MiniProf: X and Y by ColumnDef, with its offsets.

    Separators, decimal commas, quotes and the unit are recognised. MiniProf's X points to the gauge side of a rail;
    other signs are not defined. Text before and after the points, or after the numbers of a line, is left out.
    """
    lines = [(number, line.strip()) for number, line in enumerate(_lines(path), start=1) if line.strip()]
    header, body = _header(lines)
    count = sum(NUMBER.match(line) is not None for _, line in body) if len(body) > MAX_POINTS else 0
    if count > MAX_POINTS:
        raise ProfileError(path, body[-1][0], f"{count} points", f"{MIN_POINTS} to {MAX_POINTS}")
    table = text_table(body)
    if not table.rows and (numbers := [(n, text) for n, text in table.text if NUMBER.match(text)]):
        raise ProfileError(path, numbers[0][0], shortened(numbers[0][1]), "2 or more finite numbers")
    at, titles = header.get("columndef", (0, ""))
    if titles:
        names = [name.strip().upper() for name in titles.split(",")]
        if not {"X", "Y"} <= set(names):
            raise ProfileError(path, at, f"ColumnDef is {titles!r}", "columns with X and Y")
        y, z = names.index("X"), names.index("Y")
    else:
        y, z = table.columns()
    numbers_of, text = [], list(table.text)
    for number, cells in table.rows:
        pair = [cells[i] if i < len(cells) else None for i in (y, z)]
        if None in pair:
            text.append((number, dict(lines)[number]))
        else:
            numbers_of.append((number, *pair))
    values = np.array(numbers_of, dtype=float).reshape(-1, 3)
    if (endless := np.isinf(values[:, 1:]).any(axis=1)).any():
        line = int(values[endless][0, 0])
        raise ProfileError(path, line, shortened(dict(lines)[line]), "2 or more finite numbers")
    offsets = [_floats(path, *_first_word(header.get(key, (0, "0"))), 1)[0] for key in ("xoffset", "yoffset")]
    miniprof = path.suffix.lower() in (".ban", ".whl", ".mpt") or "columndef" in header
    unit, declared = _unit(path, lines, table, values)
    signs = (-1.0, 1.0) if miniprof and kind == "rail" else (1.0, 1.0)
    convention = (
        *(("MiniProf",) if miniprof else ()),
        table.style,
        f"{unit} {'' if declared else '(by size)'}".strip(),
    )
    return RawProfile(
        path,
        (values[:, 1:] + offsets) * signs * UNITS[unit],
        values[:, 0].astype(int),
        (miniprof and kind == "rail", False),
        tuple(sorted(text)),
        convention,
    )


def _header(lines: list[tuple[int, str]]) -> tuple[dict[str, tuple[int, str]], list[tuple[int, str]]]:
    """Line and value by key of lines `key = value`, and the other lines."""
    header, body = {}, []
    for number, line in lines:
        if "=" in line and (match := re.match(r"\W*([A-Za-z][\w .]*?)\s*=\s*(.*)", line)) and not NUMBER.match(line):
            header[match[1].lower()] = (number, match[2].strip("'\" "))
        else:
            body.append((number, line))
    return header, body


def _first_word(entry: tuple[int, str]) -> tuple[int, list[str]]:
    number, value = entry
    return number, (value.split() or ["0"])[:1]


def _unit(path: Path, lines: list[tuple[int, str]], table: TextTable, values: Array) -> tuple[str, bool]:
    """Unit of the points, and whether declared by the file: in a line before them, in a column's title, or by size.

    Raises ProfileError for an unknown unit, one after the first point, and for a declared one that fits no profile.
    """
    first = int(values[0, 0]) if len(values) else math.inf
    for number, line in lines:
        if match := re.match(r"\s*#\s*units\s*[:=]\s*(\S+)", line, re.IGNORECASE):
            if match[1].lower() not in UNITS or number > first:
                place = "after the first point" if number > first else "not known"
                raise ProfileError(path, number, f"units {match[1]!r} {place}", "mm, m or in, before the points")
            return match[1].lower(), True
    for number, line in lines:
        if number < first and (match := DECLARED.match(line)) and match[1].lower() in UNITS:
            return match[1].lower(), True
    for match in IN_TITLE.finditer(table.title):
        if match[1].lower() in UNITS:
            return match[1].lower(), True
    spread = np.ptp(np.nanquantile(values[:, 1], (0.02, 0.98))) if len(values) else 0.0
    return next((unit for unit, (low, high) in LIKELY.items() if 0.96 * low <= spread <= high), "mm"), False
