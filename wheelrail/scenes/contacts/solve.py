"""One contact solve of a scene: a Hertz pair, or the wheels of a wheelset."""

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

Say = Callable[[str], None]
Seen = Callable[[str, "ContactResult"], None]


@dataclass(frozen=True)
class SideSolution:
    """The contact of one side: its result, the pose (of the upper body in the frame of the lower one) that it stands
    in, z m and roll rad of the wheelset, contact solves and seconds that it took, and stresses inside the bodies.

    Without a pose there is no result but the reason why, as its status.
    """

    result: ContactResult
    pose: Pose | None = None
    z: float = nan
    roll: float = nan
    solves: int = 0
    seconds: float = 0.0
    stress: Mapping[str, SubsurfaceStress] = field(default_factory=dict)

    @classmethod
    def unfound(cls, reason: str) -> SideSolution:
        """The load cannot be carried."""
        from wheelrail.contact.results.result import ContactResult

        return cls(ContactResult.failed(reason))


def solve_contact(
    scene: HertzScene | WheelsetScene, say: Say = lambda _: None, seen: Seen = lambda *_: None
) -> dict[str, Any]:
    """The report of a scene, see `wheelrail.scenes.contacts.report`; say is told what is being done, seen the result of
    every side.

    The moment of a Hertz pair is about the point of first touch. A load that cannot be carried, or a contact that does
    not converge, is a status "failed: ..." and no error.
    """
    found = laws(scene)
    sides: dict[str, Any] = {}
    for side, solved in solve_sides(scene, say=say):
        if solved.pose is None:
            sides[side] = {"status": solved.result.status}
            continue
        seen(side, solved.result)
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
        **ways(scene),
        "falling": None if scene.falling is None else scene.falling.model_dump(),
        "stiffness_per_area": found.stiffness_per_area if found.normal_compliance else None,
        "regularisation": found.regularisation,
        **sides,
    }


def solve_sides(
    scene: HertzScene | WheelsetScene,
    *,
    model: ContactModel | WheelsetContact | None = None,
    profiles: tuple[Profile, Profile] | None = None,
    say: Say = lambda _: None,
) -> Iterator[tuple[str, SideSolution]]:
    """Every side of a scene, "contact" for a Hertz pair, solved in its turn.

    model: one that was built for this scene, or for one that differs only in pose, motion and load; profiles of wheel
    and rail as laid, where they are not the scene's own. Both are made from the scene unless given.
    """
    if isinstance(scene, HertzScene):
        return _hertz(scene, cast("ContactModel | None", model), say)
    return _wheelset(scene, cast("WheelsetContact | None", model), profiles, say)


def ways(scene: HertzScene | WheelsetScene) -> dict[str, Any]:
    """How the bodies and their contact are modelled."""
    if scene.model == "standard":
        return {"normal": scene.normal or "kik-piotrowski", "tangential": scene.tangential or "fastsim"}
    how = scene.discretisation
    return {
        "laws": scene.laws,
        "bodies": how.bodies,
        "points": how.points,
        "surface_size": scene.surface_size,
    }


def _hertz(scene: HertzScene, model: ContactModel | None, say: Say) -> Iterator[tuple[str, SideSolution]]:
    from wheelrail.contact.loading.hertz import hertz_pose, hertz_under_load
    from wheelrail.contact.loading.load_search import LoadError

    if model is None:
        say("meshes and stiffness of both bodies")
        model = hertz_model(scene)
    motion = hertz_motion(scene)
    say("contact")
    with _clock() as seconds:
        if scene.load is None:
            depth, solves = float(scene.approach or 0.0), 1
            with deferred_interrupts():
                result = model(hertz_pose(depth), motion, None)
        else:
            try:
                with deferred_interrupts():
                    found = hertz_under_load(model, motion, scene.load, expected=hertz_scale(scene, scene.load))
            except LoadError as error:
                yield "contact", SideSolution.unfound(str(error))
                return
            depth, solves, result = found.depth, found.trials, found.results[0]
    spent, pose = seconds(), hertz_pose(depth)
    if result.ok:  # the approach of the bodies: the largest overlap on a grid may miss the point of first touch
        result = replace(result, approach=depth)
    if scene.error_estimate:
        say("the same on half as many cells")
        result = _estimated(result, lambda: _halved(model)(pose, motion, None))
    yield "contact", SideSolution(result, pose, -depth, 0.0, solves, spent, _stress(scene, result, pose, None, say))


