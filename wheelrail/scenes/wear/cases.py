"""Cases of a duty: runs and steady curves of a vehicle on wheels with the present profiles."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.results.vehicle_contact import ContactsByWheelset, VehicleContact
from wheelrail.contact.wear.law_tables import law_from
from wheelrail.contact.wear.laws import WearLaw
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.scenes.builders.laws import laws
from wheelrail.scenes.builders.vehicle import applied_loads
from wheelrail.scenes.builders.wheelset import SideProfiles, mounted, on_structures, side_profiles, wheelset_contact
from wheelrail.scenes.runs.run import simulate_on_track, vehicle_for_run
from wheelrail.scenes.runs.steady import failures_as_run_failed
from wheelrail.scenes.schema.edits import changed
from wheelrail.scenes.schema.errors import RunFailed, SceneError
from wheelrail.scenes.schema.scene import RunScene, checked
from wheelrail.scenes.schema.toml import parse, read_text
from wheelrail.scenes.wear.lifted import LiftedContact
from wheelrail.scenes.wear.rails import rail_names
from wheelrail.scenes.wear.schema import DutyTable, WearTable
from wheelrail.support.arrays import Array
from wheelrail.support.cache import unstored
from wheelrail.vehicle.simulation.parallel_contact import in_threads
from wheelrail.vehicle.track.constant_curve import ConstantCurve
from wheelrail.vehicle.wear.evolution import WearingProfile, WearingRail
from wheelrail.vehicle.wear.rates import MeanRates, MotionRates, WornSurface

if TYPE_CHECKING:
    from wheelrail.contact.kinematics.wheelset_state import WheelsetState
    from wheelrail.contact.loading.structure import Structure
    from wheelrail.contact.models.lattice.influence.strip_operators import StripOperators
    from wheelrail.contact.models.wheelset import WheelsetContact
    from wheelrail.vehicle.multibody.equations import VehicleEvaluation, WheelContacts
    from wheelrail.vehicle.multibody.vehicle import Vehicle

FAILED = 0.02  # largest share of wheels without a result
# Of the mean wheel load: accepted where an equilibrium stalls, for a force jumps, as of `standard` by 0.2 % on a worn
# profile. Rates err by as much, steps by more.
UNBALANCED = 5e-3
OPPOSITE: Mapping[Side, Side] = {"left": "right", "right": "left"}
WITHOUT_CELLS = ("table",)

Profiles = Mapping[str, WearingProfile]  # by name
Structures = Sequence["Structure | None"] | None  # axle and rails of each wheelset; None where all are rigid


@dataclass(frozen=True)
class CaseRates:
    """Rates of a case, and the states of its curves by hand, from which the next solves start."""

    rates: MeanRates
    states: Mapping[str, Array]


@dataclass(frozen=True)
class Case:
    """A case of the duty.

    Parameters:
        name: in tables and pictures.
        table: of the wear file.
        scene: of its run, or of the contact and track of its curve.
        wearing: the same with the contact that wears.
        vehicle: of the scene.
        turned: whether the vehicle runs end for end, so that its left wheels are on the right.
        hand: -1 where the curve is mirrored.
        rails: names of those that wear, by side.
    """

    name: str
    table: DutyTable
    scene: RunScene
    wearing: RunScene
    vehicle: Vehicle
    turned: bool = False
    hand: int = 1
    rails: Mapping[Side, str] = field(default_factory=dict)

    @cached_property
    def new_profiles(self) -> Mapping[str, SideProfiles]:
        """New wheel and inclined rail by wheelset and side."""
        scenes = {name: self.scene.contact_of(name) for name in self.vehicle.wheelsets}
        known = {id(own): side_profiles(own) for own in {id(own): own for own in scenes.values()}.values()}
        return {name: known[id(own)] for name, own in scenes.items()}

    def new_wheel(self, wheelset: str, side: Side) -> tuple[Profile, float]:
        """New profile and radius, m, of a wheel."""
        radius = self.scene.contact_of(wheelset).side(side).radius
        assert radius is not None
        return self.new_profiles[wheelset][side][0], radius

    @cached_property
    def wheels(self) -> tuple[tuple[str, Side], ...]:
        """Wheelset and side of all wheels."""
        return tuple(product(self.vehicle.wheelsets, SIDES))

    @cached_property
    def contact_key(self) -> str:
        """Text that is equal for cases whose contacts are equal."""
        return json.dumps([_contact_keys(self.scene), _contact_keys(self.wearing), self.turned, self.rails])

    @property
    def is_lifted(self) -> bool:
        """Whether another contact wears than that of the motion."""
        return _contact_keys(self.scene) != _contact_keys(self.wearing)


def _contact_keys(scene: RunScene) -> str:
    """Text that is equal for scenes whose contacts are equal."""
    keys = scene.model_dump(exclude={"track", "vehicle", "solver", "output", "kick", "force", "torque"})
    track = scene.track.model_dump(include={"gauge", "gauge_height"})
    return json.dumps([keys, track], default=str, sort_keys=True)


class _Made(NamedTuple):
    """Present profiles, profiles of the compliance of the bodies, and models made so far."""

    profiles: Profiles
    renewed: Profiles
    models: dict[Any, Any]


class CaseContact(NamedTuple):
    """Contacts of a case's motion and of its wear, None where both are the same; elastic axles and rails."""

    motion: VehicleContact
    wearing: LiftedContact | None
    structures: Structures

    def results(self) -> Callable[[Mapping[str, WheelsetState], WheelContacts], WheelContacts]:
        """Function for a new motion: results that wear, from states and results of its wheelsets."""
        return (lambda _, contacts: contacts) if self.wearing is None else self.wearing.motion().results


