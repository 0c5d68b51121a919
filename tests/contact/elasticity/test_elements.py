"""Piecewise linear force laws, Maxwell elements, energy of the suspension."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np
import pytest
from numpy_vehicle import damper_power, spring_energy
from plane import mirror_signs, motion_of, suspension
from scipy.integrate import quad
from scipy.interpolate import interp1d
from standin_contact import CONTACT

from wheelrail.scenes.datasets.run import dataset
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian
from wheelrail.vehicle.multibody.plane_wagon import COUNT, wagon_dynamics
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.simulation.time_run import Recording
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.steady.modes import held_wheelset_modes
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.force_law import ForceLaw
from wheelrail.vehicle.wagon.wagon import Wagon

V = 45.0
LEFT, RIGHT = (Track.curve(curvature=sign / 1200, cant=0.06, transition=20.0, length=400.0) for sign in (1, -1))

# A spring softer in extension than in compression, and a damper of two stages that is weaker outwards.
UNEVEN = ForceLaw(((-0.02, -6e3), (-0.005, -1e3), (0.0, 0.0), (0.03, 2e3)))
VALVE = ForceLaw(((-0.5, -4e3), (-0.1, -3e3), (0.0, 0.0), (0.1, 1.5e3), (0.5, 2.5e3)))
# Series stiffness of the dampers of the Manchester wagon, without a public source.
SERIES = {"primary": (7.5e6, 1e6), "secondary": (6e6, 6e6)}


def with_series(wagon: Wagon, factor: float = 1.0) -> Wagon:
    stages = {
        name: replace(getattr(wagon, name), lateral_series_stiffness=factor * y, vertical_series_stiffness=factor * z)
        for name, (y, z) in SERIES.items()
    }
    return replace(wagon, **stages)


def uneven(wagon: Wagon) -> Wagon:
    """Tables everywhere: springs and dampers, lateral and vertical, in both stages."""
    stages = {
        name: replace(
            getattr(wagon, name),
            lateral_stiffness=factor * UNEVEN,
            vertical_stiffness=5 * factor * UNEVEN,
            lateral_damping=VALVE,
            vertical_damping=2.0 * VALVE,
        )
        for name, factor in (("primary", 10.0), ("secondary", 1.0))
    }
    return replace(wagon, **stages)


WAGONS = {
    "linear": Wagon(),
    "uneven": uneven(Wagon()),
    "series": with_series(Wagon()),
    "both": with_series(uneven(Wagon())),
}


def straight(wagon: Wagon) -> VehicleDynamics:
    return wagon_dynamics(wagon, Track(), CONTACT, V)


def test_force_law_against_scipy_interpolation() -> None:
    x = np.linspace(-0.08, 0.08, 1001)
    peer = interp1d(*np.array(UNEVEN.points).T, fill_value="extrapolate")
    np.testing.assert_allclose(UNEVEN(x), peer(x), rtol=1e-12, atol=1e-9)
    assert UNEVEN(0.0) == 0.0
    assert float((2.5 * UNEVEN)(0.01)) == 2.5 * float(UNEVEN(0.01))
    np.testing.assert_allclose(UNEVEN.inverse(UNEVEN(x)), x, rtol=1e-12, atol=1e-15)
    odd = ForceLaw(((0.0, 0.0), (0.01, 100.0), (0.02, 400.0)))
    whole = ForceLaw(((-0.02, -400.0), (-0.01, -100.0), (0.0, 0.0), (0.01, 100.0), (0.02, 400.0)))
    np.testing.assert_allclose(odd(x), whole(x), rtol=1e-12, atol=1e-12)
    np.testing.assert_array_equal(odd(-x), -odd(x))
    np.testing.assert_allclose(odd.energy(x), whole.energy(x), rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(odd.inverse(odd(x)), x, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("law", [UNEVEN, VALVE, Wagon().bumpstop], ids=["uneven", "valve", "bumpstop"])
def test_energy_of_a_force_law_is_its_integral(law: ForceLaw) -> None:
    for end in (-0.7, -0.033, -0.004, 0.0, 0.02, 0.0625, 0.9):
        kinks = [x for x in (s * k for k, _ in law.points for s in (1, -1)) if 0 < abs(x) < abs(end) and x * end > 0]
        expected = quad(lambda x: float(law(x)), 0.0, end, points=kinks or None, limit=200)[0]
        assert float(law.energy(end)) == pytest.approx(expected, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(
    "points",
    [
        ((0.0, 0.0),),
        ((0.0, 0.0), (0.01, -1.0)),
        ((0.0, 0.0), (0.01, 1.0), (0.01, 2.0)),
        ((0.01, 0.0), (0.02, 1.0)),
        ((-0.01, -1.0), (0.02, 1.0)),
        ((0.0, 0.0), (0.01, inf)),
        ((0.0, 0.0, 0.0), (0.01, 1.0, 1.0)),
    ],
)
def test_invalid_points_are_rejected(points: tuple[tuple[float, float], ...]) -> None:
    with pytest.raises(ValueError, match="points"):
        ForceLaw(points)


def test_a_linear_law_by_points_is_the_number() -> None:
    w = Wagon()
    line = ForceLaw(((0.0, 0.0), (1.0, 1.0)))
    p, s = (
        replace(
            stage,
            lateral_stiffness=stage.lateral_stiffness * line,
            vertical_stiffness=stage.vertical_stiffness * line,
            lateral_damping=stage.lateral_damping * line,
            vertical_damping=stage.vertical_damping * line,
        )
        for stage in (w.primary, w.secondary)
    )
    position, rate = motion(np.random.default_rng(1), ())[:2]
    wagons = (w, replace(w, primary=p, secondary=s))
    plain, tabled = (suspension(straight(x), position, rate) for x in wagons)
    np.testing.assert_allclose(tabled.force, plain.force, rtol=1e-12, atol=1e-9)


def test_scaling_applies_to_forces() -> None:
    whole, plane = WAGONS["both"].secondary, WAGONS["both"].plane.secondary
    assert isinstance(plane.vertical_stiffness, ForceLaw)
    assert float(plane.vertical_stiffness(0.03)) == 0.5 * float(whole.vertical_stiffness(0.03))  # type: ignore[operator]
    assert plane.lateral_series_stiffness == 0.5 * whole.lateral_series_stiffness == 3e6


def motion(rng: np.random.Generator, shape: tuple[int, ...], size: int = 20) -> tuple[np.ndarray, ...]:
    """Random positions and rates of the bodies, and deflections of springs in series with dampers."""
    position = rng.normal(size=(*shape, 3, 3)) * np.array([[30, 20, 30], [10, 8, 10], [3, 2, 3]]) * 1e-3
    rate = rng.normal(size=(*shape, 3, 3)) * 0.3
    return position, rate, 1e-3 * rng.normal(size=(*shape, size - 20))


@pytest.mark.parametrize("name", WAGONS)
def test_energy_balance_of_elements(name: str) -> None:
    """d(stored)/dt + power on the bodies + power of the dampers = 0 along any motion, by a central difference."""
    d, h = straight(WAGONS[name]), 1e-6
    m = len(d.coordinates.maxwell)
    for position, rate, series in zip(*motion(np.random.default_rng(5), (40,), 20 + m), strict=True):
        found, at = suspension(d, position, rate, series), motion_of(d, position, rate)
        before, after = (
            spring_energy(d, motion_of(d, position + t * rate, rate), series + t * found.series_rate) for t in (-h, h)
        )
        given, lost = float((found.on_bodies * rate).sum()), -damper_power(d, at, series)
        assert lost > 0.0
        assert abs((after - before) / (2 * h) + given + lost) < 2e-6 * (abs(given) + lost)
    still = np.zeros((3, 3))
    assert spring_energy(d, motion_of(d, still, still), np.zeros(m)) == 0.0


@pytest.mark.parametrize("name", WAGONS)
def test_mirrored_forces_are_bitwise_identical(name: str) -> None:
    d = wagon_dynamics(WAGONS[name], Track(), CONTACT, V)
    signs, rng = mirror_signs(d.coordinates), np.random.default_rng(2)
    wrench = np.array([1e3, 2e3, 1e5, 300.0, 50.0, 20.0])
    other = wrench * [1, -1, 1, -1, 1, -1]
    for _ in range(5):
        position, rate, series = motion(rng, (), d.size)
        state = np.concatenate([position.ravel(), [0.01], rate.ravel(), [0.02], series])
        here, there = (d.accelerations(0.0, x, w[None]).rates for x, w in ((state, wrench), (signs * state, other)))
        np.testing.assert_array_equal(there, signs[COUNT:] * here)


def damped(stiffness: float, damping: float) -> VehicleDynamics:
    """A wagon whose secondary dampers are in series with springs, values of one of them."""
    stage = replace(
        Wagon().secondary, vertical_damping=2 * damping, vertical_series_stiffness=2 * stiffness
    )  # half of it in the plane model
    return straight(replace(Wagon(), secondary=stage))


def frequency_response(stiffness: float, damping: float, omega: float) -> complex:
    """Force per deflection of a Maxwell element, from its state equation e' = v - F/c."""
    d = damped(stiffness, damping)
    element = list(d.vehicle.elements).index("left_secondary_damper")
    still, moving = np.zeros((3, 3)), np.zeros((3, 3))
    moving[0, 1] = 1.0
    fading = float(suspension(d, still, still, np.ones(2)).series_rate[0])  # e' = fading e + v
    assert float(suspension(d, still, moving, np.zeros(2)).series_rate[0]) == pytest.approx(1.0, abs=1e-15)
    stretch = 1j * omega / (1j * omega - fading)
    return -float(suspension(d, still, still, np.ones(2)).force[element, 1]) * stretch


