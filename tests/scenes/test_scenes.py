"""Scenes: the shipped ones are read, malformed ones give one error naming file, key, value and what is allowed."""

from __future__ import annotations

import math
import subprocess
import sys
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from malformed_inputs import WHEEL, lines
from rich.console import Console

import wheelrail as wr
from wheelrail.contact.laws.friction import FallingFriction
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.standard.model import StandardContact
from wheelrail.scenes.builders.hertz import hertz_motion, hertz_scale
from wheelrail.scenes.builders.laws import laws
from wheelrail.scenes.builders.wheelset import wheelset_contact
from wheelrail.scenes.contacts.report import contact_report
from wheelrail.scenes.contacts.solve import solve_contact
from wheelrail.scenes.contacts.table import table
from wheelrail.scenes.plots.patches import draw_patches
from wheelrail.scenes.runs.compare import with_model
from wheelrail.scenes.runs.resume import inputs
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.override import overridden
from wheelrail.scenes.schema.scene import HertzScene, RunScene, WheelsetScene, load_scene, parse_scene
from wheelrail.vehicle.track.speed_profile import SpeedProfile
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

FOLDER = Path(__file__).parents[2] / "scenes"
HERTZ, WHEELSET, CURVE, IRREGULAR = (
    (FOLDER / f"{name}.toml").read_text() for name in ("hertz", "wheelset", "paper_curve", "irregular")
)


def changed(text: str, old: str, new: str) -> str:
    assert old in text
    return text.replace(old, new, 1)


HERTZ = changed(HERTZ, 'laws = "exact"', 'laws = "paper"')


def test_hertz_scene_is_read() -> None:
    scene = load_scene(FOLDER / "hertz.toml")
    assert isinstance(scene, HertzScene)
    assert (scene.load, scene.approach, scene.friction, scene.speed) == (10e3, None, 0.3, 10.0)
    assert scene.creepage == (1e-3, 0.0, 0.0)
    assert scene.lower.radii == (math.inf, 0.3)
    assert (scene.stiffness_per_area, scene.regularisation) == (1e15, 1e-5)


def test_wheelset_scene_is_read() -> None:
    scene = load_scene(FOLDER / "wheelset.toml")
    assert isinstance(scene, WheelsetScene)
    assert scene.sides == ("left", "right")
    assert (scene.wheelset.y, scene.wheelset.wheel_load, scene.wheelset.z) == (-0.002, 57e3, None)
    assert scene.profiles.rail == "UIC60-benchmark"


def test_quick_curve_is_the_paper_s_with_other_laws_and_stepper() -> None:
    paper, quick = (load_scene(FOLDER / name).model_dump() for name in ("paper_curve.toml", "curve.toml"))
    apart = {key for key in paper if paper[key] != quick[key]}
    assert apart == {"laws", "surface_size", "strips", "cells", "solver", "output", "track"}
    assert {key for key in paper["track"] if paper["track"][key] != quick["track"][key]} == {"curve"}
    length = sum(quick["track"][key] for key in ("tangent", "transition_length", "curve"))
    assert length / quick["vehicle"]["speed"] == pytest.approx(10.0)


def test_paper_curve_is_that_of_the_paper() -> None:
    scene = load_scene(FOLDER / "paper_curve.toml")
    assert isinstance(scene, RunScene)
    assert 1.0 / scene.track.curvature == pytest.approx(1200.0, rel=1e-12)  # Table 3 of the paper
    assert (scene.track.cant, scene.vehicle.speed, scene.friction) == (0.06, 45.0, 0.3)
    assert (scene.solver.method, scene.solver.rtol, scene.solver.atol) == ("ode23", 1e-3, 1e-6)
    assert scene.profiles.laying_angle == pytest.approx(1 / 40)
    assert scene.track.length == 350.0


def test_default_values() -> None:
    text = (
        HERTZ.replace('model = "condensed"', "").replace('laws = "paper"', "").replace("friction = 0.3", "friction = 0")
    )
    text = text.replace("speed = 10.0", "").replace("creepage = [1e-3, 0.0, 0.0]", "")
    scene = parse_scene(text)
    assert isinstance(scene, HertzScene)
    assert (scene.model, scene.laws, scene.speed) == ("condensed", "exact", None)
    motion = hertz_motion(scene)
    assert not motion.wheel.velocity.any()


