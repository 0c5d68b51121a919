"""Drawings as data: numbers of the dataset, in lists that a browser reads."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from xarray import Dataset

import wheelrail as wr
from wheelrail.scenes.plots.drawing import Arrows, Bar, Cells, Drawing, Line, Segments, thinned
from wheelrail.scenes.plots.patches import pressure_drawing, traction_drawing
from wheelrail.scenes.plots.profiles import profiles_drawing
from wheelrail.scenes.plots.render import draw
from wheelrail.scenes.plots.style import REGIONS


@pytest.fixture(scope="module")
def data() -> Dataset:
    return wr.Wheelset(friction=0.3, model="standard").solve(y=2e-3, wheel_load=57e3, speed=45.0).data


def areas(cells: Cells) -> np.ndarray:
    """Area of each cell, mm2, by its diagonals."""
    one, other = cells.points[:, 2] - cells.points[:, 0], cells.points[:, 3] - cells.points[:, 1]
    return 0.5 * np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])


def distance(point: np.ndarray, curve: np.ndarray) -> float:
    """Distance of a point from a curve of straight pieces."""
    chord = np.diff(curve, axis=0)
    share = np.clip(np.einsum("nk,nk->n", point - curve[:-1], chord) / np.einsum("nk,nk->n", chord, chord), 0.0, 1.0)
    return float(np.hypot(*(curve[:-1] + share[:, None] * chord - point).T).min())


def test_pressure_over_the_drawn_cells_is_the_load(data: Dataset) -> None:
    drawing = pressure_drawing(data, "right", tractions=True)
    cells, arrows, edge = drawing.layers
    assert isinstance(cells, Cells)
    assert isinstance(arrows, Arrows)
    assert isinstance(edge, Segments)
    assert cells.values is not None
    load = float(data["patch_normal_force"].sel(side="right")[0])
    assert cells.values @ areas(cells) == pytest.approx(load, rel=1e-3)
    assert drawing.bar == Bar("pressure [MPa]", 1e-6 * float(data["patch_max_pressure"].max()))
    # arrows begin in cells, in the direction of the tractions there
    middle = cells.points.mean(axis=1)
    at = [int(np.hypot(*(middle - tail).T).argmin()) for tail in arrows.points]
    np.testing.assert_allclose(middle[at], arrows.points, atol=1e-9)
    own = (data["point_side"] == "right").values & (data["point_patch"] == 0).values
    rates = np.einsum("ns,nsc->nc", data["traction"].values[own], data["axes"].values[own][:, :2])[at]
    along = rates[:, 0] / np.hypot(*rates.T[:2])
    np.testing.assert_allclose(arrows.vector[:, 0] / np.hypot(*arrows.vector.T), along, atol=0.02)
    low, high = np.transpose(drawing.limits)
    assert (low < cells.points).all()
    assert (cells.points < high).all()


def test_stick_and_slip_areas_are_those_of_the_legend(data: Dataset) -> None:
    drawing = traction_drawing(data, "left")
    cells = drawing.layers[0]
    assert isinstance(cells, Cells)
    for name, (colour, text) in zip(("stick", "slip"), drawing.legend, strict=True):
        assert colour == REGIONS[name]
        area = areas(cells)[np.array(cells.colours) == colour].sum()
        assert float(text.removeprefix(f"{name}, ").removesuffix(" mm²")) == pytest.approx(area, rel=5e-3)
    assert len(traction_drawing(data, "left", slip=False).layers) == len(drawing.layers) - 1


def test_plain_drawings_are_json_within_a_tenth_of_a_pixel(data: Dataset) -> None:
    y = np.linspace(-6.0, 6.0, 500)
    flat = Drawing("axes of two scales", "y [mm]", "z [m]", (Line(np.column_stack([y, 1e-7 * y**3]), "#0072B2"),))
    magnified = replace(profiles_drawing(data), x_limits=(-5.0, -4.5), y_limits=(-0.1, 0.1))
    for drawing in (pressure_drawing(data), traction_drawing(data), profiles_drawing(data, "right"), magnified, flat):
        read = json.loads(json.dumps(drawing.plain(), allow_nan=False))
        assert [layer["kind"] for layer in read["layers"]] == [type(layer).__name__ for layer in drawing.layers]
        sizes = np.ptp(drawing.limits, axis=1)
        sizes = np.full(2, sizes.max()) if drawing.equal else sizes
        origin = np.array([read["x_limits"][0], read["y_limits"][0]])
        for plain, layer in zip(read["layers"], drawing.layers, strict=True):
            points, exact = np.array(plain["points"]) * read["unit"] / sizes, (layer.points - origin) / sizes
            if points.shape == exact.shape:
                np.testing.assert_allclose(points, exact, atol=1e-4)
            else:  # a curve with fewer points
                assert max(distance(point, points) for point in exact) < 2e-4
    assert len(flat.plain()["layers"][0]["points"]) < 0.5 * len(y)


def test_thinned_curves_keep_corners() -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 1001)
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    some = circle[thinned(circle, 2e-3)]
    assert len(some) < 100
    middles = 0.5 * (some[1:] + some[:-1])
    assert (1.0 - np.hypot(*middles.T)).max() < 2.1e-3
    corner = np.array([[x, abs(x)] for x in np.linspace(-1.0, 1.0, 41)])
    assert 20 in thinned(corner, 1e-6)


def test_gaps_and_empty_drawings() -> None:
    line = Line(np.array([[0.0, 1.0], [1.0, np.nan], [2.0, 3.0]]), "#0072B2", "gap", dash=True, marker="o")
    drawing = Drawing("", "x [m]", "y [m]", (line,), margin=0.0)
    assert drawing.limits == ((0.0, 2.0), (1.0, 3.0))
    assert drawing.plain()["layers"][0]["points"] == [[0, 0], None, [10000, 10000]]
    assert Drawing("", "x [m]", "y [m]", ()).limits == ((0.0, 1.0), (0.0, 1.0))
    (drawn,) = draw(drawing, Figure().subplots()).lines
    assert (drawn.get_linestyle(), drawn.get_marker(), drawn.get_label()) == ("--", "o", "gap")
