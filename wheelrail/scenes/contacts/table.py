"""Table of a contact solution, one column per side."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from wheelrail.contact.results.result import FEWEST_STRIPS
from wheelrail.scenes.contacts.report import FORCE, MOMENT
from wheelrail.scenes.contacts.side_values import SideValues
from wheelrail.scenes.datasets.result_table import TextTable
from wheelrail.scenes.quantities import CONTACT, ERRORS, SOLUTION, WIDEST
from wheelrail.scenes.quantity import Quantity, significant

if TYPE_CHECKING:
    from xarray import Dataset


# Variables of a row of a patch; the first has label, unit and digits.
PATCH_ROWS = (
    ("patch_normal_force",),
    ("patch_area",),
    ("patch_max_pressure",),
    ("patch_semi_axis_x", "patch_semi_axis_y"),
    ("patch_contact_angle",),
    ("wheel_s", "rail_s"),
    ("patch_stick_area",),
)
FRICTION_ROWS = (
    ("patch_longitudinal_creepage", "patch_lateral_creepage"),
    ("patch_spin",),
    ("patch_frictional_power",),
)


def _sum(own: SideValues, *names: str) -> tuple[Quantity, list[float]]:
    """Sums over the patches."""
    return CONTACT[names[0]], [sum(own.by_patch(name)) for name in names]


def _rows(own: SideValues) -> dict[str, str]:
    """Texts of a side by label."""
    force = CONTACT["vertical_force"]._replace(label="force x, y, z", digits=3)
    numbers = (
        (force, own.vector(FORCE)),
        (CONTACT["roll_moment"], own.vector(MOMENT)),
        _sum(own, "patch_normal_force"),
        _sum(own, "patch_longitudinal_force", "patch_lateral_force"),
        *((quantity, [own[name]]) for name, quantity in (("approach", CONTACT["approach"]), *POSITION.items())),
    )
    return {
        "status": str(own["status"]),
        **{quantity.head: quantity.texts(values) for quantity, values in numbers},
        "contact points": str(own["points_count"]),
        "contact solves": str(own["contact_solves"]),
        "Newton, linear iterations (last solve)": f"{own['newton_count']}, {own['linear_count']}",
        COST.head: COST.texts([own["contact_seconds"]]),
    }


POSITION, COST = {name: SOLUTION[name] for name in ("z", "roll")}, SOLUTION["contact_seconds"]
MISES, DEPTH = SOLUTION["von_mises"], SOLUTION["depth"]


def table(data: Dataset) -> TextTable:
    """Table with one column per side: resultants and statistics, error estimates, patches, largest stresses.

    Parameters:
        data: Dataset of `wheelrail.scenes.contacts.solution`.
    """
    names = data["side"].values.tolist()
    sides = [SideValues(data, name) for name in ("left", "right", "contact") if name in names]
    texts = [_rows(own) for own in sides]
    rows: list[tuple[str, ...]] = [
        (label, *(own[label] if side.ok else "-" for side, own in zip(sides, texts, strict=True))) for label in texts[0]
    ]
    if any(own.unsolved for own in sides):
        rows.append(("strips solve more", *(own.unsolved for own in sides)))
    if any(own.error_estimate for own in sides):
        rows.append(())
        for name, error in ERRORS.items():
            estimates = (_error(error.scale * own.error_estimate[name]) if own.error_estimate else "-" for own in sides)
            rows.append((error.head, *estimates))
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
    for names in (*PATCH_ROWS, *(FRICTION_ROWS if data.attrs["friction"] else ())):
        first = CONTACT[names[0]]
        cells = ([own.by_patch(name)[patch] for name in names] if patch < own.patches else [] for own in sides)
        yield first.head, list(map(first.texts, cells))
    if any(own.strips(patch) for own in sides):
        kind = "points" if data.attrs.get("points") == "grid" else "strips"
        yield f"{kind} across", [_strips(own.strips(patch)) for own in sides]
    if any(own.turn(patch) > WIDEST for own in sides):
        yield "turn across half the patch [rad]", [_turn(own.turn(patch)) for own in sides]
    for body in dict.fromkeys(body for own in sides for body in own.stressed_bodies):
        label = f"{MISES.label}, {body} [{MISES.shown}], at depth [{DEPTH.shown}]"
        yield label, [_largest(own, body, patch) if patch < own.patches else "" for own in sides]


def _largest(own: SideValues, body: str, patch: int) -> str:
    mises, depth = own.largest_von_mises(body, patch)
    return f"{MISES.texts([mises])}  {DEPTH.texts([depth])}"


def _strips(count: int) -> str:
    """Number of strips across a patch, marked if too small."""
    return f"{count}, rough" if 0 < count < FEWEST_STRIPS else f"{count}" if count else ""


def _turn(angle: float) -> str:
    """Angle rad by which the surfaces turn across half a patch, marked if too large for half-spaces."""
    return "" if math.isnan(angle) else f"{angle:.2f}, too wide for half-spaces" if angle > WIDEST else f"{angle:.2f}"


def _error(value: float) -> str:
    return "unknown" if math.isnan(value) else significant(value, 2)