def test_motion_has_the_creepage_and_the_mean_speed() -> None:
    scene = parse_scene(changed(HERTZ, "creepage = [1e-3, 0.0, 0.0]", "creepage = [1e-3, -2e-3, 0.4]"))
    assert isinstance(scene, HertzScene)
    motion, points = hertz_motion(scene), np.array([[0.0, 0.0, 0.0], [0.003, -0.002, 0.0]])
    upper, lower = motion.wheel.at(points), motion.rail.at(points)
    # xi - phi y and eta + phi x, over the speed of 10 m/s.
    expected = [[1e-3, -2e-3, 0.0], [1e-3 + 0.4 * 0.002, -2e-3 + 0.4 * 0.003, 0.0]]
    assert (upper - lower) / 10.0 == pytest.approx(np.array(expected), abs=1e-15)
    assert 0.5 * (upper + lower)[:, 0] == pytest.approx(-10.0, rel=1e-15)


def test_scale_of_a_sphere_on_a_plane_is_hertz() -> None:
    text = HERTZ.replace("radii = [0.46, 0.3]", "radii = [0.3, 0.3]").replace(
        "radii = [inf, 0.3]", "radii = [inf, inf]"
    )
    scene = parse_scene(text)
    assert isinstance(scene, HertzScene)
    depth = hertz_scale(scene, 10e3)
    modulus = 210e9 / (2 * 0.91)
    assert 4 / 3 * modulus * math.sqrt(0.3) * depth**1.5 == pytest.approx(10e3, rel=1e-12)


SHIFTED = HERTZ.replace("speed = 10.0", "shift = [1e-6, -2e-6]").replace("creepage = [1e-3, 0.0, 0.0]", "")


def test_exact_normal_or_tangential_law_alone() -> None:
    text = changed(HERTZ, 'laws = "paper"', 'laws = "paper"\nstiffness_per_area = inf\nregularisation = 1e-4')
    assert laws(parse_scene(text)) == ContactLaws(math.inf, 0.3, 1e-4)
    assert laws(parse_scene(text.replace("= inf\n", "= 1e14\n").replace("= 1e-4", "= 0.0"))) == ContactLaws(
        1e14, 0.3, 0.0
    )
    assert laws(parse_scene(HERTZ)) == ContactLaws.penalty(0.3)
    assert laws(parse_scene(changed(HERTZ, 'laws = "paper"', ""))) == ContactLaws() == ContactLaws(math.inf, 0.3, 0.0)
    falling = changed(HERTZ, "[upper]", "[falling]\nshare = 0.4\nrate = 0.6\n[upper]")
    assert laws(parse_scene(falling)) == ContactLaws(1e15, FallingFriction(0.3, 0.4, 0.6), 1e-5)


def test_default_laws_of_a_run_are_the_papers() -> None:
    assert laws(parse_scene(changed(CURVE, 'laws = "paper"', ""), FOLDER / "paper_curve.toml")) == ContactLaws.penalty(
        0.3
    )


def test_a_shift_moves_the_bodies_apart_and_needs_coulomb() -> None:
    with pytest.raises(SceneError, match="Coulomb"):
        parse_scene(SHIFTED)
    scene = parse_scene(changed(SHIFTED, 'laws = "paper"', ""))
    assert isinstance(scene, HertzScene)
    motion = hertz_motion(scene)
    np.testing.assert_allclose(motion.wheel.velocity - motion.rail.velocity, [1e-6, -2e-6, 0.0], rtol=1e-12)
    law = 'friction = {law = "coulomb", mu = 0.3}'
    parse_scene(changed(changed(SHIFTED, 'laws = "paper"', ""), "friction = 0.3", law))
    with pytest.raises(SceneError, match="condensed"):
        parse_scene(changed(changed(SHIFTED, 'laws = "paper"', ""), 'model = "condensed"', 'model = "full"'))


EXACT = changed(HERTZ, 'laws = "paper"', 'laws = "exact"')


