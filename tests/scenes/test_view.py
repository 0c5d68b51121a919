"""3D views off screen: contents, self-contained pages, a short animation."""

from __future__ import annotations

import re
import signal
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from notebook_runner import view_cell
from solid_scene import SOLIDS
from typer.testing import CliRunner
from xarray import Dataset
from xdmf_values import xdmf_values

import wheelrail as wr
from wheelrail.cli.main import app
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.kinematics.wheelset_state import Mounting
from wheelrail.contact.results.result import ContactResult, Fields
from wheelrail.contact.stress.fields import BodyFields
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.scenes.builders.vehicle_file import MANCHESTER, load_vehicle
from wheelrail.scenes.contacts.side_solution import SideSolution
from wheelrail.scenes.html_report.elements import PageNote, PageView
from wheelrail.scenes.html_report.views import run_view
from wheelrail.scenes.views.animation import Animation, RunBodies, magnified, write_frames
from wheelrail.scenes.views.body_meshes import (
    DISPLACEMENT,
    MISES,
    PRESSURE,
    bodies_mesh,
    displaced,
    displaced_with,
    pressure_surface,
)
from wheelrail.scenes.views.contact_view import DrawnBody, contact_scene, round_scale
from wheelrail.scenes.views.export import PARTS
from wheelrail.scenes.views.html import save_view, view_html
from wheelrail.scenes.views.plotter import colour_bar, plotter, pyvista
from wheelrail.scenes.views.vehicle_animation import VehicleAnimation
from wheelrail.scenes.views.vehicle_poses import DrawnVehicle, equal_box
from wheelrail.scenes.views.view import animate_data, largest_pressure
from wheelrail.scenes.views.whole_bodies import rail_body, wheel_body
from wheelrail.vehicle.multibody.vehicle import Vehicle, VehicleBody
from wheelrail.vehicle.track.track import Track

WHEEL, RAIL = named_profile("S1002"), named_profile("60E1")
MOUNTING = Mounting(0.75, RAIL.gauge_offset(1.435, 0.014), 0.46)


@cache
def result() -> ContactResult:
    """Synthetic patch of 12 by 10 cells of 1 mm with a paraboloidal pressure of 900 MPa."""
    x, y = (v.ravel() for v in np.meshgrid(np.arange(12) - 5.5, np.arange(10) - 4.5))
    p = 9e8 * np.sqrt(np.maximum(1 - (x / 6) ** 2 - (y / 5) ** 2, 0))
    n = len(x)
    fields = Fields(
        np.arange(n),
        np.where(p > 0, 0, -1),
        1e-3 * np.column_stack([x, y + 3, 0 * x]),
        np.tile(np.diag([1.0, -1.0, -1.0]), (n, 1, 1)),
        np.full(n, 1e-6),
        np.full(n, 1e-3),
        np.zeros(n),
        p,
        np.column_stack([0.2 * p, 0 * p]),
        np.zeros((n, 2)),
        np.zeros((n, 3)),
    )
    return ContactResult(np.zeros(3), np.zeros(3), fields=fields, status="converged")


def box(upper: bool) -> BodyFields:
    """Eight corners of a block of 40 mm on one side of z = 0; pushed down by 20 um at its top, uniaxial stress."""
    z = [0.0, 0.04] if upper else [-0.04, 0.0]
    points = np.array([[x, y, h] for h in z for x, y in [(-0.02, -0.02), (0.02, -0.02), (0.02, 0.02), (-0.02, 0.02)]])
    down = np.zeros((8, 3))
    down[np.isclose(points[:, 2], 0.0), 2] = 20e-6 * (1 if upper else -1)
    stress = np.zeros((8, 3, 3))
    stress[:, 2, 2] = -np.linspace(1e8, 8e8, 8)
    return BodyFields(points, np.arange(8)[None], "hexahedron", down, stress)


@cache
def drawn() -> str:
    """HTML page of a scene; `test_a_contact_scene` checks the screenshot."""
    bodies = tuple(DrawnBody(name, name == "wheel", box(name == "wheel"), (box(name == "wheel"),)) for name in NAMES)
    view = contact_scene(result(), bodies, title="a <contact>", off_screen=True)
    picture = np.asarray(view.screenshot(None))
    PICTURES.append(picture)
    AXES.extend((pane.cube_axes_actor.x_labels, pane.cube_axes_actor.y_labels) for pane in view.renderers)
    RANGES.update({title: bar.GetLookupTable().GetRange() for title, bar in view.scalar_bars.items()})
    page = view_html(view)
    view.close()
    return page


