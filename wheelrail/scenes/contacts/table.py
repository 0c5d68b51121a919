"""Table of a contact solution, one column per side."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

from wheelrail.contact.results.result import FEWEST_STRIPS
from wheelrail.scenes.contacts.report import FORCE, MOMENT
from wheelrail.scenes.contacts.shapes import WIDEST
from wheelrail.scenes.contacts.side_values import SideValues
from wheelrail.scenes.datasets.number_text import fixed, significant
from wheelrail.scenes.datasets.result_table import TextTable

if TYPE_CHECKING:
    from xarray import Dataset


def _numbers(values: Sequence[float], scale: float, digits: int) -> str:
    return "  ".join(fixed(scale * value, digits) for value in values)


def _points(own: SideValues) -> str:
    return f"{own['points_count']}"


def _tangential(own: SideValues) -> list[float]:
    return [sum(own.by_patch(f"patch_{axis}_force")) for axis in ("longitudinal", "lateral")]


ROWS: tuple[tuple[str, Callable[[SideValues], str]], ...] = (
    ("status", lambda own: str(own["status"])),
    ("force x, y, z [kN]", lambda own: _numbers(own.vector(FORCE), 1e-3, 3)),
    ("moment x, y, z [N m]", lambda own: _numbers(own.vector(MOMENT), 1.0, 2)),
    ("normal force [kN]", lambda own: _numbers([sum(own.by_patch("patch_normal_force"))], 1e-3, 3)),
    ("tangential force longitudinal, lateral [kN]", lambda own: _numbers(_tangential(own), 1e-3, 3)),
    ("approach [µm]", lambda own: _numbers([own["approach"]], 1e6, 2)),
    ("z [mm]", lambda own: _numbers([own["z"]], 1e3, 4)),
    ("roll [mrad]", lambda own: _numbers([own["roll"]], 1e3, 4)),
    ("contact points", _points),
    ("contact solves", lambda own: str(own["contact_solves"])),
    ("Newton, linear iterations (last solve)", lambda own: f"{own['newton_count']}, {own['linear_count']}"),
    ("computing time [s]", lambda own: _numbers([own["contact_seconds"]], 1.0, 2)),
)
# Label, estimated error, scale.
ERROR_ROWS = (
    ("force [kN]", "force", 1e-3),
    ("moment [N m]", "moment", 1.0),
    ("peak pressure [MPa]", "max_pressure", 1e-6),
    ("area [mm²]", "area", 1e6),
)
# Label, variables of the patch, scale, digits.
PATCH_ROWS: tuple[tuple[str, tuple[str, ...], float, int], ...] = (
    ("normal force [kN]", ("patch_normal_force",), 1e-3, 3),
    ("area [mm²]", ("patch_area",), 1e6, 2),
    ("peak pressure [MPa]", ("patch_max_pressure",), 1e-6, 1),
    ("semi-axes longitudinal, lateral [mm]", ("patch_semi_axis_x", "patch_semi_axis_y"), 1e3, 3),
    ("contact angle [mrad]", ("patch_contact_angle",), 1e3, 2),
    ("position on wheel, on rail (arc length) [mm]", ("wheel_s", "rail_s"), 1e3, 3),
    ("stick area [mm²]", ("patch_stick_area",), 1e6, 2),
)
FRICTION_ROWS: tuple[tuple[str, tuple[str, ...], float, int], ...] = (
    ("creepage longitudinal, lateral [1e-3]", ("patch_longitudinal_creepage", "patch_lateral_creepage"), 1e3, 4),
    ("spin creepage [1/m]", ("patch_spin",), 1.0, 4),
    ("frictional power [W]", ("patch_frictional_power",), 1.0, 2),
)


def table(data: Dataset) -> TextTable:
    """Table with one column per side: resultants and statistics, error estimates, patches, largest stresses.

    Parameters:
        data: Dataset of `wheelrail.scenes.contacts.solution`.
    """
    names = data["side"].values.tolist()
    sides = [SideValues(data, name) for name in ("left", "right", "contact") if name in names]
    rows: list[tuple[str, ...]] = [(label, *(text(own) if own.ok else "-" for own in sides)) for label, text in ROWS]
    if any(own.unsolved for own in sides):
        rows.append(("strips solve more", *(own.unsolved for own in sides)))
    if any(own.error_estimate for own in sides):
        rows.append(())
        for label, name, scale in ERROR_ROWS:
            estimates = (_error(scale * own.error_estimate[name]) if own.error_estimate else "-" for own in sides)
            rows.append((f"error estimate: {label}", *estimates))
    for patch in range(max((own.patches for own in sides), default=0)):
        rows.append(())
        rows += [(f"patch {patch + 1}: {label}", *cells) for label, cells in _patch_rows(data, sides, patch)]
    title = f"{_heading(data)}: {data.attrs['status']}"
    return TextTable(title, ["", *(own.side for own in sides)], rows, frozenset(range(1, len(sides) + 1)))


def _heading(data: Dataset) -> str:
    """Model and its choices."""
    attributes = data.attrs
    parts = [f"{attributes['model']} model", *(f"laws {attributes[key]}" for key in ("laws",) if key in attributes)]
    keys = ("bodies", "points", "normal", "tangential")
    return ", ".join([*parts, *(f"{attributes[key]} {key}" for key in keys if key in attributes)])


def _patch_rows(data: Dataset, sides: Sequence[SideValues], patch: int) -> Iterator[tuple[str, list[str]]]:
    """Labels and cells of the patches with one index; cells of sides with fewer patches are empty."""
    for label, names, scale, digits in (*PATCH_ROWS, *(FRICTION_ROWS if data.attrs["friction"] else ())):
        yield (
            label,
            [
                _numbers([own.by_patch(name)[patch] for name in names], scale, digits) if patch < own.patches else ""
                for own in sides
            ],
        )
    if any(own.strips(patch) for own in sides):
        kind = "points" if data.attrs.get("points") == "grid" else "strips"
        yield f"{kind} across", [_strips(own.strips(patch)) for own in sides]
    if any(own.turn(patch) > WIDEST for own in sides):
        yield "turn across half the patch [rad]", [_turn(own.turn(patch)) for own in sides]
    for body in dict.fromkeys(body for own in sides for body in own.stressed_bodies):
        label = f"largest von Mises stress, {body} [MPa], at depth [mm]"
        yield label, [_largest(own, body, patch) if patch < own.patches else "" for own in sides]


def _largest(own: SideValues, body: str, patch: int) -> str:
    mises, depth = own.largest_von_mises(body, patch)
    return f"{fixed(1e-6 * mises, 1)}  {fixed(1e3 * depth, 3)}"


def _strips(count: int) -> str:
    """Number of strips across a patch, and whether they are too few."""
    return f"{count}, rough" if 0 < count < FEWEST_STRIPS else f"{count}" if count else ""


def _turn(angle: float) -> str:
    """Angle rad by which the surfaces turn across half a patch, and whether half-spaces no longer stand for them."""
    return "" if math.isnan(angle) else f"{angle:.2f}, too wide for half-spaces" if angle > WIDEST else f"{angle:.2f}"


def _error(value: float) -> str:
    return "unknown" if math.isnan(value) else significant(value, 2)
