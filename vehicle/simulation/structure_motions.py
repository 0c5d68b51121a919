"""Motions of axle and rails that belong to a given state of the bodies."""

from __future__ import annotations

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.equations import VehicleDynamics, VehicleEvaluation
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian

TOLERANCE = 1e-8  # m and rad, of motions that follow constant loads: 10 N on a contact
MAX_STEPS = 8  # Newton steps; 2 suffice from states within a step of the integration


def with_motions_at_rates(
    dynamics: VehicleDynamics, time: float, state: Array, rates: Array, previous: VehicleEvaluation
) -> tuple[Array, VehicleEvaluation]:
    """State whose motions of axle and rails have given rates under the loads of the contacts, and its evaluation.

    Interpolated motions are not accurate enough: wheel and rail both move, and an error of 10 um between them is one of
    10 kN. Rates are.
    Parameters:
        dynamics: equations of motion, with elastic axles or rails.
        time: s.
        state: (2 c + m + k,), of which the last k are a first approximation.
        rates: (k,) m/s and rad/s.
        previous: evaluation nearby, whose contacts are the initial guess.

    Raises StepFailure when a contact solve fails, and without convergence.
    """
    distances = dynamics.distances(dynamics.speed_profile(time), state)
    state, first, jacobian = state.copy(), dynamics.coordinates.size, VehicleJacobian(dynamics, StepStatistics())
    for _ in range(MAX_STEPS):
        evaluation = dynamics(time, state, previous)
        error = evaluation.rate[first:] - rates
        if np.abs(dynamics.structures.static(error, distances)).max() <= TOLERANCE:
            return state, evaluation
        slopes = jacobian(time, state, evaluation).by_state[first:, first:]
        state[first:] -= np.linalg.solve(slopes, error)
        previous = evaluation
    raise StepFailure(f"motions of axle and rails do not settle in {MAX_STEPS} Newton steps")
