"""Wagons as TOML files: shipped ones, round trip, use in scenes, and invalid files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from wheelrail.cli.main import app
from wheelrail.scenes.builders.vehicle import wagon as wagon_of
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene, parse_scene
from wheelrail.scenes.schema.toml import parse
from wheelrail.scenes.schema.wagon_file import load_wagon, wagon_toml
from wheelrail.vehicle.multibody.coordinates import Coordinates
from wheelrail.vehicle.multibody.plane_wagon import plane_vehicle
from wheelrail.vehicle.wagon.force_law import ForceLaw
from wheelrail.vehicle.wagon.wagon import PRIMARY, Wagon

FOLDER = Path(__file__).parents[2] / "scenes"
CURVE = (FOLDER / "paper_curve.toml").read_text()
SPEED = "speed = 45.0 "
OTHER = replace(
    Wagon(),
    gravity=9.80665,
    primary=replace(
        PRIMARY,
        lateral_stiffness=ForceLaw(((-0.01, -1e5 / 3), (0.0, 0.0), (0.02, 0.1e5))),
        vertical_damping=ForceLaw(((0.0, 0.0), (0.1, 1e3), (1.0, 2e3))),
        vertical_series_stiffness=1e16,
    ),
)


def keys(table: dict[str, object], prefix: str = "") -> set[str]:
    inner = [keys(value, f"{prefix}{key}.") for key, value in table.items() if isinstance(value, dict)]
    return {f"{prefix}{key}" for key in table}.union(*inner)


def test_shipped_wagon_is_the_built_in_one_and_complete() -> None:
    file = FOLDER / "manchester_wagon.toml"
    assert load_wagon(file) == Wagon()
    assert keys(parse(file.read_text(), file)) == keys(parse(wagon_toml(Wagon()), "text"))


def test_shipped_maxwell_elements() -> None:
    found = load_wagon(FOLDER / "manchester_series.toml")
    stages = found.primary, found.secondary
    values = [(stage.lateral_series_stiffness, stage.vertical_series_stiffness) for stage in stages]
    assert values == [(7.5e6, 1e6), (6e6, 6e6)]
    assert len(Coordinates(plane_vehicle(found)).maxwell) == 8
    assert replace(found, primary=Wagon().primary, secondary=Wagon().secondary) == Wagon()


@pytest.mark.parametrize("wagon", [Wagon(), OTHER], ids=["manchester", "other"])
def test_wagon_file_round_trip(wagon: Wagon, tmp_path: Path) -> None:
    file = tmp_path / "wagon.toml"
    text = wagon_toml(wagon)
    file.write_text(text)
    assert load_wagon(file) == wagon
    assert "None" not in text  # every value has its unit


def test_scene_overrides_values_of_a_wagon_file(tmp_path: Path) -> None:
    (tmp_path / "my.toml").write_text("roll_bar = 1e6\n[car_body]\nmass = 40e3\n[secondary]\nturn = 0.5\n")
    text = CURVE.replace(SPEED, 'wagon = "my.toml"\ncar_body = {mass = 36e3}\n' + SPEED)
    scene = parse_scene(text, tmp_path / "scene.toml")
    assert isinstance(scene, RunScene)
    found = wagon_of(scene)
    assert (found.roll_bar, found.secondary.turn, found.car_body.mass) == (1e6, 0.5, 36e3)
    assert found.bogie == Wagon().bogie
    plain = parse_scene(CURVE)
    assert isinstance(plain, RunScene)
    assert wagon_of(plain) == Wagon()
    assert plain.vehicle.changed is False


def test_wheel_radius_of_wagon_and_scene_must_agree(tmp_path: Path) -> None:
    smaller = CURVE.replace("radius = 0.46 ", "radius = 0.42 ")
    scene = parse_scene(smaller.replace(SPEED, "roll_bar = 1e6\n" + SPEED))
    assert isinstance(scene, RunScene)
    assert wagon_of(scene).radius == 0.42
    (tmp_path / "my.toml").write_text("[wheelset]\nheight = 0.46\n")
    with pytest.raises(SceneError, match=r"vehicle: wheelset\.height .* wheelset\.radius"):
        parse_scene(smaller.replace(SPEED, 'wagon = "my.toml"\n' + SPEED), tmp_path / "scene.toml")
    with pytest.raises(SceneError, match=r"vehicle: wheelset\.height .* wheelset\.radius"):
        parse_scene(smaller.replace(SPEED, "wheelset = {height = 0.46}\n" + SPEED))


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("mass = 3", ("mass = 3: unknown key", "car_body")),
        ("[primary]\nlateral_stifness = 3", ("primary.lateral_stifness = 3: unknown key", "lateral_stiffness")),
        ("roll_bar = '1e3'", ('roll_bar = "1e3": must be a number',)),
        ("roll_bar = nan", ("roll_bar = NaN: must be zero or positive and finite",)),
        ("bumpstop = 1e3", ("bumpstop = 1000.0: must be an array of points",)),
        ("bumpstop = [[-1, -1], [0, 0]]", ("bumpstop = [[-1, -1], [0, 0]]: must be an odd law",)),
        ("car_body = 3", ("car_body = 3: must be a table",)),
        ("[car_body]\nheight = 0.5", ("car_body", "greater than that of the bogie")),
        (
            "[secondary]\nlateral_stiffness = 1e5\nturn = 0.1\nlateral_damping = -1",
            ("secondary.lateral_damping = -1: must be zero or positive and finite",),
        ),
        ("[secondary]\nturn = 2", ("secondary.turn = 2: must be between 0 and 1",)),
        (
            "[secondary]\nlateral_damping = [[0, 0], [0.1, 5], [0.1, 6]]",
            ("secondary.lateral_damping = [[0, 0], [0.1, 5], [0.1, 6]]: must be points with strictly increasing",),
        ),
        (
            "[secondary]\nvertical_stiffness = [[0, 0, 1], [1, 1, 1]]",
            ("secondary.vertical_stiffness = ", "an array of points, each [deflection or velocity, force]"),
        ),
        ("[secondary]\nvertical_stiffness = true", ("secondary.vertical_stiffness = true", "a number or an array")),
        (
            "[secondary]\nlateral_damping = 0\nlateral_series_stiffness = 6e6",
            ("secondary.lateral_series_stiffness = 6000000.0: must be inf, unless", "increases"),
        ),
        ("[primary", ("not valid TOML",)),
    ],
)
def test_errors_name_file_key_value_and_allowed_values(text: str, says: tuple[str, ...], tmp_path: Path) -> None:
    file = tmp_path / "my.toml"
    file.write_text(text)
    scene = CURVE.replace(SPEED, 'wagon = "my.toml"\n' + SPEED)
    for read in (lambda: load_wagon(file), lambda: parse_scene(scene, tmp_path / "scene.toml")):
        with pytest.raises(SceneError) as error:
            read()
        for part in (str(file), *says):
            assert part in str(error.value)
    assert 'vehicle.wagon = "my.toml"' in str(error.value)


def test_missing_wagon_file(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r'vehicle\.wagon = "nowhere\.toml".*cannot be read'):
        parse_scene(CURVE.replace(SPEED, 'wagon = "nowhere.toml"\n' + SPEED), tmp_path / "scene.toml")


def test_the_command_prints_a_wagon(tmp_path: Path) -> None:
    done = CliRunner().invoke(app, ["wagon"])
    assert (done.exit_code, done.stdout) == (0, wagon_toml(Wagon()))
    file = tmp_path / "my.toml"
    file.write_text("roll_bar = 5e5\n")
    assert "roll_bar = 500000.0  # N m/rad" in CliRunner().invoke(app, ["wagon", str(file)]).stdout
    file.write_text("roll_bar = -5e5\n")
    refused = CliRunner().invoke(app, ["wagon", str(file)])
    assert (refused.exit_code, refused.stdout) == (2, "")
