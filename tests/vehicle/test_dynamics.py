"""Equations of motion and equilibrium of the plane wagon."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy_vehicle import spring_energy
from plane import MIRROR, constants, in_frame, motion_of, suspension, wrench_of
from standin_contact import CONTACT, FunctionContact, SmoothContact, TwoPointContact
from track_frame import Frame, frame_at

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.vehicle.integration.integrate import StepSettings, integrate
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
from wheelrail.vehicle.simulation.contact_cost import CountedContact
from wheelrail.vehicle.steady.equilibrium import EquilibriumError, equilibrium
from wheelrail.vehicle.track.piecewise import PiecewiseFunction
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.force_law import ForceLaw
from wheelrail.vehicle.wagon.wagon import Wagon

V, R, CANT = 45.0, 1200.0, 0.06
CURVE = Track.curve(curvature=1 / R, cant=CANT, tangent=50.0, transition=100.0, length=200.0)
IN_CURVE = 250.0 / V


@FunctionContact
def no_contact(state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
    return ContactResult.separated()


def dynamics(track: Track = CURVE, contact: VehicleContact = CONTACT, wagon: Wagon | None = None) -> VehicleDynamics:
    return wagon_dynamics(wagon or Wagon(), track, contact, V)


def random_state(seed: int) -> np.ndarray:
    return 1e-3 * np.random.default_rng(seed).normal(size=20) * np.tile([5, 1, 2, 2, 1, 2, 2, 0.1, 0.3, 1], 2)


def test_static_wheel_load_on_straight_track() -> None:
    found = equilibrium(dynamics())
    assert found.residual < 1e-6
    for side in ("left", "right"):
        assert found.contacts["wheelset"][side].force[2] == pytest.approx(54546.05, rel=1e-6)  # type: ignore[index]
    assert np.abs(found.state[[0, 2, 3, 5, 6, 8]]).max() < 1e-12
    assert np.ptp(found.state[[1, 4, 7]]) < 1e-9  # springs at their nominal length, all on the contacts' approach
    evaluation = dynamics()(0.0, found.state)
    assert np.abs(evaluation.rate[10:]).max() < 1e-5


def test_loads_in_the_full_curve() -> None:
    """Figures of the design data: 72.3 / 37.4 kN, 14.39 kN, 46 mm, 3.0 kN and 0.020 rad. They leave out
    the shift of the wheelset, the gyroscopic moment and the bogie's lean under the displaced body."""
    d = dynamics()
    found = equilibrium(d, time=IN_CURVE)
    left, right = found.contacts["wheelset"]["left"].force, found.contacts["wheelset"]["right"].force
    assert right[2] == pytest.approx(72.3e3, rel=0.02)
    assert left[2] == pytest.approx(37.4e3, rel=0.03)
    assert left[1] + right[1] == pytest.approx(14.39e3, rel=1e-3)
    position = found.state[:9].reshape(3, 3)
    at = [found.dynamics.speed_profile(found.time)]
    deflection, force = (values[0, :, 1] for values in found.dynamics.bodies.element_states(at, found.state[None]))
    elements = list(found.dynamics.vehicle.elements)
    assert deflection[elements.index("left_secondary_spring")] == pytest.approx(-0.046, rel=0.04)
    assert force[elements.index("bumpstop")] == pytest.approx(3.0e3, rel=0.15)
    assert position[0, 2] == pytest.approx(0.020, rel=0.06)
    assert found.state[6] < -0.004  # towards the outer rail


def test_curve_loads_balance_as_a_whole() -> None:
    """Forces and moments on all bodies together, about the track's origin, with the gyroscopic moment J w V/R."""
    d = dynamics()
    found = equilibrium(d, time=IN_CURVE, tolerance=1e-9)
    beta = np.arcsin(CANT / 1.5)
    mass, _, pitch, yaw, height = constants(d)
    position = found.state[:9].reshape(3, 3)
    y, z, sigma = position[:, 0], height + position[:, 1], position[:, 2]
    # The bodies circle at V/R about a vertical R to the left of the origin; the plane of the rails falls to the left.
    inward = (V / R) ** 2 * (R - (y * np.cos(beta) + z * np.sin(beta)))
    fy = mass * (inward * np.cos(beta) - 9.81 * np.sin(beta))
    fz = mass * (inward * np.sin(beta) + 9.81 * np.cos(beta))
    total = wrench_of(found.contacts)
    assert total[1] == pytest.approx(fy.sum(), rel=1e-9)
    assert total[2] == pytest.approx(fz.sum(), rel=1e-9)
    moment = total[3] + y[2] * total[2] - z[2] * total[1]
    oy, oz = V / R * np.sin(sigma - beta), V / R * np.cos(sigma - beta)
    spin = V / 0.46 + found.state[19]
    gyroscopic = ((yaw - pitch) * oy * oz).sum() - pitch[2] * spin * oz[2]
    assert moment == pytest.approx((y * fz - z * fy).sum() + gyroscopic, rel=1e-7)
    assert pitch[2] * spin * oz[2] == pytest.approx(411.0, abs=1.0)


