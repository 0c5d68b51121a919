"""Parallel solution of the contacts of both sides: a second process solves the right-hand ones.

Measured: two threads would reach 79 to 88 % of the gain of a second process, as 61 to 66 % of a solve holds the
interpreter's lock, and PETSc is not thread-safe. A call through the pipe costs 0.2 to 0.3 ms; through an executor of
`concurrent.futures` 0.6 to 1.1 ms, and its threads may wait for the interpreter's lock before the other side starts.
"""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, fields, replace
from functools import partial
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any, NamedTuple, cast
from weakref import finalize

import numpy as np

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult, LazyPatches, Patch
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.support.arrays import Array
from wheelrail.support.interrupts import deferred_interrupts, ignore
from wheelrail.vehicle.integration.problem import StepFailure

LOCAL: Side = "left"
REMOTE: Side = "right"


class WorkerLost(StepFailure):
    """The second process ended unexpectedly; a run ends with the steps before."""

    def __init__(self) -> None:
        super().__init__("the process of the right-hand contact has ended: killed, out of memory, or a crash")


class Key:
    """Number of a result that the second process stores for as long as the key is referenced in this one."""

    def __init__(self, number: int, release: Callable[[int], None]) -> None:
        self.number = number
        at_end = finalize(self, release, number)
        at_end.atexit = False  # type: ignore[misc]


@dataclass(frozen=True)
class RemoteResult(ContactResult):
    """A result without what stays in the second process: fields, tangent and warm start; patches are read on demand."""

    key: Key | None = field(default=None, repr=False, compare=False)


class PendingRequest(NamedTuple):
    """A request whose answer was not read yet."""

    number: int
    what: str
    state: WheelsetState | None
    key: Key | None


@dataclass
class Parallel(VehicleContact):
    """Contact model that solves left-hand contacts here and right-hand ones in a second process: `in_parallel`.

    `ahead`, `ahead_tangent` and the patches' own `ahead` start calls for the right side early, of several wheelsets one
    after another; the calls follow in the same order, and a call forgets what was started before it. A guess is sent as
    the key of a stored result; results without references are released. Results agree with those of one process to the
    last bit. Exceptions of the contact model are raised here, WorkerLost when the second process has ended.
    """

    contact: VehicleContact
    pipe: Connection
    requests: int = 0
    pending: list[PendingRequest] = field(default_factory=list)
    released: list[int] = field(default_factory=list)

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        if side == LOCAL:
            return self.contact(state, side, guess)
        return self._result(*self._requested("solve", state, _key(guess)))

    def ahead(self, state: WheelsetState, guess: ContactResult | None) -> None:
        """Start the solve of the right side."""
        self._announce("solve", state, _key(guess))

    def tangent(self, state: WheelsetState, side: Side, result: ContactResult) -> Array:
        """As the tangent of the contact model; raises ValueError when that has none."""
        if side == LOCAL:
            return self.contact.tangent(state, side, result)
        return np.asarray(self._requested("tangent", state, _key(result))[1])

    def ahead_tangent(self, state: WheelsetState, result: ContactResult) -> None:
        """Start the tangent of the right side."""
        self._announce("tangent", state, _key(result))

    def warm_start(self, side: Side, result: ContactResult) -> object:
        if side == LOCAL:
            return self.contact.warm_start(side, result)
        return self._answer(self._send("warm start", None, _key(result)))

    def guess(self, side: Side, warm_start: object) -> ContactResult:
        if side == LOCAL:
            return self.contact.guess(side, warm_start)
        number = self._send("guess", warm_start, None)
        return self._result(number, self._answer(number))

    def _result(self, number: int, answer: ContactResult) -> ContactResult:
        """The answer to a request with the key of what the second process stores."""
        key = Key(number, self.released.append)
        values = {f.name: getattr(answer, f.name) for f in fields(ContactResult)}
        patches = partial(self._patches, key), partial(self._announce, "patches", None, key)
        values["patches"] = LazyPatches(*patches)
        return RemoteResult(**values, key=key)

    def _patches(self, key: Key) -> tuple[Patch, ...]:
        return tuple(cast(Sequence[Patch], self._requested("patches", None, key)[1]))

    def _announce(self, what: str, state: WheelsetState | None, key: Key | None) -> None:
        """Start a request unless it is pending."""
        if self._index(what, state, key) is None:
            number = self._send(what, state, key)
            self.pending.append(PendingRequest(number, what, state, key))

    def _requested(self, what: str, state: WheelsetState | None, key: Key | None) -> tuple[int, Any]:
        """Number of a request, of a pending one if there is one, and its answer."""
        index = self._index(what, state, key)
        if index is None:
            number = self._send(what, state, key)
            return number, self._answer(number)
        number, pending = self.pending[index].number, self.pending[index + 1 :]
        answer = self._answer(number)
        self.pending = pending
        return number, answer

    def _index(self, what: str, state: WheelsetState | None, key: Key | None) -> int | None:
        """Index among the pending requests."""
        for index, request in enumerate(self.pending):
            if request.what == what and request.state == state and request.key is key:
                return index
        return None

    def _send(self, what: str, state: object, key: Key | None) -> int:
        """Number of a request after sending it."""
        self.requests += 1
        released = [self.released.pop() for _ in range(len(self.released))]
        try:
            self.pipe.send((self.requests, what, state, None if key is None else key.number, released))
        except OSError as error:
            self.pending = []
            raise WorkerLost from error
        return self.requests

    def _answer(self, request: int) -> Any:
        """Answer to a request; those to earlier requests are still in the pipe, and are forgotten."""
        self.pending = []
        number = -1
        while number != request:
            if number > 0:
                self.released.append(number)
            try:
                number, answer, error = self.pipe.recv()
            except (EOFError, OSError) as lost:
                raise WorkerLost from lost
        if error is not None:
            raise error
        return answer


