"""Randomly sampled poses, loads, creepages, laws and sizes of an S1002 wheel on a rail: a Latin hypercube."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import qmc

from wheelrail.contact.kinematics.frames import Pose, RigidMotion, Twist
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.meshes.profiles.named import named_profile

RADIUS, SPEED, WHEEL_Y = 0.46, 20.0, 0.75
RAILS = ("60E1", "UIC60-benchmark")
SIZES = (0.5e-3, 1e-3, 2e-3, 3e-3)
EXACT_K = 0.6  # fraction of cases with the exact normal law
EXACT_EPS = 0.4  # fraction of cases with Coulomb's own law
NO_MU = 0.05  # fraction of cases without friction
MAX_POINTS = 700  # of a grid: heavy loads get the smallest size that needs no more
AREA = 1.9e-7  # m2 N^(-2/3), approximate area of penetration


@dataclass(frozen=True)
class SampledCase:
    """One contact. y m, roll and yaw rad, load N, longitudinal and lateral creepage, spin 1/m beyond that of the
    contact angle, friction, stiffness_per_area N/m3 (inf: exact), regularisation, size m of the surface.
    """

    number: int
    rail: str
    y: float
    roll: float
    yaw: float
    load: float
    longitudinal: float
    lateral: float
    spin: float
    friction: float
    stiffness_per_area: float
    regularisation: float
    size: float

    @property
    def laws(self) -> ContactLaws:
        return ContactLaws(self.stiffness_per_area, self.friction, self.regularisation)

    @property
    def state(self) -> WheelsetState:
        """At nominal height, rolling at 20 m/s."""
        return WheelsetState(
            y=self.y,
            roll=self.roll,
            yaw=self.yaw,
            y_rate=self.lateral * SPEED,
            pitch_rate=(1 + self.longitudinal) * SPEED / RADIUS,
            speed=SPEED,
        )

    def at(self, depth: float) -> tuple[Pose, RigidMotion]:
        """Pose of the left wheel lowered by a depth m, and motion with the spin about a vertical axis through the
        wheel's nominal contact.
        """
        rail = named_profile(self.rail)
        mounting = Mounting(WHEEL_Y, rail.gauge_offset(1.435, 0.014), RADIUS)
        pose, motion = mounting.left_pair(replace(self.state, z=-depth))
        turn = np.array([0.0, 0.0, self.spin * SPEED])
        below = pose.origin - np.array([0.0, 0.0, RADIUS])
        wheel = motion.wheel
        velocity = wheel.velocity + np.cross(turn, wheel.reference - below)
        return pose, replace(motion, wheel=Twist(velocity, wheel.rotation + turn, wheel.reference))


def cases(count: int, seed: int) -> list[SampledCase]:
    """Latin hypercube of a number of cases; logarithmic in load, stiffness and regularisation."""
    names = ("rail", "y", "roll", "yaw", "load", "xi", "eta", "spin", "mu", "K", "eps", "size")
    unit = qmc.LatinHypercube(len(names), seed=seed).random(count)

    def symmetric(u: float) -> float:
        """Creepages of both signs, logarithmic from 1e-5 of the largest."""
        return float(np.sign(u - 0.5) * 10 ** (5 * abs(2 * u - 1) - 5))

    def above(u: float, fraction: float) -> float:
        """Part of u beyond a fraction, scaled to 0 to 1; negative within the fraction."""
        return (u - fraction) / (1 - fraction)

    sampled = []
    for number, row in enumerate(unit):
        at = dict(zip(names, map(float, row), strict=True))
        K, eps, mu = above(at["K"], EXACT_K), above(at["eps"], EXACT_EPS), above(at["mu"], NO_MU)
        sampled.append(
            SampledCase(
                number=number,
                rail=RAILS[int(at["rail"] * len(RAILS))],
                y=9e-3 * (2 * at["y"] - 1),
                roll=1e-2 * (2 * at["roll"] - 1),
                yaw=3e-2 * (2 * at["yaw"] - 1),
                load=100.0 * 2000.0 ** at["load"],
                longitudinal=0.05 * symmetric(at["xi"]),
                lateral=0.05 * symmetric(at["eta"]),
                spin=symmetric(at["spin"]),
                friction=max(0.8 * mu, 0.0),
                stiffness_per_area=np.inf if K < 0 else 1e13 * 1e4**K,
                regularisation=0.0 if eps < 0 else 10 ** (-3 - 4 * eps),
                size=max(SIZES[int(at["size"] * len(SIZES))], 0.0 if K < 0 else _finest(at["load"])),
            )
        )
    return sampled


def _finest(load: float) -> float:
    """Smallest size m whose grid has at most MAX_POINTS points, load as in the unit cube."""
    area = AREA * (100.0 * 2000.0**load) ** (2 / 3)
    return next(size for size in SIZES if area / size**2 <= MAX_POINTS)