def test_strips_are_the_default_with_exact_laws() -> None:
    """Default points for waveguides and the exact normal law."""
    half = 'laws = "paper"\nstiffness_per_area = inf'
    for text, points in (
        (HERTZ, "grid"),
        (EXACT, "lattice"),
        (changed(EXACT, 'laws = "exact"', 'laws = "exact"\npoints = "grid"'), "grid"),
        (changed(EXACT, 'model = "condensed"', 'model = "full"'), "grid"),
        (changed(HERTZ, 'laws = "paper"', half), "grid"),
        (changed(HERTZ, 'laws = "paper"', half + '\nbodies = "waveguide"'), "lattice"),
        (changed(EXACT, 'laws = "exact"', 'laws = "exact"\nbodies = "half-space"'), "lattice"),
        (CURVE, "grid"),
        (changed(CURVE, 'laws = "paper"', 'laws = "exact"'), "lattice"),
    ):
        assert parse_scene(text).discretisation.points == points
    fine = parse_scene(changed(EXACT, 'laws = "exact"', 'laws = "exact"\nstrips = 8\ncells = 20'))
    assert (fine.strips, fine.cells) == (8, 20)


def test_stress_names_the_bodies_of_its_scene() -> None:
    asked = parse_scene(HERTZ + "\n[stress]\ndepths = [1e-3, 2e-3]")
    assert isinstance(asked, HertzScene)
    assert asked.stress is not None
    assert asked.stress.bodies == ("upper", "lower")
    wheelset = parse_scene(WHEELSET + '\n[stress]\nbody = "rail"\ndepths = [2e-3]')
    assert isinstance(wheelset, WheelsetScene)
    assert wheelset.stress is not None
    assert wheelset.stress.bodies == ("rail",)
    assert parse_scene(EXACT).stress is None  # type: ignore[union-attr]


