"""Steady-state curving against statics in closed form."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from importlib import import_module
from itertools import pairwise
from math import asin, cos, inf, nan, sin

import numpy as np
import pytest
from scipy.optimize import brentq
from standin_contact import CONTACT, FunctionContact

from benchmarks.exudyn.linear_contact import LinearContact
from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.vehicle.multibody.equations import VehicleDynamics, wheelset_wrenches
from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
from wheelrail.vehicle.multibody.wheel_forces import WheelsetForces, wheelset_forces
from wheelrail.vehicle.simulation.contact_cost import CountedContact
from wheelrail.vehicle.steady.equilibrium import Equilibrium, EquilibriumError, equilibria, equilibrium
from wheelrail.vehicle.steady.steady_problem import SteadyProblem
from wheelrail.vehicle.track.constant_curve import ConstantCurve
from wheelrail.vehicle.wagon.wagon import Wagon

WAGON = Wagon()
SPRINGS = LinearContact(WAGON.wheel_load)
PAPER = ConstantCurve(45.0, 1 / 1200, 0.06)


def dynamics(contact: VehicleContact, curve: ConstantCurve) -> VehicleDynamics:
    return wagon_dynamics(WAGON, curve.track, contact, curve.speed)


@dataclass(frozen=True)
class SteadyCurving:
    """Forces and positions of an equilibrium in a curve."""

    equilibrium: Equilibrium

    @cached_property
    def forces(self) -> WheelsetForces:
        at = self.equilibrium
        return wheelset_forces(at.dynamics, at.state, at.contacts)["wheelset"]

    @property
    def load(self) -> dict[Side, float]:
        return {side: wheel.vertical for side, wheel in self.forces.wheels.items()}

    @property
    def unloading(self) -> float:
        return 1.0 - 2.0 * min(self.load.values()) / sum(self.load.values())

    @property
    def yaw_reaction(self) -> float:
        at = self.equilibrium
        return at.dynamics.yaw_reactions(0.0, at.state, wheelset_wrenches(at.contacts)).item()

    def element(self, name: str, quantity: int) -> float:
        """Lateral deflection (0) or force (1) of an element."""
        d = self.equilibrium.dynamics
        values = d.bodies.element_states([d.speed_profile(0.0)], self.equilibrium.state[None])
        return float(values[quantity][0, list(d.vehicle.elements).index(name), 1])

    @property
    def bodies(self) -> np.ndarray:
        """y, z, roll of car body, bogie and wheelset."""
        return self.equilibrium.state[:9].reshape(3, 3)


def curving(contact: VehicleContact, curve: ConstantCurve) -> SteadyCurving:
    return SteadyCurving(equilibrium(dynamics(contact, curve)))


def on_paper(curve: ConstantCurve, contact: LinearContact = SPRINGS, *, simpler: bool = False) -> dict[str, float]:
    """Statics with small angles, loads in their displaced position, and one equation for the bumpstop.

    simpler: of the displaced loads only the car body's weight about the secondary springs and on the rails, and no
    gyroscopic moment.

    Lateral quantities positive to the outside, rolls too. Masses from the top: 1 car body, 2 bogie, 3 wheelset; heights
    h; a and n: acceleration in and normal to the plane of the rails; one spring of each stage at +-1 m.
    """
    w, v, k = WAGON.plane, curve.speed, abs(curve.curvature)
    beta = asin(curve.cant / curve.base)
    a, n = v * v * k * cos(beta) - w.gravity * sin(beta), v * v * k * sin(beta) + w.gravity * cos(beta)
    m1, m2, m3 = w.car_body.mass, w.bogie.mass, w.wheelset.mass
    h1, h2, h3 = w.car_body.height, w.bogie.height, w.wheelset.height
    hs, hb, hp, b = w.secondary.spring_height, w.bumpstop_height, w.primary.spring_height, contact.across
    turn2 = 2 * w.secondary.vertical_stiffness + w.roll_bar + 2 * w.secondary.bending_stiffness
    turn1, turn0 = 2 * w.primary.vertical_stiffness, 2 * contact.vertical[0] * b * b
    gyroscopic = w.wheelset.pitch_inertia * v / h3 * v * k * cos(beta)

    def position(stop: float) -> tuple[float, np.ndarray]:
        """Deflection at the bumpstop and (d, p1, p2, p3, u): secondary deflection, rolls, car body aside."""
        lateral = 2 * w.secondary.lateral_stiffness
        side = 2 * w.primary.lateral_stiffness
        low = (m1 + m2) / side  # of the primary deflection: over a + n p3

        def row(d: float, p1: float, p2: float, p3: float) -> list[float]:
            return [d, p1, p2, p3]

        # Offsets of the centres against the foot of the wheelset, as rows over (d, p1, p2, p3), and their constants.
        u3 = np.array(row(0, 0, 0, h3))
        up = u3 + row(0, 0, 0, hp - h3 + low * n)
        u2 = up + row(0, 0, h2 - hp, 0)
        us = up + row(1, 0, hs - hp, 0)
        u1 = us + row(0, h1 - hs, 0, 0)
        shift = low * a
        about_p = m1 * n * (u1 - up) + m2 * n * (u2 - up)
        about_foot = n * (m1 * u1 + m2 * u2 + m3 * u3)
        if simpler:
            about_p, about_foot = 0 * about_p, n * m1 * u1
        matrix = np.array(
            [
                row(lateral, 0, 0 if simpler else -m1 * n, 0),
                row(0, turn2 - m1 * (h1 - hs) * n, -turn2, 0),
                np.array(row(0, 0, turn1, -turn1)) - about_p,
                np.array(row(0, 0, 0, turn0)) - about_foot,
            ]
        )
        right = [
            m1 * a - stop,
            m1 * (h1 - hs) * a + (hs - hb) * stop,
            a * (m1 * (h1 - hp) + m2 * (h2 - hp)),
            a * (m1 * h1 + m2 * h2 + m3 * h3)
            + n * shift * (m1 if simpler else m1 + m2)
            + (0 if simpler else gyroscopic),
        ]
        d, p1, p2, _ = found = np.linalg.solve(matrix, right)
        outer = (m1 + m2 + m3) * a / (2 * contact.lateral[0])
        return d - (hs - hb) * (p1 - p2), np.array([*found, outer + shift + u1 @ found])

    most = m1 * abs(a)
    stop = brentq(lambda f: f - float(w.bumpstop(position(f)[0])), -most, most, xtol=1e-9)
    _, (d, p1, _, p3, u1) = position(stop)
    total = (m1 + m2 + m3) * n
    return {
        "outer": 0.5 * total + contact.vertical[0] * b * p3,
        "inner": 0.5 * total - contact.vertical[0] * b * p3,
        "lateral": (m1 + m2 + m3) * a,
        "deflection": d,
        "stop": stop,
        "aside": u1,
        "roll": p1,
    }


def found_in(steady: SteadyCurving) -> dict[str, float]:
    """The same of a left-hand curve, whose outer side is the right."""
    y, _, roll = steady.bodies[0]
    return {
        "outer": steady.load["right"],
        "inner": steady.load["left"],
        "lateral": steady.forces.track_shifting,
        "deflection": -0.5 * sum(steady.element(f"{side}_secondary_spring", 0) for side in ("left", "right")),
        "stop": steady.element("bumpstop", 1),
        "aside": -y,
        "roll": roll,
    }


@pytest.mark.parametrize("speed", [15.0, 30.0, 45.0, 55.0])
def test_statics_in_closed_form(speed: float) -> None:
    """What statics leave out: squares of the angles, bodies that sink by 2 mm, speeds that differ over the height."""
    curve = replace(PAPER, speed=speed)
    found, expected = found_in(curving(SPRINGS, curve)), on_paper(curve)
    for name, scale in (("outer", 5e4), ("inner", 5e4), ("lateral", 1e4), ("stop", 3e3)):
        assert found[name] == pytest.approx(expected[name], abs=2e-3 * scale), name
    for name, scale in (("deflection", 0.05), ("aside", 0.07), ("roll", 0.02)):
        assert found[name] == pytest.approx(expected[name], abs=2e-3 * scale), name


def test_figures_of_the_design_data() -> None:
    """72.3 and 37.4 kN, 14.39 kN, 46 mm, 3.0 kN, 69 mm and 0.020 rad belong to simpler statics on rigid rails
    (which give 72.28, 37.48, 14.39, 45.96, 2.997, 68.1 and 0.0190)."""
    rigid = LinearContact(WAGON.wheel_load, lateral=(1e12, 0.0), vertical=(1e12, 0.0))
    found = on_paper(PAPER, rigid, simpler=True)
    assert [found["outer"], found["inner"]] == pytest.approx([72.3e3, 37.4e3], abs=80)
    assert found["lateral"] == pytest.approx(14.39e3, abs=5)
    assert found["stop"] == pytest.approx(3.0e3, abs=50)
    assert [found["deflection"], found["aside"]] == pytest.approx([0.046, 0.069], abs=1e-3)
    assert found["roll"] == pytest.approx(0.020, abs=1e-3)


@pytest.mark.parametrize("contact", [SPRINGS, CONTACT])
def test_balance_of_the_whole_wagon(contact) -> None:  # type: ignore[no-untyped-def]
    """Load transfer: moments of all forces about the track's origin, with the gyroscopic moment J w V / R."""
    steady = curving(contact, PAPER)
    w, (v, k) = WAGON.plane, (PAPER.speed, PAPER.curvature)
    a, n = PAPER.unbalanced(), v * v * k * sin(PAPER.angle) + w.gravity * cos(PAPER.angle)
    bodies = list(zip((w.car_body, w.bogie, w.wheelset), steady.bodies, strict=True))
    mass = sum(b.mass for b, _ in bodies)
    assert steady.forces.track_shifting == pytest.approx(mass * a, rel=3e-4)  # a little inside of this radius
    assert sum(steady.load.values()) == pytest.approx(mass * n, rel=1e-5)
    overturning = sum(b.mass * (a * (b.height + x[1]) - n * x[0]) for b, x in bodies)
    gyroscopic = w.wheelset.pitch_inertia * v / 0.46 * v * k * cos(PAPER.angle)
    assert gyroscopic == pytest.approx(411.0, abs=1.0)
    moment = sum(c.moment[0] for c in steady.equilibrium.contacts["wheelset"].values())
    moment += steady.bodies[2, 0] * mass * n - (0.46 + steady.bodies[2, 1]) * steady.forces.track_shifting
    assert -moment == pytest.approx(overturning + gyroscopic, rel=1e-3)


