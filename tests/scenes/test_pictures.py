"""Figures contain their data, with units on every axis."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.quiver import Quiver
from matplotlib.text import Text
from test_figures import history as run_history
from xarray import Dataset

import wheelrail as wr
from wheelrail.contact.analytical.hertz import hertz, modulus
from wheelrail.contact.kinematics.frames import RigidMotion, Twist
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.builders import hertz_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.scenes.builders.vehicle import vehicle_on
from wheelrail.scenes.datasets.contact import contact_dataset
from wheelrail.scenes.datasets.run import dataset as run_dataset
from wheelrail.scenes.plots import comparison, runs
from wheelrail.scenes.plots.errors import convergence, work_precision
from wheelrail.scenes.plots.patch_cells import PatchCells
from wheelrail.scenes.plots.patches import patches_figure, pressure_map, traction_map
from wheelrail.scenes.plots.profiles import profiles_in_contact
from wheelrail.scenes.plots.sections import closed_form, section
from wheelrail.scenes.plots.style import styled
from wheelrail.scenes.runs.track_plot import track_figure
from wheelrail.scenes.runs.track_table import segment_table
from wheelrail.scenes.schema.scene import RunScene, load_scene
from wheelrail.scenes.views.body_meshes import pressure_surface

UNIT = re.compile(r"\[[^\]]+\]")


@pytest.fixture(scope="module")
def data() -> Dataset:
    return wr.Wheelset(friction=0.3, model="standard").solve(y=2e-3, wheel_load=57e3, speed=45.0).data


def test_every_axis_has_a_unit(data: Dataset) -> None:
    panels = [
        pressure_map(data),
        traction_map(data, "right"),
        section(data, "x"),
        section(data, "y", side="right"),
        profiles_in_contact(data, "left"),
        convergence([1e-3, 2e-3], {"peak": [1e-3, 4e-3]}),
        work_precision({"fitted": ([1e-3, 2e-3], [1e-2, 1e-3])}),
    ]
    for ax in panels:
        assert UNIT.search(ax.get_xlabel()), ax.get_xlabel()
        assert UNIT.search(ax.get_ylabel()), ax.get_ylabel()


def test_a_pair_of_blocks_has_no_wheel(data: Dataset) -> None:
    pair = wr.Hertz(upper=(0.46, 0.3), lower=(0.5, 0.3), friction=0.3, model="standard")
    blocks = pair.solve(load=10e3, speed=10.0, creepage=(1e-3, 0.0, 0.0)).data
    for found, body in ((blocks, "upper body"), (data, "wheel")):
        assert f"MPa on the {body}\n" in traction_map(found).get_xlabel() + "\n"
        assert section(found, "x").get_ylabel() == f"on the {body} [MPa]"


def test_pressure_map_shows_all_cells(data: Dataset) -> None:
    ax = pressure_map(data, "right")
    own = (data["point_side"] == "right") & (data["point_patch"] == 0)
    (cells,) = (artist for artist in ax.collections if isinstance(artist, PolyCollection))
    np.testing.assert_allclose(cells.get_array(), 1e-6 * data["pressure"].values[own.values])
    assert ax.get_title() == "right wheel: 57 kN"


def test_slip_arrows_are_in_the_slip_region_and_against_the_traction(data: Dataset) -> None:
    cells = PatchCells.of(data, "left", 0)
    slips = ~cells.sticks
    assert 0 < slips.sum() < len(slips)
    opposite = np.einsum("nk,nk->n", cells.traction[slips], cells.slip[slips])
    assert (opposite < 0.0).all()
    traction, slip = (a for a in traction_map(data, "left").collections if isinstance(a, Quiver))
    assert len(slip.U) <= slips.sum() < len(cells.pressure)
    assert len(traction.U) > len(slip.U) > 0
    alone = [a for a in traction_map(data, "left", slip=False).collections if isinstance(a, Quiver)]
    assert len(alone) == 1
    regions = {text.get_text().split(",")[0] for text in traction_map(data, "left").get_legend().get_texts()}
    assert regions == {"stick", "slip"}


def test_section_through_the_centre_with_hertz(data: Dataset) -> None:
    ax = section(data, "x", side="right")
    lines = {str(line.get_label()).split(",")[0]: line for line in ax.lines}
    assert set(lines) == {"pressure", "traction", "friction bound", "Hertz"}
    peak = 1e-6 * data["patch_max_pressure"].sel(side="right").values[0]
    assert lines["pressure"].get_ydata().max() == pytest.approx(peak, rel=0.05)
    assert (np.diff(lines["pressure"].get_xdata()) > 0.0).all()
    exact = closed_form(data, "right", 0)
    assert exact is not None
    assert exact.force == pytest.approx(float(data["patch_normal_force"].sel(side="right")[0]))
    assert lines["Hertz"].get_ydata().max() == pytest.approx(1e-6 * exact.peak)
    assert len(section(data, "x", hertz=False).lines) == 3
    with pytest.raises(ValueError, match='must be "x" or "y"'):
        section(data, "z")  # type: ignore[arg-type]


@pytest.mark.parametrize("side", ["left", "right"])
def test_contact_points_lie_on_wheel_and_rail(data: Dataset, side: str) -> None:
    ax = profiles_in_contact(data, side)
    rail, wheel, *points = (np.column_stack(line.get_data()) for line in ax.lines)
    assert len(points) == int(data["patches"].sel(side=side))
    hand = 1.0 if side == "left" else -1.0
    assert points[0][0, 0] == pytest.approx(hand * 1e3 * float(data["rail_y"].sel(side=side)[0]), abs=0.3)
    for curve in (rail, wheel):
        assert np.hypot(*(curve - points[0]).T).min() < 0.3  # mm: the middle of a patch, curves by points
    assert (wheel[:, 0].argmin() < wheel[:, 0].argmax()) == (side == "left")  # flanges are inside


def test_missing_side_or_patch_is_an_error(data: Dataset) -> None:
    with pytest.raises(ValueError, match="side = 'inner', patch = 0: must be side = 'left'"):
        pressure_map(data, "inner")
    with pytest.raises(ValueError, match="must be 'left' or 'right'"):
        profiles_in_contact(data, "inner")


def test_fitted_slopes_are_labelled() -> None:
    size = [1e-3, 2e-3, 4e-3]
    ax = convergence(size, {"second": [3.0 * h**2 for h in size], "one": [1e-3, float("nan"), 0.0]})
    assert ax.get_legend_handles_labels()[1] == ["second, slope 2.00", "one"]
    points, line = ax.lines[:2]
    np.testing.assert_allclose(points.get_ydata(), 3.0 * np.square(size))
    np.testing.assert_allclose(line.get_ydata(), 3.0 * np.square([size[0], size[-1]]))
    with pytest.raises(ValueError, match="2 errors for 3 sizes"):
        convergence(size, {"short": [1.0, 2.0]})


def test_work_precision_plots_its_data() -> None:
    ax = work_precision({"a": ([1e-3, 1e-2], [-1e-2, 1e-3]), "b": ([1.0], [0.1])})
    assert [line.get_label() for line in ax.lines] == ["a", "b"]
    np.testing.assert_array_equal(ax.lines[0].get_ydata(), [1e-2, 1e-3])
    assert (ax.get_xscale(), ax.get_yscale()) == ("log", "log")


def lines_of(figure: Figure) -> list[Text]:
    """Texts of a figure that are drawn, tick labels within the axes' limits only."""
    ticks = {
        label
        for ax in figure.axes
        for axis in (ax.xaxis, ax.yaxis)
        for tick in axis.get_major_ticks()
        if not (min(v := axis.get_view_interval()) - 1e-9 <= tick.get_loc() <= max(v) + 1e-9)
        for label in (tick.label1, tick.label2)
    }
    return [text for text in figure.findobj(Text) if text.get_visible() and text.get_text() and text not in ticks]