# (scene, what to replace, by what, what the error must say: key, value and what is allowed)
MALFORMED = [
    (HERTZ, 'kind = "hertz"', "", ("kind: missing", "'hertz', 'wheelset', 'run'")),
    (HERTZ, 'kind = "hertz"', 'kind = "herz"', ("kind = 'herz'", "'hertz'")),
    (HERTZ, 'kind = "hertz"', "kind = 3", ("kind = 3",)),
    (HERTZ, "load = 10e3", "load = ", ("not valid TOML", "line 4")),
    (HERTZ, "load = 10e3", "load = 10e3\nload = 2", ("not valid TOML", "line 5")),
    (HERTZ, "load = 10e3", "", ("load: missing", "exactly one of load and approach")),
    (HERTZ, "load = 10e3", "load = 10e3\napproach = 25e-6", ("load = 10000.0", "exactly one")),
    (HERTZ, "load = 10e3", "approach = 25", ("approach = 25", "µm")),
    (HERTZ, "load = 10e3", "load = -10e3", ("load = -10000.0", "from 0.001 to 1e+08 N")),
    (HERTZ, "load = 10e3", 'load = "10e3"', ('load = "10e3"', "a number from")),
    (HERTZ, "load = 10e3", "load = nan", ("load = NaN", "a number from")),
    (HERTZ, "load = 10e3", "load = 10e3\nlaod = 3", ("laod = 3: unknown key; did you mean load?",)),
    (HERTZ, "friction = 0.3", "", ("friction: missing", "from 0 to 2")),
    (HERTZ, "friction = 0.3", "friction = -0.1", ("friction = -0.1", "from 0 to 2")),
    (HERTZ, "friction = 0.3", "friction = true", ("friction = true", "a number from 0 to 2")),
    (HERTZ, "speed = 10.0", "speed = 0", ("speed = 0", "0.001 to 200 m/s")),
    (HERTZ, "speed = 10.0", "", ("speed: missing", "friction is not 0")),
    (HERTZ, "creepage = [1e-3, 0.0, 0.0]", "creepage = [1e-3, 0.0]", ("creepage", "missing", "rad/m")),
    (HERTZ, "creepage = [1e-3, 0.0, 0.0]", "creepage = 1e-3", ("creepage = 0.001", "an array of 3")),
    (HERTZ, "creepage = [1e-3, 0.0, 0.0]", "creepage = [1e-3, inf, 0.0]", ("creepage[1] = Infinity", "from -1 to 1")),
    (HERTZ, "surface_size = 0.5e-3", "surface_size = 0.5", ("surface_size = 0.5", "5e-05 to 0.01 m", "0.5e-3")),
    (HERTZ, "surface_size = 0.5e-3", "surface_size = 1e-6", ("surface_size = 1e-06",)),
    (HERTZ, 'model = "condensed"', 'model = "condense"', ('model = "condense"', '"condensed" or "full"')),
    (HERTZ, 'laws = "paper"', 'laws = "hertz"', ('laws = "hertz"', '"paper"', '"exact"')),
    (HERTZ, 'laws = "paper"', "stiffness_per_area = nan", ("stiffness_per_area = NaN", "inf, the exact law")),
    (HERTZ, "friction = 0.3", "friction = 0.3\nshift = [1e-6, 0.0]", ("speed = 10.0", "combined with shift")),
    (HERTZ, "speed = 10.0 ", "shift = [1.0, 0.0] ", ("shift[0] = 1.0", "µm")),
    (HERTZ, "[upper]", "[falling]\nshare = 40\nrate = 0.6\n[upper]", ("falling.share = 40", "from 0 to 1")),
    (HERTZ, "[upper]", "[falling]\nshare = 0.4\n[upper]", ("falling.rate: missing", "s/m")),
    (
        HERTZ,
        'laws = "paper"',
        'laws = "exact"\nregularisation = 1e-5',
        ("regularisation = 1e-05", 'laws = "paper"'),
    ),
    (HERTZ, 'laws = "paper"', 'points = "regular"', ('points = "regular"', '"lattice" or "grid"')),
    (EXACT, 'laws = "exact"', 'laws = "exact"\npoints = "fitted"', ('points = "fitted"', '"lattice" or "grid"')),
    (EXACT, 'model = "condensed"', 'model = "full"\npoints = "lattice"', ('points = "lattice"', "waveguide")),
    (HERTZ, 'laws = "paper"', 'laws = "paper"\nbodies = "half-space"', ('bodies = "half-space"', "exact normal law")),
    (EXACT, 'model = "condensed"', 'model = "full"\nbodies = "half-space"', ('bodies = "half-space"', '"solid"')),
    (HERTZ, 'laws = "paper"', 'laws = "paper"\nstrips = 8', ("strips = 8", 'points = "lattice"')),
    (HERTZ, 'laws = "paper"', 'laws = "paper"\npoints = "lattice"', ('points = "lattice"', "waveguide", '"exact"')),
    (EXACT, 'laws = "exact"', "cells = 4", ("cells = 4", "from 6 to 64")),
    (EXACT, 'laws = "exact"', "cells = 12.5", ("cells = 12.5", "from 6 to 64")),
    (EXACT, 'laws = "exact"', "slip_order = 1", ("slip_order = 1", 'points = "grid"')),
    (EXACT, 'laws = "exact"', "error_estimate = 1", ("error_estimate = 1", "true or false")),
    (HERTZ, 'laws = "paper"', 'laws = "paper"\nerror_estimate = true', ("error_estimate = true", 'points = "lattice"')),
    (CURVE, 'laws = "paper"', 'laws = "exact"\nerror_estimate = true', ("error_estimate = true: unknown key",)),
    (HERTZ, "[upper]", "[stress]\ndepths = []\n[upper]", ("stress.depths = []", "below the surface")),
    (HERTZ, "[upper]", "[stress]\ndepths = [2]\n[upper]", ("stress.depths[0] = 2", "2 mm is 2e-3")),
    (HERTZ, "[upper]", '[stress]\nbody = "rail"\ndepths = [1e-3]\n[upper]', ('"upper" or "lower" or "both"',)),
    (WHEELSET, "[track]", '[stress]\nbody = "upper"\ndepths = [1e-3]\n[track]', ('"wheel" or "rail" or "both"',)),
    (HERTZ, "radii = [0.46, 0.3]", "radii = [0.46, 0.0]", ("upper.radii[1] = 0.0", "inf is straight")),
    (HERTZ, "radii = [0.46, 0.3]", "radii = [nan, 0.3]", ("upper.radii[0] = NaN",)),
    (
        HERTZ,
        "radii = [0.46, 0.3]",
        "radii = [0.46, -0.2]",
        ("upper.radii = [0.46, -0.2]", "in y must be greater than 0"),
    ),
    (HERTZ, "radii = [0.46, 0.3]", "radii = [inf, 0.3]", ("upper.radii", "in x must be greater than 0")),
    (HERTZ, "radii = [0.46, 0.3]", "radii = [0.46, 0.3, 1.0]", ("upper.radii", "an array of 2")),
    (HERTZ, "E = 210e9", "E = 210", ("upper.E = 210", "1e+09 to 1e+13 Pa", "GPa")),
    (HERTZ, "E = 210e9", "E = 210e3", ("upper.E = 210000.0", "MPa")),
    (HERTZ, "nu = 0.3", "nu = 0.5", ("upper.nu = 0.5", "between -1 and 0.5, ends excluded")),
    (HERTZ, "nu = 0.3", "nu = 0.3\nG = 8e10", ("upper.G = 80000000000.0: unknown key", "allowed are radii, E, nu")),
    (HERTZ, "[lower]", "[lwoer]", ("lwoer: unknown key; did you mean lower?",)),
    (WHEELSET, 'sides = ["left", "right"]', "sides = []", ("sides = []", '"left" or "right"')),
    (WHEELSET, 'sides = ["left", "right"]', 'sides = ["left", "middle"]', ('sides[1] = "middle"', '"left" or "right"')),
    (WHEELSET, 'sides = ["left", "right"]', 'sides = ["left", "left"]', ("sides = ", "at most once")),
    (WHEELSET, '"S1002" ', '"S1003" ', ('profiles.wheel = "S1003"', "S1002", "file")),
    (WHEELSET, '"S1002" ', '"60E1" ', ('profiles.wheel = "60E1"', "must be S1002")),
    (WHEELSET, "laying_angle = 0.0", "laying_angle = 40", ("profiles.laying_angle = 40", "1/40 is 0.025")),
    (WHEELSET, "gauge = 1.435", "gauge = 1435", ("track.gauge = 1435", "0.5 to 2 m")),
    (WHEELSET, "gauge_height = 0.014", "gauge_height = 14", ("track.gauge_height = 14", "14 mm is 0.014")),
    (WHEELSET, "curvature = 0.0", "curvature = 1200", ("track.curvature = 1200", "1/radius")),
    (WHEELSET, "[track]", "speed = 45\n[track]", ("profiles.speed = 45: unknown key; did you mean wheelset.speed?",)),
    (WHEELSET, "flange_back = -0.070", "flange_back = 0.070", ("wheelset.flange_back = 0.07", "negative")),
    (WHEELSET, "y = -0.002", "y = -2", ("wheelset.y = -2", "2 mm is 0.002")),
    (WHEELSET, "roll = 0.0", 'roll = "solv"', ('wheelset.roll = "solv"', '"solve"')),
    (WHEELSET, "yaw = 0.0", "yaw = 3", ("wheelset.yaw = 3", "rad")),
    (WHEELSET, "wheel_load = 57e3", "wheel_load = 57e3\nz = 0.0", ("wheelset.z = 0.0", "exactly one")),
    (WHEELSET, "pitch_rate = 97.82608695652173", "pitch_rate = 934", ("pitch_rate = 934", "pure rolling (97.8261")),
    (
        CURVE,
        "transition_length = 100.0",
        "transition_length = 0.0",
        ("track.transition_length = 0.0", "greater than 0"),
    ),
    (CURVE, "cant = 0.06 ", "cant = 60 ", ("track.cant = 60", "60 mm is 0.06")),
    (
        CURVE,
        'transition = "quintic"',
        'transition = "cubic"',
        ('track.transition = "cubic"', '"quintic" or "clothoid" or "bloss"'),
    ),
    (CURVE, "speed = 45.0", "speed = 450.0", ("vehicle.speed = 450.0", "162 km/h")),
    (CURVE, "speed = 45.0", "speed = 45.0\nmass = 3", ("vehicle.mass = 3: unknown key", "car_body")),
    (CURVE, "speed = 45.0", "speed = 45.0\ncar_body = {mass = -1}", ("vehicle.car_body.mass = -1", "positive")),
    (CURVE, "speed = 45.0", 'speed = 45.0\nroll_bar = "x"', ('vehicle.roll_bar = "x"', "a number")),
    (CURVE, 'method = "ode23"', 'method = "ode15s"', ('solver.method = "ode15s"', '"ode23" or "ode45"')),
    (CURVE, "speed = 45.0", "speed = [[0.0, 45.0], [5.0, 450.0]]", ("vehicle.speed[1][1] = 450.0", "162 km/h")),
    (CURVE, "speed = 45.0", "speed = [[5.0, 45.0], [5.0, 40.0]]", ("vehicle.speed = ", "times must increase")),
    (CURVE, "tangent = 50.0", "", ("track.tangent: missing", "without segments")),
    (IRREGULAR, "radius = 800.0", "radius = 8.0", ("track.segments[2].radius = 8.0", "at least 15")),
    (
        IRREGULAR,
        "radius = 800.0",
        "radius = 800.0\ncurvature = 1e-3",
        ("segments[2].radius = 800.0", "combined with curvature"),
    ),
    (IRREGULAR, "cant = 0.08 ", "cant = 0.8 ", ("track.segments[2].cant = 0.8", "60 mm is 0.06")),
    (IRREGULAR, "vertical_radius = 4000.0", "", ("track.segments[3].vertical_radius: missing", "gradient changes")),
    (
        IRREGULAR,
        "cant = 0.06",
        'shape = "bloss"',
        ('track.segments[4].shape = "bloss"', 'only with kind = "transition"'),
    ),
    (IRREGULAR, "cant_base = 1.5", "cant_base = 1.5\ntangent = 5.0", ("track.tangent = 5.0", "combined with segments")),
    (IRREGULAR, 'kind = "arc"', 'kind = "tangent"', ("track.segments[2].radius = 800.0", "left out for a tangent")),
    (IRREGULAR, 'spectrum = "low"', 'spectrum = "medium"', ('spectrum = "medium"', '"low" or "high"')),
    (IRREGULAR, 'spectrum = "low"', 'file = "none.csv"', ('irregularities.file = "none.csv"', "cannot be read")),
    (IRREGULAR, "seed = 1", "seed = -1", ("track.irregularities.seed = -1", "from 0")),
    (IRREGULAR, "[3.0, 100.0]", "[100.0, 3.0]", ("irregularities.wavelengths", "increasing order")),
    (IRREGULAR, "fade = 10.0", "fade = 500.0", ("track.irregularities.fade = 500.0", "track length of 160 m")),
    (CURVE, "rtol = 1e-3", "rtol = 0.0", ("solver.rtol = 0.0", "1e-12")),
]


