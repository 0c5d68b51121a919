"""Irregularities: spectra, files, displacement of rails, and response of the vehicle."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from plane import MIRROR
from scipy.integrate import quad
from scipy.signal import welch
from standin_contact import CONTACT, STIFFNESS

from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.scenes.datasets.run import dataset
from wheelrail.scenes.schema.irregularity_file import IrregularityFileError, read_irregularities
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.coordinates import Z
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian
from wheelrail.vehicle.multibody.plane_wagon import COUNT, wagon_dynamics
from wheelrail.vehicle.simulation.rail_following import rail_following
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.simulation.time_run import Recording
from wheelrail.vehicle.track.alignment import Segment
from wheelrail.vehicle.track.irregularity import QUANTITIES, Irregularities
from wheelrail.vehicle.track.irregularity_spectrum import ERRI
from wheelrail.vehicle.track.speed_profile import SpeedProfile
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

SHIFT = ((1e-3, -2e-3), (-5e-4, 3e-4))


def plateau(values: list[float], length: float = 300.0) -> Irregularities:
    """The four quantities at these values but for 10 m at both ends."""
    stations = np.linspace(0.0, length, 1501)
    return Irregularities.faded(stations, np.tile(values, (1501, 1)))


def test_spectra_against_other_programs() -> None:
    """ORE B176 high as given in the manual of GENSYS (program TRC_IPSD), in m2/(1/m)."""
    f = np.array([0.0200, 0.1000, 0.2000])
    found = 2 * np.pi * ERRI["high"](2 * np.pi * f)
    np.testing.assert_allclose(found[:, 0], [2.3194e-04, 6.1608e-06, 7.3333e-07], rtol=1e-4)
    np.testing.assert_allclose(found[:, 1], [4.0897e-04, 1.0863e-05, 1.2931e-06], rtol=1e-4)


def test_realisations_have_their_spectrum_and_variance() -> None:
    shortest, longest, length = 5.0, 60.0, 1100.0
    spectrum, h = ERRI["low"], 0.5
    stations = np.arange(20.0, length - 20.0, h)
    tracks = np.array(
        [spectrum.irregularities(length, seed=seed, wavelengths=(shortest, longest)).at(stations) for seed in range(8)]
    )
    f, density = welch(tracks, fs=1.0 / h, nperseg=1024, axis=1)
    inside = (f > 1.5 / longest) & (f < 0.8 / shortest)
    # one-sided densities in m2/(1/m)
    ratio = density.mean(axis=0)[inside] / (2 * np.pi * spectrum(2 * np.pi * f[inside]))
    np.testing.assert_allclose(ratio.mean(axis=0), 1.0, atol=0.08)
    slope = np.polyfit(np.log(f[inside]), np.log(ratio), 1)[0]
    np.testing.assert_allclose(slope, 0.0, atol=0.15)
    for i in range(4):
        variance = quad(lambda o: spectrum(np.array(o))[i], 2 * np.pi / longest, 2 * np.pi / shortest)[0]  # noqa: B023
        assert tracks[:, :, i].var(axis=1).mean() == pytest.approx(variance, rel=0.1)
    outside = (f > 1.3 / shortest) & (f < 0.8 / h / 2)
    assert density[:, outside].max() < 1e-3 * density[:, inside].min()


def test_seed_determines_the_track_for_any_length() -> None:
    short, long, other = (
        ERRI["low"].irregularities(length, seed=seed) for length, seed in ((150.0, 3), (300.0, 3), (150.0, 4))
    )
    at = np.linspace(0.0, 139.0, 50)
    np.testing.assert_allclose(short.at(at), long.at(at), atol=1e-7)
    assert np.abs(short.at(at) - other.at(at)).max() > 1e-3
    assert short.rails(0.0) == ((0.0, 0.0), (0.0, 0.0))
    assert short.rails(-1e-9) is None
    assert short.rails(150.0) is None


def test_irregularities_fade_once_from_where_they_begin() -> None:
    whole, later = (ERRI["low"].irregularities(100.0, seed=3, start=start, fade=10.0) for start in (0.0, 12.0))
    assert later.rails(11.9) is None
    np.testing.assert_allclose(later.at(np.array([12.0, 100.0 - 1e-9])), 0.0, atol=1e-12)
    inside = np.linspace(22.0, 99.9, 200)
    np.testing.assert_allclose(later.at(inside), whole.at(inside), atol=1e-8)


def test_derivatives_of_rails_by_distance() -> None:
    irregularities, s, h = ERRI["low"].irregularities(100.0, seed=3), 43.21, 1e-4
    before, values, after = irregularities.derivatives(np.array([s - h, s, s + h])).transpose(1, 0, 2)
    np.testing.assert_allclose(values[0].reshape(2, 2), irregularities.rails(s), rtol=1e-14)
    np.testing.assert_allclose((after - before)[:3] / (2 * h), values[1:], rtol=1e-6, atol=1e-9)
    assert not irregularities.derivatives(np.array([-1.0, 200.0])).any()


def test_rail_following_and_its_derivatives() -> None:
    """At a wheelset on its rails the height follows the level; rates are those of changing speed."""
    track = Track(irregularities=ERRI["low"].irregularities(300.0, seed=1))
    d = wagon_dynamics(Wagon(), track, CONTACT, SpeedProfile.through((0.0, 4.0), (40.0, 20.0)))
    of_steps, t, h = rail_following(d), 1.7, 1e-6
    assert of_steps is not None
    state = np.zeros(d.size)
    follow = of_steps(1.0, state, d(1.0, state))
    position, rate, acceleration = follow(t)
    np.testing.assert_allclose((follow(t + h)[0] - follow(t - h)[0]) / (2 * h), rate, rtol=1e-5, atol=1e-9)
    np.testing.assert_allclose((follow(t + h)[1] - follow(t - h)[1]) / (2 * h), acceleration, rtol=1e-5, atol=1e-6)
    level = track.irregularities.at(np.array([d.speed_profile(t).distance]))[0, 1]  # type: ignore[union-attr]
    assert position[d.coordinates.index("wheelset", Z)] == pytest.approx(level, rel=1e-12)
    assert rail_following(wagon_dynamics(Wagon(), Track(), CONTACT, 40.0)) is None


def test_long_steps_on_irregular_rails_neither_lift_nor_press_wheels() -> None:
    """Steps of a third of the shortest wave give forces within 2 % of the load; before, wheels left the rails."""
    track = Track(irregularities=ERRI["low"].irregularities(100.0, seed=1))
    d = wagon_dynamics(Wagon(), track, CONTACT, 45.0)
    coarse, fine = (simulate(d, (0.0, 1.6), steps=StepSettings("rosenbrock", r, 1e-2 * r)) for r in (3e-3, 5e-5))
    assert coarse.cost.steps.accepted < 120
    late = fine.time > 0.3
    load = fine.force[0, 0, :, 2]
    times = coarse.time[coarse.time > 0.3]
    for side in range(2):
        exact = np.interp(times, fine.time[late], fine.force[late, 0, side, 2])
        error = coarse.force[coarse.time > 0.3, 0, side, 2] - exact
        assert np.sqrt(np.mean(error**2)) < 0.02 * load[side]


def test_rails_by_the_four_quantities() -> None:
    for values, expected in (
        ([1e-3, 0, 0, 0], ((1e-3, 0.0), (1e-3, 0.0))),
        ([0, 1e-3, 0, 0], ((0.0, 1e-3), (0.0, 1e-3))),
        ([0, 0, 1e-3, 0], ((0.0, -5e-4), (0.0, 5e-4))),
        ([0, 0, 0, 1e-3], ((5e-4, 0.0), (-5e-4, 0.0))),
    ):
        uneven = plateau(values)
        np.testing.assert_allclose(uneven.rails(100.0), expected, atol=1e-15)
        np.testing.assert_allclose(uneven.at(np.array([5.0, 100.0])), np.outer([0.5, 1.0], values), atol=1e-9)


def test_a_shift_of_both_rails_is_one_of_the_wheelset() -> None:
    state = WheelsetState(y=1e-3, z=-1e-4, roll=2e-4, y_rate=0.1, pitch_rate=98.0, speed=45.0)
    moved = replace(state, y=state.y + 2e-3, z=state.z - 1e-3, rail_shift=((2e-3, -1e-3), (2e-3, -1e-3)))
    for side in ("left", "right"):
        one, other = CONTACT(state, side), CONTACT(moved, side)  # type: ignore[arg-type]
        np.testing.assert_allclose(other.force, one.force, rtol=1e-9)
        np.testing.assert_allclose(other.moment, one.moment, rtol=1e-9, atol=1e-9)


def test_mirrored_shifts() -> None:
    state = WheelsetState(y=1e-3, z=-1e-4, pitch_rate=98.0, speed=45.0, rail_shift=SHIFT)
    assert state.mirrored().rail_shift == ((5e-4, 3e-4), (-1e-3, -2e-3))
    assert state.mirrored().mirrored() == state
    assert replace(state, rail_shift=None).mirrored().rail_shift is None
    np.testing.assert_array_equal(CONTACT(state, "left").force, CONTACT(state.mirrored(), "right").force * [1, -1, 1])


def test_the_mirrored_track_gives_the_mirrored_run() -> None:
    """Bitwise, by an explicit method: forward differences of a contact without tangent are not symmetric."""
    uneven = ERRI["high"].irregularities(100.0, seed=5)
    mirrored = Irregularities(uneven.stations, uneven.values * [-1.0, 1.0, -1.0, 1.0])
    state = 1e-4 * np.random.default_rng(1).normal(size=2 * COUNT)
    state[[1, 4, 7]] += uneven.at(np.array([20.0]))[0, 1] - 2e-4
    runs = [
        simulate(
            wagon_dynamics(
                Wagon(),
                Track.of(
                    [Segment("tangent", 5.0), Segment("transition", 30.0), Segment("arc", 60.0, k, 0.05)],
                    irregularities=irregularities,
                ),
                CONTACT,
                40.0,
            ),
            (0.5, 0.55),
            initial=initial,
        )
        for k, irregularities, initial in ((1 / 900, uneven, state), (-1 / 900, mirrored, MIRROR * state))
    ]
    assert runs[0].status == runs[1].status == "completed"
    np.testing.assert_array_equal(runs[1].time, runs[0].time)
    np.testing.assert_array_equal(runs[1].state, runs[0].state * MIRROR)
    shown = dataset(runs[0])
    columns = [shown[f"irregularity_{name}"].values for name in QUANTITIES]
    np.testing.assert_allclose(np.stack(columns, axis=1), uneven.at(runs[0].distance))


def test_vertical_response_is_that_of_three_masses() -> None:
    """Amplitudes on a wave of the level against the linear chain of contact, primary and secondary suspension."""
    speed, length, size = 45.0, 11.25, 2e-4
    stations = np.linspace(0.0, 200.0, 4001)
    values = np.zeros((4001, 4))
    values[:, 1] = size * np.cos(2 * np.pi * stations / length)
    track = Track(irregularities=Irregularities.faded(stations, values))
    dynamics = wagon_dynamics(Wagon(), track, CONTACT, speed)
    run = simulate(dynamics, (0.0, 4.0), steps=StepSettings("rosenbrock"), recording=Recording(0.01))
    plane, w = Wagon().plane, 2 * np.pi * speed / length
    steel, primary, secondary = (
        2 * STIFFNESS,
        2 * (plane.primary.vertical_stiffness + 1j * w * plane.primary.vertical_damping),
        2 * (plane.secondary.vertical_stiffness + 1j * w * plane.secondary.vertical_damping),
    )
    mass = np.array([plane.car_body.mass, plane.bogie.mass, plane.wheelset.mass])
    chain = np.array(
        [
            [secondary, -secondary, 0.0],
            [-secondary, secondary + primary, -primary],
            [0.0, -primary, primary + steel],
        ]
    )
    expected = np.linalg.solve(chain - w * w * np.diag(mass), [0.0, 0.0, steel * size])
    late = run.time > 2.001  # eight waves
    basis = np.exp(-1j * w * run.time[late])
    z = run.state[late][:, [1, 4, 7]]
    found = 2 * (basis[:, None] * (z - z.mean(axis=0))).mean(axis=0)
    np.testing.assert_allclose(found[1:], expected[1:], rtol=0.01)
    assert found[0] == pytest.approx(expected[0], abs=0.02 * size)


def test_derivative_by_time_includes_rail_motion() -> None:
    track = Track(irregularities=ERRI["high"].irregularities(200.0, seed=1))
    d = wagon_dynamics(Wagon(), track, CONTACT, 45.0)
    t, state = 1.3, 1e-4 * np.random.default_rng(1).normal(size=2 * COUNT)
    state[[1, 4, 7]] += track.irregularities.at(np.array([45.0 * t]))[0, 1] - 2e-4  # type: ignore[union-attr]
    linear = VehicleJacobian(d, StepStatistics())(t, state, d(t, state))
    h = 1e-6
    exact = (d(t + h, state).rate - d(t - h, state).rate) / (2 * h)
    np.testing.assert_allclose(linear.by_time, exact, rtol=1e-3, atol=1e-3 * np.abs(exact).max())
    assert np.abs(exact).max() > 1e3


def test_smooth_rails_are_not_evaluated() -> None:
    dynamics = wagon_dynamics(Wagon(), Track.curve(curvature=1e-3, transition=10.0, length=10.0), CONTACT, 40.0)
    assert dynamics.wheelset_states(0.1, np.zeros(20))["wheelset"].rail_shift is None


def test_files_with_and_without_names(tmp_path: Path) -> None:
    file = tmp_path / "track.csv"
    file.write_text("# measured\nlevel [mm], s [m]\n1, 0\n-2.5, 0.25\n\n3, 0.5\n")
    stations, values = read_irregularities(file)
    np.testing.assert_array_equal(stations, [0.0, 0.25, 0.5])
    np.testing.assert_allclose(values[:, 1], [1e-3, -2.5e-3, 3e-3])
    assert not values[:, [0, 2, 3]].any()
    file.write_text("0; 1e-3; 2e-3; 3e-3; 4e-3\n1;0;0;0;0\n")
    np.testing.assert_array_equal(read_irregularities(file)[1], [[1e-3, 2e-3, 3e-3, 4e-3], [0, 0, 0, 0]])


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "0 rows"),
        ("s, level\n0, 1e-3\n", "1 rows"),
        ("s, height\n0, 0\n1, 0\n", "row 1, 'height'"),
        ("s, level [km]\n0, 0\n1, 0\n", "row 1, 'level [km]'"),
        ("level\n0\n1\n", "column s"),
        ("s, level\n0, 0\n1, x\n", "row 3, level = 'x'"),
        ("s, level\n0, 0\n1, nan\n", "row 3, level = 'nan'"),
        ("s, level\n0, 0\n1\n", "row 3: 1 values, must be 2"),
        ("s, level\n0, 0\n2, 0\n2, 0\n", "row 4, s = 2: must be greater than 2"),
        ("s, level\n0, 0\n1, 3.5\n", "row 3, level = 3.5: must be from -0.1 to 0.1 m"),
    ],
)
def test_invalid_files(text: str, says: str, tmp_path: Path) -> None:
    file = tmp_path / "track.csv"
    file.write_text(text)
    with pytest.raises(IrregularityFileError) as caught:
        read_irregularities(file)
    assert str(file) in str(caught.value)
    assert says in str(caught.value)


def test_missing_file_and_invalid_samples(tmp_path: Path) -> None:
    with pytest.raises(IrregularityFileError, match="cannot be read"):
        read_irregularities(tmp_path / "none.csv")
    for stations, values in (
        ([0.0, 1.0], np.ones((2, 4))),
        ([0.0, 0.0], np.zeros((2, 4))),
        ([0.0], np.zeros((1, 4))),
        ([0.0, 1.0, 2.0], np.diag([0.0, np.nan, 0.0]) @ np.ones((3, 4))),
    ):
        with pytest.raises(ValueError, match=r"irregularities|stations"):
            Irregularities(np.array(stations), np.asarray(values))
    with pytest.raises(ValueError, match="two fades"):
        Irregularities.faded(np.array([0.0, 5.0, 19.0]), np.zeros((3, 4)))
    with pytest.raises(ValueError, match="shortest first"):
        ERRI["low"].irregularities(100.0, seed=1, wavelengths=(10.0, 3.0))