NAMES = ("wheel", "rail")
PICTURES: list[np.ndarray] = []
RANGES: dict[str, tuple[float, float]] = {}
AXES: list[tuple[list[str], list[str]]] = []


def test_a_contact_scene() -> None:
    """Both panes are not empty; colour bars range from zero to the largest values."""
    drawn()
    (picture,) = PICTURES
    for pane in np.array_split(picture, 2, axis=1):
        dark = (pane.min(axis=-1) < 200).mean()
        assert 0.05 < dark < 0.9
        assert len(np.unique(pane.reshape(-1, 3), axis=0)) > 200
    assert RANGES[DISPLACEMENT] == pytest.approx((0.0, 20.0))
    assert RANGES[MISES] == pytest.approx((0.0, 800.0))


def test_one_label_at_the_common_corner_of_two_axes() -> None:
    """In the picture, where x ends and y begins."""
    drawn()
    assert len(AXES) == 2
    for x, y in AXES:
        assert all(x)
        assert y[0] == " "
        assert all(y[1:])


@pytest.mark.parametrize("size", [(800, 450), (1280, 720), (1600, 900)])
def test_titles_of_colour_bars_are_clear_of_tick_labels(size: tuple[int, int]) -> None:
    """Rows of dark pixels above the bar: the title, then white, then the tick labels."""
    view = plotter(size=size, off_screen=True)
    mesh = pyvista().Sphere()
    mesh[DISPLACEMENT] = 100.0 * mesh.points[:, 2]
    actor = view.add_mesh(mesh, scalars=DISPLACEMENT, cmap="autumn", show_scalar_bar=False)
    mesh_free = 0.3  # of the height, below the sphere
    view.camera.focal_point = (0.0, 0.0, -0.5)
    colour_bar(view, actor.mapper, DISPLACEMENT)
    picture = np.asarray(view.screenshot(None))[round((1 - mesh_free) * size[1]) :]
    view.close()
    coloured = (np.ptp(picture.astype(int), axis=-1) > 100).mean(axis=1) > 0.3
    above = picture[: int(np.flatnonzero(coloured)[0])]
    dark = (above.max(axis=-1) < 140).any(axis=1)
    assert np.count_nonzero(np.diff(dark.astype(int)) == 1) + dark[0] == 2


def test_magnified_wheelset_stays_on_its_rails() -> None:
    """Rails keep their place relative to the wheelset, and the wheelset has the magnified displacement."""
    y, z, roll, radius = 6e-3, 0.4598, 1e-3, 0.46
    at_rail = np.array([0.0, 0.75, 0.0, 1.0])
    assert magnified(y, z, roll, 2e-3, 1.0, radius) == pytest.approx(np.eye(4), abs=1e-15)
    moved = magnified(y, z, roll, 0.0, 20.0, radius)
    assert moved @ [0.0, y, z, 1.0] == pytest.approx([0.0, 20 * y, radius - 20 * 2e-4, 1.0])
    before, after = at_rail[:3] - [0.0, y, z], (moved @ at_rail - moved @ [0.0, y, z, 1.0])[:3]
    turn = np.array([[1, 0, 0], [0, np.cos(19 * roll), -np.sin(19 * roll)], [0, np.sin(19 * roll), np.cos(19 * roll)]])
    assert after == pytest.approx(turn @ before)


def test_rails_of_an_animation_follow_the_magnified_wheelset() -> None:
    animation = Animation(run_data(), RunBodies(WHEEL, RAIL, MOUNTING), "wheelset", scale=20.0)
    animation.show(1.0)
    for rail in animation._rails:
        assert rail.user_matrix[:3, 3] == pytest.approx([0.0, 19 * 6e-3, 0.0])
    animation.view.close()


