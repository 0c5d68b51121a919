"""Contact solve of a scene: a Hertz pair, or the wheels of a wheelset."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from itertools import starmap
from time import perf_counter
from typing import TYPE_CHECKING, cast

from wheelrail.scenes.builders.hertz import hertz_model, hertz_motion, hertz_scale
from wheelrail.scenes.builders.wheelset import (
    SideProfiles,
    flexibility,
    side_profiles,
    wheel_scale,
    wheelset_contact,
    wheelset_state,
)
from wheelrail.scenes.contacts.side_solution import SideSolution, StructuralMotion
from wheelrail.scenes.contacts.solution import solution_dataset
from wheelrail.scenes.contacts.stress import subsurface_stress
from wheelrail.scenes.schema.scene import HertzScene, WheelsetScene
from wheelrail.support.interrupts import deferred_interrupts
from wheelrail.support.threads import Threads

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.contact.kinematics.frames import Side
    from wheelrail.contact.kinematics.wheelset_state import WheelsetState
    from wheelrail.contact.loading.load_search import LoadError
    from wheelrail.contact.loading.moved_pair import MovedPair
    from wheelrail.contact.loading.wheelset import WheelsetEquilibrium
    from wheelrail.contact.models.wheelset import ContactModel, WheelsetContact
    from wheelrail.contact.results.result import ContactResult

    TimedSolve = tuple[tuple[str, ...], WheelsetEquilibrium | LoadError, float]

    Starts = Mapping[str, tuple[WheelsetState, ContactResult]]

ReportProgress = Callable[[str], None]

START = 0.02  # of the load: error of the equilibrium of rigid hubs and rails from which those of flexible ones start


def coarse_models(model: ContactModel) -> Sequence[ContactModel]:
    """The models on lattices of half as many strips and cells."""
    from wheelrail.contact.models.lattice.model import LatticeContact

    assert isinstance(model, LatticeContact)
    return model.coarse


def estimated(result: ContactResult, coarse_solves: Sequence[Callable[[], ContactResult]]) -> ContactResult:
    """The result with an error estimate, computed at the final position only and not at every trial depth.

    Parameters:
        result: on all strips and cells.
        coarse_solves: solve the same contact on half as many; if one fails, the errors are unknown (NaN).
    """
    from wheelrail.contact.results.extrapolation import estimate

    if not result.patches:
        return result
    with deferred_interrupts():
        coarse = [solve() for solve in coarse_solves]
    return replace(result, error_estimate=estimate(result, coarse))


def solve_contact(
    scene: HertzScene | WheelsetScene,
    report_progress: ReportProgress = lambda _: None,
    *,
    model: ContactModel | WheelsetContact | None = None,
) -> Dataset:
    """Solution of a scene as one Dataset, see `wheelrail.scenes.contacts.solution`.

    Parameters:
        scene: to solve.
        report_progress: called with a text at every stage.
        model: as for `solve_sides`.

    The moment of a Hertz pair is about the point of first contact. A load that cannot be carried, or a contact that
    does not converge, gives status "failed: ..." and no exception.
    """
    profiles = None if isinstance(scene, HertzScene) else side_profiles(scene)
    sides = dict(solve_sides(scene, model=model, profiles=profiles, report_progress=report_progress))
    return solution_dataset(scene, sides, profiles)


def built_model(scene: HertzScene | WheelsetScene) -> ContactModel | WheelsetContact:
    """Contact model of a scene."""
    return hertz_model(scene) if isinstance(scene, HertzScene) else wheelset_contact(scene)


def solve_sides(
    scene: HertzScene | WheelsetScene,
    *,
    model: ContactModel | WheelsetContact | None = None,
    profiles: SideProfiles | None = None,
    threads: Threads | None = None,
    near: Starts | None = None,
    report_progress: ReportProgress = lambda _: None,
) -> Iterator[tuple[str, SideSolution]]:
    """Solve the sides of a scene one after the other; the only side of a Hertz pair is "contact".

    Parameters:
        scene: to solve.
        model: contact model built for this scene, or for one that differs only in pose, motion and load; built from
            the scene by default.
        profiles: of wheel and inclined rail by side; those of the scene by default.
        threads: that solve both sides at the same time, with a model that has solved before.
        near: of `starts`; the results then differ in their last digits.
        report_progress: called with a text at every stage.
    """
    if isinstance(scene, HertzScene):
        return _hertz(scene, cast("ContactModel | None", model), report_progress)
    return _wheelset(scene, cast("WheelsetContact | None", model), profiles, threads, near or {}, report_progress)


def starts(scene: WheelsetScene, sides: Mapping[str, SideSolution]) -> Starts:
    """States and results by side from which solves of other positions may begin, of wheels at heights of their own.

    Parameters:
        scene: that was solved.
        sides: its solution.
    """
    position = scene.wheelset
    if scene.is_flexible or position.roll == "solve" or position.z is not None or position.axle_load is not None:
        return {}
    touching = {side: own for side, own in sides.items() if own.result.status == "converged"}
    state = wheelset_state(scene)
    return {
        side: (replace(state, z=own.z), own.result)
        for side, own in touching.items()
        if own.result.warm_start is not None
    }


def _hertz(
    scene: HertzScene, model: ContactModel | None, report_progress: ReportProgress
) -> Iterator[tuple[str, SideSolution]]:
    from wheelrail.contact.loading.hertz import hertz_pose, hertz_under_load
    from wheelrail.contact.loading.load_search import LoadError

    if model is None:
        report_progress("compliance of both bodies")
        model = hertz_model(scene)
    motion = hertz_motion(scene)
    report_progress("contact")
    with _clock() as seconds:
        if scene.load is None:
            depth, solves = float(scene.approach or 0.0), 1
            with deferred_interrupts():
                result = model(hertz_pose(depth), motion, None)
        else:
            try:
                with deferred_interrupts():
                    solution = hertz_under_load(model, motion, scene.load, expected=hertz_scale(scene, scene.load))
            except LoadError as error:
                yield "contact", SideSolution.failed(str(error))
                return
            depth, solves, result = solution.depth, solution.trials, solution.results[0]
    spent, pose = seconds(), hertz_pose(depth)
    if result.ok:  # of the bodies; the largest penetration on a grid may miss the point of first contact
        result = replace(result, approach=depth)
    if scene.error_estimate:
        report_progress("error estimate: solution on half as many strips and cells")
        result = estimated(result, [partial(coarse, pose, motion, None) for coarse in coarse_models(model)])
    stress = subsurface_stress(scene, result, pose, "left", report_progress)
    yield "contact", SideSolution(result, pose, -depth, 0.0, solves, spent, stress)


def _wheelset(
    scene: WheelsetScene,
    contact: WheelsetContact | None,
    profiles: SideProfiles | None,
    threads: Threads | None,
    near: Starts,
    report_progress: ReportProgress,
) -> Iterator[tuple[str, SideSolution]]:
    if contact is None:
        report_progress("compliance of wheel and rail")
        contact = wheelset_contact(scene, profiles)
    if scene.is_flexible:
        yield from _flexible(scene, contact, profiles or side_profiles(scene), report_progress)
        return
    each: Callable[..., Iterable[TimedSolve]] = starmap
    if threads and contact.concurrent and not contact.together:
        each = threads.each
    for sides, equilibrium, seconds in each(partial(_timed, report_progress), _equilibria(scene, contact, near=near)):
        if isinstance(equilibrium, Exception):
            yield from ((side, SideSolution.failed(str(equilibrium))) for side in sides)
            continue
        solves, time = equilibrium.solves // len(sides), seconds / len(sides)
        state = equilibrium.state
        for side, result in equilibrium.results.items():
            if scene.error_estimate:
                report_progress(f"{side} wheel: error estimate: solution on half as many strips and cells")
                own = contact.of(side)
                coarse = (replace(own, model=model) for model in coarse_models(own.model))
                result = estimated(result, [partial(model, state, side) for model in coarse])
            pose, _ = contact.of(side).mounting.left_pair(state if side == "left" else state.mirrored())
            stress = subsurface_stress(scene, result, pose, side, report_progress)
            if side == "right":
                pose, stress = pose.mirrored(), {name: body_stress.mirrored() for name, body_stress in stress.items()}
            yield side, SideSolution(result, pose, state.z, state.roll, solves, time, stress)


def _timed(
    report_progress: ReportProgress, sides: tuple[str, ...], solve: Callable[[], WheelsetEquilibrium]
) -> TimedSolve:
    """Sides, their equilibrium or the error of the load search, and the time s."""
    from wheelrail.contact.loading.load_search import LoadError

    report_progress(f"contact of the {' and '.join(sides)} wheel")
    with _clock() as seconds:
        try:
            with deferred_interrupts():
                return sides, solve(), seconds()
        except LoadError as error:
            return sides, error, seconds()


def _flexible(
    scene: WheelsetScene, contact: WheelsetContact, profiles: SideProfiles, report_progress: ReportProgress
) -> Iterator[tuple[str, SideSolution]]:
    """Sides of a wheelset whose axle bends, or whose rails move on pads, from its equilibrium as a rigid one."""
    from wheelrail.contact.loading.flexible_wheelset import FlexibleWheelset, Loads
    from wheelrail.contact.loading.load_search import LoadError

    report_progress("compliance of axle and pads")
    wheelset, position = FlexibleWheelset(contact, flexibility(scene, profiles)), scene.wheelset
    loads = Loads()
    if position.axle_load is not None:
        loads = Loads.axle(position.axle_load)
    elif position.wheel_load is not None:
        loads = Loads.wheels(position.wheel_load)
    report_progress("contact of the left and right wheel")
    ((sides, solve),) = _equilibria(scene, contact, rtol=START)
    with _clock() as seconds:
        try:
            with deferred_interrupts():
                rigid = solve()
                equilibrium = wheelset.equilibrium(rigid.state, loads, rigid.results)
        except LoadError as error:
            yield from ((side, SideSolution.failed(str(error))) for side in sides)
            return
    solves, time, state = (rigid.solves + equilibrium.solves) // 2, seconds() / 2, equilibrium.state
    for side, pair in equilibrium.pairs.items():
        result, pose = equilibrium.results[side], pair.pose
        if scene.error_estimate:
            report_progress(f"{side} wheel: error estimate: solution on half as many strips and cells")
            result = estimated(
                result, [partial(_moved, model, pair, side) for model in coarse_models(contact.of(side).model)]
            )
        stress = subsurface_stress(scene, result, pose, side, report_progress)
        if side == "right":
            pose, stress = pose.mirrored(), {name: body_stress.mirrored() for name, body_stress in stress.items()}
        motion = StructuralMotion(equilibrium.hubs[side], equilibrium.rails[side], equilibrium.stress.get(side))
        yield side, SideSolution(result, pose, state.z, state.roll, solves, time, stress, motion)


def _moved(model: ContactModel, pair: MovedPair, side: Side) -> ContactResult:
    """Result of a model for a pair with moved hub and rail."""
    result = pair.in_track(model(pair.pose, pair.motion, None))
    return result if side == "left" else result.mirrored()


def _equilibria(
    scene: WheelsetScene,
    contact: WheelsetContact,
    rtol: float | None = None,
    near: Starts | None = None,
) -> Iterator[tuple[tuple[str, ...], Callable[[], WheelsetEquilibrium]]]:
    """Solves of a wheelset scene: sides, and the function that computes their static equilibrium within rtol of the
    load, by default `RTOL` of the core; near as for `solve_sides`.
    """
    from wheelrail.bindings._contact import RTOL
    from wheelrail.contact.loading.wheelset import (
        axle_under_load,
        wheel_under_load,
        wheels_under_load,
        wheelset_at_state,
    )

    position, state, rtol = scene.wheelset, wheelset_state(scene), RTOL if rtol is None else rtol
    if position.z is not None:
        yield scene.sides, lambda: wheelset_at_state(contact, state, scene.sides)
    elif position.axle_load is not None:
        load = position.axle_load
        yield (
            scene.sides,
            partial(axle_under_load, contact, state, load, expected=wheel_scale(scene, 0.5 * load), rtol=rtol),
        )
    else:
        load = position.wheel_load or 0.0
        expected = wheel_scale(scene, load)
        if position.roll == "solve":
            yield scene.sides, lambda: wheels_under_load(contact, state, load, expected=expected, rtol=rtol)
            return
        for side in scene.sides:
            start = (near or {}).get(side)
            yield (
                (side,),
                partial(wheel_under_load, contact, state, side, load, expected=expected, rtol=rtol, near=start),
            )


@contextmanager
def _clock() -> Iterator[Callable[[], float]]:
    """Seconds since the start of the block."""
    start = perf_counter()
    yield lambda: perf_counter() - start
