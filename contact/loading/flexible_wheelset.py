"""Static equilibrium of a wheelset whose axle bends on rails that move on their pads: one Newton method for both sides.

Unknowns are the free coordinates of the wheelset (height, roll), the motions e of its hubs and r of its rails. With the
loads w on the hubs and l on the rails, which the contacts return with their derivatives, the equations are

    vertical forces = loads,    e = e_0 + C w,    r = c l.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from wheelrail.bindings._contact import compliant, lifted, position_at
from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.kinematics.wheelset_state import STATE_MIRRORED, WheelsetState
from wheelrail.contact.loading.flexible_state import FlexibleState
from wheelrail.contact.loading.load_search import LoadError, Results, find_depth_for_load
from wheelrail.contact.loading.moved_pair import COORDINATES, HUB, RAIL, MovedPair
from wheelrail.contact.loading.two_wheels import find_depths_for_loads
from wheelrail.contact.loading.wheelset import penetration_of
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.solvers.tangent import MIRRORED
from wheelrail.contact.structure.ballast import of_both_sides
from wheelrail.contact.structure.hubs import HubCompliance, about_hubs_line
from wheelrail.contact.structure.pads import RailCompliance
from wheelrail.contact.structure.rim import RimCompliance
from wheelrail.support.arrays import Array
from wheelrail.support.interrupts import check_interrupt

MAX_STEPS = 40  # Newton steps: 4 to 8 suffice from the equilibrium of rigid hubs and rails
FORCE = 1e-7  # of the load: largest error of a vertical force
PLACE = 1e-9  # m and rad: largest error of a motion
STALLED_FORCE, STALLED_PLACE = 1e-5, 1e-8  # accepted where halved steps gain nothing: the contact's own tolerance
MOTION = 1e-3  # m and rad, usual size of motions, by which their errors are compared with those of loads
LARGE = 5e-3  # m and rad, motions that hubs and rails do not make
SHORTEST = 2.0**-12  # of a Newton step
SHORTEST_LOADED = 2.0**-3  # where loads are searched: from other motions, if that stalls
LONGEST = 5e-3  # m and rad, largest step of a motion there
LOADED = 0.1  # of the load: larger errors of a step are mended at its motions, whose errors count with the loads on
RESTORED = 1e-2  # of the load: their error then
TURNING = 0.05  # of the growth of motions by their loads, from 1, where equilibria turn back
PULLED = ", where the wheel is pulled onto its rail: loads grow as fast as the motions that carry them"
COLUMNS = COORDINATES + 18  # of derivatives: the wheelset's coordinates, then the motions of hubs and rails
MIRRORED_HUB = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])  # factors of a hub's motion in the mirror y = 0
MIRRORED_RAIL = np.array([-1.0, 1.0, -1.0])  # the same of a rail's


@dataclass(frozen=True)
class Flexibility:
    """Compliance of the hubs against the wheelset, and of the rails against the track.

    Parameters:
        hubs: compliance of the hubs, or of the rims that a host moves; None: a rigid axle.
        rails: compliance of the left and of the right rail, as left-hand ones; None: clamped feet.
        place: distance of the wheels from a sleeper, m, where sleepers are discrete.
        mirrored_rails: compliance under loads that are mirror images, where rigid sleepers join both rails, and `rails`
            have that under loads to the same side. None: rails are independent.
    """

    hubs: HubCompliance | RimCompliance | None = None
    rails: tuple[RailCompliance, RailCompliance] | None = None
    place: float = 0.0
    mirrored_rails: tuple[RailCompliance, RailCompliance] | None = None

    @property
    def rigid(self) -> bool:
        """Whether nothing moves."""
        return self.hubs is None and self.rails is None

    @cached_property
    def matrix(self) -> Array:
        """Compliance (18, 18): motions of both hubs (6 each), then of both rails (3 each), by the loads on them."""
        out = np.zeros((18, 18))
        if self.hubs is not None:
            out[:12, :12] = self.hubs.matrix
        if self.rails is not None:
            out[12:, 12:] = self._of_rails(lambda rail: rail.at(self.place))
        return out

    def _of_rails(self, value: Callable[[RailCompliance], Array]) -> Array:
        """Matrix (6, 6) of both rails, of values (3, 3) of one."""
        same, mirrored = ([value(rail) for rail in own] if own else None for own in (self.rails, self.mirrored_rails))
        return of_both_sides(same or (), mirrored)

    @property
    def varies(self) -> bool:
        """Whether the compliance depends on the place along the track."""
        return any(len(rail.harmonics) for rail in self.rails or ())

    def moved(self, distance: float) -> Flexibility:
        """Flexibility at a distance m along the track from here."""
        return replace(self, place=self.place + distance) if self.varies else self

    @cached_property
    def matrix_slope(self) -> Array:
        """Derivative (18, 18) of `matrix` by the place along the track, per m."""
        out = np.zeros((18, 18))
        if self.rails is not None:
            out[12:, 12:] = self._of_rails(lambda rail: rail.slope(self.place))
        return out

    @cached_property
    def unloaded(self) -> Array:
        """Motions (18,) without contact: of the hubs, by the wheelset's own weight."""
        out = np.zeros(18)
        if self.hubs is not None:
            out[:12] = self.hubs.own_weight
        return out

    def foot(self, index: int) -> Array:
        """Centre (2,) m of a rail's roll in its frame."""
        return np.zeros(2) if self.rails is None else self.rails[index].foot