def test_equilibrium_needs_few_contact_solves() -> None:
    straight, curve = CountedContact(CONTACT), CountedContact(CONTACT)
    equilibrium(dynamics(contact=straight))
    assert straight.costs["left"].solves == straight.costs["right"].solves <= 25
    equilibrium(dynamics(contact=curve), time=IN_CURVE)
    assert curve.costs["left"].solves <= 150


@pytest.mark.parametrize("slope", [1.0, 2.0])
@pytest.mark.parametrize(("radius", "speed"), [(600.0, 45.0), (1200.0, 45.0), (1200.0, 20.0), (-1200.0, 20.0)])
def test_equilibrium_with_a_second_contact_point(radius: float, speed: float, slope: float) -> None:
    track = Track.curve(curvature=1 / radius, cant=CANT, transition=100.0, length=200.0)
    contact = CountedContact(WheelsetContact(TwoPointContact(slope=slope), CONTACT.mounting))
    found = equilibrium(wagon_dynamics(Wagon(), track, contact, speed), time=150.0 / speed)
    assert found.residual < 1e-6
    assert contact.costs["left"].solves <= 150


def test_equilibrium_avoids_depths_beyond_the_model() -> None:
    rest = equilibrium(dynamics()).contacts["wheelset"]["left"].approach
    for deepest in (1.01 * rest, 1.1 * rest):
        shallow = WheelsetContact(TwoPointContact(deepest=deepest), CONTACT.mounting)
        assert equilibrium(dynamics(contact=shallow)).residual < 1e-6


def test_equilibrium_from_an_initial_guess() -> None:
    first = equilibrium(dynamics(), time=IN_CURVE)
    counted = CountedContact(CONTACT)
    again = equilibrium(dynamics(contact=counted), time=IN_CURVE, guess=first.state)
    assert again.iterations == 0
    assert counted.costs["left"].solves == 1


def test_no_equilibrium_is_an_error() -> None:
    with pytest.raises(EquilibriumError, match="50 mm"):
        equilibrium(dynamics(contact=no_contact))
    slippery = WheelsetContact(SmoothContact(cone=0.0, flange=0.0), CONTACT.mounting)
    with pytest.raises(EquilibriumError):
        equilibrium(dynamics(contact=slippery), time=IN_CURVE)  # no lateral force on the wheelset


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_right_hand_curve_is_the_mirror_image(seed: int) -> None:
    other = Track.curve(curvature=-1 / R, cant=CANT, tangent=50.0, transition=100.0, length=200.0)
    state = random_state(seed)
    for s in (100.0, 120.0, 250.0):
        left, right = dynamics()(s / V, state), dynamics(other)(s / V, MIRROR * state)
        np.testing.assert_allclose(right.rate, MIRROR * left.rate, rtol=1e-10, atol=1e-10)
        yaw = [
            d.yaw_reactions(s / V, x, wrench_of(at.contacts)[None]).item()
            for d, x, at in ((dynamics(), state, left), (dynamics(other), MIRROR * state, right))
        ]
        assert yaw[1] == pytest.approx(-yaw[0], rel=1e-10)


@pytest.mark.parametrize("body", [0, 1, 2])
@pytest.mark.parametrize("seed", [1, 2])
def test_moments_equal_the_rate_of_angular_momentum(seed: int, body: int) -> None:
    """Roll, spin and yaw reaction from d/dt L + w x L, with L(t) differentiated by a complex step."""
    rng = np.random.default_rng(seed)
    w, wd = 0.3 * rng.normal(size=3), rng.normal(size=3)
    frame = Frame(V, 1.7, w, wd, np.array([0.0, 0.0, -1.0]))
    state = 30 * random_state(seed)
    wrench = np.concatenate([1e4 * rng.normal(size=3), 1e3 * rng.normal(size=3)])
    d = dynamics()
    accelerations, reaction = in_frame(d, frame, state, wrench)
    on_bodies = suspension(d, state[:9].reshape(3, 3), state[10:19].reshape(3, 3)).on_bodies
    inertia = np.diag(constants(d)[1:4, body])
    angle, rate, change = state[3 * body + 2], state[10 + 3 * body + 2], accelerations[3 * body + 2]
    spin, spin_change = (V / 0.46 + state[19], accelerations[9] + 1.7 / 0.46) if body == 2 else (0.0, 0.0)

    def axes(t: complex) -> np.ndarray:
        a = angle + rate * t + change * t * t / 2
        return np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])

    def momentum(t: complex) -> np.ndarray:
        turn = axes(t)
        absolute = w + wd * t + np.array([rate + change * t, 0, 0]) + turn[:, 1] * (spin + spin_change * t)
        return turn @ inertia @ turn.T @ absolute

    total = momentum(1e-30j).imag / 1e-30 + np.cross(w, momentum(0.0).real)
    in_body = axes(0.0).T @ total
    given = axes(0.0).T @ wrench[3:] if body == 2 else np.zeros(3)
    assert in_body[0] == pytest.approx(on_bodies[body, 2] + given[0], rel=1e-9)
    if body == 2:
        assert in_body[1] == pytest.approx(given[1], rel=1e-9)
        assert in_body[2] == pytest.approx(given[2] + reaction, rel=1e-9)


