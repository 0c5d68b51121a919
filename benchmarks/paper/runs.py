"""Runs of the variants, each once, on the long and the short part of the paper's curve; failures are recorded."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from benchmarks.paper.error import Ran, difference
from benchmarks.paper.segment import PaperBody, TrackSegment
from benchmarks.paper.variants import LATTICE, PaperVariant
from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.scenes.builders.wheelset import wheelset_contact
from wheelrail.vehicle.simulation.history import RunCost

FAILURES = (RuntimeError, ValueError, ArithmeticError, np.linalg.LinAlgError)


@dataclass(frozen=True)
class BySide(VehicleContact):
    """Separate models for both wheels: that of Eq. (12) uses its own last displacements as initial guess."""

    contacts: dict[Side, WheelsetContact]

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        return self.contacts[side](state, side, guess)


@dataclass
class Runs:
    """Parts by contact model and outcomes by variant; start and lengths of both parts in s."""

    start: float
    seconds: float
    short: float
    say: Callable[[str], None] = print
    _parts: dict[tuple[PaperBody, float], TrackSegment] = field(default_factory=dict)
    _done: dict[tuple[Any, ...], Ran] = field(default_factory=dict)
    _full: dict[PaperBody, WheelsetContact] = field(default_factory=dict)
    variants: list[tuple[PaperVariant, Ran, float]] = field(default_factory=list)

    def length(self, variant: PaperVariant) -> float:
        """Length of the part that a variant runs, s."""
        return self.short if variant.full or variant.short else self.seconds

    def part(self, body: PaperBody, seconds: float) -> TrackSegment:
        """The part of a contact model; raises as `TrackSegment` does when its reference fails."""
        return self._parts.setdefault((body, seconds), TrackSegment(body, self.start, seconds))

    def of(self, variant: PaperVariant) -> Ran:
        """Outcome of a variant."""
        if variant.key not in self._done:
            self.say(f"{variant.name}, {variant.body.name}")
            try:
                ran = self._run(variant)
            except FAILURES as error:
                ran = Ran(RunCost(), failure=f"{type(error).__name__}: {error}")
            self._done[variant.key] = ran
            self.variants.append((variant, ran, self.length(variant)))
        return self._done[variant.key]

    def _run(self, variant: PaperVariant) -> Ran:
        part, options = self.part(variant.body, self.length(variant)), dict(variant.options)
        self.say(f"  {part.missing or 'reference run'}")  # computes the compliances, which no timed run includes
        contact: VehicleContact = self._whole(part, options) if variant.full else part.tuned(options)
        dynamics = part.dynamics(contact)
        dynamics(part.start, part.initial)  # factorisations and compilation are not timed
        return part.compared(part.run(variant.method, options, contact=contact))

    def _whole(self, part: TrackSegment, options: dict[str, Any]) -> BySide:
        """Eq. (12) on the meshes of the part."""
        if part.body not in self._full:
            self._full[part.body] = wheelset_contact(part.scene.model_copy(update={"model": "full"}))
        contact = self._full[part.body]
        model: Any = contact.model
        tuned = replace(model.options, **options)
        return BySide({side: replace(contact, model=replace(model, options=tuned)) for side in SIDES})

    def models(self) -> list[list[Any]]:
        """Reference of every contact model compared with that on a lattice: name, residual at the start in % of the
        axle load, differences mm and % of load.
        """
        lattice = self._parts.get((LATTICE, self.seconds))
        rows: list[list[Any]] = []
        for (body, seconds), part in self._parts.items():
            if seconds != self.seconds:
                continue
            try:
                residual = f"{100 * part.steady.residual:.2g}"
                if lattice is None:
                    raise RuntimeError("no run on a lattice")
                y, force = difference(part.reference, lattice.reference)
                rows.append([body.name, residual, f"{1e3 * y:.4f}", f"{100 * force / lattice.load:.3f}"])
            except FAILURES as error:
                rows.append([body.name, "", "", f"{type(error).__name__}: {error}"])
        return rows