@pytest.mark.parametrize(
    ("text", "old", "new", "says"), MALFORMED, ids=lambda value: value[:30] if isinstance(value, str) else ""
)
def test_malformed_scene_gives_one_error(text: str, old: str, new: str, says: tuple[str, ...], tmp_path: Path) -> None:
    file = tmp_path / "scene.toml"
    file.write_text(changed(text, old, new))
    with pytest.raises(SceneError) as caught:
        load_scene(file)
    message = str(caught.value)
    assert str(file) in message
    for part in says:
        assert part in message
    assert "pydantic" not in message


def test_short_form_and_segments_of_a_track(tmp_path: Path) -> None:
    short, long = parse_scene(CURVE), parse_scene(IRREGULAR)
    assert isinstance(short, RunScene)
    assert isinstance(long, RunScene)
    again = Track.curve(curvature=8.333333333333333e-4, cant=0.06, tangent=50.0, transition=100.0, length=200.0)
    assert (short.track.track(), short.vehicle.speed_profile) == (again, 45.0)
    made = long.track.track()
    assert made.curvature.values == (0.0, 1 / 800, 1 / 800, -1 / 1000)
    assert made.curvature.shape == ("bloss", "quintic", "bloss")
    assert made.irregularities is not None
    assert np.abs(made.irregularities.at(np.array([long.track.length]))).max() > 0.0
    assert isinstance(long.vehicle.speed_profile, SpeedProfile)
    assert long.vehicle.speed_profile(10.0).speed == 34.0
    (tmp_path / "measured.csv").write_text("s, level [mm]\n" + "".join(f"{s}, 1\n" for s in range(200)))
    text = changed(IRREGULAR, 'spectrum = "low"', 'file = "measured.csv"')
    for line in ("seed = 1", "wavelengths = [3.0, 100.0]"):
        with pytest.raises(SceneError, match="only with spectrum"):
            parse_scene(text, tmp_path / "scene.toml")
        text = changed(text, line, "")
    measured = parse_scene(text, tmp_path / "scene.toml")
    assert isinstance(measured, RunScene)
    uneven = measured.track.track().irregularities
    assert uneven is not None
    np.testing.assert_allclose(uneven.at(np.array([100.0])), [[0.0, 1e-3, 0.0, 0.0]], atol=1e-12)


