"""Contact condensed to the active points, eq. (15): tractions from the bodies' surface compliance."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field, replace
from time import perf_counter
from typing import Literal

import numpy as np

from wheelrail.bindings._contact import overloaded
from wheelrail.contact.elasticity.compliance import Compliance, condense
from wheelrail.contact.geometry.contact_operators import pair_operators
from wheelrail.contact.geometry.grid_points import GridPoints, SurfacePair
from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.kinematics.creepage import NotRolling, creepage, shift
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.results.result import ContactResult, Statistics
from wheelrail.contact.results.resultants import FrictionalWork, assemble_result, connected
from wheelrail.contact.results.touching_material import symmetric
from wheelrail.contact.solvers.options import IterationCount, NewtonOptions, NotConverged
from wheelrail.contact.solvers.tangent import TangentProblem, tangent_of
from wheelrail.contact.solvers.tractions import ContactCompliance, Tractions, solve_tractions
from wheelrail.support.arrays import Array, Nodes


def body_displacements(points: GridPoints, loads: Array, bodies: tuple[Compliance, Compliance]) -> Array:
    """Displacements B C B^T f (2, 3, n) m of wheel and rail at n contact points, in their axes.

    Parameters:
        points: of contact.
        loads: (n, 3) N on the wheel, in the points' axes.
        bodies: compliance of wheel and rail on their grids.
    """
    displacements = []
    for operators, body, sign in zip(pair_operators(points, 0, tangential=True), bodies, (1.0, -1.0), strict=True):
        forces = operators.displacement.T @ (sign * loads.T.ravel())
        turn, matrix = body.turned(operators.nodes, operators.directions)
        response = turn @ (matrix @ (turn.T @ forces))
        displacements.append((operators.displacement @ response).reshape(3, -1))
    return np.array(displacements)


@dataclass(frozen=True)
class NodalTractions:
    """Tractions from which a next solve starts.

    Parameters:
        node: (n,) of the surface grid.
        pressure: (n,) Pa.
        traction: (n, 2) Pa.
    """

    node: Nodes
    pressure: Array
    traction: Array


@dataclass(frozen=True)
class CondensedContact:
    """Contact model on surface compliances: pose and velocities in, `ContactResult` out.

    Parameters:
        geometry: surfaces of both bodies and their grids.
        wheel, rail: surface compliances on these grids.
        laws: of the interface.
        order: of the upstream difference formula for the slip, 1 or 2.
        options: of the Newton method.
        tangential: steady "rolling", or "shift", one step of tangential loading from none (Cattaneo, Mindlin): the
            motion is then the rigid displacement of that step, m, slip is a distance, m, and friction Coulomb's law.
        modulus: contact modulus of both bodies, Pa, which bounds the pressure.

    Cost of a solve with n candidates, a of them active: n^2 to assemble the compliance, 5 a^3 per Newton step with
    friction, a^3 / 3 without; the same again where pressure and friction are coupled and the active points change.
    Raises ValueError for a friction law that depends on the slip velocity together with tangential = "shift".
    """

    geometry: SurfacePair
    wheel: Compliance
    rail: Compliance
    laws: ContactLaws
    order: int = 2
    options: NewtonOptions = field(default_factory=NewtonOptions)
    tangential: Literal["rolling", "shift"] = "rolling"
    modulus: float = np.inf

    def __post_init__(self) -> None:
        if self.tangential == "shift" and self.laws.depend_on_slip:
            raise ValueError(f"a shift has no slip velocity for friction to depend on, got {self.laws}")

    def __call__(self, pose: Pose, motion: RigidMotion, guess: ContactResult | None = None) -> ContactResult:
        started = perf_counter()
        try:
            points, approach = self.geometry.contact_points(pose, self._slip_order)
        except OutsideSurface as error:
            return ContactResult.failed(str(error))
        if points is None:
            return ContactResult.separated(approach)
        try:
            speed, rigid = self._rigid(points, motion)
        except NotRolling as error:
            return ContactResult.failed(str(error), approach)
        located = perf_counter()
        displacement, slip = self._compliance(points)
        assembled = perf_counter()
        # pressure acts along the inward normal: the last columns are for -p
        operator = ContactCompliance(np.vstack([slip, displacement[-len(points.node) :]]), len(points.node), self.laws)
        count = IterationCount()
        try:
            tractions = self._tractions(operator, points, rigid, speed, guess, count)
        except (NotConverged, np.linalg.LinAlgError) as error:
            return ContactResult.failed(str(error), approach)
        failure = overloaded(approach, float(tractions.pressure.max(initial=0.0)), self.modulus)
        if failure:
            return ContactResult.failed(failure, approach)
        solved = perf_counter()
        solution = TangentProblem(points, pose.origin, motion, operator, rigid, speed, self.laws, tractions)
        statistics = Statistics(
            newton=count.newton,
            linear=count.linear,
            points=len(points.node),
            residual=count.residual,
            seconds={"points": located - started, "compliance": assembled - located, "solve": solved - assembled},
        )
        return self._result(points, solution, displacement, approach, statistics)

    @property
    def _shifts(self) -> bool:
        return self.tangential == "shift"

    @property
    def _slip_order(self) -> int:
        """Order of the upstream difference formula; 0 without friction."""
        return 0 if not self.laws.frictional else 1 if self._shifts else self.order

    def _rigid(self, points: GridPoints, motion: RigidMotion) -> tuple[float, Array | None]:
        """Rolling speed m/s and rigid creepage, or the tangential displacement m; None without friction.

        Raises NotRolling.
        """
        if not self._slip_order:
            return 0.0, None
        return (0.0, shift(points, motion)) if self._shifts else creepage(points, motion)

    def _compliance(self, points: GridPoints) -> tuple[Array, Array]:
        """Relative displacement m/Pa and slip (rows) of the points by unit tractions (columns) on the wheel."""
        wheel, rail = pair_operators(points, self._slip_order)
        if self._shifts:
            wheel, rail = replace(wheel, slip=None), replace(rail, slip=None)
        columns = np.tile(points.area, 3 if self._slip_order else 1)
        displacement, slip = (
            a + b for a, b in zip(condense(wheel, self.wheel), condense(rail, self.rail), strict=True)
        )
        displacement *= columns
        slip *= columns
        if self._shifts and self._slip_order:
            slip = displacement[: -len(points.node)]
        return displacement, slip

    def _tractions(
        self,
        operator: ContactCompliance,
        points: GridPoints,
        rigid: Array | None,
        speed: float,
        guess: ContactResult | None,
        count: IterationCount,
    ) -> Tractions:
        """Tractions, started from a guess, or from zero if the solve from the guess fails. Raises NotConverged."""

        def solve(start: tuple[Array, Array] | None) -> Tractions:
            return solve_tractions(
                operator,
                points.penetration,
                rigid,
                laws=self.laws,
                speed=speed,
                guess=start,
                options=self.options,
                count=count,
            )

        start = warm(guess, points.node)
        if start is not None:
            with suppress(NotConverged, np.linalg.LinAlgError):
                return solve(start)
        return solve(None)

    def _result(
        self,
        points: GridPoints,
        solution: TangentProblem,
        displacement: Array,
        approach: float,
        statistics: Statistics,
    ) -> ContactResult:
        """Result in the frame of the rail, from the compliance (rows displacement) and the tractions."""
        n, p, q = len(points.node), solution.found.pressure, solution.found.tangential
        loads = np.concatenate([*q.T, -p]) if self._slip_order else -p
        deformation = np.zeros((n, 3))
        deformation[:, 3 - displacement.shape[0] // n :] = (displacement @ loads).reshape(-1, n).T
        bound = self.laws.friction_bound(p, np.hypot(*solution.found.slip.T), solution.speed)

        def bodies() -> Array:
            forces = np.column_stack([q, -p]) * points.area[:, None]
            return body_displacements(points, forces, (self.wheel, self.rail))

        result = assemble_result(
            FrictionalWork.below(bound, points, q, solution.motion, solution.speed),
            node=points.node,
            patch=connected(points.node, p > 0, self.wheel.shape),
            pressure=p,
            slip=solution.found.slip,
            displacement=deformation,
            approach=approach,
            statistics=statistics,
            bodies=None if symmetric(points, q) else bodies,
        )
        return replace(result, force_tangent=tangent_of(solution), warm_start=NodalTractions(points.node, p, q))


def warm(guess: ContactResult | None, nodes: Nodes) -> tuple[Array, Array] | None:
    """Pressure (n,) Pa and tangential traction (2 n,) Pa of an earlier result at candidate nodes (n,); None without."""
    if guess is None or not isinstance(guess.warm_start, NodalTractions):
        return None
    earlier = guess.warm_start
    _, index, guess_index = np.intersect1d(nodes, earlier.node, assume_unique=True, return_indices=True)
    pressure, traction = np.zeros(len(nodes)), np.zeros((2, len(nodes)))
    pressure[index], traction[:, index] = earlier.pressure[guess_index], earlier.traction[guess_index].T
    return pressure, traction.ravel()