def test_sides_have_one_scale_of_pressure() -> None:
    """The peak of the side with the larger one, in both panes."""
    fields = result().fields
    assert fields is not None
    higher = replace(result(), fields=replace(fields, pressure=2 * fields.pressure))
    peak = largest_pressure([SideSolution(each, None) for each in (result(), higher, ContactResult.separated())])
    assert peak == pytest.approx(2e-6 * fields.pressure.max())
    view = contact_scene(result(), (DrawnBody("rail", False, box(False), (box(False),)),), title="t", peak=peak)
    ranges = [m.scalar_range for r in view.renderers for a in r.actors.values() if (m := getattr(a, "mapper", None))]
    assert sum(upper == pytest.approx(peak) for _, upper in ranges) == 2
    view.close()


def test_animation_draws_each_side_with_its_own_bodies() -> None:
    right = RunBodies(WHEEL, RAIL, Mounting(0.75, MOUNTING.rail_y + 5e-3, 0.46), 0.44)
    animation = Animation(run_data(), RunBodies(WHEEL, RAIL, MOUNTING, right=right), "wheelset", scale=1.0)
    bounds = {side: animation._wheels[side].mapper.dataset.bounds for side in ("left", "right")}
    assert bounds["right"][4] - bounds["left"][4] == pytest.approx(0.02, abs=1e-4)
    rails = [rail.mapper.dataset.bounds for rail in animation._rails]
    assert -rails[1][2] - rails[0][3] == pytest.approx(5e-3, abs=1e-6)
    whole = animation._axle.mapper.dataset.points
    lowest = [whole[sign * whole[:, 1] > 0.7, 2].min() for sign in (1, -1)]
    assert lowest[1] - lowest[0] == pytest.approx(0.02, abs=1e-4)
    animation.view.close()


def test_html_page_is_self_contained() -> None:
    """Scripts and styles are embedded, and the title is escaped."""
    page = drawn()
    head = page[: page.index("<body>")]
    tags = re.findall(r"<(?:script|link|img|iframe)\b[^>]*>", head + page[page.index("<body>") :][:2000])
    assert tags
    assert not any(re.search(r"\b(?:src|href)\s*=\s*[\"']?(?:https?:)?//", tag) for tag in tags)
    assert "a &lt;contact&gt;" in page
    assert len(page) > 400_000


def test_fields_on_a_mesh() -> None:
    mesh = bodies_mesh(box(False))
    assert mesh.bounds[4:] == pytest.approx((-40.0, 0.0))
    assert mesh[MISES].max() == pytest.approx(800.0)
    assert mesh[DISPLACEMENT].max() == pytest.approx(20.0)
    assert displaced(mesh, 100.0).points[:, 2].max() == pytest.approx(-2.0)
    assert mesh.volume == pytest.approx(40.0**3)


def test_patch_position() -> None:
    """On top of the rail, left of its middle; on the right in the mirror image; displaced with the rail."""
    fields = result().fields
    assert fields is not None
    patch = pressure_surface(result())
    assert patch.n_cells == np.count_nonzero(fields.pressure)
    assert patch[PRESSURE].max() == pytest.approx(1e-6 * fields.pressure.max())
    assert patch.area == pytest.approx(1e6 * fields.area[fields.pressure > 0].sum())
    assert patch.bounds[2:4] == pytest.approx((-2.0, 8.0))
    assert 0 < patch.bounds[4] < 0.2
    assert pressure_surface(result(), mirrored=True).bounds[2:4] == pytest.approx((-8.0, 2.0))
    lowered = displaced_with(patch, bodies_mesh(box(False)), 100.0)
    assert lowered.points[:, 2].max() < -0.5
    with pytest.raises(ValueError, match="not in contact"):
        pressure_surface(ContactResult.separated())


def test_whole_bodies() -> None:
    """Rail with the standard's section, wheel with the radius of its tread; left and right are mirror images."""
    rail = rail_body(RAIL, length=0.5)
    end = rail.extract_cells(rail.cell_centers().points[:, 0] > 0.25 - 1e-9)
    assert end.area == pytest.approx(7.670e-3, rel=0.01)  # 60E1: 76.70 cm2, EN 13674-1
    wheel = wheel_body(WHEEL, 0.46)
    assert wheel.bounds[4:] == pytest.approx((-0.488, 0.488), abs=2e-3)  # flange of 28 mm
    assert np.allclose(np.array(wheel_body(WHEEL, 0.46, right=True).bounds[2:4]), -np.array(wheel.bounds[3:1:-1]))


