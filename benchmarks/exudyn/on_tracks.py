"""Manchester vehicle 1 by a smooth law of contact on co-running tracks with mass."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from benchmarks.exudyn.smooth_pair import SmoothLaw, SmoothPair
from wheelrail.contact.loading.co_running_structure import CoRunningStructure
from wheelrail.contact.loading.flexible_contact import FlexibleContact
from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.scenes.builders.wheelset import run_contact
from wheelrail.scenes.schema.scene import RunScene, checked
from wheelrail.scenes.schema.toml import parse, read_text
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.integrate import StepSettings, integrate
from wheelrail.vehicle.multibody.coordinates import PITCH, ROLL, Z
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.track.track import Track

SCENE = Path(__file__).parents[2] / "scenes" / "vehicle.toml"
BENEATH = {"pads": {"vertical": 100e6, "lateral": 40e6}, "ballast": {"length": "halves"}}
# m and rad, m/s and rad/s, of a random start: Exudyn leaves out rotations below 1e-7 rad in a step
PLACES, RATES, STIFF = 1e-3, 3e-2, 0.1  # the last one: share of z and roll of wheelsets
# of the motions of a wheelset's axle and tracks by side, those of the left track, then of the right one
TRACKS = [12, 13, 14, 18, 19, 15, 16, 17, 20, 21]


@dataclass(frozen=True)
class OnTracks:
    """The vehicle on halves of sleepers, whose rails carry its nominal load at first."""

    law: SmoothLaw = field(default_factory=SmoothLaw)

    @cached_property
    def dynamics(self) -> VehicleDynamics:
        """Equations of motion of this package."""
        data = parse(read_text(SCENE), SCENE)
        scene = checked({**data, "track": {**data["track"], **BENEATH}}, SCENE)
        assert isinstance(scene, RunScene)
        vehicle = replace(load_vehicle(), speed_hold=None)
        contact, structures = run_contact(scene, vehicle.wheelsets)
        assert isinstance(contact, FlexibleContact)
        pair = SmoothPair(self.law, contact.contact.mounting.wheel_y - contact.contact.mounting.rail_y)
        return VehicleDynamics(vehicle, Track(), contact.changed(lambda _: pair), self.law.speed, structures)

    @cached_property
    def structure(self) -> CoRunningStructure:
        """Track of the first wheelset; they are alike."""
        first = self.dynamics.structures.own[0]
        assert isinstance(first, CoRunningStructure)
        return first

    @cached_property
    def rest(self) -> Array:
        """Motions (10,) of the left and the right track under the nominal load."""
        load = np.array([0.0, -self.law.load, 0.0, 0.0, 0.0])
        return np.concatenate([np.linalg.solve(track.stiffness, load) for track in self.structure.tracks])

    @cached_property
    def initial(self) -> Array:
        """Random state of the bodies, which are lower as the rails are."""
        of, size, random = self.dynamics.coordinates, self.structure.size, np.random.default_rng(7)
        state, sides = np.zeros(self.dynamics.size), np.zeros(size)
        state[: of.count] = PLACES * random.normal(size=of.count)
        state[of.count : 2 * of.count] = RATES * random.normal(size=of.count)
        for name, body in self.dynamics.vehicle.bodies.items():
            for own in (Z, ROLL) if body.wheelset else ():
                for first in (0, of.count):
                    state[first + of.index(name, own)] *= STIFF
            state[of.index(name, Z)] += self.rest[1]
        sides[TRACKS] = self.rest
        count = len(self.dynamics.vehicle.wheelsets)
        state[-count * size :] = np.tile(np.linalg.solve(self.structure.of_sides, sides), count)
        return state

    def ours(self, end: float) -> Array:
        """Coordinates (n, 6) of the bodies at the end by this package, pitch as zero."""
        settings = StepSettings("ode45", rtol=1e-8, atol=1e-11)
        *_, last = integrate(self.dynamics, 0.0, self.initial, end, settings)
        position = last.x[: self.dynamics.coordinates.count].reshape(-1, 6).copy()
        position[:, PITCH] = 0.0
        return np.asarray(position)
