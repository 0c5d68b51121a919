"""Both wheels at the same time: a second process solves the right-hand contact."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, fields, replace
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any, cast
from weakref import finalize

import numpy as np

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult, LazyPatches, Patch
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.support.arrays import Array
from wheelrail.support.interrupts import deferred_interrupts, ignore

HERE: Side = "left"
THERE: Side = "right"
LOST = "the process of the right-hand contact has ended"


class WorkerLost(RuntimeError):
    """The second process ended without being asked to."""


class Key:
    """Names a result that stays in the other process; as long as it lives here, the result is kept there."""

    def __init__(self, number: int, forget: Callable[[int], None]) -> None:
        self.number = number
        at_end = finalize(self, forget, number)
        at_end.atexit = False  # type: ignore[misc]


@dataclass(frozen=True)
class Remote(ContactResult):
    """What a run needs of a result that stays in the other process: no fields; patches and tangent are asked for."""

    key: Key | None = field(default=None, repr=False, compare=False)


@dataclass
class Parallel(VehicleContact):
    """A contact that solves left here and right in a second process; `in_parallel` makes and ends it.

    `ahead` sets the other process to work on what the next call for its side will ask. A guess goes over as a key: the
    other process looks up the result that it kept, and forgets what nobody here refers to any longer. Results are the
    same to the last bit as in one process. What the contact raises there is raised here. Raises WorkerLost when the
    process died.
    """

    contact: VehicleContact
    pipe: Connection
    asked: int = 0
    pending: tuple[str, WheelsetState, ContactResult | None] | None = None
    forgotten: list[int] = field(default_factory=list)

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        if side == HERE:
            return self.contact(state, side, guess)
        return self._result(self._asked_for("solve", state, guess))

    def ahead(self, state: WheelsetState, guess: ContactResult | None) -> None:
        """Begin with the solve of the right side."""
        self._ask("solve", state, guess)

    def tangent(self, state: WheelsetState, side: Side, result: ContactResult) -> Array:
        """As the contact's own; raises ValueError when that has none."""
        if side == HERE:
            return self.contact.tangent(state, side, result)
        return np.asarray(self._asked_for("tangent", state, result))

    def ahead_tangent(self, state: WheelsetState, result: ContactResult) -> None:
        """Begin with the tangent of the right side."""
        self._ask("tangent", state, result)

    def _result(self, answer: ContactResult) -> ContactResult:
        key = Key(self.asked, self.forgotten.append)
        values = {f.name: getattr(answer, f.name) for f in fields(ContactResult)}
        values["patches"] = LazyPatches(lambda: tuple(self._patches(key)))
        return Remote(**values, key=key)

    def _patches(self, key: Key) -> Sequence[Patch]:
        self._send("patches", None, key.number)
        return cast(Sequence[Patch], self._answer())

    def _asked_for(self, what: str, state: WheelsetState, result: ContactResult | None) -> Any:
        before, self.pending = self.pending, None
        if before is None or not (before[0] == what and before[1] == state and before[2] is result):
            self._ask(what, state, result)
            self.pending = None
        return self._answer()

    def _ask(self, what: str, state: WheelsetState, result: ContactResult | None) -> None:
        if result is not None and not (isinstance(result, Remote) and result.key):
            raise ValueError("a result of the right-hand contact that did not come from its process")
        self._send(what, state, result.key.number if isinstance(result, Remote) and result.key else None)
        self.pending = what, state, result

    def _send(self, what: str, state: WheelsetState | None, key: int | None) -> None:
        self.asked, self.pending = self.asked + 1, None
        gone = [self.forgotten.pop() for _ in range(len(self.forgotten))]
        try:
            self.pipe.send((self.asked, what, state, key, gone))
        except OSError as error:
            raise WorkerLost(LOST) from error

    def _answer(self) -> Any:
        """The answer to the latest question: one that was not waited for has left its own in the pipe."""
        number = -1
        while number != self.asked:
            if number > 0:
                self.forgotten.append(number)
            try:
                number, answer, error = self.pipe.recv()
            except (EOFError, OSError) as lost:
                raise WorkerLost(LOST) from lost
        if error is not None:
            raise error
        return answer


@contextmanager
def in_parallel(contact: VehicleContact) -> Iterator[Parallel]:
    """Fork a second process that has the contact as it is now; ended on leaving, and when this process dies.

    Raises ValueError where processes cannot be forked.
    """
    context = get_context("fork")
    here, there = context.Pipe()
    process = context.Process(target=_serve, args=(contact, here, there), name="right-hand contact", daemon=True)
    with deferred_interrupts():  # two processes come out of it
        process.start()
        there.close()
    try:
        with _broken_pipes_told():
            yield Parallel(contact, here)
    finally:
        here.close()  # which ends it after what it is at
        process.join(timeout=1.0)
        if process.is_alive():
            process.terminate()
            process.join()


@contextmanager
def _broken_pipes_told() -> Iterator[None]:
    """A pipe that nobody reads from is an error, and does not end this process: libraries of MPI put that back."""
    try:
        before = signal.signal(signal.SIGPIPE, signal.SIG_IGN)
    except ValueError:  # not in the main thread
        yield
        return
    try:
        yield
    finally:
        signal.signal(signal.SIGPIPE, before)


def _serve(contact: VehicleContact, parents: Connection, pipe: Connection) -> None:
    """Answer questions (number, what, state, key of a result, keys to forget) until the other end is closed."""
    ignore()  # Ctrl-C goes to both; the parent decides
    parents.close()  # else the pipe would never end
    kept: dict[int, ContactResult] = {}
    while True:
        try:
            number, what, state, key, gone = pipe.recv()
        except (EOFError, OSError):
            return
        for old in gone:
            kept.pop(old, None)
        answer, error = None, None
        try:
            answer = _answered(contact, kept, number, what, state, key)
        except Exception as caught:
            error = caught
        try:
            pipe.send((number, answer, error))
        except OSError:
            return
        except Exception as unsendable:
            pipe.send((number, None, RuntimeError(f"{error or unsendable!r} (from the other process)")))


def _answered(
    contact: VehicleContact,
    kept: dict[int, ContactResult],
    number: int,
    what: str,
    state: WheelsetState,
    key: int | None,
) -> Any:
    known = None if key is None else kept[key]
    if what == "solve":
        kept[number] = contact(state, THERE, known)
        return replace(kept[number], patches=(), fields=None, force_tangent=None, warm_start=None)
    assert known is not None
    return known.patches if what == "patches" else contact.tangent(state, THERE, known)
