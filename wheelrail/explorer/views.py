"""Pictures of a solution for the page, from its Dataset: the drawings of figures, and those that go with a slider."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.contacts.side_values import SideValues
from wheelrail.scenes.plots.drawing import Drawing, Line
from wheelrail.scenes.plots.patch_cells import title, touching
from wheelrail.scenes.plots.patches import pressure_drawing, traction_drawing
from wheelrail.scenes.plots.profiles import profiles_drawing
from wheelrail.scenes.plots.style import SERIES, SIDES
from wheelrail.scenes.quantities import CONTACT, SOLUTION
from wheelrail.scenes.quantity import Quantity, significant
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from xarray import Dataset

# Views of the page and their texts; those of the second kind are computed beside, on request.
DRAWN = {
    "profiles": "profiles in contact",
    "closeup": "profiles, magnified",
    "pressure": "pressure and traction",
    "slip": "stick and slip",
    "forces": "tangential forces against the friction bound",
}
BESIDE = {
    "geometry": "rolling radius difference and conicity",
    "trace": "trace along a slider",
    "stress": "stress below the surface",
    "bodies": "deformed bodies in 3D",
}
BOUND, PRESENT = "#737373", "#D55E00"
COLOURS = [str(own["color"]) for own in SERIES[:6]]  # those of CSS
NEAR = 12.0  # mm around the contacts, shown in the magnified view
DEPTHS = tuple(np.round(np.geomspace(0.2e-3, 20e-3, 24), 6).tolist())  # m, of the stress
Traced = tuple[Quantity, Callable[[SideValues], float]]
_SUMS = ("patch_normal_force", "patch_longitudinal_force", "patch_lateral_force", "patch_area", "patch_stick_area")
TRACED: dict[str, Traced] = {
    **{
        name: (CONTACT[name], lambda own, name=name: float(own[name]))  # type: ignore[misc]
        for name in ("longitudinal_force", "lateral_force", "vertical_force", "yaw_moment", "approach", "patches")
    },
    **{
        name: (CONTACT[name], lambda own, name=name: float(sum(own.by_patch(name))))  # type: ignore[misc]
        for name in (*_SUMS, "patch_frictional_power")
    },
    "patch_max_pressure": (
        CONTACT["patch_max_pressure"],
        lambda own: float(max(own.by_patch("patch_max_pressure"), default=0.0)),
    ),
    "roll": (SOLUTION["roll"], lambda own: float(own["roll"])),
    "z": (SOLUTION["z"], lambda own: float(own["z"])),
}


@dataclass(frozen=True)
class Panel:
    """One picture of a view.

    Parameters:
        view: its name.
        side: of the wheel; empty where the picture has both.
        drawing: of the browser.
    """

    view: str
    side: str
    drawing: Drawing

    def plain(self) -> dict[str, Any]:
        """Values for a browser."""
        return {"view": self.view, "side": self.side, "drawing": self.drawing.plain()}


def as_text(panels: Iterable[Panel]) -> str:
    """Panels for a browser, as JSON."""
    return json.dumps([panel.plain() for panel in panels])


def panels(data: Dataset, views: Sequence[str]) -> list[Panel]:
    """Pictures of a solution.

    Parameters:
        data: Dataset of `wheelrail.scenes.contacts.solution`.
        views: names in DRAWN.
    """
    makers = {"profiles": _profiles, "closeup": _closeups, "pressure": _pressure, "slip": _slip, "forces": _forces}
    return [panel for view in views if view in makers for panel in makers[view](data)]


def _profiles(data: Dataset) -> Iterator[Panel]:
    if "wheel_profile" in data:
        for side in data["side"].values.tolist():
            yield Panel("profiles", side, profiles_drawing(data, side))


def _closeups(data: Dataset) -> Iterator[Panel]:
    """The same around the contacts, heights magnified as far as the curves there allow."""
    for panel in _profiles(data):
        lines = [layer for layer in panel.drawing.layers if isinstance(layer, Line)]
        marks = [line.points for line in lines if line.width == 0.0]
        if not marks:
            continue
        x = np.concatenate(marks)[:, 0]
        low, high = float(x.min()) - NEAR, float(x.max()) + NEAR
        near = tuple(replace(line, points=_within(line.points, low, high)) for line in lines)
        height = np.concatenate([line.points[:, 1] for line in near])
        margin = 0.05 * np.ptp(height)
        drawing = replace(
            panel.drawing,
            title=f"{panel.drawing.title}, heights magnified",
            layers=near,
            equal=False,
            x_limits=(low, high),
            y_limits=(float(height.min() - margin), float(height.max() + margin)),
        )
        yield Panel("closeup", panel.side, drawing)


def _within(points: Array, low: float, high: float) -> Array:
    """Part of a curve (n, 2) between two limits of its first coordinate."""
    inside = np.flatnonzero((points[:, 0] > low) & (points[:, 0] < high))
    return points[inside[0] : inside[-1] + 1] if inside.size else points[:0]


def _pressure(data: Dataset) -> Iterator[Panel]:
    for side, patch in touching(data):
        yield Panel("pressure", side, pressure_drawing(data, side, patch, tractions=True))


def _slip(data: Dataset) -> Iterator[Panel]:
    if data.attrs["friction"]:
        for side, patch in touching(data):
            yield Panel("slip", side, traction_drawing(data, side, patch))


def _forces(data: Dataset) -> Iterator[Panel]:
    """Tangential force of each patch over its normal force, and the circle of the coefficient of friction."""
    found = touching(data)
    if not found or not data.attrs["friction"]:
        return
    layers, notes = [], []
    for number, (side, patch) in enumerate(found):
        own = SideValues(data, side)
        normal = own.by_patch("patch_normal_force")[patch]
        force = [own.by_patch(f"patch_{axis}_force")[patch] / normal for axis in ("longitudinal", "lateral")]
        colour = COLOURS[number % len(COLOURS)]
        line = np.array([[0.0, 0.0], force])
        label = f"{title(data, side, patch)} x {significant(float(np.hypot(*force)), 4)}"
        layers += [Line(line, colour, label=label), Line(line[1:], colour, width=0.0, marker="o")]
    for side in dict.fromkeys(side for side, _ in found):
        if error := SideValues(data, side).error_estimate.get("force"):
            notes.append(f"{side}: estimated error of the force {significant(error, 2)} N")
    bounds = sorted({_coefficient(data, side) for side, _ in found} - {None})  # type: ignore[type-var]
    angle = np.linspace(0.0, 2.0 * np.pi, 121)
    for bound in bounds:
        circle = bound * np.column_stack([np.cos(angle), np.sin(angle)])  # type: ignore[operator]
        layers.insert(0, Line(circle, BOUND, label=f"coefficient of friction {bound:g}", dash=True))
    yield Panel(
        "forces",
        "",
        Drawing(
            "tangential over normal force, on the wheel",
            "longitudinal, positive forward [1]",
            "lateral, positive to the left [1]",
            tuple(layers),
            equal=True,
            notes=tuple(notes),
        ),
    )


def _coefficient(data: Dataset, side: str) -> float | None:
    """Coefficient of friction of a side; None for a law."""
    friction = data.attrs.get(f"friction_{side}", data.attrs["friction"])
    try:
        return float(friction)
    except ValueError:
        return None


def geometry_panels(geometry: Dataset, y: float) -> list[Panel]:
    """Rolling radius difference and equivalent conicity, with the present place.

    Parameters:
        geometry: of `wheelrail.contact_geometry`.
        y: lateral position, m.
    """
    difference, conicity = (
        1e3 * geometry["rolling_radius_difference"].values,
        geometry["equivalent_conicity"].values,
    )
    place, amplitude = 1e3 * geometry["y"].values, 1e3 * geometry["amplitude"].values
    here = float(np.interp(1e3 * y, place, difference))
    drawn = (
        ("y of the wheelset, positive to the left [mm]", "rolling radius difference [mm]", place, difference, here),
        (
            "amplitude [mm]",
            "equivalent conicity (EN 15302) [1]",
            amplitude,
            conicity,
            float(np.interp(abs(1e3 * y), amplitude, conicity)) if abs(1e3 * y) >= amplitude[0] else np.nan,
        ),
    )
    return [
        Panel(
            "geometry",
            "",
            Drawing(
                label.partition(" [")[0],
                x_label,
                label,
                (
                    Line(np.column_stack([x, values]), SIDES["left"]["color"]),
                    *_present(1e3 * y if number == 0 else abs(1e3 * y), at),
                ),
            ),
        )
        for number, (x_label, label, x, values, at) in enumerate(drawn)
    ]


def _present(x: float, y: float) -> tuple[Line, ...]:
    """Mark of the present place; nothing where there is none."""
    return (Line(np.array([[x, y]]), PRESENT, label="now", width=0.0, marker="o"),) if np.isfinite(y) else ()


def traced(data: Dataset, name: str) -> dict[str, float]:
    """Value of a traced quantity by side, NaN where the solve failed."""
    of = TRACED[name][1]
    sides = [SideValues(data, side) for side in data["side"].values.tolist()]
    return {own.side: of(own) if own.ok else np.nan for own in sides}


def trace_panel(name: str, label: str, places: Array, values: dict[str, Array], now: float) -> Panel:
    """Trace of a quantity along a slider.

    Parameters:
        name: in TRACED.
        label: of the slider, with its unit.
        places: (n,) in that unit, in order.
        values: (n,) SI units by side.
        now: present place.
    """
    quantity = TRACED[name][0]
    lines: list[Line] = []
    for number, (side, own) in enumerate(values.items()):
        style, shown = SIDES.get(side, SERIES[number]), quantity.scale * own
        line = Line(np.column_stack([places, shown]), style["color"], side, number > 0, marker="o")
        good = np.isfinite(shown)
        at = float(np.interp(now, places[good], shown[good])) if good.any() else np.nan
        lines += [line, *(replace(mark, colour=style["color"], label="", marker="D") for mark in _present(now, at))]
    return Panel("trace", "", Drawing(f"{quantity.title} along {label}", label, quantity.caption, tuple(lines)))


def stress_panels(data: Dataset) -> list[Panel]:
    """Von Mises stress over depth, below each patch."""
    drawn = []
    mises, depth = SOLUTION["von_mises"], 1e3 * data["depth"].values
    for side, patch in touching(data):
        own = SideValues(data, side)
        lines = tuple(
            Line(
                np.column_stack([mises.scale * np.asarray(own.below("von_mises", body, patch)), -depth]),
                COLOURS[number],
                f"{body}, at most {mises.texts([own.largest_von_mises(body, patch)[0]])} {mises.shown}",
                number > 0,
            )
            for number, body in enumerate(own.stressed_bodies)
        )
        drawn.append(
            Panel("stress", side, Drawing(title(data, side, patch), mises.caption, "depth, negative [mm]", lines))
        )
    return drawn
