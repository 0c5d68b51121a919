"""Loop of wear: rates of the duty on the present profiles, a step of the distance, and so on."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.geometry.wheelset_conicity import difference_without_roll, wheelset_conicity
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.wear.strips import ProfileRates
from wheelrail.scenes.builders.wheelset import rigid_wheelset
from wheelrail.scenes.datasets.netcdf import provenance, read, write
from wheelrail.scenes.datasets.wear import (
    AMPLITUDE,
    joined,
    rail_rate_values,
    rail_state_values,
    rate_values,
    state_values,
    step_dataset,
)
from wheelrail.scenes.schema.errors import RunFailed, SceneError
from wheelrail.scenes.schema.toml import read_text
from wheelrail.scenes.wear.cases import Case, CaseRates, Duty
from wheelrail.scenes.wear.jobs import CaseJob, rates_of
from wheelrail.scenes.wear.rails import rail_rates, stored_rail_rates
from wheelrail.support.arrays import Array
from wheelrail.support.plain_data import decode, encode
from wheelrail.vehicle.wear.evolution import WearingProfile, WearingRail, wear_step
from wheelrail.vehicle.wear.smoothing import Step, smoothed

if TYPE_CHECKING:
    from xarray import Dataset

STEPS, RESULTS = "steps", "wear.nc"  # folder of the steps in that of the results, and the whole
SAME = 1e-6  # m, of a measure of a new wheel and its limit
TOGETHER = 0.5  # of the depth of a rail's step: rails that are due when another one reaches the whole
ROUNDING = 1e-9  # of the whole distance: a rest that is none
SOLVED = "solved"  # rates of the cases that a step solves, in its file: bytes of plain data
PACKAGES = tuple(f"wheelrail.{name}" for name in ("bindings", "contact", "vehicle", "scenes.wear"))  # of its classes
UNCHANGED = 0.1  # of the last change of all rates: change of a case below which its last rates count again

Solved = Mapping[str, CaseRates]  # by case


@dataclass(frozen=True)
class WearState:
    """Profiles at a distance, with data of earlier steps that the next one needs.

    Parameters:
        profiles: by name.
        renewed: those that the compliance of the bodies is of.
        distance: m.
        turned: number of reprofilings by profile, if any.
        solved: distances, m, and rates of the last two solves of each case, at most.
        rails: those that wear, by name.
        before: area rates (profiles, n) m of the last two steps, at most; none after a reprofiling.
    """

    profiles: dict[str, WearingProfile]
    renewed: dict[str, WearingProfile]
    distance: float = 0.0
    turned: Mapping[str, int] = field(default_factory=dict)
    rails: dict[str, WearingRail] = field(default_factory=dict)
    solved: Mapping[str, tuple[tuple[float, CaseRates], ...]] = field(default_factory=dict)
    before: tuple[Array, ...] = ()

    def guesses(self, case: str) -> dict[str, Array]:
        """States from which the curves of a case start, by hand: wheels sink as they wear, straight in the distance."""
        known = self.solved.get(case, ())
        if len(known) < 2:
            return dict(known[0][1].states) if known else {}
        (d0, first), (d1, last) = known
        part = (self.distance - d1) / (d1 - d0)
        return {hand: state + part * (state - first.states[hand]) for hand, state in last.states.items()}

    def kept(self, case: str, share: float) -> CaseRates | None:
        """Last rates of a case, if a solve would change all rates by less than a tenth of the error of the steps.

        Parameters:
            case: name.
            share: of the distance.
        """
        known = self.solved.get(case, ())
        if len(known) < 2 or len(self.before) < 2 or self.rails:
            return None
        (d0, first), (d1, last) = known
        rates = [np.stack([own.removed for own in solved.rates.wheels.values()]) for solved in (first, last)]
        change = share * np.linalg.norm(rates[1] - rates[0]) * 2.0 * (self.distance - d1) / (d1 - d0)
        return last if change <= UNCHANGED * np.linalg.norm(self.before[1] - self.before[0]) else None

    @property
    def surfaces(self) -> dict[str, WearingProfile]:
        """Profiles of wheels and rails by name."""
        return self.profiles | {name: rail.profile for name, rail in self.rails.items()}


class WearLoop:
    """Wear of a duty over distance.

    Parameters:
        duty: cases.
        folder: for each step, from which an interrupted loop resumes; None: nothing is written.
        report: called with the part of the distance that is done and words, at each case and step.
        executor: of the cases; None: this process.
    """

    def __init__(
        self,
        duty: Duty,
        folder: Path | None = None,
        report: Callable[[float, str], None] = lambda *_: None,
        executor: Executor | None = None,
    ) -> None:
        self.duty, self.folder, self.report, self.executor = duty, folder, report, executor
        self.steps: list[Dataset] = []
        self.status = "running"

    @cached_property
    def inputs(self) -> str:
        """Text that is equal for equal wear, whatever its distance."""
        table, vehicle = self.duty.table, self.duty.table.vehicle
        scenes = [case.scene.model_dump() for case in self.duty.cases]
        pairs = [pair for case in self.duty.cases for own in case.new_profiles.values() for pair in own.values()]
        digests = [wheel.digest() + rail.digest() for wheel, rail in pairs]
        own = [table.model_dump(exclude={"until"}), scenes, digests, read_text(Path(vehicle)) if vehicle else ""]
        return sha256(json.dumps(own, default=str, sort_keys=True).encode()).hexdigest()

    def run(self, *, resume: bool = False) -> Dataset:
        """Dataset over all steps; its status is "completed", or says why the loop ended before.

        Parameters:
            resume: whether to continue from the steps in the folder.

        Raises SceneError for steps of another wear, and without a first step RunFailed.
        """
        first = self._resumed() if resume else self._begun()
        try:
            self._run(first)
            self.status = "completed"
        except KeyboardInterrupt:
            self.status = "interrupted"
        except (RunFailed, ValueError) as error:
            self.status = f"failed: {error}"
        if not self.steps:
            raise RunFailed(f"{self.status} before the first step")
        data = joined(self.steps).assign_attrs(status=self.status)
        if self.folder is not None:
            write(data, self.folder / RESULTS)
        return data

    def _begun(self) -> WearState:
        state = self._unworn()
        if self.folder is not None:
            (self.folder / STEPS).mkdir(parents=True, exist_ok=True)
            for file in self._files():
                file.unlink()
        return state

    def _unworn(self) -> WearState:
        """New wheels and rails. Raises SceneError for a limit that these exceed."""
        state = WearState(self.duty.unworn(), {}, rails=self.duty.unworn_rails())
        for profile, name, value, limit in self._beyond_limits(state):
            if abs(value - limit) > SAME:
                text = f"reprofile.{name} = {limit:g} m: {profile} is beyond it when new, with {value:.4g} m"
                raise SceneError(text)
        return replace(state, renewed=state.surfaces)

    def _files(self) -> list[Path]:
        assert self.folder is not None
        return sorted((self.folder / STEPS).glob("[0-9]*.nc"))

    def _resumed(self) -> WearState:
        """State after the last whole step in the folder."""
        assert self.folder is not None
        (self.folder / STEPS).mkdir(parents=True, exist_ok=True)
        state = self._unworn()
        for file in self._files():
            step = read(file)
            if step.attrs.get("inputs") != self.inputs:
                raise SceneError(f"{file}: step of another wear; omit --resume to start anew")
            if np.isnan(step["area_rate"].values).any():  # the end of a shorter distance
                file.unlink()
                break
            self.steps.append(step)
            state = self._after(self._solved(state, decode(step[SOLVED].values.tobytes(), PACKAGES)), step)
        return state

    def _solved(self, state: WearState, new: Solved) -> WearState:
        """The state with the rates of the cases that are solved for its step."""
        solved = {case: (*state.solved.get(case, ())[-1:], (state.distance, own)) for case, own in new.items()}
        return replace(state, solved={**state.solved, **solved})

    def _run(self, state: WearState) -> None:
        """Steps from a state up to the end of the distance."""
        table, until = self.duty.table, self.duty.table.until
        shares = {case.name: case.table.share for case in self.duty.cases}
        law = self.duty.law
        attributes = {
            **provenance(),
            "title": "Wear of wheel profiles",
            "wear": json.dumps(self.duty.table.model_dump(exclude_defaults=True, exclude={"kind"})),
            "scene": read_text(Path(table.scene)),
            "vehicle": read_text(Path(table.vehicle)) if table.vehicle else "",
            "status": "running",
            "inputs": self.inputs,
            "law": json.dumps(self.duty.table.law),
            "law_source": law.source,
            "law_unsure": law.unsure,
            "law_remark": law.remark,
        }
        while True:
            start = perf_counter()
            rated = self._rated(state) if state.distance < until else lambda: ({}, {})
            values = self._measured(state)  # while other processes solve
            rates, solved = rated()
            values |= rates
            values["seconds"] = perf_counter() - start
            rails = {name: rail.profile for name, rail in state.rails.items()}
            step = step_dataset(state.profiles, shares, values, attributes, rails)
            if self.folder is not None:
                stored = step.assign({SOLVED: ("byte", np.frombuffer(encode(solved), np.uint8))})
                write(stored, self.folder / STEPS / f"{len(self.steps):05d}.nc")
            self.steps.append(step)
            if state.distance >= until:
                return
            state = self._after(self._solved(state, solved), step)

    def _measured(self, state: WearState) -> dict[str, Any]:
        """Values of the profiles of a state."""
        conicity = float(np.mean(self._conicities(state)))
        turned = [state.turned.get(name, 0) for name in state.profiles]
        wheels = state_values(state.profiles, self._measures(state), state.distance, conicity, turned)
        passages = 0.0 if self.duty.table.rails is None else state.distance * self.duty.table.rails.passages
        return wheels | rail_state_values({name: rail.profile for name, rail in state.rails.items()}, passages)

    def _conicities(self, state: WearState) -> list[float]:
        """Equivalent conicities of wheelsets with profiles of their own; NaN without contact on both sides."""
        case, known, keys = self.duty.cases[0], dict[tuple[Any, ...], float](), list[tuple[Any, ...]]()
        present = {name: own.present for name, own in state.profiles.items()}
        for wheelset, *_ in self.duty.groups(case, case.scene):
            pairs = self.duty.pairs(case, wheelset, present)
            digests = [profile.digest() for pair in pairs.values() for profile in pair]
            keys.append((*digests, *(case.new_wheel(wheelset, side)[1] for side in SIDES)))
            if keys[-1] in known:
                continue
            rigid = rigid_wheelset(case.scene.contact_of(wheelset), pairs)
            try:
                known[keys[-1]] = float(wheelset_conicity(rigid, np.array([AMPLITUDE]), difference_without_roll)[0])
            except ValueError:
                known[keys[-1]] = np.nan
        return [known[key] for key in keys]

    def _measures(self, state: WearState) -> list[Any]:
        """Measures of each profile of a state."""
        back = self.duty.cases[0].scene.wheelset.flange_back
        return [
            own.present.measures(own.new, radius=self.duty.new_wheels[name][1], flange_back=back)
            for name, own in state.profiles.items()
        ]

    def _rated(self, state: WearState) -> Callable[[], tuple[dict[str, Any], dict[str, CaseRates]]]:
        """Function that awaits and returns the values of the rates of all cases, and newly solved rates by case."""
        kept = {case.name: state.kept(case.name, case.table.share) for case in self.duty.cases}
        open_cases = [(number, case) for number, case in enumerate(self.duty.cases) if kept[case.name] is None]
        rated = zip(open_cases, self._case_rates(state, open_cases), strict=True)
        return lambda: self._rate_values(state, kept, rated)

    def _rate_values(
        self,
        state: WearState,
        kept: dict[str, CaseRates | None],
        rated: Iterable[tuple[tuple[int, Case], CaseRates]],
    ) -> tuple[dict[str, Any], dict[str, CaseRates]]:
        """Values of rates that are kept, by case, and of rates being solved; the latter by case."""
        every = self.duty.cases
        solved = {case.name: rates for (_, case), rates in rated}
        cases = [(kept | solved)[case.name].rates for case in every]  # type: ignore[union-attr]
        shares = [case.table.share for case in self.duty.cases]
        _, values = rate_values(state.profiles, cases, shares)
        values |= rail_rate_values(rail_rates(state.rails, [case.passages for case in cases], shares).values())
        if state.before:
            change = 0.5 * np.linalg.norm(values["area_rate"] - state.before[-1], axis=1)
            size = np.linalg.norm(state.before[-1], axis=1)
            values["step_error"] = np.divide(change, size, out=np.zeros(len(size)), where=size > 0.0)
        with suppress(ValueError):  # which ends the loop after this step is written
            values |= self._smoothed(state, values)
        return values, solved

    def _smoothed(self, state: WearState, values: Mapping[str, Any]) -> dict[str, Array]:
        """Fatigue as the step smooths wear: rates at the ends of strips, where contacts leave edges, last for less."""
        steps, _ = self._steps(state, values)
        found = {name: values[name].copy() for name in ("damage_rate", "fatigue_rate")}
        for number, (name, own) in enumerate(state.profiles.items()):
            for rates in found.values():
                for case in rates:
                    part = own.width / own.widths  # of the new width, on which the rates are
                    case[number] = smoothed(case[number] * part, steps[name].length, own.widths) / part
        return found | {"smoothing_length": np.stack([own.length for own in steps.values()])}

    def _case_rates(self, state: WearState, cases: Sequence[tuple[int, Case]]) -> Iterator[CaseRates]:
        """Rates of cases with their numbers at a state, in their order; other processes begin now."""
        if self.executor is None:
            return self._own_rates(state, cases)
        profiles, renewed = state.surfaces, state.renewed
        jobs = [CaseJob.of(self.duty, number, profiles, renewed, state.guesses(case.name)) for number, case in cases]
        return self._reported(state, len(cases), rates_of(self.executor, jobs))

    def _report(self, state: WearState, words: str) -> None:
        self.report(state.distance / self.duty.table.until, f"step {len(self.steps)}: {words}")

    def _reported(self, state: WearState, count: int, rated: Iterator[CaseRates]) -> Iterator[CaseRates]:
        for number, rates in enumerate(rated, start=1):
            self._report(state, f"{number} of {count} cases")
            yield rates

    def _own_rates(self, state: WearState, cases: Sequence[tuple[int, Case]]) -> Iterator[CaseRates]:
        profiles, renewed = state.surfaces, state.renewed
        with self.duty.contacts(profiles, renewed, [case for _, case in cases]) as contacts:
            for _, case in cases:
                self._report(state, case.name)
                yield self.duty.rates(case, contacts[case.contact_key], profiles, state.guesses(case.name))

    def _steps(self, state: WearState, values: Mapping[Any, Any]) -> tuple[dict[str, Step], float]:
        """Steps of the wheels at given rates, and passages of wheelsets until a rail is due."""
        table, passages = self.duty.table, np.inf
        rates = {name: _rates(values, number) for number, name in enumerate(state.profiles)}
        longest = min(table.step, table.until - state.distance)
        if table.rails is not None:
            due = stored_rail_rates(state.rails, values)
            passages = min(rail.passages(due[name], table.rails.depth) for name, rail in state.rails.items())
            longest = min(longest, passages / table.rails.passages)
        steps = wear_step(state.profiles, rates, modulus=self.duty.modulus, depth=table.depth, distance=longest)
        return steps, passages

    def _after(self, state: WearState, step: Dataset) -> WearState:
        """The state after a step with given rates."""
        table = self.duty.table
        rail_rates = stored_rail_rates(state.rails, step)
        steps, passages = self._steps(state, step)
        distance = next(iter(steps.values())).distance
        profiles = {name: own.after(steps[name]) for name, own in state.profiles.items()}
        reached = state.distance + distance
        if table.until - reached < ROUNDING * table.until:
            reached = table.until
        rails = {}
        if table.rails is not None:
            due = TOGETHER if distance * table.rails.passages > (1.0 - ROUNDING) * passages else 1.0
            depth = 0.0 if reached == table.until else due * table.rails.depth
            rails = {
                name: rail.after(
                    rail_rates[name], distance * table.rails.passages, modulus=self.duty.modulus, depth=depth
                )
                for name, rail in state.rails.items()
            }
        before = (*state.before[-1:], step["area_rate"].values)
        after = replace(state, profiles=profiles, rails=rails, distance=reached, before=before)
        if turning := self._worn_out(after):
            unworn = self.duty.unworn()
            profiles = after.profiles | {name: unworn[name] for name in turning}
            turned = {**state.turned, **{name: state.turned.get(name, 0) + 1 for name in turning}}
            after = replace(after, profiles=profiles, turned=turned, solved={}, before=())
            return replace(after, renewed=after.surfaces)
        depth = max(float(np.max(own.depth - state.renewed[name].depth)) for name, own in after.surfaces.items())
        return replace(after, renewed=after.surfaces) if depth > table.renew else after

    def _worn_out(self, state: WearState) -> list[str]:
        """Profiles that are due to be turned, as measures are beyond their limits."""
        beyond = [profile for profile, *_ in self._beyond_limits(state)]
        apart = self.duty.table.reprofile is not None and self.duty.table.reprofile.apart
        return self.duty.turned_with(beyond) if apart or not beyond else list(state.profiles)

    def _beyond_limits(self, state: WearState) -> Iterator[tuple[str, str, float, float]]:
        """Profile, name, value m and limit m of measures beyond their limits."""
        limits = self.duty.table.reprofile
        if limits is None:
            return
        for profile, own in zip(state.profiles, self._measures(state), strict=True):
            for name, sign in (("Sd", -1.0), ("qR", -1.0), ("Sh", 1.0), ("hollow", 1.0)):
                value, limit = getattr(own, name), getattr(limits, name)
                if limit is not None and sign * (value - limit) > 0.0:
                    yield profile, name, float(value), limit


def _rates(step: Mapping[Any, Any], number: int) -> ProfileRates:
    """Removed sections and pressures of the number-th profile, for the next step; other rates are NaN."""
    removed, pressed, outside = (np.asarray(step[f"{name}_rate"])[number] for name in ("area", "pressed", "outside"))
    return ProfileRates.of_sections(removed, pressed, float(outside))