@pytest.fixture(scope="module")
def two_patches() -> Dataset:
    """A narrow second patch on the flange of the left wheel."""
    pair = wr.Wheelset(friction=0.3, model="standard", normal="kik-piotrowski")
    solved = pair.solve(y=5.2e-3, wheel_load=57e3, speed=45.0).data
    assert solved["patches"].sel(side="left") >= 2
    return solved


def all_figures(data: Dataset) -> dict[str, Figure]:
    run = run_dataset(run_history())
    return {
        "patches": patches_figure(data),
        "track": track_figure(scene := load_run("irregular"), vehicle_on(scene)),
        **{name: draw(run) for name, draw in runs.PICTURES.items()},
        **{name: draw((run, run), ("condensed", "standard")) for name, draw in comparison.PICTURES.items()},
        "pressure": pressure_map(data).figure,
        "tractions": traction_map(data).figure,
        "section": section(data).figure,
        "profiles": profiles_in_contact(data).figure,
    }


def load_run(name: str) -> RunScene:
    scene = load_scene(Path(__file__).parents[2] / "scenes" / f"{name}.toml")
    assert isinstance(scene, RunScene)
    return scene


def test_no_label_is_cut_off(two_patches: Dataset) -> None:
    """800 pixels wide; text and axes grow alike with the resolution."""
    with styled():
        for name, figure in all_figures(two_patches).items():
            figure.set_dpi(800 / figure.get_size_inches()[0])
            figure.draw_without_rendering()
            across, high = figure.bbox.size
            for text in lines_of(figure):
                box = text.get_window_extent()
                assert min(box.x0, box.y0, across - box.x1, high - box.y1) >= -1, (name, text)