def _key(result: ContactResult | None) -> Key | None:
    """Key of a result of the second process. Raises ValueError for another one."""
    if result is None:
        return None
    if not (isinstance(result, RemoteResult) and result.key):
        raise ValueError("a result of the right-hand contact that was not computed in its process")
    return result.key


@contextmanager
def in_parallel(contact: VehicleContact) -> Iterator[Parallel]:
    """Fork a second process with the contact model in its present state; it is stopped on exit and with this process.

    Raises ValueError where processes cannot be forked.
    """
    context = get_context("fork")
    local, remote = context.Pipe()
    process = context.Process(target=_serve, args=(contact, local, remote), name="right-hand contact", daemon=True)
    with deferred_interrupts():  # until the second process ignores them
        process.start()
        remote.close()
    try:
        with _broken_pipe_errors():
            yield Parallel(contact, local)
    finally:
        local.close()  # ends the process after its present request
        process.join(timeout=1.0)
        if process.is_alive():
            process.terminate()
            process.join()


@contextmanager
def _broken_pipe_errors() -> Iterator[None]:
    """A write to a closed pipe raises an error instead of ending this process, which MPI libraries set."""
    try:
        before = signal.signal(signal.SIGPIPE, signal.SIG_IGN)
    except ValueError:  # not in the main thread
        yield
        return
    try:
        yield
    finally:
        signal.signal(signal.SIGPIPE, before)


def _serve(contact: VehicleContact, parent_end: Connection, pipe: Connection) -> None:
    """Answer requests (number, what, state or warm start, key of a result, released keys) until the pipe is closed."""
    ignore()  # Ctrl-C reaches both processes; the parent decides
    parent_end.close()  # the pipe closes with the parent's copy
    stored: dict[int, ContactResult] = {}
    while True:
        try:
            number, what, state, key, released = pipe.recv()
        except (EOFError, OSError):
            return
        for old in released:
            stored.pop(old, None)
        answer, error = None, None
        try:
            answer = _answered(contact, stored, number, what, state, key)
        except Exception as caught:
            error = caught
        try:
            pipe.send((number, answer, error))
        except OSError:
            return
        except Exception as unsendable:
            pipe.send((number, None, RuntimeError(f"{error or unsendable!r} (from the second process)")))


def _answered(
    contact: VehicleContact,
    stored: dict[int, ContactResult],
    number: int,
    what: str,
    state: Any,
    key: int | None,
) -> Any:
    result = None if key is None else stored[key]
    if what in ("solve", "guess"):
        stored[number] = contact(state, REMOTE, result) if what == "solve" else contact.guess(REMOTE, state)
        return replace(stored[number], patches=(), fields=None, force_tangent=None, warm_start=None)
    assert result is not None
    if what == "warm start":
        return contact.warm_start(REMOTE, result)
    return result.patches if what == "patches" else contact.tangent(state, REMOTE, result)
