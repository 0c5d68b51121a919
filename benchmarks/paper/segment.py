"""The part of the paper's curve that all variants run: contact models, initial states, cost, and error.

Each contact model has its own reference, a run at tight tolerances from the same initial state, which also computes the
compliance of the bodies, so that no timed run includes it. Errors are RMS differences at the times of the reference's
steps.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.paper.error import Ran, difference
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.scenes.builders.vehicle import wagon
from wheelrail.scenes.builders.wheelset import wheelset_contact
from wheelrail.scenes.schema.scene import RunScene, load_scene
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.steady.equilibrium import Equilibrium, equilibrium

SCENE = Path(__file__).parents[2] / "scenes" / "paper_curve.toml"
TIGHT_NEWTON = 1e-11
ACCEPTABLE = 0.05  # of the axle load, static residual at the start, the same for all variants of a model


@dataclass(frozen=True)
class PaperBody:
    """A contact model: its name in tables, and its changes of the scene."""

    name: str
    changes: tuple[tuple[str, Any], ...] = ()

    def scene(self) -> RunScene:
        """The paper's scene with these changes."""
        scene = load_scene(SCENE)
        if not isinstance(scene, RunScene):
            raise TypeError(f"{SCENE.name} is not a run")
        data = scene.model_dump(exclude_unset=True)
        data["profiles"] = scene.profiles
        if dict(self.changes).get("laws") == "exact":
            data = {key: data[key] for key in data if key not in ("stiffness_per_area", "regularisation")}
        return RunScene.model_validate({**data, **dict(self.changes)})


@dataclass
class TrackSegment:
    """A time interval of the scene's run from start s, with one contact model.

    patience: time limit s of its reference.
    """

    body: PaperBody
    start: float
    seconds: float
    patience: float = 120.0

    @cached_property
    def scene(self) -> RunScene:
        return self.body.scene()

    @cached_property
    def contact(self) -> WheelsetContact:
        return wheelset_contact(self.scene)

    def tuned(self, options: dict[str, Any]) -> WheelsetContact:
        """The same bodies with other options of Newton's method, which a lattice does not have."""
        model: Any = self.contact.model
        if isinstance(model, LatticeContact):
            return self.contact
        return replace(self.contact, model=replace(model, options=replace(model.options, **options)))

    def dynamics(self, contact: VehicleContact) -> VehicleDynamics:
        return wagon_dynamics(wagon(self.scene), self.scene.track.track(), contact, self.scene.vehicle.speed_profile)

    @cached_property
    def steady(self) -> Equilibrium:
        """Steady state at the start, within the accuracy of the contact model. Raises EquilibriumError."""
        return equilibrium(self.dynamics(self.contact), time=self.start, acceptable=ACCEPTABLE)

    @property
    def initial(self) -> Array:
        return self.steady.state

    @cached_property
    def reference(self) -> History:
        """The run at tight tolerances. Raises RuntimeError when it fails, EquilibriumError without a start."""
        run = self._run(
            self.tuned({"tolerance": TIGHT_NEWTON}), "ode45", 1e-3 * self.scene.solver.rtol, 1e-9, self.patience
        )
        if run.status != "completed":
            raise RuntimeError(f"the reference run: {run.status}")
        return run

    @cached_property
    def missing(self) -> str:
        """Reason of a missing reference; empty if there is one. Tried once."""
        try:
            return "" if len(self.reference) else "empty"
        except RuntimeError as error:
            return str(error)

    def run(self, method: str, options: dict[str, Any], *, contact: VehicleContact | None = None) -> History:
        """One run at the tolerances of the scene; contact: replaces that of this part, for Eq. (12)."""
        solver = self.scene.solver
        return self._run(contact or self.tuned(options), method, solver.rtol, solver.atol)

    def compared(self, history: History) -> Ran:
        """Cost and error of a run."""
        if history.status != "completed" or len(history) < 2:
            return Ran(history.cost, failure=history.status)
        if self.missing:
            return Ran(history.cost, note=f"no error: {self.missing}")
        y, force = difference(history, self.reference)
        return Ran(history.cost, y, force / self.load)

    @cached_property
    def load(self) -> float:
        """Static wheel load, N."""
        return float(self.reference.force[:, 0, :, 2].mean())

    def _run(self, contact: VehicleContact, method: str, rtol: float, atol: float, patience: float = np.inf) -> History:
        began = perf_counter()

        def check_time(fraction: float, _: Mapping[str, float]) -> None:
            if perf_counter() - began > patience:
                raise RuntimeError(f"the reference run is {100 * fraction:.0f} % done after {patience:g} s")

        return simulate(
            wagon_dynamics(wagon(self.scene), self.scene.track.track(), contact, self.scene.vehicle.speed_profile),
            (self.start, self.start + self.seconds),
            initial=self.initial,
            steps=StepSettings(method, rtol, atol),
            progress=check_time,
        )
