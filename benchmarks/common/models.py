"""Contact models of the accuracy benchmark; bodies and discretisation are set here."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np
from scipy.special import ellipe, ellipk

from wheelrail.contact.analytical.hertz import Hertz, hertz, modulus
from wheelrail.contact.kinematics.frames import RigidMotion, Twist
from wheelrail.contact.kinematics.wheelset_state import Mounting
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose, hertz_under_load
from wheelrail.contact.models.builders import hertz_pair, wheel_rail_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.contact.models.wheelset import ContactModel, WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.meshes.profiles.library import load_profile
from wheelrail.support.arrays import Array

CHOICES: dict[str, Any] = {"bodies": "waveguide"}  # of the discretisation of every pair
EXACT = np.inf  # N/m3
STEEL = Material()


def lattice_resolution(text: str) -> LatticeResolution:
    """Strips and cells of an argument such as 8x10. Raises ValueError."""
    strips, cells = map(int, text.split("x"))
    return LatticeResolution(strips, cells)


def frictionless() -> ContactLaws:
    return ContactLaws(EXACT, 0.0, 0.0)


def frictional(friction: float) -> ContactLaws:
    return ContactLaws(EXACT, friction, 0.0)


@dataclass(frozen=True)
class Ellipse:
    """Two bodies of the same material, the upper one with principal radii (x, y) [m] on a plane, under a load [N]."""

    radii: tuple[float, float]
    load: float
    steel: Material = STEEL

    @cached_property
    def exact(self) -> Hertz:
        """Hertz's solution on half-spaces."""
        A, B = 0.5 / self.radii[0], 0.5 / self.radii[1]
        return hertz(A, B, modulus(*[(self.steel.E, self.steel.nu)] * 2), force=self.load)

    @property
    def shear(self) -> float:
        """Shear modulus G, Pa."""
        return self.steel.E / (2 + 2 * self.steel.nu)

    def size(self, *, points: int | None = None, across: float | None = None) -> float:
        """Surface size [m] for a total number of points, or a number across the short axis."""
        a, b = self.exact.semi_axes
        return float(np.sqrt(np.pi * a * b / points)) if points else 2 * min(a, b) / (across or 20.0)

    def half_width(self, size: float) -> float:
        """Half width and depth [m] of the blocks of `hertz_pair`: at least 40 semi-axes, in coarse steps."""
        return float(size * 2.0 ** np.ceil(np.log2(40 * max(self.exact.semi_axes) / size)))

    @classmethod
    def of_ratio(cls, ratio: float, radius: float, load: float, steel: Material) -> Ellipse:
        """The pair with semi-axes in the ratio a / b and the radius [m] along the rolling direction."""
        k = min(ratio, 1 / ratio)
        m = 1 - k * k
        low = k * k * (ellipk(m) - ellipe(m)) / (ellipe(m) - k * k * ellipk(m)) if m > 1e-9 else 1.0  # A / B
        return cls((radius, float(radius * low if ratio > 1 else radius / low)), load, steel)


def hertz_model(pair: Ellipse, laws: ContactLaws, size: float, **choices: Any) -> Any:
    """Contact model of a pair with surface size [m] and choices of `Discretisation`."""
    how = Discretisation(size, **(CHOICES | choices))
    return hertz_pair((pair.radii, (np.inf, np.inf)), (pair.steel, pair.steel), laws, how, load=pair.load)


@dataclass(frozen=True)
class PairTrack:
    """Track and materials of a wheelset: gauge m, 14 mm below the top of the rail, wheel_y m, radius m."""

    steel: Material
    gauge: float = 1.435
    gauge_height: float = 0.014
    wheel_y: float = 0.75
    radius: float = 0.46


@cache
def wheelset_model(track: PairTrack, laws: ContactLaws, size: float, **choices: Any) -> WheelsetContact:
    """S1002 on UIC60 (inclined 1/40 as given) with surface size [m]."""
    wheel, rail = load_profile("S1002", "wheel"), load_profile("UIC60-benchmark", "rail")
    how = Discretisation(size, **(CHOICES | choices))
    model = wheel_rail_pair((wheel, rail), track.radius, (track.steel, track.steel), laws, how)
    return WheelsetContact(
        model, Mounting(track.wheel_y, rail.gauge_offset(track.gauge, track.gauge_height), track.radius)
    )


def rolling(xi: float, eta: float = 0.0, phi: float = 0.0, *, speed: float = 1.0) -> RigidMotion:
    """Both materials move backwards at a speed [m/s]; the upper one is faster by creepages xi, eta and phi [rad/m]."""
    flow, slip, origin = np.array([-speed, 0.0, 0.0]), speed * np.array([xi, eta, 0.0]), np.zeros(3)
    spin = np.array([0.0, 0.0, speed * phi])
    return RigidMotion(Twist(flow + 0.5 * slip, 0.5 * spin, origin), Twist(flow - 0.5 * slip, -0.5 * spin, origin))


def pressed(pair: Ellipse, size: float) -> tuple[float, ContactResult]:
    """Approach [m] and result of the frictionless pair under its load."""
    solution = hertz_under_load(
        hertz_model(pair, frictionless(), size), rolling(0.0), pair.load, expected=pair.exact.approach, rtol=1e-7
    )
    return solution.depth, solution.results[0]


def solved(model: ContactModel, depth: float, motion: RigidMotion) -> ContactResult:
    """One contact at a depth [m]; raises RuntimeError when it fails."""
    result = model(hertz_pose(depth), motion, None)
    if result.status != "converged":
        raise RuntimeError(f"contact {result.status}")
    return result


def carrying(result: ContactResult) -> int:
    """Number of points under pressure."""
    return 0 if result.fields is None else int((result.fields.pressure > 0).sum())


def loads(result: ContactResult) -> Array:
    """(Fx, Fy, Mz, Fz) on the upper body, moment about the point of first contact."""
    return np.array([*result.force[:2], result.moment[2], result.force[2]])