def run_data() -> Dataset:
    """Three samples of a wheelset that moves to the left."""
    by_wheel, by_patch = ("time", "wheelset", "side"), ("time", "wheelset", "side", "patch")
    y = np.array([0.0, 3e-3, 6e-3])
    patches = {
        "patch_normal_force": 6e4,
        "patch_semi_axis_x": 6e-3,
        "patch_semi_axis_y": 4e-3,
        "patch_contact_angle": 0.0,
        "patch_x": 0.0,
        "rail_s": 0.0,
    }
    return Dataset(
        {
            "body_y": (("time", "body"), y[:, None]),
            **{f"body_{name}": (("time", "body"), 0 * y[:, None]) for name in ("z", "roll", "pitch", "yaw")},
            "speed": ("time", 0 * y + 20),
            "curvature": ("time", 0 * y),
            "vertical_force": (by_wheel, np.full((3, 1, 2), 6e4)),
            "lateral_force": (by_wheel, np.outer(y, [1e6, 2e6])[:, None]),
            **{name: (by_patch, np.full((3, 1, 2, 1), value)) for name, value in patches.items()},
        },
        coords={
            **{"time": [0.0, 0.5, 1.0], "side": ["left", "right"], "distance": ("time", [0.0, 10.0, 20.0])},
            **{"body": ["wheelset"], "wheelset": ["wheelset"]},
        },
        attrs={"nominal_radius": 0.46, "vehicle": "", "scene": (MANCHESTER.parent / "curve.toml").read_text()},
    )


def test_animation_of_a_run(tmp_path: Path) -> None:
    """Requested number of frames, all different; both formats; invalid options are rejected before drawing."""
    import imageio.v3 as imageio

    told: list[tuple[int, int]] = []
    file = tmp_path / "run.gif"

    def animate(out: Path, frames: int = 3) -> None:
        animate_data(run_data(), Path("run.nc"), out, lambda *done: told.append(done), frames=frames, fps=5.0)

    animate(file)
    assert told == [(1, 3), (2, 3), (3, 3)]
    frames = imageio.imread(file)
    assert len(frames) == 3
    moving = [np.abs(a.astype(int) - b).max(axis=-1) > 60 for a, b in pairwise(frames)]
    assert all(0.001 < change.mean() < 0.5 for change in moving)
    animate(tmp_path / "run.mp4", 1)
    assert (tmp_path / "run.mp4").stat().st_size > 5000
    with pytest.raises(ValueError, match="must end in"):
        animate(tmp_path / "run.png")
    with pytest.raises(ValueError, match="must be positive"):
        animate(file, 0)


def vehicle_data(vehicle: Vehicle) -> Dataset:
    """A straight second, in which the car body sways by 20 mm to the left, and the right wheels are unloaded."""
    zero = np.zeros((2, len(vehicle.bodies)))
    values = {f"body_{name}": (("time", "body"), zero.copy()) for name in ("x", "y", "z", "roll", "pitch", "yaw")}
    values["body_y"][1][1, list(vehicle.bodies).index("car_body")] = 0.02
    load = np.full((2, 4, 2), 50e3)
    load[1, :, 1] = 0.0
    series = {name: ("time", [value, value]) for name, value in (("speed", 20.0), ("curvature", 0.0), ("lift", 0.0))}
    data = {**values, **series, "vertical_force": (("time", "wheelset", "side"), load)}
    names = {"body": list(vehicle.bodies), "wheelset": list(vehicle.wheelsets), "side": list(SIDES)}
    return Dataset(data, coords={"time": [0.0, 1.0], "distance": ("time", [0.0, 20.0]), **names})  # type: ignore[arg-type]