@dataclass(frozen=True)
class Loads:
    """Condition on the vertical forces of the wheels.

    Parameters:
        free: coordinates of the wheelset that are solved for, of "z" and "roll".
        forces: (n, 2), sums of the left and the right force that are given, as many as free coordinates.
        values: (n,) N.
    """

    free: tuple[str, ...] = ()
    forces: Array = field(default_factory=lambda: np.zeros((0, 2)))
    values: Array = field(default_factory=lambda: np.zeros(0))

    @classmethod
    def wheels(cls, load: float) -> Loads:
        """The same load N on each wheel, by height and roll."""
        return cls(("z", "roll"), np.eye(2), np.full(2, load))

    @classmethod
    def axle(cls, load: float) -> Loads:
        """A load N on both wheels together, by the height."""
        return cls(("z",), np.ones((1, 2)), np.array([load]))


@dataclass(frozen=True, eq=False)
class FlexibleEquilibrium:
    """Equilibrium of a flexible wheelset on its track.

    Parameters:
        state: of the wheelset, whose frame is that of the line through its journals.
        results: contact by side in the track's axes, with the moment about the wheelset's centre.
        pairs: of the wheels and their moved rails, as left-hand ones.
        hubs: (6,) m and rad, motion of each hub in the wheelset's axes about its centre.
        rails: (3,) m and rad, y, z and roll of each rail about its foot.
        hub_loads: (6,) N and N m on each hub, as left-hand ones.
        stress: bending stress Pa of the axle at places y m from its middle, on the side of each wheel, see
            `HubCompliance.bending_stress`; empty for a rigid axle.
        solves: number of contact solves.
        errors: by Newton step, of forces over the load and of motions over 1 mm or 1 mrad, the largest.
        tangent: (2, 6, 27), derivative of both sides' force and moment about the wheelset's centre by
            `FlexibleState.coordinates`, hubs and rails moving with the loads.
        motions: (18,) of both hubs relative to the line through the journals, then of both rails; those of the right
            side mirrored.
    """

    state: WheelsetState
    results: dict[Side, ContactResult]
    pairs: dict[Side, MovedPair]
    hubs: dict[Side, Array]
    rails: dict[Side, Array]
    hub_loads: dict[Side, Array]
    stress: dict[Side, tuple[Array, Array]]
    solves: int
    errors: tuple[float, ...]
    tangent: Array
    motions: Array


@dataclass(frozen=True, eq=False)
class Trial:
    """Contact of both sides at given motions.

    Parameters:
        state: of the wheelset.
        motions: (18,) of hubs and rails.
        pairs: of both sides.
        results: of their contacts in the track's axes, as left-hand ones, see `MovedPair.in_track`.
    """

    state: WheelsetState
    motions: Array
    pairs: tuple[MovedPair, ...]
    results: tuple[ContactResult, ...]

    def usable(self, loads: Loads) -> bool:
        """Whether both contacts are solved and each given load is carried, that of an axle by one of its wheels."""
        carry = np.array([r.status == "converged" for r in self.results])
        return all(r.ok for r in self.results) and all(carry[own].any() for own in loads.forces > 0.0)

    @cached_property
    def wrenches(self) -> Array:
        """Force and moment (2, 6) about the wheelset's centre, by side."""
        return np.stack([np.concatenate([result.force, result.moment]) for result in self.results])

    @cached_property
    def loads(self) -> Array:
        """Loads (18,) on both hubs, then on both rails."""
        return structural(
            np.stack([pair.load_matrix @ wrench for pair, wrench in zip(self.pairs, self.wrenches, strict=True)])
        )

    @cached_property
    def slopes(self) -> tuple[Array, Array]:
        """Derivatives (2, 6, 27) of the wrenches and (18, 27) of the loads by the state's coordinates, then the motions
        in its frame.
        """
        wrenches, loads = np.zeros((2, 6, COLUMNS)), np.zeros((2, 9, COLUMNS))
        for index, (pair, wrench, result) in enumerate(zip(self.pairs, self.wrenches, self.results, strict=True)):
            wrenches[index] = by_unknowns(pair.wrench_slopes(result), index)
            loads[index] = pair.load_matrix @ wrenches[index] + by_unknowns(pair.load_change(wrench), index)
        return wrenches, structural(loads)