def test_speed_of_balance() -> None:
    speed = float(np.sqrt(1200 * 9.81 * np.tan(np.arcsin(0.04))))
    steady = curving(SPRINGS, replace(PAPER, speed=speed))
    assert abs(steady.forces.track_shifting) < 1e-4 * 14.39e3
    assert PAPER.deficiency() == pytest.approx(0.198, abs=1e-4)
    assert replace(PAPER, speed=speed).deficiency() == pytest.approx(0.0, abs=1e-4)  # that formula takes sin for tan
    assert abs(replace(PAPER, speed=speed).unbalanced()) < 1e-12


@pytest.mark.parametrize("contact", [SPRINGS, CONTACT])
def test_right_hand_curve_is_the_mirror_image(contact) -> None:  # type: ignore[no-untyped-def]
    """Within the tolerance of the equilibrium, 1e-6 of the axle load."""
    left, right = (curving(contact, replace(PAPER, curvature=sign / 1200)) for sign in (1, -1))
    other = {"left": "right", "right": "left"}
    for side, wheel in left.forces.wheels.items():
        for name in ("vertical", "guiding", "derailment_quotient"):
            mirrored = getattr(right.forces.wheels[other[side]], name)
            assert mirrored == pytest.approx(getattr(wheel, name), rel=2e-5)
        deflection = right.element(f"{other[side]}_secondary_spring", 0)
        assert deflection == pytest.approx(-left.element(f"{side}_secondary_spring", 0), rel=2e-5)
    assert right.element("bumpstop", 1) == pytest.approx(-left.element("bumpstop", 1), rel=2e-5)
    assert right.forces.track_shifting == pytest.approx(-left.forces.track_shifting, rel=2e-5)
    assert right.yaw_reaction == pytest.approx(-left.yaw_reaction, rel=2e-5)
    assert right.unloading == pytest.approx(left.unloading, rel=2e-5)
    assert left.forces.track_shifting > 0.0  # towards the centre of a left-hand curve
    assert left.forces.right.guiding > left.forces.left.guiding
    outer = left.equilibrium.contacts["wheelset"]["right"].force
    assert left.forces.right.derailment_quotient == outer[1] / outer[2]