def test_animation_of_a_vehicle(tmp_path: Path) -> None:
    """Bodies at their magnified places, wheels in the colour of their load, frames in a file."""
    vehicle, bodies = load_vehicle(), RunBodies(WHEEL, RAIL, MOUNTING)
    animation = VehicleAnimation(vehicle_data(vehicle), bodies, vehicle, Track(), scale=10.0)
    animation.show(0.5)
    assert animation._actors["car_body"][0].user_matrix[:3, 3] == pytest.approx([0.0, 0.1, 1.8], abs=1e-12)
    assert animation._actors["wheelset_1"][0].user_matrix[:3, 3] == pytest.approx([10.78, 0.0, 0.46], abs=1e-12)
    colours = {side: animation._wheels["wheelset_3", side][0].mapper.dataset["wheel load Q [kN]"] for side in SIDES}
    assert (set(colours["left"]), set(colours["right"])) == ({50.0}, {25.0})
    top = {side: rail.points[:, 2].max() for side, rail in animation._rails.items()}
    assert list(top.values()) == pytest.approx([0.0, 0.0], abs=1e-4)
    file = tmp_path / "vehicle.gif"
    write_frames(animation, file, [0.0, 1.0], 5.0, None)
    assert file.stat().st_size > 10_000


def test_view_of_a_vehicle_in_a_report() -> None:
    """At its largest guiding forces; without the files of the scene the reason takes its place."""
    vehicle = load_vehicle()
    data = vehicle_data(vehicle)
    force = np.zeros((2, 4, 2))
    force[1] = 20e3
    scene = (MANCHESTER.parent / "vehicle.toml").read_text()
    data["guiding_force"] = (("time", "wheelset", "side"), force)
    data = data.assign_attrs(scene=scene, vehicle=MANCHESTER.read_text())
    shown = run_view(data, Path("run.nc"))
    assert isinstance(shown, PageView)
    assert "Largest guiding forces, at 20.0 m" in shown.caption
    assert shown.still.startswith("data:image/png;base64,")
    assert "</html>" in shown.page
    missing = run_view(data.assign_attrs(scene=scene.replace('"S1002"', '"worn.prw"')), Path("run.nc"))
    assert isinstance(missing, PageNote)
    assert missing.text.startswith("No 3D view: ")


def test_undeflected_bodies_lie_on_those_below_them_in_a_curve() -> None:
    """In a circle a centred vehicle has no displacements: its bogies and body lie on chords, and stay there."""
    vehicle, radius = load_vehicle(), 200.0
    bogie, body = (radius * (1 - np.cos(reach / radius)) for reach in (1.28, 9.5))  # from chord to arc
    inwards = {"car_body": body + bogie, "front_bogie": bogie, "rear_bogie": bogie}
    coordinates = np.zeros((7, 6))
    coordinates[:, 1] = [inwards.get(name, 0.0) for name in vehicle.bodies]
    track = Track.curve(curvature=1 / radius, transition=20.0, length=500.0)
    to_scale, magnified_poses = (DrawnVehicle(vehicle, track, k).poses(200.0, coordinates) for k in (1.0, 50.0))
    np.testing.assert_allclose(magnified_poses.position, to_scale.position, atol=2e-3)  # of 500 mm
    np.testing.assert_allclose(magnified_poses.axes, to_scale.axes, atol=1e-4)


def test_a_homogeneous_box_has_its_own_size() -> None:
    length, width, height, mass = 20.0, 3.0, 2.5, 30e3
    squares = (width**2 + height**2, length**2 + height**2, length**2 + width**2)
    x, y, z = (mass / 12 * square for square in squares)
    assert equal_box(VehicleBody(mass, (x, y, z), 0.0, 1.8)) == pytest.approx((length, width, height))


@pytest.mark.parametrize(
    ("command", "complaint"),
    [
        (["view", "scenes/wheelset.toml", "--out", "a.stl"], "--out a.stl: must end in .png, .html"),
        (["view", "scenes/wheelset.toml", "--out", "a.png", "--scale", "-1"], "--scale -1: must be greater than 0"),
        (["view", "scenes/wheelset.toml", "--out", "a.png", "--body", "axle"], "--body axle: must be wheel, rail"),
        (["view", "scenes/wheelset.toml", "--out", "a.png", "--side", "top"], "--side top: must be left or right"),
        (["view", "scenes/curve.toml", "--out", "a.png"], "use wheelrail animate"),
        (["export", "scenes/curve.toml", "--out", "a"], 'must be "hertz" or "wheelset"'),
        (["export", "scenes/hertz.toml", "--out", "README.md"], "README.md is a file"),
        (["animate", "nowhere", "--out", "a.png"], "--out a.png: must end in .mp4, .gif"),
        (["animate", "nowhere", "--out", "a.gif"], "nowhere: file does not exist"),
    ],
)
def test_invalid_options_are_rejected(command: list[str], complaint: str) -> None:
    outcome = CliRunner().invoke(app, command)
    assert outcome.exit_code == 2
    assert complaint in outcome.stderr