def test_patches_of_a_scene_have_one_scale_of_lengths_and_pressure(two_patches: Dataset) -> None:
    figure = patches_figure(two_patches)
    FigureCanvasAgg(figure).draw()
    panels = [ax for ax in figure.axes if ax.get_title(loc="left") or ax.get_title()]
    assert len(panels) >= 3
    scales = [ax.bbox.width / np.ptp(ax.get_xlim()) for ax in panels]
    assert scales == pytest.approx([scales[0]] * len(scales), rel=1e-3)
    assert [ax.bbox.height / np.ptp(ax.get_ylim()) for ax in panels] == pytest.approx(scales, rel=1e-3)
    largest = 1e-6 * float(two_patches["patch_max_pressure"].max())
    drawn = [*panels, pressure_map(two_patches, "right")]
    norms = [artist.norm.vmax for ax in drawn for artist in ax.collections if artist.get_array() is not None]
    assert norms == pytest.approx([largest] * len(norms))
    for ax in panels:
        (cells,) = (a for a in ax.collections if isinstance(a, PolyCollection) and a.get_array() is not None)
        low, high = cells.get_datalim(ax.transData).get_points()
        assert (low >= [ax.get_xlim()[0], ax.get_ylim()[0]]).all()
        assert (high <= [ax.get_xlim()[1], ax.get_ylim()[1]]).all()


def test_cant_and_deficiency_have_one_sign_in_table_and_picture() -> None:
    """The scene ends in a right-hand curve of 60 mm of cant: positive, as in the scene, in both."""
    scene = load_run("irregular")
    table = segment_table(scene)
    text = table.as_text
    cells = dict(zip(text.head, zip(*text.rows, strict=True), strict=True))
    (ax,) = (
        ax
        for ax in track_figure(scene, vehicle_on(scene)).axes
        if "cant deficiency" in (ax.get_title() + ax.get_title(loc="left")).lower()
    )
    drawn = {str(line.get_label()): line for line in ax.lines}
    for name in ("cant", "cant deficiency"):
        x, y = drawn[name].get_data()
        ends = np.array([float(text) for text in cells["to [m]"]])
        np.testing.assert_allclose(np.interp(ends, x, y), [float(text) for text in cells[f"{name} [mm]"]], atol=0.6)
    assert float(cells["cant [mm]"][-1]) == 60.0
    assert float(cells["radius [m]"][-1]) < 0.0


def test_pictures_between_two_widths_of_strips_show_one_of_them() -> None:
    """A light contact, on strips of two widths: cells drawn cover the patch once, in two and three dimensions."""
    radii, steel = (0.46, 0.3), Material()
    how = Discretisation(1e-3, bodies="half-space", points="lattice")
    model = hertz_pair((radii, (np.inf, np.inf)), (steel, steel), ContactLaws(friction=0.0), how, load=60e3)
    pair = hertz(0.5 / radii[0], 0.5 / radii[1], modulus(*[(steel.E, steel.nu)] * 2), force=4e3)
    still = Twist(*np.zeros((3, 3)))
    result = model(hertz_pose(pair.approach), RigidMotion(still, still))
    fields = result.fields
    assert fields is not None
    assert fields.share is not None
    assert 0 < fields.drawn.sum() < len(fields.drawn)
    data = contact_dataset({"contact": result}, {"contact": ContactLaws(friction=0.0)})
    covered = PatchCells.of(data, "contact", 0).areas.sum()
    assert covered == pytest.approx(np.pi * pair.semi_axes[0] * pair.semi_axes[1], rel=0.05)
    assert pressure_surface(result).area == pytest.approx(1e6 * covered, rel=1e-3)
    assert float((data["pressure"] * data["area"]).sum()) == pytest.approx(result.force[2], rel=1e-3)
