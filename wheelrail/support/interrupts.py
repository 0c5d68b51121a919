"""Deferred interrupts (Ctrl-C).

An exception in the callback of a weak reference is lost, and one within a step leaves states that do not belong
together. Such work is done under `deferred_interrupts`, with regular calls of `check_interrupt`.
"""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from threading import Thread, current_thread, main_thread
from time import monotonic
from types import FrameType

PATIENCE = 1.0  # s: signals within that time are one Ctrl-C, as `timeout` and users send several


@dataclass
class DeferredInterrupt:
    """Signal handler that defers the first Ctrl-C and forwards one that follows later than PATIENCE."""

    before: Callable[[int, FrameType | None], object]
    time: float | None = None

    def __call__(self, number: int, frame: FrameType | None) -> None:
        now = monotonic()
        if self.time is None:
            self.time = now
        elif now - self.time >= PATIENCE:
            self.before(number, frame)


_waiting: DeferredInterrupt | None = None


@contextmanager
def deferred_interrupts() -> Iterator[None]:
    """Ctrl-C is deferred to the next `check_interrupt` or the end of the block; a second one, a second later, is not.

    No effect within another such block, outside of the main thread, and where Ctrl-C is ignored.
    """
    global _waiting
    if _waiting is not None or current_thread() is not main_thread():
        yield
        return
    before = signal.getsignal(signal.SIGINT)
    if not callable(before):
        yield
        return
    handler = _waiting = DeferredInterrupt(before)
    signal.signal(signal.SIGINT, handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        _waiting = None
        if handler.time is not None:
            before(signal.SIGINT, None)


class Helper(Thread):
    """Thread that works for the main thread, which waits for the end."""


def check_interrupt() -> None:
    """Raise KeyboardInterrupt if a Ctrl-C is deferred; to be called where no state is incomplete.

    In the main thread it is then no longer deferred; of others only a `Helper` is interrupted.
    """
    if _waiting is None or _waiting.time is None:
        return
    if current_thread() is main_thread():
        _waiting.time = None
    elif not isinstance(current_thread(), Helper):
        return
    raise KeyboardInterrupt


def ignore() -> None:
    """Ignore Ctrl-C from now on: it is handled by the parent process."""
    global _waiting
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _waiting = None