@pytest.mark.parametrize("line", ["wheel_load = 57e3", "axle_load = 114e3", "z = -0.0002"])
def test_solving_for_roll_needs_both_wheel_loads(line: str) -> None:
    text = changed(changed(WHEELSET, "wheel_load = 57e3", line), "roll = 0.0", 'roll = "solve"')
    if line.startswith("wheel_load"):
        assert isinstance(parse_scene(text), WheelsetScene)
        text = changed(text, 'sides = ["left", "right"]', 'sides = ["left"]')
    with pytest.raises(SceneError, match=r"roll|sides"):
        parse_scene(text)


def test_axle_load_needs_both_sides() -> None:
    text = changed(WHEELSET, "wheel_load = 57e3", "axle_load = 114e3")
    parse_scene(text)
    with pytest.raises(SceneError, match="sides"):
        parse_scene(changed(text, 'sides = ["left", "right"]', 'sides = ["right"]'))


def test_profile_paths_are_relative_to_the_scene(tmp_path: Path) -> None:
    (tmp_path / "worn.whl").write_text(lines(WHEEL))
    file = tmp_path / "scene.toml"
    file.write_text(changed(WHEELSET, '"S1002" ', '"worn.whl" '))
    scene = load_scene(file)
    assert isinstance(scene, WheelsetScene)
    assert scene.profiles.wheel == str(tmp_path / "worn.whl")