def test_default_scale_is_a_round_number() -> None:
    assert [round_scale(v) for v in (1.0, 1.9, 2.1, 49.0, 99.9, 501.0)] == [1, 1, 2, 20, 50, 500]


def test_view_file_endings(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="must end in"):
        save_view(None, tmp_path / "a.jpg")


def test_ctrl_c_works_after_an_interactive_page() -> None:
    view = plotter(size=(300, 200))
    view.add_mesh(pyvista().Sphere())
    assert "<script>" in view_html(view)
    view.close()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_notebook_shows_an_interactive_scene(monkeypatch: pytest.MonkeyPatch) -> None:
    """The cell of the notebook: in a kernel a plotter is displayed as a widget served by a local server."""
    import nbclient
    import nbformat

    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[2]))
    sphere = """from wheelrail.scenes.views.plotter import plotter, pyvista
LOAD = 10e3
class pair:  # a view of a sphere in place of that of a solution
    def solve(self, load):
        return self
    def view(self):
        view = plotter(size=(300, 200))
        view.add_mesh(pyvista().Sphere())
        return view
"""
    cell = nbformat.v4.new_code_cell(sphere + view_cell())
    nbclient.NotebookClient(nbformat.v4.new_notebook(cells=[cell]), timeout=120, kernel_name="python3").execute()
    shown = [output["data"] for output in cell.outputs if "data" in output]
    assert any("application/vnd.jupyter.widget-view+json" in data for data in shown)
    assert any("<iframe" in data.get("text/plain", "") for data in shown)


def test_export_of_solids_for_paraview(tmp_path: Path) -> None:
    """The meshes of the full model itself, and the deepest point under the load."""
    (tmp_path / "scene.toml").write_text(SOLIDS)
    outcome = CliRunner().invoke(app, ["export", str(tmp_path / "scene.toml"), "--out", str(tmp_path / "fields")])
    assert outcome.exit_code == 0, outcome.stderr
    solids = [Path(line) for line in outcome.stdout.splitlines() if Path(line).suffix == ".xdmf"]
    assert [file.stem for file in solids] == ["contact_upper_solid", "contact_lower_solid"]
    for file, up in zip(solids, (1, -1), strict=True):
        points, moved = (xdmf_values(file, where) for where in (".//Geometry", ".//Attribute[@Name='displacement']"))
        k = int(np.argmax(up * moved[:, 2]))
        assert up * moved[k, 2] > 4e-3  # mm, of an approach of 15 um
        assert np.linalg.norm(points[k]) < 6.1  # mm, a cell from the middle of the patch


def test_export_for_paraview(tmp_path: Path) -> None:
    """Fields of both blocks under 10 kN, read again: pressure over the patch is the load, stress is below the patch."""
    pair = wr.Hertz(upper=(0.46, 0.3), lower=(0.5, 0.3), friction=0.0, strips=8)
    solution = pair.solve(load=10e3)
    files = solution.export(tmp_path / "fields")
    names = {f"contact_{body}_{part}.vtu" for body in ("upper", "lower") for part in PARTS} | {"contact_patches.vtp"}
    assert {file.name for file in files} == names == {file.name for file in (tmp_path / "fields").iterdir()}
    read = {file.stem: pyvista().read(file) for file in files}
    patch = read["contact_patches"].compute_cell_sizes()
    assert float(patch[PRESSURE] @ patch["Area"]) == pytest.approx(10e3, rel=1e-6)  # MPa mm2 = N
    peak = float(solution.patches.max_pressure.iloc[0]) * 1e-6
    cut = read["contact_lower_longitudinal_cut"]
    assert 0.5 * peak < cut[MISES].max() < 0.7 * peak
    assert cut.points[np.argmax(cut[MISES]), 2] < 0.0
    assert cut["stress"].shape == (cut.n_points, 9)
    assert read["contact_lower_body"]["displacement"][:, 2].min() < -5e-3
    with pytest.raises(ValueError, match="contains no bodies"):
        wr.Solution(solution.data).export(tmp_path)