def test_maxwell_element_has_its_complex_stiffness() -> None:
    k, c = 6e6, 32e3
    for omega in 2 * np.pi * np.array([0.1, 1.0, 10.0, 30.0, 100.0, 1e3]):
        assert frequency_response(k, c, omega) == pytest.approx(1j * omega * c * k / (k + 1j * omega * c), rel=1e-12)


def free_modes(wagon: Wagon) -> np.ndarray:
    """Eigenvalues of the oscillating modes of car body and bogie above a fixed wheelset, in ascending order, 1/s."""
    values = np.array([mode.eigenvalue for mode in held_wheelset_modes(straight(wagon))])
    return np.sort_complex(1j * values[values.imag > 1.0])[::-1]


def test_stiff_maxwell_element_tends_to_the_damper() -> None:
    """The eigenvalues' difference falls as 1/stiffness."""
    plain, factors = free_modes(Wagon()), np.array([4.0, 8.0, 16.0, 32.0])
    errors = [np.abs(free_modes(with_series(Wagon(), f)) - plain) for f in factors]
    assert errors[0].shape == (6,)
    for error in np.transpose(errors):
        assert np.polyfit(np.log(factors), np.log(error), 1)[0] == pytest.approx(-1.0, abs=0.05)


def test_dissipation_of_a_maxwell_element() -> None:
    """Over a cycle of a sinusoidal deflection the work done is the integral of F2/c, and that of the closed form."""
    k, c, omega, size = 1e6, 4e3, 2 * np.pi * 12.0, 5e-3
    d, still, stiffness = damped(k, c), np.zeros((3, 3)), frequency_response(k, c, omega)
    t = np.linspace(0.0, 2 * np.pi / omega, 401)[:-1]
    u, force = size * np.exp(1j * omega * t), size * stiffness * np.exp(1j * omega * t)
    powers = []
    for rate, stretch in zip((1j * omega * u).real, force.real / k, strict=True):
        moving = np.zeros((3, 3))
        moving[0, 1] = rate
        powers.append(-0.5 * damper_power(d, motion_of(d, still, moving), np.full(2, stretch)))  # of two
    power = np.array(powers)
    np.testing.assert_allclose(power, force.real**2 / c, rtol=1e-12)
    assert power.mean() * 2 * np.pi / omega == pytest.approx(np.pi * size**2 * stiffness.imag, rel=1e-12)