def conserved(d: VehicleDynamics, frame: Frame, state: np.ndarray) -> float:
    """Kinetic energy of the motion in the frame, less that of being carried along, plus potential energy (Jacobi)."""
    mass, roll_inertia, pitch_inertia, yaw_inertia, height = constants(d)
    y, z, roll = state[:9].reshape(3, 3).T
    vy, vz, spin = state[10:19].reshape(3, 3).T
    theta = V / 0.46 + state[19]
    _, wy, wz = frame.rate
    oy, oz = wy * np.cos(roll) + wz * np.sin(roll), wz * np.cos(roll) - wy * np.sin(roll)
    relative = mass * (vy**2 + vz**2) + roll_inertia * spin**2
    up = height + z
    carried = mass * ((V + wy * up - wz * y) ** 2) + pitch_inertia * oy**2 + yaw_inertia * oz**2
    weight = -mass * d.vehicle.gravity * (frame.down[1] * y + frame.down[2] * up)
    springs = spring_energy(d, motion_of(d, state[:9].reshape(3, 3), state[10:19].reshape(3, 3)), np.zeros(0))
    return float((0.5 * (relative - carried) + weight).sum() + 0.5 * pitch_inertia[2] * theta**2 + springs)


@pytest.mark.parametrize("track", [Track(), Track(PiecewiseFunction.constant(1 / R), PiecewiseFunction.constant(CANT))])
def test_energy_of_the_undamped_free_wagon(track: Track) -> None:
    """Springs, preloads, gyroscopic and centrifugal terms conserve energy, also in a curve."""
    w = Wagon()
    wagon = replace(
        w,
        bumpstop=ForceLaw(((0.0, 0.0), (1.0, 0.0))),
        primary=replace(w.primary, lateral_damping=0.0, vertical_damping=0.0),
        secondary=replace(w.secondary, lateral_damping=0.0, vertical_damping=0.0),
    )
    d = dynamics(track, no_contact, wagon)
    frame = frame_at(track, 0.0, V)
    start = np.zeros(20)
    start[10:19] = [0.2, 0.1, 0.1, -0.3, 0.2, 0.3, 0.1, -0.2, 0.2]
    energies = [
        conserved(d, frame, step.x) for step in integrate(d, 0.0, start, 0.2, StepSettings("ode45", 1e-9, 1e-11))
    ]
    scale = 0.5 * 8000 * 0.2**2
    assert np.ptp([conserved(d, frame, start), *energies]) < 1e-5 * scale


def test_failed_or_non_finite_contact_results_are_rejected() -> None:
    @FunctionContact
    def failing(state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        return replace(ContactResult.separated(), status="failed: no convergence")

    @FunctionContact
    def infinite(state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        return ContactResult(np.full(3, np.inf), np.zeros(3), status="converged")

    @FunctionContact
    def raising(state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        raise RuntimeError("linear solver broke down")

    @FunctionContact
    def wrong(state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        raise TypeError("a mistake in the program")

    for contact, text in ((failing, "no convergence"), (infinite, "not finite"), (raising, "broke down")):
        with pytest.raises(StepFailure, match=text):
            dynamics(contact=contact)(0.0, np.zeros(20))
    with pytest.raises(TypeError):
        dynamics(contact=wrong)(0.0, np.zeros(20))
    with pytest.raises(StepFailure, match="state"):
        dynamics()(0.0, np.full(20, np.nan))
    with pytest.raises(ValueError, match="speed"):
        wagon_dynamics(Wagon(), CURVE, CONTACT, 0.0)


def test_contact_receives_wheelset_and_frame_motion() -> None:
    seen: list[WheelsetState] = []

    @FunctionContact
    def contact(state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        seen.append(state)
        return CONTACT(state, side, guess)

    state = random_state(5)
    dynamics(contact=contact)(IN_CURVE, state)
    left, right = seen
    assert left == right
    assert (left.y, left.z, left.roll, left.y_rate) == (state[6], state[7], state[8], state[16])
    assert left.pitch_rate == V / 0.46 + state[19]
    assert (left.speed, left.yaw) == (V, 0.0)
    np.testing.assert_allclose(left.frame_rate, frame_at(CURVE, 250.0, V).rate, rtol=1e-13)
