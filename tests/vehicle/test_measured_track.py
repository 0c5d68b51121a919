"""Measured tracks: columns of rails, contradictions, gaps, bands, chords, standard deviations."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import trapezoid

from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.irregularity_file import IrregularityFileError, Measurement, read_irregularities
from wheelrail.scenes.schema.scene import RunScene, checked
from wheelrail.scenes.schema.toml import parse
from wheelrail.vehicle.track.irregularity import RAILS
from wheelrail.vehicle.track.irregularity_spectrum import ERRI
from wheelrail.vehicle.track.measured_track import (
    BANDS,
    MeasurementError,
    band_passed,
    chord_response,
    quantities,
    without_gaps,
)
from wheelrail.vehicle.track.track_quality import quality, quality_class, spectral_density

S, LONG = np.arange(0.0, 400.0, 0.25), np.arange(0.0, 1200.0, 0.5)


def track(seed: int = 3) -> np.ndarray:
    """The four quantities (n, 4) of a realisation."""
    return ERRI["low"].irregularities(420.0, seed=seed).at(S)


def measured(values: np.ndarray) -> dict[str, np.ndarray]:
    """What a car measures of the rails, by their displacements."""
    left_y, left_z, right_y, right_z = (values @ RAILS.T).T
    return {"alignment_left": left_y, "level_left": left_z, "alignment_right": right_y, "level_right": right_z}


@pytest.mark.parametrize("seed", range(3))
def test_columns_of_the_rails_give_the_four_quantities(seed: int) -> None:
    values = track(seed)
    columns = measured(values)
    np.testing.assert_allclose(quantities(S, columns), values, atol=1e-15)
    redundant = columns | {"cross_level": values[:, 2] + 1e-5, "gauge": values[:, 3]}
    half = 1.5
    twist = (np.interp(S + half, S, values[:, 2]) - np.interp(S - half, S, values[:, 2])) / 3.0
    np.testing.assert_allclose(quantities(S, redundant | {"twist": twist})[:, 2], values[:, 2] + 1e-5, atol=1e-15)
    one = {
        "level_left": columns["level_left"],
        "cross_level": values[:, 2],
        "alignment_right": columns["alignment_right"],
    }
    np.testing.assert_allclose(quantities(S, one | {"gauge": values[:, 3]}), values, atol=1e-15)


def test_contradicting_and_missing_columns_are_refused() -> None:
    values = track()
    columns = measured(values)
    for name, column, said in (
        ("cross_level", -values[:, 2], "cross_level and level_left and level_right contradict"),
        ("gauge", values[:, 3] + 2e-3 * np.sin(S), "gauge and alignment_left and alignment_right contradict"),
        ("level", 0.3 * values[:, 1], "level and level_left and level_right contradict"),
        ("twist", np.gradient(values[:, 2]), r"twist and the change of cross level over 3 m contradict .* mm/m"),
    ):
        with pytest.raises(MeasurementError, match=said):
            quantities(S, columns | {name: column})
    with pytest.raises(MeasurementError, match="column level_right: needs level_left or cross_level"):
        quantities(S, {"level_right": values[:, 1]})
    with pytest.raises(MeasurementError, match="column twist: needs cross_level"):
        quantities(S, {"level": values[:, 1], "twist": values[:, 2]})


def test_a_band_keeps_its_waves_and_no_others() -> None:
    """Sines inside and outside of D1, with steps that vary: amplitudes and phases far from the ends, where it rings."""
    random = np.random.default_rng(2)
    uneven = np.sort(LONG + random.uniform(-0.05, 0.05, len(LONG)))
    inside, outside = np.sin(2 * np.pi * uneven / 7.0), np.sin(2 * np.pi * uneven / 60.0 + 1.0)
    stations, found = band_passed(uneven, np.stack([inside + outside, outside], 1), BANDS["D1"])
    middle = (stations > 500.0) & (stations < 700.0)
    np.testing.assert_allclose(found[middle, 0], np.sin(2 * np.pi * stations[middle] / 7.0), atol=5e-3)
    assert np.abs(found[middle, 1]).max() < 3e-3
    with pytest.raises(MeasurementError, match="must be at most a quarter of the shortest wavelength, 3 m"):
        band_passed(np.arange(0.0, 100.0, 1.0), np.zeros((100, 1)), BANDS["D1"])


@pytest.mark.parametrize("parts", [(5.0, 5.0), (2.6, 6.0), (4.0, 7.0)])
def test_chords_are_corrected(parts: tuple[float, float]) -> None:
    """Offsets from a chord, from the track itself; corrected in a band that the chord sees."""
    band = (6.5, 25.0)
    level = ERRI["low"].irregularities(1220.0, seed=3, wavelengths=(6.5, 25.0))
    true, before, after = (level.at(LONG + shift)[:, 1] for shift in (0.0, -parts[0], parts[1]))
    behind, ahead = parts
    offset = true - (ahead * before + behind * after) / (behind + ahead)
    found = band_passed(LONG, offset[:, None], band, parts)[1][:, 0]
    inside = (LONG > 300.0) & (LONG < 900.0)
    assert np.abs(found - true)[inside].max() < 0.01 * np.abs(true).max()
    assert np.abs(offset - true)[inside].max() > 0.2 * np.abs(true).max()
    np.testing.assert_allclose(abs(chord_response(np.array([1 / 10.0]), (5.0, 5.0))), 2.0)
    with pytest.raises(
        MeasurementError, match=r"chord of 5 \+ 5 m: shows waves of 4\.\d+ to 5\.\d+ m by less than 25 %"
    ):
        band_passed(LONG, offset[:, None], (3.0, 25.0), (5.0, 5.0))


def test_gaps_of_chainage() -> None:
    s = np.concatenate([np.arange(0.0, 100.0, 0.25), np.arange(150.0, 250.0, 0.25)])
    values = np.ones((len(s), 4))
    with pytest.raises(MeasurementError, match=r"gap of chainage from s = 99\.75 to 150 m \(1 in all\)"):
        without_gaps(s, values, "refuse")
    closed, _ = without_gaps(s, values, "close")
    np.testing.assert_allclose(np.diff(closed), 0.25)
    faded, weighted = without_gaps(s, values, "fade", 10.0)
    at = lambda x: float(np.interp(x, faded, weighted[:, 0]))  # noqa: E731
    assert [at(x) for x in (80.0, 99.75, 125.0, 150.0, 165.0)] == [1.0, 0.0, 0.0, 0.0, 1.0]
    assert at(155.0) == pytest.approx(0.5)
    assert np.diff(faded).max() < 0.4


def test_standard_deviations_and_classes() -> None:
    """A sine of 10 m on the left rail has its amplitude over the root of two; one of 50 m is in D2."""
    values = np.zeros((len(S), 4))
    columns = {"level_left": 2e-3 * np.sin(2 * np.pi * S / 10.0), "level_right": np.zeros(len(S))}
    columns |= {"alignment_left": 1e-3 * np.sin(2 * np.pi * S / 50.0), "alignment_right": np.zeros(len(S))}
    values = quantities(S, columns)
    first, second = quality(S, values, 30.0)
    assert (first.start, first.end, second.end) == (0.0, 200.0, S[-1])
    assert first.level[0] == pytest.approx(2e-3 / 2**0.5, rel=0.02)
    assert first.alignment[1] == pytest.approx(1e-3 / 2**0.5, rel=0.05)
    assert first.level[1] < 1e-4
    assert first.classes == ("C", "A")  # 1.41 mm at 108 km/h
    assert quality_class("level", 9e-3, 20.0) == "E"
    assert quality_class("level", 9e-3, 90.0) == "-"
    assert np.isnan(quality(S[:300], values[:300], 30.0)[0].level[2])


def test_spectral_densities_are_those_of_realisations() -> None:
    """The mean over 40 seeds, and the variance as their integral."""
    tracks = [ERRI["low"].irregularities(1220.0, seed=seed, wavelengths=(3.0, 60.0)).at(LONG) for seed in range(40)]
    found = np.array([spectral_density(LONG, own)[1] for own in tracks])
    wave_number = spectral_density(LONG, tracks[0])[0]
    inside = (wave_number > 2 * np.pi / 40.0) & (wave_number < 2 * np.pi / 4.0)
    np.testing.assert_allclose(found.mean(axis=0)[inside] / ERRI["low"](wave_number[inside]), 1.0, atol=0.25)
    variance = trapezoid(found.mean(axis=0), wave_number, axis=0)
    np.testing.assert_allclose(variance, np.var(tracks, axis=(0, 1)), rtol=0.1)


def write(path: Path, head: str, columns: list[np.ndarray]) -> Path:
    path.write_text(
        f"# measured\n{head}\n"
        + "\n".join(",".join(map(repr, row)) for row in zip(*(c.tolist() for c in columns), strict=True))
    )
    return path


def test_files_of_measuring_cars(tmp_path: Path) -> None:
    values = track()
    columns = measured(values)
    names = list(columns)
    head = "s; -level_left [mm]".replace(";", ",") + ", level_right [mm], alignment_left, alignment_right"
    order = [S, -1e3 * columns["level_left"], 1e3 * columns["level_right"], columns["alignment_left"]]
    file = write(tmp_path / "car.csv", head, [*order, columns["alignment_right"]])
    stations, found = read_irregularities(file)
    np.testing.assert_allclose(found, values, atol=1e-14)
    assert sorted(names) == sorted(["level_left", "level_right", "alignment_left", "alignment_right"])
    np.testing.assert_array_equal(stations, S)
    banded = read_irregularities(file, Measurement(band=BANDS["D1"]))[1]
    np.testing.assert_allclose(banded, band_passed(S, values, BANDS["D1"])[1], atol=1e-12)
    gap = write(
        tmp_path / "gap.csv", "s, level_left, level_right", [np.append(S, 600.0), np.zeros(1601), np.zeros(1601)]
    )
    with pytest.raises(IrregularityFileError, match=r"gap\.csv: gap of chainage from s = 399\.75 to 600 m"):
        read_irregularities(gap)
    plain = write(tmp_path / "plain.csv", "s, level", [np.append(S, 600.0), np.zeros(1601)])
    assert len(read_irregularities(plain)[0]) == 1601  # as before
    wrong = write(tmp_path / "wrong.csv", "s, twist [mm]", [S, S])
    with pytest.raises(IrregularityFileError, match=r"'twist \[mm\]': must be one of .* twist: mm/m\)"):
        read_irregularities(wrong)


SCENE = Path(__file__).parents[2] / "scenes" / "vehicle_irregular.toml"


def scene(table: dict[str, object]) -> RunScene:
    data = parse(SCENE.read_text(), SCENE)
    data["track"]["irregularities"] = table
    found = checked(data, SCENE)
    assert isinstance(found, RunScene)
    return found


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ({"chord": 10.0}, "irregularities.chord = 10.0: needs band"),
        ({"band": [25.0, 3.0]}, "irregularities.band = .*: must be in increasing order"),
        ({"band": "D1", "chord": 10.0}, r"irregularities.file = .*car\.csv: chord of 5 \+ 5 m: shows waves of"),
        ({"spectrum": "low", "gaps": "fade", "file": None}, 'irregularities.gaps = "fade": allowed only with file'),
        (
            {"file": "wrong.csv"},
            r"wrong\.csv: columns cross_level and level_left and level_right contradict",
        ),
    ],
)
def test_scenes_refuse_measurements_with_one_message(table: dict[str, object], said: str, tmp_path: Path) -> None:
    columns = measured(track())
    head, rails = "s, level_left, level_right", [columns["level_left"], columns["level_right"]]
    write(tmp_path / "car.csv", head, [S, *rails])
    write(tmp_path / "wrong.csv", f"{head}, cross_level", [S, *rails, rails[0] - rails[1]])
    given = {"file": "car.csv", **table}
    names = {key: str(tmp_path / str(value)) if key == "file" else value for key, value in given.items() if value}
    with pytest.raises(SceneError, match=said) as error:
        scene(names)
    assert str(error.value).count("\n") == 0


def test_a_scene_takes_a_chord_measurement_in_its_band(tmp_path: Path) -> None:
    """The track of the run has the level that was measured over a chord of 10 m."""
    level = ERRI["low"].irregularities(1220.0, seed=3, wavelengths=(6.5, 25.0))
    true, before, after = (level.at(LONG + shift)[:, 1] for shift in (0.0, -5.0, 5.0))
    file = write(tmp_path / "chord.csv", "s, level [mm]", [LONG, 1e3 * (true - 0.5 * (before + after))])
    table = scene({"file": str(file), "band": [6.5, 25.0], "chord": 10.0}).track.irregularities
    assert table is not None
    found = table.irregularities(180.0).at(LONG)
    inside = (LONG > 300.0) & (LONG < 900.0)
    assert np.abs(found[inside, 1] - true[inside]).max() < 0.01 * np.abs(true).max()


STATIONS = np.arange(0.0, 40.0, 0.25)
LEVELS = 1e-3 * np.stack([np.sin(STATIONS / 3.0), np.cos(STATIONS / 2.0)], axis=1)
DATE = "12.05.2020"
HEADS = {"s": "KM [km]", "level_left": "-Top L", "level_right": "-Top R"}


SEPARATED = [*product((";", "\t", "; "), ".,", ("", ";")), *product((" ", ",", ", "), ".", ("",))]


@pytest.mark.parametrize(("separator", "mark", "end"), SEPARATED)
def test_files_with_any_separator_and_heads(separator: str, mark: str, end: str, tmp_path: Path) -> None:
    """As measuring cars write them: kilometres, a date in each row, top positive downwards, other columns between."""
    blank = "_" if separator == " " else " "
    heads = [f"Top{blank}R (mm)", "KM", "Date", f"Top{blank}L (mm)", f"Speed{blank}km/h"]
    lines = [separator.join(heads) + end]
    for s, (left, right) in zip(STATIONS, LEVELS, strict=True):
        cells = [f"{-1e3 * right:.6f}", f"{12.0 + 1e-3 * s:.6f}", DATE, f"{-1e3 * left:.6f}", f"{80 + s:.1f}"]
        lines.append(separator.join(cell if cell == DATE else cell.replace(".", mark) for cell in cells) + end)
    file = tmp_path / "car.txt"
    file.write_text("\n".join(lines), encoding="utf-8-sig")
    named = Measurement(columns={name: head.replace("Top ", f"Top{blank}") for name, head in HEADS.items()})
    stations, found = read_irregularities(file, named)
    plain = tmp_path / "plain.csv"
    rows = (f"{12e3 + s:.6f},{left:.9f},{right:.9f}" for s, (left, right) in zip(STATIONS, LEVELS, strict=True))
    plain.write_text("s,level_left,level_right\n" + "\n".join(rows))
    expected = read_irregularities(plain)
    np.testing.assert_allclose(stations, expected[0], rtol=0, atol=2e-6)
    np.testing.assert_allclose(found, expected[1], rtol=0, atol=2e-9)


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ({"s": "KM", "level": "Top"}, "column level 'Top' is missing"),
        ({"s": "KM", "levl": "A"}, "columns: 'levl': must be one of s, "),
        ({"s": "KM", "level": "A [inch]"}, "each once, with unit m or mm"),
        ({"s": "A", "level": "A"}, "column level 'A' is missing"),
        ({"s": "-KM", "level": "A"}, "each once, with unit"),
        ({"level": "A"}, "column s is missing"),
    ],
)
def test_heads_that_a_file_does_not_have(columns: dict[str, str], said: str, tmp_path: Path) -> None:
    (tmp_path / "car.txt").write_text("KM;A\n0;0,001\n1;0,002\n")
    with pytest.raises(IrregularityFileError) as error:
        read_irregularities(tmp_path / "car.txt", Measurement(columns=columns))
    assert said in str(error.value)
