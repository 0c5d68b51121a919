"""The plane wagon on `LinearContact` from its energies by Lagrange's equations, derived by SymPy. Only the parameters
are those of the wagon; suspension, equations of motion and frame formulas of the package are not used.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import sympy as sp
from track_frame import Frame

from benchmarks.exudyn.linear_contact import LinearContact
from wheelrail.vehicle.wagon.components import Suspension
from wheelrail.vehicle.wagon.wagon import Wagon

Q = sp.Matrix(sp.symbols("y1 z1 s1 y2 z2 s2 y3 z3 s3 theta"))
P = sp.Matrix(sp.symbols("vy1 vz1 vs1 vy2 vz2 vs2 vy3 vz3 vs3 vtheta"))  # of theta: the whole spin, rolling included
SPEED, *W = sp.symbols("V wx wy wz")
WD = sp.symbols("dx dy dz")
DOWN = sp.symbols("down_x down_y down_z")
STOP = sp.Function("stop")


def turned(angle: sp.Expr, y: sp.Expr, z: sp.Expr) -> sp.Matrix:
    return sp.Matrix([sp.cos(angle) * y - sp.sin(angle) * z, sp.sin(angle) * y + sp.cos(angle) * z])


def rate(expression: sp.Matrix) -> sp.Matrix:
    """Time derivative relative to the track frame."""
    return expression.jacobian(Q) * P


@dataclass(frozen=True)
class Energies:
    """kinetic and potential energy J, dissipation function W/2, deflection of the bumpstop m to the left."""

    kinetic: sp.Expr
    potential: sp.Expr
    dissipation: sp.Expr
    stop: sp.Expr

    @classmethod
    def of(cls, wagon: Wagon, contact: LinearContact) -> Energies:
        w = wagon.plane
        bodies = (w.car_body, w.bogie, w.wheelset)
        centre = [sp.Matrix([Q[3 * i], b.height + Q[3 * i + 1]]) for i, b in enumerate(bodies)]
        kinetic = potential = dissipation = sp.Integer(0)
        for i, body in enumerate(bodies):
            (y, z), (vy, vz), roll = centre[i], P[3 * i : 3 * i + 2], Q[3 * i + 2]
            velocity = sp.Matrix([SPEED, vy, vz]) + sp.Matrix(W).cross(sp.Matrix([0, y, z]))
            o_y, o_z = turned(-roll, W[1], W[2])
            spin = P[9] if i == 2 else 0
            turning = body.roll_inertia * (W[0] + P[3 * i + 2]) ** 2 + body.pitch_inertia * (o_y + spin) ** 2
            kinetic += (body.mass * velocity.dot(velocity) + turning + body.yaw_inertia * o_z**2) / 2
            potential -= body.mass * w.gravity * (DOWN[1] * y + DOWN[2] * z)

        def gap(upper: int, lower: int, y: float, height: float) -> sp.Matrix:
            """Of two points that coincide in the nominal position, in the axes of the lower body."""
            ends = [centre[i] + turned(Q[3 * i + 2], y, height - bodies[i].height) for i in (upper, lower)]
            return turned(-Q[3 * lower + 2], *(ends[0] - ends[1]))

        stages: list[tuple[Suspension, int, int, float]] = [
            (w.secondary, 0, 1, w.car_body.mass),
            (w.primary, 1, 2, w.car_body.mass + w.bogie.mass),
        ]
        for stage, upper, lower, mass in stages:
            for side in (1, -1):
                y, z = gap(upper, lower, side * stage.spring_y, stage.spring_height)
                potential += (stage.lateral_stiffness * y**2 + stage.vertical_stiffness * z**2) / 2
                potential -= mass * w.gravity / 2 * z
                v = rate(gap(upper, lower, side * stage.damper_y, stage.damper_height))
                dissipation += (stage.lateral_damping * v[0] ** 2 + stage.vertical_damping * v[1] ** 2) / 2
        potential += (w.roll_bar + 2 * w.secondary.bending_stiffness) * (Q[2] - Q[5]) ** 2 / 2
        for b in (contact.across, -contact.across):
            moved = centre[2] + turned(Q[8], b, -contact.radius) - sp.Matrix([b, 0])
            v = rate(moved)
            for k, (stiffness, damping) in enumerate((contact.lateral, contact.vertical)):
                potential += stiffness * moved[k] ** 2 / 2
                dissipation += damping * v[k] ** 2 / 2
            potential -= contact.load * moved[1]
        return cls(kinetic, potential, dissipation, gap(0, 1, 0.0, w.bumpstop_height)[0])

    def linear(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Mass, damping and stiffness (9, 9) of small motions about the nominal position at rest, without
        the bumpstop.
        """
        slopes = [
            sp.Matrix([e]).jacobian(v) for e, v in ((self.kinetic, P), (self.dissipation, P), (self.potential, Q))
        ]
        slope = sp.lambdify([*Q, *P, SPEED, *W, *DOWN], slopes, cse=True)
        at, tiny = np.array([0.0] * 20 + [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0], dtype=complex), 1e-30
        by_rate, by_position = (
            [slope(*(at + 1j * tiny * np.eye(27)[first + i])) for i in range(9)] for first in (10, 0)
        )
        mass, damping = (np.array([column[k][0, :9] for column in by_rate]).imag / tiny for k in (0, 1))
        return mass, damping, np.array([column[2][0, :9] for column in by_position]).imag / tiny

    def accelerations(
        self, stop: Callable[[np.ndarray], np.ndarray]
    ) -> Callable[[Frame, np.ndarray, float], np.ndarray]:
        """(10,) from frame, state (20,) and nominal spin, by d/dt dT/dq' - dT/dq + dU/dq + dD/dq' + stop = 0."""
        momentum = sp.Matrix([self.kinetic]).jacobian(P).T
        moves = momentum.jacobian(Q) * P + momentum.jacobian(list(W)) * sp.Matrix(WD)
        lagrangian = sp.Matrix([self.kinetic - self.potential]).jacobian(Q).T
        lost = sp.Matrix([self.dissipation]).jacobian(P).T
        stopped = STOP(self.stop) * sp.Matrix([self.stop]).jacobian(Q).T
        arguments = [*Q, *P, SPEED, *W, *WD, *DOWN]
        modules = [{"stop": stop}, "numpy"]
        made = sp.lambdify(
            arguments, [momentum.jacobian(P), lagrangian - moves - lost - stopped], modules=modules, cse=True
        )

        def solved(frame: Frame, state: np.ndarray, nominal: float) -> np.ndarray:
            values = np.append(state[:19], nominal + state[19])
            mass, force = made(*values, frame.speed, *frame.rate, *frame.rate_dot, *frame.down)
            return np.linalg.solve(mass, force[:, 0])

        return solved