@pytest.mark.parametrize("name", WAGONS)
def test_static_loads_of_the_springs(name: str) -> None:
    """39.24 kN on each secondary and 45.65 kN on each primary spring of the plane wagon, for any law."""
    d = wagon_dynamics(WAGONS[name], Track(), CONTACT, V)
    found = equilibrium(d)
    assert found.residual < 1e-6
    assert len(found.state) == d.size == 20 + len(d.coordinates.maxwell)
    assert not found.state[2 * COUNT :].any()
    force = suspension(d, found.state[:9].reshape(3, 3), np.zeros((3, 3))).force
    np.testing.assert_allclose(force[[0, 4], 1], 45.65e3, rtol=2e-4)
    np.testing.assert_allclose(force[[2, 6], 1], 39.24e3, rtol=1e-6)
    np.testing.assert_allclose(d.suspension.static_loads[[0, 2]], [9.81 * 9307.5 / 2, 39.24e3], rtol=1e-12)
    np.testing.assert_allclose(found.state[[1, 4]], found.state[7], atol=1e-9)  # springs at their nominal length
    again = equilibrium(d, guess=found.state)
    assert again.iterations == 0


@pytest.mark.parametrize("name", ["uneven", "both"])
def test_right_hand_curve_is_the_mirror_image(name: str) -> None:
    vehicles = [wagon_dynamics(WAGONS[name], track, CONTACT, 30.0) for track in (LEFT, RIGHT)]
    left, right = (equilibrium(vehicle, time=5.0).state for vehicle in vehicles)
    np.testing.assert_allclose(right, mirror_signs(vehicles[0].coordinates) * left, rtol=0.0, atol=1e-9)
    assert abs(left[0]) > 5e-3


