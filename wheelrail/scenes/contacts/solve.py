"""Contact solve of a scene: a Hertz pair, or the wheels of a wheelset."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from math import nan
from time import perf_counter
from typing import TYPE_CHECKING, Any, cast

from wheelrail.scenes.builders.hertz import hertz_model, hertz_motion, hertz_scale
from wheelrail.scenes.builders.laws import laws
from wheelrail.scenes.builders.loaded_bodies import stressed_bodies
from wheelrail.scenes.builders.wheelset import wheel_scale, wheelset_contact
from wheelrail.scenes.contacts.report import overall, side_report
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import HertzScene, WheelsetScene
from wheelrail.support.interrupts import deferred_interrupts

if TYPE_CHECKING:
    from wheelrail.contact.kinematics.frames import Pose
    from wheelrail.contact.loading.wheelset import WheelsetEquilibrium
    from wheelrail.contact.models.wheelset import ContactModel, WheelsetContact
    from wheelrail.contact.results.result import ContactResult
    from wheelrail.contact.stress.subsurface import SubsurfaceStress
    from wheelrail.meshes.profiles.profile import Profile

ReportProgress = Callable[[str], None]
OnResult = Callable[[str, "ContactResult"], None]


@dataclass(frozen=True)
class SideSolution:
    """Contact solution of one side.

    Parameters:
        result: contact result; its status is the reason where no pose was found.
        pose: of the upper body in the frame of the lower one; None if the load cannot be carried.
        z: height of the wheelset above its nominal height, m.
        roll: of the wheelset, rad.
        solves: number of contact solves.
        seconds: their computing time.
        stress: subsurface stress by body.
    """

    result: ContactResult
    pose: Pose | None = None
    z: float = nan
    roll: float = nan
    solves: int = 0
    seconds: float = 0.0
    stress: Mapping[str, SubsurfaceStress] = field(default_factory=dict)

    @classmethod
    def failed(cls, reason: str) -> SideSolution:
        """A load that cannot be carried."""
        from wheelrail.contact.results.result import ContactResult

        return cls(ContactResult.failed(reason))


def solve_contact(
    scene: HertzScene | WheelsetScene,
    report_progress: ReportProgress = lambda _: None,
    on_result: OnResult = lambda *_: None,
) -> dict[str, Any]:
    """Solve a scene and report it, see `wheelrail.scenes.contacts.report`.

    Parameters:
        scene: to solve.
        report_progress: called with a text at every stage.
        on_result: called with side and result of every side.

    The moment of a Hertz pair is about the point of first contact. A load that cannot be carried, or a contact that
    does not converge, gives status "failed: ..." and no exception.
    """
    contact_laws = laws(scene)
    sides: dict[str, Any] = {}
    for side, solved in solve_sides(scene, report_progress=report_progress):
        if solved.pose is None:
            sides[side] = {"status": solved.result.status}
            continue
        on_result(side, solved.result)
        sides[side] = side_report(
            solved.result,
            z=solved.z,
            roll=solved.roll,
            solves=solved.solves,
            seconds=solved.seconds,
            stress=solved.stress,
        )
    return {
        "status": overall(sides),
        "kind": scene.kind,
        "model": scene.model,
        "friction": scene.friction,
        **model_choices(scene),
        "falling": None if scene.falling is None else scene.falling.model_dump(),
        "stiffness_per_area": contact_laws.stiffness_per_area if contact_laws.normal_compliance else None,
        "regularisation": contact_laws.regularisation,
        **sides,
    }


def solve_sides(
    scene: HertzScene | WheelsetScene,
    *,
    model: ContactModel | WheelsetContact | None = None,
    profiles: tuple[Profile, Profile] | None = None,
    report_progress: ReportProgress = lambda _: None,
) -> Iterator[tuple[str, SideSolution]]:
    """Solve the sides of a scene one after the other; the only side of a Hertz pair is "contact".

    Parameters:
        scene: to solve.
        model: contact model built for this scene, or for one that differs only in pose, motion and load; built from
            the scene by default.
        profiles: of wheel and inclined rail; those of the scene by default.
        report_progress: called with a text at every stage.
    """
    if isinstance(scene, HertzScene):
        return _hertz(scene, cast("ContactModel | None", model), report_progress)
    return _wheelset(scene, cast("WheelsetContact | None", model), profiles, report_progress)


def model_choices(scene: HertzScene | WheelsetScene) -> dict[str, Any]:
    """Choices of the contact model, by key of the scene."""
    if scene.model == "standard":
        return {"normal": scene.normal or "kik-piotrowski", "tangential": scene.tangential or "fastsim"}
    how = scene.discretisation
    return {
        "laws": scene.laws,
        "bodies": how.bodies,
        "points": how.points,
        "surface_size": scene.surface_size,
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
        report_progress("error estimate: solution on half as many cells")
        result = _estimated(result, lambda: _halved(model)(pose, motion, None))
    stress = _stress(scene, result, pose, None, report_progress)
    yield "contact", SideSolution(result, pose, -depth, 0.0, solves, spent, stress)


def _wheelset(
    scene: WheelsetScene,
    contact: WheelsetContact | None,
    profiles: tuple[Profile, Profile] | None,
    report_progress: ReportProgress,
) -> Iterator[tuple[str, SideSolution]]:
    from wheelrail.contact.loading.load_search import LoadError

    if contact is None:
        report_progress("compliance of wheel and rail")
        contact = wheelset_contact(scene)
    for sides, solve in _equilibria(scene, contact):
        report_progress(f"contact of the {' and '.join(sides)} wheel")
        with _clock() as seconds:
            try:
                with deferred_interrupts():
                    equilibrium = solve()
            except LoadError as error:
                yield from ((side, SideSolution.failed(str(error))) for side in sides)
                continue
        solves, time = equilibrium.solves // len(sides), seconds() / len(sides)
        state = equilibrium.state
        for side, result in equilibrium.results.items():
            if scene.error_estimate:
                report_progress(f"{side} wheel: error estimate: solution on half as many cells")
                coarse = replace(contact, model=_halved(contact.model))
                result = _estimated(result, partial(coarse, state, side))
            pose, _ = contact.mounting.left_pair(state if side == "left" else state.mirrored())
            stress = _stress(scene, result, pose, profiles, report_progress)
            if side == "right":
                pose, stress = pose.mirrored(), {name: body_stress.mirrored() for name, body_stress in stress.items()}
            yield side, SideSolution(result, pose, state.z, state.roll, solves, time, stress)


def _halved(model: ContactModel) -> ContactModel:
    """The model with half as many cells in both directions."""
    from wheelrail.contact.models.fitted.model import FittedContact
    from wheelrail.contact.models.lattice.model import LatticeContact

    if isinstance(model, LatticeContact):
        return replace(model, resolution=model.resolution.coarsened())
    assert isinstance(model, FittedContact)
    return replace(model, resolution=model.resolution.coarsened())


def _estimated(result: ContactResult, solve_coarse: Callable[[], ContactResult]) -> ContactResult:
    """The result with an error estimate, computed at the final position only and not at every trial depth."""
    from wheelrail.contact.results.error_estimate import ErrorEstimate
    from wheelrail.contact.results.extrapolation import difference

    if not result.patches:
        return result
    with deferred_interrupts():
        coarse = solve_coarse()
    return replace(result, error_estimate=difference(result, coarse) if coarse.ok else ErrorEstimate.unknown())


def _stress(
    scene: HertzScene | WheelsetScene,
    result: ContactResult,
    pose: Pose,
    profiles: tuple[Profile, Profile] | None,
    report_progress: ReportProgress,
) -> dict[str, SubsurfaceStress]:
    """Subsurface stress by body, in the frame of the result's fields. Raises SceneError for depths outside a body."""
    if scene.stress is None or not result.patches:
        return {}
    import numpy as np

    stress = {}
    for name, body in stressed_bodies(scene, pose, profiles).items():
        report_progress(f"stress in the {name}")
        try:
            stress[name] = body.below(result, np.array(scene.stress.depths))
        except ValueError as error:
            raise SceneError(f"stress.depths: {name}: {error}") from None
    return stress


