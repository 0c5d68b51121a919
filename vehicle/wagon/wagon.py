"""The Manchester wagon (benchmark vehicle 1) and its scaling to the plane model.

Sources: S. Iwnicki, Vehicle System Dynamics 30 (1998) 295-313, DOI 10.1080/00423119808969454, as quoted by the public
codes OpenVSD and TTB-2D and a public MATLAB vehicle file. Masses, inertias, heights, primary and secondary springs and
dampers agree in at least two of them. Only one gives the top of the secondary spring (hence its mid height 0.8275 m),
the bending stiffness, the anti-roll bar and the bumpstop. Assumed: attachment points of dampers, no stiffness in series
with them, and the axes of the spring forces (`Suspension.turn`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

from wheelrail.vehicle.wagon.components import InvalidParameter, RigidBody, Scaling, Suspension, check
from wheelrail.vehicle.wagon.force_law import ForceLaw

PAPER = Scaling()
WHOLE = Scaling(1.0, 1.0, 1.0, 1.0, 1.0)

CAR_BODY = RigidBody(mass=32000.0, roll_inertia=56800.0, pitch_inertia=1.97e6, yaw_inertia=1.97e6, height=1.80)
BOGIE = RigidBody(mass=2615.0, roll_inertia=1722.0, pitch_inertia=1476.0, yaw_inertia=3067.0, height=0.60)
WHEELSET = RigidBody(mass=1813.0, roll_inertia=1120.0, pitch_inertia=112.0, yaw_inertia=1120.0, height=0.46)
PRIMARY = Suspension(
    lateral_stiffness=3.884e6,
    vertical_stiffness=1.220e6,
    lateral_damping=2e3,
    vertical_damping=4e3,
    bending_stiffness=0.0,
    spring_y=1.0,
    spring_height=0.46,
    damper_y=1.0,
    damper_height=0.46,
)
SECONDARY = Suspension(
    lateral_stiffness=160e3,
    vertical_stiffness=430e3,
    lateral_damping=32e3,
    vertical_damping=20e3,
    bending_stiffness=10.5e3,
    spring_y=1.0,
    spring_height=0.8275,
    damper_y=1.0,
    damper_height=0.8275,
)
BUMPSTOP = ForceLaw(
    (
        (0.0, 0.0),
        (0.025, 0.0),
        (0.030, 600.0),
        (0.035, 1760.0),
        (0.040, 3730.0),
        (0.045, 6870.0),
        (0.050, 11580.0),
        (0.055, 17170.0),
        (0.060, 29200.0),
        (0.065, 230000.0),
    )
)


@dataclass(frozen=True)
class Wagon:
    """A four-axle wagon: one car body, two bogies, four wheelsets.

    Parameters:
        car_body, bogie, wheelset: rigid bodies; the height of the wheelset is its nominal rolling radius.
        primary: suspension stage, values per axle box.
        secondary: suspension stage, values per side of a bogie.
        roll_bar: per bogie, N m/rad.
        bumpstop: lateral, per bogie; an odd law.
        bumpstop_height: above top of rail, m.
        scaling: fractions of the vehicle in the plane model.
        gravity: m/s2.

    `dataclasses.replace` changes values. Raises InvalidParameter for values out of bounds.
    """

    car_body: RigidBody = CAR_BODY
    bogie: RigidBody = BOGIE
    wheelset: RigidBody = WHEELSET
    primary: Suspension = PRIMARY
    secondary: Suspension = SECONDARY
    roll_bar: float = 940e3
    bumpstop: ForceLaw = BUMPSTOP
    bumpstop_height: float = 0.65
    scaling: Scaling = PAPER
    gravity: float = 9.81

    def __post_init__(self) -> None:
        check(self)
        if not self.car_body.height > self.bogie.height > 0.0:
            raise InvalidParameter(self, "car_body", "height must be greater than that of the bogie")
        if not self.bumpstop.odd:
            raise InvalidParameter(self, "bumpstop", "must be an odd law: its first point must be (0, 0)")

    @property
    def radius(self) -> float:
        """Nominal rolling radius, m."""
        return self.wheelset.height

    @cached_property
    def plane(self) -> Wagon:
        """The plane model, with the fractions of one wheelset: values scaled, scaling 1."""
        s = self.scaling
        return replace(
            self,
            car_body=self.car_body.scaled(s.car_body),
            bogie=self.bogie.scaled(s.bogie),
            wheelset=self.wheelset.scaled(s.wheelset),
            primary=self.primary.scaled(s.primary),
            secondary=self.secondary.scaled(s.secondary),
            roll_bar=s.secondary * self.roll_bar,
            bumpstop=s.secondary * self.bumpstop,
            scaling=WHOLE,
        )

    @property
    def axle_load(self) -> float:
        """Weight on one wheelset, N."""
        p = self.plane
        return p.gravity * (p.car_body.mass + p.bogie.mass + p.wheelset.mass)

    @property
    def wheel_load(self) -> float:
        """Static load of one wheel, N."""
        return 0.5 * self.axle_load
