"""Contact of a Hertz pair by the state of its upper body."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from wheelrail.contact.kinematics.hertz_state import HertzState
from wheelrail.contact.models.wheelset import ContactModel
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import StateContact
from wheelrail.support.arrays import Array

HertzSide = Literal["contact"]


@dataclass(frozen=True)
class HertzContact(StateContact[HertzState, HertzSide]):
    """Contact of a Hertz pair; its only side is "contact".

    Parameters:
        model: contact model of the pair.

    The force acts on the upper body, the moment is about `HertzState.reference`.
    """

    model: ContactModel

    def __call__(self, state: HertzState, side: HertzSide, guess: ContactResult | None = None) -> ContactResult:
        result = self.model(*state.pair(), guess).about(state.reference)
        return replace(result, approach=-state.z) if result.ok else result  # of the bodies, not of the nearest cell

    def tangent(self, state: HertzState, side: HertzSide, result: ContactResult) -> Array:
        """Derivative (6, 6) of force N and moment N m by `HertzState.coordinates`.

        Parameters as for `StateContact.tangent`. Raises ValueError for a model or a result without tangent.
        """
        derivative = result.tangent()[:, SLOPE]
        x, y, z = result.force
        derivative[3:, 0] += [0.0, z, -y]  # the reference moves: F x e_x
        derivative[3:, 1] += [-z, 0.0, x]  # .. and F x e_y
        return np.asarray(derivative)


SLOPE = [0, 1, 2, 6, 7, 11]  # columns of `ContactResult.tangent`: translation, velocity along x and y, spin