def test_jacobian_of_maxwell_elements() -> None:
    wagon = WAGONS["series"]
    d = wagon_dynamics(wagon, LEFT, CONTACT, V)
    position, rate, series = motion(np.random.default_rng(3), (), d.size)
    state = np.concatenate([position.ravel() / 10, [0.0], rate.ravel(), [0.0], series])
    state[6:9] = [1e-3, -1e-4, 1e-4]
    found = VehicleJacobian(d, StepStatistics())(2.0, state, d(2.0, state)).by_state
    h = 1e-6
    columns = [(d(2.0, state + x).rate - d(2.0, state - x).rate) / (2 * h) for x in h * np.eye(d.size)]
    expected = np.stack(columns, axis=1)
    scale = np.abs(expected).max(axis=1, keepdims=True)
    error = np.abs(found - expected) / scale
    assert max(error[20:].max(), error[:, 20:].max()) < 1e-6  # the contact's part is tested elsewhere
    rates = np.diag(expected)[20:]
    closed = np.array([-7.5e6 / 2e3, -1e6 / 4e3, -3e6 / 16e3, -3e6 / 10e3])
    np.testing.assert_allclose(rates, np.tile(closed, 2), rtol=1e-6)


@pytest.mark.parametrize("method", ["ode23", "rosenbrock"])
def test_run_with_force_laws_and_maxwell_elements(method: str) -> None:
    dynamics = wagon_dynamics(WAGONS["both"], LEFT, CONTACT, V)
    found = simulate(dynamics, (0.0, 0.3), steps=StepSettings(method), recording=Recording(0.1))
    assert found.status == "completed"
    assert found.state.shape == (4, 28)
    assert found.series.shape == (4, 8)
    assert np.abs(found.series[-1]).max() > 1e-6
    kept = dataset(found)["series_deflection"]
    assert kept.dims == ("time", "series")
    np.testing.assert_array_equal(kept, found.series)
    with pytest.raises(ValueError, match=r"must be \(28,\)"):
        simulate(dynamics, initial=np.zeros(20))
