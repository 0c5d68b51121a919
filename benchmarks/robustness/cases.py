"""Runs that must complete, or end with a reason."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np

from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.scenes.builders.wheelset import wheelset_contact
from wheelrail.scenes.schema.scene import RunScene, parse_scene
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.plane_wagon import COORDINATES, COUNT, wagon_dynamics
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.track.irregularity_spectrum import ERRI
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

SCENE = Path(__file__).parents[2] / "scenes" / "curve.toml"
ELASTIC, STANDARD = "elastic", "standard"
FALLING = '{ law = "polach-dry" }'  # friction of a scene: 0.55 at no slip, 0.22 at high velocities
OF_ELEMENTS = ("laws", "surface_size", "strips", "cells")  # keys that the standard contact does not have


@dataclass(frozen=True)
class RobustnessCase:
    """A run: coefficient of friction or law as in a scene, radius m and cant m of the curve after `tangent` and
    `transition` m, seed of irregularities of the class high or None, initial rates m/s or rad/s by coordinate, added to
    the equilibrium; whether it is compared with a run at a tenth of the tolerances.
    """

    name: str
    model: str
    speed: float
    friction: float | str = 0.3
    radius: float = 1200.0
    cant: float = 0.06
    tangent: float = 50.0
    transition: float = 100.0
    seconds: float | None = None
    seed: int | None = None
    kick: dict[str, float] = field(default_factory=dict)
    again: bool = False
    quick: bool = False

    @property
    def mu(self) -> str:
        """Friction in words."""
        return "falling" if self.friction == FALLING else f"{self.friction:g}"

    @property
    def span(self) -> tuple[float, float]:
        """s; by default up to 120 m into the curve."""
        return 0.0, self.seconds or (self.tangent + self.transition + 120.0) / self.speed

    def track(self) -> Track:
        smooth = Track.curve(
            curvature=1.0 / self.radius,
            cant=self.cant,
            tangent=self.tangent,
            transition=self.transition,
            length=1000.0,
        )
        if self.seed is None:
            return smooth
        uneven = ERRI["high"].irregularities(self.speed * self.span[1] + 50.0, seed=self.seed)
        return Track(smooth.curvature, smooth.superelevation, smooth.gradient, smooth.base, uneven)

    def start(self, wagon: Wagon, contact: VehicleContact) -> Array | None:
        """Initial state with the additional rates, if any."""
        if not self.kick:
            return None
        state = equilibrium(wagon_dynamics(wagon, self.track(), contact, self.speed)).state
        for name, rate in self.kick.items():
            state[COUNT + COORDINATES.index(name)] += rate
        return np.asarray(state)


@cache
def scene(model: str, friction: float | str) -> RunScene:
    """scenes/curve.toml with another contact and friction."""
    lines = [line for line in SCENE.read_text(encoding="utf-8").splitlines() if not line.startswith("friction")]
    if model == STANDARD:
        lines = [line for line in lines if line.split(" ")[0] not in OF_ELEMENTS]
        lines = [line.replace('"condensed"', '"standard"') for line in lines]
    run_scene = parse_scene("\n".join([f"friction = {friction}", *lines]))
    assert isinstance(run_scene, RunScene)
    return run_scene


@cache
def contact_of(model: str, friction: float | str) -> WheelsetContact:
    return wheelset_contact(scene(model, friction))


def cases() -> list[RobustnessCase]:
    """All cases, in ascending order of cost."""
    all_cases: list[RobustnessCase] = []
    for model in (STANDARD, ELASTIC):
        cheap = model == STANDARD
        all_cases += [
            RobustnessCase(
                "curve",
                model,
                speed,
                friction,
                again=cheap,
                quick=cheap or (speed, friction) == (60.0, 0.05),
            )
            for speed, friction in product((40.0, 50.0, 60.0), (0.05, 0.3, 0.6, FALLING))
        ]
        all_cases += [
            RobustnessCase(
                "irregular", model, speed, seconds=1.5, seed=seed, quick=cheap and (speed, seed) == (40.0, 1)
            )
            for speed, seed in product((40.0, 60.0), (1, 2) if cheap else (1,))
        ]
        all_cases += [
            RobustnessCase("blow on a wheel", model, 45.0, seconds=0.2, kick={"wheelset_roll": 0.3}, quick=cheap),
            RobustnessCase(
                "wheel lifted, landed", model, 45.0, seconds=0.7, kick={"car_body_roll": 1.1}, again=cheap, quick=False
            ),
            RobustnessCase(
                "body pushed aside", model, 45.0, seconds=2.0, kick={"car_body_y": -1.2}, again=cheap, quick=False
            ),
            RobustnessCase(
                "curve too fast", model, 45.0, radius=430.0, cant=0.0, tangent=20.0, seconds=5.0, quick=cheap
            ),
            RobustnessCase(
                "overturning",
                model,
                45.0,
                radius=300.0,
                cant=0.0,
                tangent=20.0,
                seconds=5.0,
                again=cheap,
                quick=cheap,
            ),
            RobustnessCase("overturning, low friction", model, 60.0, 0.05, 500.0, 0.0, 20.0, seconds=5.0, quick=cheap),
            RobustnessCase("blow aside", model, 45.0, 0.6, seconds=0.2, kick={"wheelset_y": -2.0}, quick=cheap),
            RobustnessCase("thrown off", model, 45.0, 0.3, seconds=0.5, kick={"wheelset_y": -4.0}, quick=cheap),
        ]
    return all_cases
