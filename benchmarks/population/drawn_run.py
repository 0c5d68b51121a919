"""A vehicle run of the population: vehicle, track, profiles, loads, method, speed and start from one integer."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from time import process_time

import numpy as np

import wheelrail as wr
from benchmarks.population.profiles import Shape, abraded, rail, wheel
from wheelrail.contact.laws.material import Material
from wheelrail.contact.loading.flexible_contact import FlexibleContact
from wheelrail.contact.loading.flexible_wheelset import Flexibility
from wheelrail.contact.loading.quasi_static_structure import QuasiStaticStructure
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.vehicle_contact import ContactsByWheelset, VehicleContact
from wheelrail.contact.structure.hubs import hub_compliance
from wheelrail.contact.structure.pads import RailPads, rail_compliance
from wheelrail.contact.structure.sleepers import sleeper_compliance
from wheelrail.meshes.bodies.axle import AxleShape
from wheelrail.meshes.bodies.outlines import rail_outline, wheel_outline
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.explicit import METHODS as EXPLICIT
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.loads import AppliedLoads, BodyForce, LoadTable, WheelsetTorque
from wheelrail.vehicle.multibody.coordinates import Y
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
from wheelrail.vehicle.multibody.vehicle import Vehicle
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.steady.start_state import start_state
from wheelrail.vehicle.track.alignment import Segment
from wheelrail.vehicle.track.irregularity import Irregularities
from wheelrail.vehicle.track.irregularity_spectrum import ERRI
from wheelrail.vehicle.track.piecewise import PiecewiseFunction
from wheelrail.vehicle.track.speed_profile import SpeedProfile
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

BASE, GRAVITY = 1.5, 9.81  # m, m/s2
MIRROR = np.array([-1.0, 1.0, -1.0, 1.0])  # of alignment, level, cross level, gauge


@dataclass(frozen=True)
class Run:
    """A run of a vehicle, all of it from one integer.

    Parameters:
        seed: of the random numbers.
        mirrored: as its mirror image in y = 0.
        fixed: names and numbers from 0 to 1 that are not drawn.
        rougher: factor on all coefficients of friction.
    """

    seed: int
    mirrored: bool = False
    fixed: tuple[tuple[str, float], ...] = ()
    rougher: float = 1.0

    @property
    def sign(self) -> float:
        return -1.0 if self.mirrored else 1.0

    @cached_property
    def drawn(self) -> dict[str, float]:
        """Uniform numbers from 0 to 1, by name: each is independent of what else is drawn."""
        names = (
            "plane mass spring damper wheel rail friction radius hand cant length speed joint rough depth at load pull"
        )
        more = "brake free method start tolerance elastic profile sleepers named turning rubbing supple worn"
        random = np.random.default_rng(self.seed)
        return {name: float(random.random()) for name in f"{names} {more}".split()} | dict(self.fixed)

    def between(self, name: str, low: float, high: float) -> float:
        """Number of a name, uniform in the logarithm."""
        return float(low * (high / low) ** self.drawn[name])

    @property
    def plane(self) -> bool:
        return self.drawn["plane"] < 0.2

    @property
    def sleepers(self) -> bool:
        """Whether the rails lie on discrete sleepers."""
        return self.plane and self.drawn["sleepers"] < 0.2

    @property
    def supple(self) -> bool:
        """Whether the first wheelset of a vehicle has an axle that bends, on rails on pads."""
        return not self.plane and self.drawn["supple"] < 0.05

    @property
    def elastic(self) -> bool:
        """Whether contacts are solved by strips on half-spaces."""
        return self.drawn["elastic"] < 0.06 or self.sleepers or self.supple

    @property
    def named(self) -> tuple[str, ...]:
        """Wheelsets of a vehicle with a contact of their own: other profiles, and half the friction."""
        named = not (self.plane or self.supple) and self.drawn["named"] < 0.15
        return self.vehicle.wheelsets[1::2] if named else ()

    @property
    def turning(self) -> tuple[str, ...]:
        """Wheelsets of a vehicle whose wheels turn by themselves."""
        free = not (self.plane or self.supple) and self.drawn["turning"] < 0.15
        return self.vehicle.wheelsets[2:] if free else ()

    @property
    def radius(self) -> float:
        """Of the curve, m; infinite on straight track."""
        return self.between("radius", 250.0, 3000.0) if self.drawn["hand"] < 0.7 else np.inf

    @property
    def cant(self) -> float:
        return 0.15 * self.drawn["cant"] if np.isfinite(self.radius) else 0.0

    @property
    def speed(self) -> float:
        """m/s, with at most 1 m/s2 of cant deficiency."""
        fastest = np.sqrt(self.radius * (1.0 + GRAVITY * self.cant / BASE))
        return float(min(self.between("speed", 4.0, 60.0), fastest))

    @cached_property
    def track(self) -> Track:
        track = Track()
        if np.isfinite(self.radius):
            side = 1.0 if self.drawn["hand"] < 0.35 else -1.0
            arc = Segment("arc", 15.0, self.sign * side / self.radius, self.cant)
            ramp, tangent = Segment("transition", 10.0 + 10.0 * self.drawn["length"]), 25.0 + 50.0 * self.drawn["at"]
            track = Track.of([Segment("tangent", tangent), ramp, arc, ramp], base=BASE)
        return replace(track, irregularities=self.irregularities, friction=self.rubbing)

    @property
    def rubbing(self) -> PiecewiseFunction:
        """Factor on the coefficient of friction over distance: leaves or water after 5 to 35 m, or sand."""
        if self.drawn["rubbing"] > 0.2:
            return PiecewiseFunction.constant(1.0)
        begins = 5.0 + 150.0 * self.drawn["rubbing"]
        return PiecewiseFunction((begins, begins + 2.0), (1.0, 1.5 if self.drawn["at"] < 0.2 else 0.4))

    @property
    def irregularities(self) -> Irregularities | None:
        """A dip of one or both rails, a realisation of a spectrum, or none."""
        if self.drawn["rough"] < 0.25:
            made = ERRI["low"].irregularities(200.0, seed=self.seed, start=20.0)
            return replace(made, values=made.values * (MIRROR if self.mirrored else 1.0))
        if self.drawn["rough"] > 0.6:
            return None
        half = 0.5 + 2.0 * self.drawn["length"]
        x, depth = np.linspace(-half, half, 101), 1e-3 * min(half, 1.0) * self.between("depth", 0.1, 1.0)
        dip = -depth * (1.0 - np.abs(x) / half) ** 2
        one = self.sign * (self.drawn["joint"] - 0.5) if self.drawn["joint"] > 0.3 else 0.0
        values = np.stack([0.0 * x, dip, 2.0 * one * dip, 0.0 * x], axis=1)
        values[[0, -1]] = 0.0
        return Irregularities(35.0 + 40.0 * self.drawn["at"] + x, values)

    @cached_property
    def vehicle(self) -> Vehicle:
        """Manchester vehicle of another load, springs and dampers."""
        vehicle = load_vehicle()
        body, spring, damper = (
            vehicle.bodies["car_body"],
            self.between("spring", 0.6, 1.6),
            self.between("damper", 0.7, 2),
        )
        bodies = {**vehicle.bodies, "car_body": replace(body, mass=body.mass * self.between("mass", 0.5, 1.4))}

        def scaled(values: tuple[object, ...], factor: float) -> tuple[object, ...]:
            return tuple(factor * v if isinstance(v, float | int) else v for v in values)

        elements = {
            name: replace(own, stiffness=scaled(own.stiffness, spring), damping=scaled(own.damping, damper))
            for name, own in vehicle.elements.items()
        }
        hold = None if self.drawn["free"] < 0.25 else vehicle.speed_hold
        return replace(vehicle, bodies=bodies, elements=elements, speed_hold=hold)

    @property
    def running(self) -> Vehicle:
        """The vehicle with the wheels that turn by themselves."""
        bodies = self.vehicle.bodies
        free = {
            name: replace(bodies[name], independent=True, torsion=(0.0, 100.0 * (i % 2)))
            for i, name in enumerate(self.turning)
        }
        return replace(self.vehicle, bodies={**bodies, **free})

    @property
    def loads(self) -> AppliedLoads:
        """Wind or a drawbar over distance, and brakes over time."""
        forces, torques = (), ()
        if self.drawn["load"] < 0.3:
            wind = self.sign * 3e4 * (self.drawn["pull"] - 0.5)
            table = LoadTable(((40.0, 0.0), (42.0, wind), (50.0, wind), (52.0, 0.0)), by_distance=True)
            forces = (BodyForce("car_body", (0.0, 0.0, 2.0), lateral=table),)
        if self.drawn["brake"] < 0.2:
            torque = LoadTable(((0.5, 0.0), (0.8, 2e3)))
            braked = (name for name in self.vehicle.wheelsets if name not in self.turning)
            torques = tuple(WheelsetTorque(name, torque, brake=True) for name in braked)
        return AppliedLoads(torques, forces)

    @property
    def pair(self) -> tuple[Shape, Shape]:
        wheels = (wheel("S1002"), wheel("S1002", tread=2e-3), wheel("S1002", hollow=1e-3), wheel("cone", slope=0.05))
        rails = (rail("60E1"), rail("60E1", corner=1e-3), rail("arcs", crown=0.254))
        return wheels[int(4 * self.drawn["wheel"] ** 2)], rails[int(3 * self.drawn["rail"] ** 2)]

    @property
    def friction(self) -> float:
        return self.rougher * self.between("friction", 0.05, 0.6)

    def coefficient(self, wheelset: str, distance: float) -> float:
        """Coefficient of friction of a wheelset at a distance m of its own."""
        return self.friction * (0.5 if wheelset in self.named else 1.0) * self.rubbing(distance)[0]

    def turn(self, wheelset: str, low: float, high: float) -> float:
        """Range rad of the normals of a wheel between places y m of its profile."""
        y, angle = self._angles["" if wheelset not in self.named else "named"]
        first, last = np.searchsorted(y, (low, high))
        return float(np.ptp(angle[max(first - 2, 0) : last + 2]))

    @cached_property
    def _angles(self) -> dict[str, tuple[Array, Array]]:
        """Places y of chords of the wheels' profiles, from the flange's tip on, and the chords' angles."""
        found = {}
        for name, shape in (("", self.pair[0]), ("named", wheel("S1002"))):
            points = shape.points[int(np.argmax(shape.points[:, 1])) :]
            step = np.diff(points, axis=0)
            found[name] = 0.5 * (points[1:, 0] + points[:-1, 0]), np.arctan2(step[:, 1], step[:, 0])
        return found

    def wheelset(self, of_wheel: Shape, of_rail: Shape, friction: float) -> WheelsetContact:
        """Contact of a pair of profiles."""
        more = {"model": "standard"}
        if self.elastic:
            more = {"bodies": "half-space", "strips": 6, "cells": 6}
        profile = of_wheel.profile
        if self.drawn["worn"] < 0.15:  # as a run of wear changes it
            profile = abraded(profile, self.between("depth", 3e-5, 1e-3))
        return wr.Wheelset(profile, of_rail.profile, laying_angle=0.025, friction=friction, **more).element().contact

    @cached_property
    def dynamics(self) -> VehicleDynamics:
        contact: VehicleContact = self.wheelset(*self.pair, self.friction)
        pads = Material(), RailPads()
        if self.sleepers:
            support = sleeper_compliance(rail_outline(named_profile("UIC60-benchmark")), *pads)
            moving = FlexibleContact(contact, Flexibility(None, (support, support)))
            structure = QuasiStaticStructure(moving.pairs)
            return wagon_dynamics(Wagon(), Track(), moving, self.speed, structure)
        if self.plane:
            return wagon_dynamics(Wagon(), replace(self.track, irregularities=None), contact, self.speed)
        speed: float | SpeedProfile = self.speed
        if self.drawn["profile"] < 0.15 and self.vehicle.speed_hold is not None:
            speed = SpeedProfile.through((0.0, 1.0, 1.5, 99.0), (speed, speed, 0.97 * speed, 0.97 * speed))
        structures: tuple[QuasiStaticStructure | None, ...] | None = None
        if self.supple:
            hubs = hub_compliance(wheel_outline(named_profile("S1002"), 0.46), AxleShape(), pads[0], wheel_y=0.75)
            support = rail_compliance(rail_outline(named_profile("UIC60-benchmark")), *pads)
            contact = FlexibleContact(contact, Flexibility(hubs, (support, support)))
            structures = (QuasiStaticStructure(contact.pairs), *(len(self.vehicle.wheelsets) - 1) * (None,))
        elif self.named:
            other = self.wheelset(wheel("S1002"), rail("60E1", corner=5e-4), 0.5 * self.friction)
            contact = ContactsByWheelset(contact, dict.fromkeys(self.named, other))
        return VehicleDynamics(self.running, self.track, contact, speed, structures, loads=self.loads)

    @property
    def method(self) -> str:
        if self.plane and not self.sleepers and self.drawn["method"] > 0.8:
            return "ode45" if self.drawn["method"] > 0.9 else "ode23"
        if 0.6 < self.drawn["method"] < 0.8:
            return "rosenbrock_ends"
        return "rosenbrock4" if self.drawn["method"] < 0.2 else "rosenbrock"

    @property
    def span(self) -> tuple[float, float]:
        """s; of less road where every contact is solved by elements."""
        road = 10.0 if self.sleepers else 60.0 if self.elastic else 150.0
        longest = np.inf if self.method not in EXPLICIT else 0.5 if self.elastic else 1.5
        return 0.0, float(min(road / self.speed, longest))

    def initial(self) -> Array | None:
        """The equilibrium, for a third of the runs with wheelsets up to 3 mm beside it."""
        if self.drawn["start"] > 0.33:
            return None
        state, coordinates = start_state(self.dynamics), self.dynamics.coordinates
        for name in self.dynamics.vehicle.wheelsets:
            state[coordinates.index(name, Y)] += self.sign * 6e-3 * (self.drawn["start"] / 0.33 - 0.5)
        return state

    def history(self, limit: float, longest: float | None = None) -> History:
        """The run, interrupted after a processor time s; or with short steps and a fifth of the tolerance."""
        part, end = (1.0, np.inf) if longest is None else (0.2, longest)
        tolerance = part * self.between("tolerance", 1e-3, 5e-3)
        until = process_time() + limit

        def within_limit(done: float, figures: object) -> None:
            if process_time() > until:
                raise KeyboardInterrupt

        settings = StepSettings(self.method, tolerance, 1e-2 * tolerance, max_step=end)
        return simulate(self.dynamics, self.span, initial=self.initial(), steps=settings, progress=within_limit)
