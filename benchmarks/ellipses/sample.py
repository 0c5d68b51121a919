"""Randomly sampled ellipses that roll, from light to heavy loads and from adhesion to gross slip."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.common.models import Ellipse
from wheelrail.contact.analytical.kalker import kalker
from wheelrail.contact.laws.friction import Coulomb, FallingFriction
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws

ROLLING_RADII = 0.2, 1.0  # m
LATERAL_RADII = 0.02, 3.0  # m
LOADS = 1.0, 3e5  # N
POISSON = 0.2, 0.4
YOUNG = 2.1e11  # Pa
FRICTION = 0.8  # largest coefficient
FALLING = 0.25  # fraction of cases whose friction falls with the slip velocity
RATES = 0.01, 1.0  # s/m, of the fall; Polach's are 0.2 and 0.6
SATURATION = 5.0  # largest creepage over that at which Kalker's linear force reaches mu F_n
SPEEDS = 1.0, 80.0  # m/s


@dataclass(frozen=True)
class RollingEllipse:
    """One contact: a body with radii (along x, across) [m] on a plane under a load [N], rolling at a speed [m/s] with
    creepages (xi, eta, phi [rad/m]), and the friction law between the bodies.
    """

    number: int
    pair: Ellipse
    friction: Coulomb | FallingFriction
    creepages: tuple[float, float, float]
    speed: float

    @property
    def laws(self) -> ContactLaws:
        """Exact contact with friction."""
        return ContactLaws(friction=self.friction)


def rolling_ellipse(seed: int, number: int) -> RollingEllipse:
    """The case of a number, which does not depend on how many are drawn."""
    random = np.random.default_rng((seed, number))

    def logarithmic(limits: tuple[float, float]) -> float:
        return float(np.exp(random.uniform(*np.log(limits))))

    radii, load = (logarithmic(ROLLING_RADII), logarithmic(LATERAL_RADII)), logarithmic(LOADS)
    pair = Ellipse(radii, load, Material(YOUNG, float(random.uniform(*POISSON))))
    mu, speed = float(random.uniform(0, FRICTION)), logarithmic(SPEEDS)
    falls, remainder, rate = random.uniform() < FALLING, float(random.uniform(0.2, 1)), logarithmic(RATES)
    a, b = pair.exact.semi_axes
    ratio = float(np.clip(a / b, 0.1, 10))  # of Kalker's table
    linear = np.array([kalker(name, ratio, pair.steel.nu) for name in ("C11", "C22", "C23")])
    stiffness = pair.shear * a * b * linear * [1, 1, np.sqrt(a * b)]
    direction = random.standard_normal(3)
    saturation = random.uniform(0, SATURATION) * mu * load / stiffness
    creepages = saturation * direction / np.linalg.norm(direction)
    friction = FallingFriction(mu, remainder, rate) if falls else Coulomb(mu)
    return RollingEllipse(number, pair, friction, (creepages[0], creepages[1], creepages[2]), speed)