def _equilibria(
    scene: WheelsetScene, contact: WheelsetContact
) -> Iterator[tuple[tuple[str, ...], Callable[[], WheelsetEquilibrium]]]:
    """Solves of a wheelset scene: sides, and the function that computes their static equilibrium."""
    from wheelrail.contact.kinematics.wheelset_state import WheelsetState
    from wheelrail.contact.loading.wheelset import axle_under_load, placed, wheel_under_load, wheels_under_load

    position = scene.wheelset
    state = WheelsetState(
        y=position.y,
        z=position.z or 0.0,
        roll=0.0 if position.roll == "solve" else position.roll,
        yaw=position.yaw,
        y_rate=position.y_rate,
        z_rate=position.z_rate,
        roll_rate=position.roll_rate,
        pitch_rate=position.pitch_rate or 0.0,
        speed=position.speed or 0.0,
        frame_rate=(0.0, 0.0, (position.speed or 0.0) * scene.track.curvature),
    )
    if position.z is not None:
        yield scene.sides, lambda: placed(contact, state, scene.sides)
    elif position.axle_load is not None:
        load = position.axle_load
        yield scene.sides, lambda: axle_under_load(contact, state, load, expected=wheel_scale(scene, 0.5 * load))
    else:
        load = position.wheel_load or 0.0
        expected = wheel_scale(scene, load)
        if position.roll == "solve":
            yield scene.sides, lambda: wheels_under_load(contact, state, load, expected=expected)
            return
        for side in scene.sides:
            yield (side,), partial(wheel_under_load, contact, state, side, load, expected=expected)


@contextmanager
def _clock() -> Iterator[Callable[[], float]]:
    """Seconds since the start of the block."""
    start = perf_counter()
    yield lambda: perf_counter() - start