@pytest.mark.parametrize("content", [None, b"\xff\xfe\x00"])
def test_unreadable_file(content: bytes | None, tmp_path: Path) -> None:
    file = tmp_path / "scene.toml"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(SceneError, match=r"cannot be read|UTF-8"):
        load_scene(file)


def test_vehicle_overrides_reach_into_the_wagon() -> None:
    stop = [[0, 0], [0.02, 0], [0.03, 5e3]]
    wagon = overridden(Wagon(), {"roll_bar": 1e6, "secondary": {"turn": 0.5}, "bumpstop": stop})
    assert (wagon.roll_bar, wagon.secondary.turn, float(wagon.bumpstop(0.03))) == (1e6, 0.5, 5e3)
    assert wagon.secondary.lateral_stiffness == Wagon().secondary.lateral_stiffness


def test_reading_a_hertz_scene_loads_no_numerics() -> None:
    code = (
        "import sys; from wheelrail.scenes.schema.scene import load_scene; load_scene(sys.argv[1]);"
        "print(*{'numpy', 'scipy', 'dolfinx', 'gmsh', 'xarray', 'matplotlib', 'petsc4py'} & set(sys.modules))"
    )
    run = subprocess.run(
        [sys.executable, "-c", code, str(FOLDER / "hertz.toml")], capture_output=True, text=True, check=True
    )
    assert run.stdout.split() == []


def standard(text: str, *more: str) -> str:
    return changed(text, 'model = "condensed"', "\n".join(['model = "standard"', *more]))


def test_standard_model_accepts_scenes_of_other_models() -> None:
    for text in (HERTZ, WHEELSET, CURVE):
        scene = parse_scene(standard(text), FOLDER / "scene.toml")
        assert (scene.model, scene.normal, scene.tangential) == ("standard", None, None)
        assert laws(scene) == ContactLaws(friction=0.3)  # for any laws of the elastic models
    bare = standard(changed(WHEELSET, "surface_size = 1e-3", ""), 'normal = "hertz"', "merge_distance = 6e-3")
    contact = wheelset_contact(parse_scene(bare))
    assert isinstance(contact.model, StandardContact)
    assert (contact.model.normal, contact.model.tangential) == ("hertz", "fastsim")
    assert contact.model.surfaces.merge_distance == 6e-3  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (changed(HERTZ, "surface_size = 0.5e-3", ""), ("surface_size", 'unless model = "standard"')),
        (changed(HERTZ, 'laws = "paper"', 'normal = "hertz"'), ('normal = "hertz"', 'model = "standard"')),
        (standard(HERTZ, 'tangential = "kalker"'), ('tangential = "kalker"', '"fastsim" or "polach"')),
        (standard(HERTZ, "merge_distance = 4e-3"), ("merge_distance", "one contact point")),
        (standard(WHEELSET, "merge_distance = 4.0"), ("merge_distance = 4.0", "4 mm is 4e-3")),
        (standard(WHEELSET, 'points = "grid"'), ('points = "grid"', "no elements")),
        (standard(CURVE, "strips = 8"), ("strips = 8", "no elements")),
        (standard(WHEELSET, "error_estimate = true"), ("error_estimate = true", 'points = "lattice"')),
        (standard(WHEELSET) + "\n[stress]\ndepths = [1e-3]", ("stress", '"condensed" or "full"')),
    ],
)
def test_keys_of_other_models_are_rejected(text: str, says: tuple[str, ...]) -> None:
    with pytest.raises(SceneError) as caught:
        parse_scene(text)
    for part in says:
        assert part in str(caught.value)