def structural(loads: Array) -> Array:
    """Rows (18, ...) on both hubs, then on both rails, of the loads (2, 9, ...) by side."""
    return np.concatenate([loads[0, :6], loads[1, :6], loads[0, 6:], loads[1, 6:]])


def by_unknowns(slopes: Array, index: int) -> Array:
    """Derivatives (..., 27) by the coordinates of the wheelset's state and the motions of both hubs and both rails.

    Parameters:
        slopes: (..., 18) of the left-hand pair of a side, columns as of `MovedPair.wrench_slopes`.
        index: of the side.
    """
    out = np.zeros((*slopes.shape[:-1], COLUMNS))
    out[..., :COORDINATES] = slopes[..., :COORDINATES] * (STATE_MIRRORED if index else 1.0)
    for first, size, own in ((0, 6, HUB), (12, 3, RAIL)):
        start = COORDINATES + first + size * index
        out[..., start : start + size] = slopes[..., own]
    return out


@dataclass(frozen=True)
class FlexibleWheelset:
    """A wheelset with elastic axle on rails on pads.

    Parameters:
        contact: of both sides.
        flexibility: of axle and rails.
        on_hubs: whether the frame of the wheelset is that of the line through its hubs instead of its journals.
    """

    contact: WheelsetContact
    flexibility: Flexibility
    on_hubs: bool = False

    def equilibrium(
        self,
        state: WheelsetState,
        loads: Loads,
        guess: dict[Side, ContactResult] | None = None,
        motions: Array | None = None,
    ) -> FlexibleEquilibrium:
        """Equilibrium under given vertical loads, from a state near that of the rigid wheelset.

        Parameters:
            state: first height and roll, and the other coordinates and velocities; motions of a `FlexibleState` are
                given ones, to which those under the loads are added.
            loads: condition on the wheels' vertical forces.
            guess: results to start from.
            motions: (18,) of hubs and rails to start from, see `FlexibleEquilibrium.motions`; None: zero.

        Raises LoadError.
        """
        guesses = tuple((guess or {}).get(side) for side in SIDES)
        trial = self._trial(state, np.zeros(18) if motions is None else motions, guesses)
        if not trial.usable(loads):
            raise LoadError(f"no contact to start from: {', '.join(result.status for result in trial.results)}")
        try:
            return self._settled(trial, loads)
        except LoadError as error:
            # Loads that grow as the wheel follows its rail end the equilibria, as of a column that buckles.
            moved = float(np.abs(self._yielding(trial)).max())
            reason = f"; loads at the start would move them by {1e3 * moved:.2g} mm or mrad" if moved > LARGE else ""
            raise LoadError(f"{error}{reason}") from error

    def _settled(self, trial: Trial, loads: Loads) -> FlexibleEquilibrium:
        """Equilibrium from a trial, or from hubs and rails that have given way to its loads. Raises LoadError."""
        try:
            return self._newton(trial, 2, loads)
        except LoadError:
            if not loads.free:
                raise
            start, solves = self._given_way(trial, loads)
            return self._newton(start, solves, loads)

    def _yielding(self, trial: Trial) -> Array:
        """Motions (18,) by the loads of a trial."""
        return np.asarray(self.flexibility.unloaded + self.flexibility.matrix @ trial.loads)

    def _given_way(self, trial: Trial, loads: Loads) -> tuple[Trial, int]:
        """Trial with hub and rail motions due to the loads of another trial, wheels on their loads, and number of
        solves.

        A rigid wheelset may rest on a flange, rolled, where one whose wheels are pushed away rests on its treads. From
        the motions without loads Newton's method would have to pass the roll at which the wheel falls.
        Raises LoadError.
        """
        level = replace(trial.state, z=0.0, roll=0.0 if "roll" in loads.free else trial.state.roll)
        return self._carrying(level, self._yielding(trial), trial, loads, RESTORED)

    def _newton(self, trial: Trial, solves: int, loads: Loads) -> FlexibleEquilibrium:
        """Equilibrium by Newton's method from a trial. Raises LoadError."""
        errors: list[float] = []
        for _ in range(MAX_STEPS):
            check_interrupt()
            residual = self._residual(trial, loads)
            force, place = _sizes(residual, loads)
            errors.append(max(force, place / MOTION))
            if force <= FORCE and place <= PLACE:
                return self._outcome(trial, solves, errors)
            step = -np.linalg.solve(self._jacobian(trial, loads), residual)
            following, more = self._advance(trial, step, loads, errors[-1])
            solves += more
            if following is None:
                if force <= STALLED_FORCE and place <= STALLED_PLACE:
                    return self._outcome(trial, solves, errors)
                text = f"hubs and rails do not settle: loads within {force:.1e}, motions within {place:.1e} m"
                ended = not loads.free and abs(self._growth(trial) - 1.0) < TURNING
                raise LoadError(f"{text}{PULLED}" if ended else text)
            trial = following
        raise LoadError(f"hubs and rails do not settle in {MAX_STEPS} Newton steps")

    def _growth(self, trial: Trial) -> float:
        """Largest factor by which the motions due to changed loads exceed the motions that changed the loads.

        Where it is 1 equilibria turn back: beyond, friction pulls the wheel onto its rail, and nothing stops it nearby.
        """
        return float(np.linalg.eigvals(np.eye(18) - self._jacobian(trial, Loads())).real.max())

    @cached_property
    def _frame(self) -> Array:
        """Transformation (18, 18) from motions relative to the line through the journals to the wheelset's frame."""
        frame = np.eye(18)
        if self.on_hubs:
            frame[:12, :12] = about_hubs_line(self.contact.mounting.wheel_y)
        return frame

    def _pairs(self, state: WheelsetState, motions: Array) -> tuple[MovedPair, ...]:
        placed = self._frame @ motions
        if isinstance(state, FlexibleState):
            placed = placed + state.motions
        return tuple(
            MovedPair(
                self.contact.of(side).mounting,
                state.mirrored() if index else state,
                placed[6 * index : 6 * index + 6],
                placed[12 + 3 * index : 15 + 3 * index],
                self.flexibility.foot(index),
            )
            for index, side in enumerate(SIDES)
        )

    def _trial(self, state: WheelsetState, motions: Array, guesses: tuple[ContactResult | None, ...]) -> Trial:
        pairs = self._pairs(state, motions)
        results = tuple(
            pair.in_track(self.contact.of(side).model(pair.pose, pair.motion, guess))
            for side, pair, guess in zip(SIDES, pairs, guesses, strict=True)
        )
        return Trial(state, motions, pairs, results)

    def _residual(self, trial: Trial, loads: Loads) -> Array:
        vertical = loads.forces @ trial.wrenches[:, 2] - loads.values
        return np.concatenate([vertical, trial.motions - self._yielding(trial)])

    def _jacobian(self, trial: Trial, loads: Loads) -> Array:
        wrenches, structural_loads = trial.slopes
        free = [WheelsetState.coordinates.index(name) for name in loads.free]
        frame = np.zeros((COLUMNS, len(free) + 18))
        frame[free, range(len(free))], frame[COORDINATES:, len(free) :] = 1.0, self._frame
        vertical = loads.forces @ wrenches[:, 2] @ frame
        elastic = -self.flexibility.matrix @ structural_loads @ frame
        elastic[:, len(free) :] += np.eye(18)
        return np.concatenate([vertical, elastic])

    def _advance(self, trial: Trial, step: Array, loads: Loads, size: float) -> tuple[Trial | None, int]:
        """Next trial, by the longest halving of a step that lowers the error, and number of solves."""
        count, solves = len(loads.free), 0
        if loads.free:
            step = step * min(1.0, LONGEST / float(np.abs(step[count:]).max()))
        fraction = 1.0
        while fraction >= (SHORTEST_LOADED if loads.free else SHORTEST):
            change = {
                name: getattr(trial.state, name) + fraction * s for name, s in zip(loads.free, step, strict=False)
            }
            following = self._trial(
                replace(trial.state, **change), trial.motions + fraction * step[count:], trial.results
            )
            solves += 2
            force, place = self._errors(following, loads)
            if force > LOADED and loads.free:
                with suppress(LoadError):
                    following, more = self._carrying(
                        following.state, following.motions, trial, loads, min(RESTORED, 0.1 * size)
                    )
                    solves += more
                    force, place = self._errors(following, loads)
            if force <= LOADED and max(force, place / MOTION) < (1 - 0.1 * fraction) * size:
                return following, solves
            fraction *= 0.5
        return None, solves

    def _errors(self, trial: Trial, loads: Loads) -> tuple[float, float]:
        """Errors of forces and motions, see `_sizes`; infinite where no contact carries a load."""
        return _sizes(self._residual(trial, loads), loads) if trial.usable(loads) else (np.inf, np.inf)

    def _carrying(
        self, level: WheelsetState, motions: Array, earlier: Trial, loads: Loads, rtol: float
    ) -> tuple[Trial, int]:
        """Trial at given motions, at the height and roll that carry the loads there, and number of solves.

        A step of motions by which a wheel leaves a steep flange changes its force much more than its own load does the
        motions: the loads are found at given motions. Raises LoadError.
        """
        base, guess = self.contact.mounting.wheel_y, earlier.results
        approach = np.array([result.approach for result in guess])
        expected = np.maximum(approach, 0.1 * approach.max())
        deepest = float(expected.max())

        def at(depths: Array | float) -> WheelsetState:
            z, roll = position_at(np.broadcast_to(depths, 2).tolist(), level.roll, base)
            return replace(level, z=z, roll=roll)

        def solved(depths: Array | float, own: Results | None) -> Results:
            return self._trial(at(depths), motions, own or guess).results

        def penetrations(depths: Array) -> Array:
            pairs = zip(SIDES, self._pairs(at(depths), motions), strict=True)
            return np.array([penetration_of(self.contact.of(side).model, own.pose, own.motion) for side, own in pairs])

        if len(loads.free) == 1:
            start = lifted(
                np.array([-level.z]), np.array([deepest]), deepest, lambda own: penetrations(own).max(keepdims=True)
            )
            found = find_depth_for_load(
                solved, float(loads.values[0]), expected=deepest, start=float(start[0]), rtol=rtol
            )
            state, results, trials = at(found.depth), found.results, found.trials
        else:
            start = lifted(np.full(2, -level.z), expected, deepest, penetrations)
            slopes = compliant(float(loads.values.max())) / expected
            depths, results, trials = find_depths_for_loads(solved, loads.values, start=start, slopes=slopes, rtol=rtol)
            state = at(depths)
        return Trial(state, motions, self._pairs(state, motions), results), 2 * trials

    def _outcome(self, trial: Trial, solves: int, errors: list[float]) -> FlexibleEquilibrium:
        results, hub_loads = trial.results, trial.loads[:12].reshape(2, 6)
        hubs, rails = trial.motions[:12].reshape(2, 6), trial.motions[12:].reshape(2, 3)
        return FlexibleEquilibrium(
            trial.state,
            {"left": results[0], "right": results[1].mirrored()},
            dict(zip(SIDES, trial.pairs, strict=True)),
            {"left": hubs[0], "right": MIRRORED_HUB * hubs[1]},
            {"left": rails[0], "right": MIRRORED_RAIL * rails[1]},
            dict(zip(SIDES, hub_loads, strict=True)),
            self._stress(hub_loads),
            solves,
            tuple(errors),
            self._condensed(trial),
            trial.motions,
        )

    def _stress(self, hub_loads: Array) -> dict[Side, tuple[Array, Array]]:
        hubs = self.flexibility.hubs
        if not isinstance(hubs, HubCompliance):
            return {}
        stresses = hubs.bending_stress(*hub_loads)
        return {side: (hubs.places, stress) for side, stress in zip(SIDES, stresses, strict=True)}

    def _condensed(self, trial: Trial) -> Array:
        """Derivative (2, 6, 27) of force and moment by the state and given motions, with motions x that follow the
        loads: dw = W_q dq + W_g (dg + P dx), dx = A dw.
        """
        wrenches, loads = trial.slopes
        moved = self.flexibility.matrix @ loads
        motion = np.linalg.solve(np.eye(18) - moved[:, COORDINATES:] @ self._frame, moved)  # (18, 27)
        out = wrenches + wrenches[:, :, COORDINATES:] @ self._frame @ motion
        out[1] *= MIRRORED[:, None]
        return np.asarray(out)


def _sizes(residual: Array, loads: Loads) -> tuple[float, float]:
    """Largest error of a force over the largest load, and of a motion, m or rad."""
    count = len(loads.free)
    force = np.abs(residual[:count]).max() / np.abs(loads.values).max() if count else 0.0
    return float(force), float(np.abs(residual[count:]).max())