@dataclass
class Duty:
    """Cases of a wear file, checked, with bodies that are kept from step to step.

    Parameters:
        table: of the wear file.
        path: of the wear file.

    Raises SceneError that names the case.
    """

    table: WearTable
    path: Path
    _bodies: dict[tuple[str, ...], tuple[str, StripOperators]] = field(default_factory=dict)  # of the renewed profiles

    def __post_init__(self) -> None:
        first, kind = self.cases[0], self.table.profiles
        for case in self.cases[1:]:
            for wheel in first.wheels:
                if not _same(case.new_wheel(*wheel), first.new_wheel(*wheel)):
                    text = f"has another {wheel[1]} wheel than {first.name!r}"
                    raise SceneError(f"{self.path}: duty {case.name!r}: {text}")
        self.unworn_rails()  # of which each is the same in all its cases
        if not self.table.sides_apart and not all(first.scene.contact_of(name).sides_alike for name, _ in first.wheels):
            other = "sides" if kind == "one" else "wheels"
            raise SceneError(f'{self.path}: profiles = "{kind}": must be "{other}" for sides that differ')
        if not all(_same(first.new_wheel(*wheel), self.new_wheels[self.profile_of(*wheel)]) for wheel in first.wheels):
            other = "wheelsets" if kind == "one" else "wheels"
            raise SceneError(f'{self.path}: profiles = "{kind}": must be "{other}" for wheelsets that differ')
        if len({len(own.removed) for own in self.unworn().values()}) > 1:
            raise SceneError(f"{self.path}: new wheels: must have equal lengths of their profiles")

    @cached_property
    def new_wheels(self) -> dict[str, tuple[Profile, float]]:
        """The new wheels and their radii, m, by profile."""
        first = self.cases[0]
        return {self.profile_of(*wheel): first.new_wheel(*wheel) for wheel in reversed(first.wheels)}

    @cached_property
    def cases(self) -> tuple[Case, ...]:
        vehicle = None if self.table.vehicle is None else Path(self.table.vehicle)
        return tuple(
            way
            for number, entry in enumerate(self.table.duty)
            for table in entry.cases(number)
            for way in self._ways(self._case(table, vehicle), entry.title(number))
        )

    def _ways(self, case: Case, entry: str) -> Iterator[Case]:
        """The case, in parts where the vehicle runs turned, too, or where rails of a curve have another hand.

        Parameters:
            case: whole.
            entry: title in the duty, of which rails are named.
        """
        radii = [[case.new_wheel(name, side)[1] for side in SIDES] for name in case.vehicle.wheelsets]
        if self.table.turned and (case.scene.force or any(left != right for left, right in radii)):
            text = "not allowed with forces on bodies, nor with wheels of different radii"
            raise SceneError(f"{self.path}: turned = true: duty {case.name!r}: {text}")
        apart = case.table.both_hands and self.table.sides_apart and self.table.rails is not None
        ways = list(product((1, -1) if apart else (1,), (False, True) if self.table.turned else (False,)))
        part = case.table.model_copy(update={"share": case.table.share / len(ways)})
        for hand, turned in ways:
            words = [case.name, *(["other hand"] if hand < 0 else []), *(["turned"] if turned else [])]
            vehicle = case.vehicle.turned if turned else case.vehicle
            rails = {} if self.table.rails is None else rail_names(entry, part, hand)
            yield Case(", ".join(words), part, case.scene, case.wearing, vehicle, turned, hand, rails)

    def _case(self, table: DutyTable, vehicle: Path | None) -> Case:
        name, file = table.title(0), table.scene or self.table.scene
        try:
            data = changed(parse(read_text(Path(file)), file), table.set, file)
            scene = checked(data, file)
            if not isinstance(scene, RunScene):
                raise SceneError(f'{file}: kind = "{scene.kind}": must be "run"')
            if scene.track.check_rail is not None:
                raise SceneError(f"{file}: track.check_rail: not allowed: flange backs do not wear")
            wearing = checked(changed(data, self.table.contact, "contact"), f"{file}, contact")
            assert isinstance(wearing, RunScene)
            if wearing.model in WITHOUT_CELLS:
                raise SceneError(f'{file}: model = "{wearing.model}": has no cells to wear')
            return Case(name, table, scene, wearing, vehicle_for_run(scene, vehicle))
        except SceneError as error:
            raise SceneError(f"{self.path}: duty {name!r}: {error}") from None

    @cached_property
    def law(self) -> WearLaw:
        return law_from(self.table.law)

    @property
    def modulus(self) -> float:
        """E*, Pa, of two bodies of the material of the scene."""
        scene = self.cases[0].scene
        return 0.5 * float(scene.E) / (1.0 - float(scene.nu) ** 2)

    def profile_of(self, wheelset: str, side: Side, turned: bool = False) -> str:
        """Name of the profile of a wheelset on a side of the track, of a vehicle that may be turned."""
        own = OPPOSITE[side] if turned else side
        names = {"one": "wheel", "sides": own, "wheelsets": wheelset, "wheels": f"{wheelset}, {own}"}
        return names[self.table.profiles]

    def turned_with(self, names: Collection[str]) -> list[str]:
        """Profiles of all wheelsets of the named profiles."""
        wheels = [(wheelset, self.profile_of(wheelset, side)) for wheelset, side in self.cases[0].wheels]
        wheelsets = {wheelset for wheelset, name in wheels if name in names}
        return list(dict.fromkeys(name for wheelset, name in wheels if wheelset in wheelsets))

    def unworn(self) -> dict[str, WearingProfile]:
        """The new profiles by name."""
        names = dict.fromkeys(self.profile_of(*wheel) for wheel in self.cases[0].wheels)
        return {name: WearingProfile.unworn(*self.new_wheels[name]) for name in names}

    def unworn_rails(self) -> dict[str, WearingRail]:
        """The new rails that wear, by name. Raises SceneError for different ones in the cases of a rail."""
        found = dict[str, WearingRail]()
        wheels = [(case, *wheel) for case in self.cases for wheel in case.wheels if wheel[1] in case.rails]
        for case, wheelset, side in wheels:
            name, new = case.rails[side], case.new_profiles[wheelset][side][1]
            own = found.setdefault(name, WearingRail(WearingProfile.unworn_rail(new)))
            if own.profile.new.digest() != new.digest():
                text = f"rail {name!r}: must be the same in all cases, as it wears: list rails as cases of their own"
                raise SceneError(f"{self.path}: duty {case.name!r}: {text}")
        return found

    @contextmanager
    def contacts(
        self, profiles: Profiles, renewed: Profiles, cases: Sequence[Case], threads: int | None = None
    ) -> Iterator[dict[str, CaseContact]]:
        """Contacts of cases on worn profiles, by `Case.contact_key`, solved in threads until the end of the block.

        Parameters:
            profiles: present ones, also of rails that wear.
            renewed: those that the compliance of the bodies is of; worn ones are not stored on the disk.
            cases: of this duty.
            threads: number; by default that of the scene.
        """
        found: dict[str, CaseContact] = {}
        made = _Made(profiles, renewed, {})
        with ExitStack() as block:
            if any(own.removed.any() for own in renewed.values()):
                block.enter_context(unstored())

            def shared(own: Mapping[str, VehicleContact], case: Case) -> VehicleContact:
                first = next(iter(own.values()))
                same = all(contact is first for contact in own.values())
                contact = first if same else ContactsByWheelset(first, own)
                return block.enter_context(in_threads(contact, threads or case.scene.solver.workers))

            for case in cases:
                if (key := case.contact_key) not in found:
                    own, structures = self._contacts(case, case.scene, made)
                    motion, wearing = shared(own, case), None
                    if case.is_lifted:
                        lifted, _ = self._contacts(case, case.wearing, made)
                        wearing = LiftedContact(case.wearing, lifted, shared(lifted, case))
                    found[key] = CaseContact(motion, wearing, structures)
            yield found

    def groups(self, case: Case, scene: RunScene) -> list[list[str]]:
        """Wheelsets of a case, together if of the same contact of a scene and the same profiles."""
        found = dict[Any, list[str]]()
        for name in case.vehicle.wheelsets:
            key = id(scene.contact_of(name)), *(self.profile_of(name, side) for side in SIDES)
            found.setdefault(key, []).append(name)
        return list(found.values())

    def _contacts(self, case: Case, scene: RunScene, made: _Made) -> tuple[Mapping[str, VehicleContact], Structures]:
        """Contacts of a scene of a case by wheelset, and axles and rails, which bend as with new profiles."""
        present = {name: own.present for name, own in made.profiles.items()}
        found: dict[str, WheelsetContact] = {}
        firsts: dict[str, str] = {}  # first wheelset with the same contact
        for wheelsets in self.groups(case, scene):
            first = wheelsets[0]
            contact = wheelset_contact(scene.contact_of(first), self.pairs(case, first, present), made.models)
            on_bodies = partial(self._on_bodies, case, scene, first, made)
            left, right = on_bodies(contact, "left"), contact.right and on_bodies(contact.right, "right")
            found[first] = replace(left, right=right)
            firsts |= dict.fromkeys(wheelsets, first)
        own = {name: firsts[name] for name in case.vehicle.wheelsets}
        if not scene.is_flexible:
            return {name: found[first] for name, first in own.items()}, None
        moving, structures = on_structures(scene, own, case.new_profiles, found)
        return {name: moving[first] for name, first in own.items()}, structures

    def pairs(self, case: Case, wheelset: str, present: Mapping[str, Profile]) -> SideProfiles:
        """Worn wheel and inclined rail of a wheelset by side; present: profiles by name."""
        new = case.new_profiles[wheelset]
        left, right = (
            (present[self.profile_of(wheelset, side, case.turned)], present.get(case.rails.get(side, ""), new[side][1]))
            for side in SIDES
        )
        return {"left": left, "right": right}

    def _on_bodies(
        self,
        case: Case,
        scene: RunScene,
        wheelset: str,
        made: _Made,
        contact: WheelsetContact,
        side: Side,
    ) -> WheelsetContact:
        """The contact with the compliance of earlier profiles: that of a worn wheel takes seconds, and a depth of 0.3
        mm changes places of contact by 0.1 mm and pressures by 1.5 %.
        """
        if case.rails:  # worn rails stay in their place
            contact = replace(contact, mounting=mounted(case.scene, case.new_profiles[wheelset][side][1]))
        model, names = contact.model, [self.profile_of(wheelset, side, case.turned)]
        names += filter(None, [case.rails.get(side)])
        if not isinstance(model, LatticeContact):
            return contact
        worn = any(made.profiles[name] is not made.renewed[name] for name in names)
        key = _contact_keys(scene), wheelset, *names
        earlier = "".join(made.renewed[name].present.digest() for name in names)
        if key not in self._bodies or self._bodies[key][0] != earlier:
            self._bodies.pop(key, None)  # before the next, which takes as much memory
            bodies = contact
            if worn:
                pairs = self.pairs(case, wheelset, {name: own.present for name, own in made.renewed.items()})
                bodies = wheelset_contact(scene.contact_of(wheelset), pairs, made.models).of(side)
            self._bodies[key] = earlier, bodies.model.operators  # type: ignore[attr-defined]
        if not worn:
            return contact
        operators = self._bodies[key][1].under(model.operators.surfaces)
        return replace(contact, model=replace(model, operators=operators))

    def rates(
        self,
        case: Case,
        contact: CaseContact,
        profiles: Profiles,
        guesses: Mapping[str, Array],
    ) -> CaseRates:
        """Rates of a case.

        Parameters:
            case: of this duty.
            contact: on the present profiles.
            profiles: present ones, also of rails that wear.
            guesses: states of its curves, by hand.

        Raises RunFailed that names the case.
        """

        def surface(name: str, wheelset: str, side: Side) -> WornSurface:
            friction = laws(case.wearing.contact_of(wheelset), side)
            return WornSurface(name, profiles[name].grid, profiles[name].place, friction)

        surfaces = {
            (name, side): surface(self.profile_of(name, side, case.turned), name, side) for name, side in case.wheels
        }
        rails = {side: surface(name, case.vehicle.wheelsets[0], side) for side, name in case.rails.items()}
        rates, after = MotionRates(surfaces, self.law, rails), dict[str, Array]()
        try:
            if case.table.steady is None:
                self._run(case, contact, rates)
            else:
                both = case.table.both_hands and self.table.sides_apart and not case.rails
                for hand in (1, -1) if both else (case.hand,):
                    after[str(hand)] = self._curve(case, contact, hand, rates, guesses.get(str(hand)))
        except RunFailed as error:
            raise RunFailed(f"duty {case.name!r}: {error}") from None
        means = rates.means
        if means.failed_share > FAILED:
            raise RunFailed(
                f"duty {case.name!r}: {100 * means.failed_share:.1f} % of the wheels have no contact result"
            )
        return CaseRates(means, after)

    def _curve(self, case: Case, contact: CaseContact, hand: int, rates: MotionRates, guess: Array | None) -> Array:
        """Add the wheels of a steady curve; its state."""
        from wheelrail.vehicle.multibody.equations import VehicleDynamics
        from wheelrail.vehicle.steady.equilibrium import equilibrium

        steady = case.table.steady
        assert steady is not None
        curve = ConstantCurve(steady.speed, hand * steady.curvature, steady.cant, case.scene.track.track().base)
        loads = applied_loads(case.scene, case.vehicle)
        motion = contact.motion
        dynamics = VehicleDynamics(case.vehicle, curve.track, motion, steady.speed, contact.structures, loads)
        with failures_as_run_failed():
            found = equilibrium(dynamics.with_constant_loads(0.0), guess=guess, acceptable=UNBALANCED)
        rates.residual = max(rates.residual, found.residual)
        states = found.dynamics.wheelset_states(found.time, found.state)
        rates.add(steady.speed, contact.results()(states, found.contacts))
        return found.state

    def _run(self, case: Case, contact: CaseContact, rates: MotionRates) -> None:
        """Add the wheels of the rows of a run."""
        from wheelrail.vehicle.simulation.time_run import Recording
        from wheelrail.vehicle.track.speed_profile import SpeedProfile

        scene, results = case.scene, contact.results()
        profile = SpeedProfile.of(scene.vehicle.speed_profile)
        end = profile.time_at(scene.track.length)

        def observe(time: float, state: Array, at: VehicleEvaluation) -> None:
            travel = profile(time)
            if travel.distance >= case.table.start and time > 0.0:
                assert at.states is not None
                rates.add(travel.speed, results(at.states, at.contacts))

        recording = Recording(self.table.interval / scene.vehicle.first_speed, observer=observe)
        motion, structures = contact.motion, contact.structures
        history = simulate_on_track(scene, case.vehicle, motion, end, recording, lambda *_: None, structures)
        if history.status != "completed":
            raise RunFailed(history.status)
        if not rates.wheels:
            raise RunFailed(f"start = {case.table.start:g} m: no row of the run lies beyond it")


def _same(wheel: tuple[Profile, float], other: tuple[Profile, float]) -> bool:
    """Whether new wheels have the same profile and radius."""
    return wheel[0].digest() == other[0].digest() and wheel[1] == other[1]