def test_the_standard_model_reports_and_draws(tmp_path: Path) -> None:
    scene = parse_scene(standard(WHEELSET, 'tangential = "fastsim"'))
    assert isinstance(scene, WheelsetScene)
    data = solve_contact(scene)
    report = contact_report(data)
    assert (report["normal"], report["tangential"]) == ("kik-piotrowski", "fastsim")
    assert report["left"]["force"][2] == pytest.approx(57e3, rel=1e-6)
    assert "laws" not in report
    text = StringIO()
    Console(file=text, width=120).print(table(data))
    assert "standard model, kik-piotrowski normal, fastsim tangential: converged" in text.getvalue()
    draw_patches(data, tmp_path / "patches.png")
    assert (tmp_path / "patches.png").stat().st_size > 10_000


def test_a_wheelset_scene_needs_no_more_keys_than_python() -> None:
    """Every default of `wheelrail.Wheelset`, alone and with single keys."""
    for keys, arguments, solve in (
        ("", {}, {}),
        ("friction = 0.0\n", {"friction": 0.0}, {}),
        ('model = "standard"\n', {"model": "standard"}, {}),
        ('[profiles]\nrail = "UIC60-benchmark"\n', {"rail": "UIC60-benchmark"}, {}),
        ("[wheelset]\ny = 1e-3\nz = -1e-4\nspeed = 45.0\n", {}, {"y": 1e-3, "z": -1e-4, "speed": 45.0}),
    ):
        scene = parse_scene(f'kind = "wheelset"\n{keys}')
        wheelset = wr.Wheelset(**arguments)
        load = {} if "z" in solve else {"wheel_load": 57e3}
        assert scene.model_dump() == wheelset._scene({**load, **solve}).model_dump()


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("wheelset = 3", "wheelset"),
        ('wheelset = {radius = "large"}', "wheelset.radius"),
        ("friction = [1]", "friction"),
        ('track = "straight"', "track"),
        ("profiles = {rail = 7}", "profiles.rail"),
        ("wheelset = {radius = 0}", "wheelset.radius"),
    ],
)
def test_defaults_leave_wrong_types_to_the_messages(text: str, says: str) -> None:
    with pytest.raises(SceneError, match=says):
        parse_scene(f'kind = "wheelset"\n{text}')


def test_inputs_of_a_run_hold_only_what_it_uses() -> None:
    text = (FOLDER / "curve.toml").read_text()
    elastic = inputs(parse_scene(text))
    assert not {"normal", "tangential", "merge_distance", "stiffness_per_area", "regularisation"} & set(elastic)
    assert not {"cell", "slip_order", "falling", "normal_law"} & set(elastic)
    assert (elastic["bodies"], elastic["points"], elastic["strips"], elastic["cells"]) == (
        "waveguide",
        "lattice",
        6,
        10,
    )
    assert "segments" not in elastic["track"]
    assert elastic["solver"]["rtol"] == 4.5e-3
    standard = inputs(parse_scene(with_model(text, "standard")))
    assert not {"laws", "surface_size", "bodies", "points", "strips", "regularisation"} & set(standard)
    assert standard["model"] == "standard"
    paper = inputs(load_scene(FOLDER / "paper_curve.toml"))
    assert {"stiffness_per_area", "regularisation", "cell", "slip_order"} <= set(paper)
    assert not {"strips", "cells"} & set(paper)