def _wheelset(
    scene: WheelsetScene, contact: WheelsetContact | None, profiles: tuple[Profile, Profile] | None, say: Say
) -> Iterator[tuple[str, SideSolution]]:
    from wheelrail.contact.loading.load_search import LoadError

    if contact is None:
        say("meshes and stiffness of wheel and rail")
        contact = wheelset_contact(scene)
    for sides, solve in _seats(scene, contact):
        say(f"contact of the {' and '.join(sides)} wheel")
        with _clock() as seconds:
            try:
                with deferred_interrupts():
                    seat = solve()
            except LoadError as error:
                yield from ((side, SideSolution.unfound(str(error))) for side in sides)
                continue
        share, time = seat.solves // len(sides), seconds() / len(sides)
        state = seat.state
        for side, result in seat.results.items():
            if scene.error_estimate:
                say(f"{side} wheel: the same on half as many cells")
                rough = replace(contact, model=_halved(contact.model))
                result = _estimated(result, partial(rough, state, side))
            pose, _ = contact.mounting.left_pair(state if side == "left" else state.mirrored())
            stress = _stress(scene, result, pose, profiles, say)
            if side == "right":
                pose, stress = pose.mirrored(), {name: found.mirrored() for name, found in stress.items()}
            yield side, SideSolution(result, pose, state.z, state.roll, share, time, stress)


def _halved(model: ContactModel) -> ContactModel:
    """The model on half as many cells each way."""
    from wheelrail.contact.models.fitted.model import FittedContact

    assert isinstance(model, FittedContact)
    return replace(model, fineness=model.fineness.halved())


def _estimated(result: ContactResult, rough: Callable[[], ContactResult]) -> ContactResult:
    """The result with an estimate of its error, once at its place and not at every depth tried on the way."""
    from wheelrail.contact.results.error_estimate import ErrorEstimate
    from wheelrail.contact.results.extrapolation import difference

    if not result.patches:
        return result
    with deferred_interrupts():
        other = rough()
    return replace(result, error_estimate=difference(result, other) if other.ok else ErrorEstimate.unknown())


def _stress(
    scene: HertzScene | WheelsetScene,
    result: ContactResult,
    pose: Pose,
    profiles: tuple[Profile, Profile] | None,
    say: Say,
) -> dict[str, SubsurfaceStress]:
    """Stresses by body, in the frame of the result's fields. Raises SceneError for depths that leave a body."""
    if scene.stress is None or not result.patches:
        return {}
    import numpy as np

    found = {}
    for name, body in stressed_bodies(scene, pose, profiles).items():
        say(f"stress inside the {name}")
        try:
            found[name] = body.below(result, np.array(scene.stress.depths))
        except ValueError as error:
            raise SceneError(f"stress.depths: {name}: {error}") from None
    return found


def _seats(
    scene: WheelsetScene, contact: WheelsetContact
) -> Iterator[tuple[tuple[str, ...], Callable[[], WheelsetEquilibrium]]]:
    """The solves that a wheelset scene asks for: sides, and the call that seats them."""
    from wheelrail.contact.kinematics.wheelset_state import WheelsetState
    from wheelrail.contact.loading.wheelset import axle_under_load, placed, wheel_under_load, wheels_under_load

    given = scene.wheelset
    state = WheelsetState(
        y=given.y,
        z=given.z or 0.0,
        roll=0.0 if given.roll == "solve" else given.roll,
        yaw=given.yaw,
        y_rate=given.y_rate,
        z_rate=given.z_rate,
        roll_rate=given.roll_rate,
        pitch_rate=given.pitch_rate or 0.0,
        speed=given.speed or 0.0,
        frame_rate=(0.0, 0.0, (given.speed or 0.0) * scene.track.curvature),
    )
    if given.z is not None:
        yield scene.sides, lambda: placed(contact, state, scene.sides)
    elif given.axle_load is not None:
        load = given.axle_load
        yield scene.sides, lambda: axle_under_load(contact, state, load, expected=wheel_scale(scene, 0.5 * load))
    else:
        load = given.wheel_load or 0.0
        expected = wheel_scale(scene, load)
        if given.roll == "solve":
            yield scene.sides, lambda: wheels_under_load(contact, state, load, expected=expected)
            return
        for side in scene.sides:
            yield (side,), partial(wheel_under_load, contact, state, side, load, expected=expected)


@contextmanager
def _clock() -> Iterator[Callable[[], float]]:
    """Seconds since the start of the block."""
    start = perf_counter()
    yield lambda: perf_counter() - start