def test_continuation_over_speeds() -> None:
    curves = [replace(PAPER, speed=float(v)) for v in np.linspace(20.0, 50.0, 7)]
    together, alone = CountedContact(CONTACT), CountedContact(CONTACT)
    states = equilibria(dynamics(together, PAPER), [curve.speed for curve in curves])
    found = [SteadyCurving(state) for state in states]
    each = [curving(alone, curve) for curve in curves]
    for one, other in zip(found, each, strict=True):
        assert one.load["right"] == pytest.approx(other.load["right"], rel=1e-5)
        assert one.bodies[0] == pytest.approx(other.bodies[0], abs=1e-6)
    assert together.costs["left"].solves < 0.75 * alone.costs["left"].solves
    assert all(a.unloading < b.unloading for a, b in pairwise(found))
    wider = [curving(CONTACT, replace(PAPER, curvature=1 / r)) for r in (800, 1200, 3000)]
    assert [s.element("bumpstop", 1) > 0.0 for s in wider] == [True, True, False]


def test_transient_run_as_initial_guess(monkeypatch: pytest.MonkeyPatch) -> None:
    expected, starts = curving(CONTACT, PAPER), []
    module = import_module("wheelrail.vehicle.steady.equilibrium")
    newton = module._newton

    def stubborn(problem: SteadyProblem, state: np.ndarray, *options: float) -> Equilibrium:
        starts.append(state)
        if len(starts) == 1:
            raise EquilibriumError("stuck")
        return newton(problem, state, *options)

    monkeypatch.setattr(module, "_newton", stubborn)
    found = curving(CONTACT, PAPER)
    assert len(starts) == 3  # from rest, on straight track, at the end of the run
    assert starts[2][:9] == pytest.approx(
        expected.equilibrium.state[:9], abs=2e-3
    )  # after 6 s a small transient remains
    assert found.load["right"] == pytest.approx(expected.load["right"], rel=1e-5)
    assert found.equilibrium.iterations <= 6


def test_no_equilibrium_names_the_speed() -> None:
    @FunctionContact
    def nothing(state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        return ContactResult.separated()

    with pytest.raises(EquilibriumError, match=r"50 mm.*, at 45 m/s"):
        equilibria(dynamics(nothing, PAPER), [45.0])


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"speed": 0.0}, "speed = 0.0"),
        ({"speed": inf}, "speed = inf"),
        ({"curvature": nan}, "curvature = nan"),
        ({"base": -1.0}, "base = -1.0"),
        ({"cant": 2.0}, "cant = 2.0: must be less than"),
    ],
)
def test_invalid_curves_are_rejected(change: dict[str, float], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        replace(PAPER, **change)
