"""Ctrl-C where it does no harm.

An exception that comes up while compiled code builds its results leaves these broken, up to a crash, and one in the
callback of a weak reference is lost: so work of that kind is done under `deferred_interrupts`, and looks now and then.
"""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from threading import current_thread, main_thread
from time import monotonic
from types import FrameType

PATIENCE = 1.0  # s: what follows sooner is the same Ctrl-C, which `timeout` sends twice and people hammer


@dataclass
class DeferredInterrupt:
    """Keeps the first Ctrl-C, and passes one on that comes after some patience."""

    before: Callable[[int, FrameType | None], object]
    came: float | None = None

    def __call__(self, number: int, frame: FrameType | None) -> None:
        now = monotonic()
        if self.came is None:
            self.came = now
        elif now - self.came >= PATIENCE:
            self.before(number, frame)


_waiting: DeferredInterrupt | None = None


@contextmanager
def deferred_interrupts() -> Iterator[None]:
    """Ctrl-C waits until `check_interrupt` is called, or the block is done; another one, a second later, does not wait.

    Within another such block this is part of it; outside of the main thread, where no Ctrl-C arrives, and where it is
    ignored, it changes nothing.
    """
    global _waiting
    if _waiting is not None or current_thread() is not main_thread():
        yield
        return
    before = signal.getsignal(signal.SIGINT)
    if not callable(before):
        yield
        return
    mine = _waiting = DeferredInterrupt(before)
    signal.signal(signal.SIGINT, mine)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        _waiting = None
        if mine.came is not None:
            before(signal.SIGINT, None)


def check_interrupt() -> None:
    """Raises KeyboardInterrupt when Ctrl-C waits; to be called where nothing is half done."""
    if _waiting is not None and _waiting.came is not None and current_thread() is main_thread():
        _waiting.came = None
        raise KeyboardInterrupt


def ignore() -> None:
    """Ctrl-C is from now on the business of the process that started this one."""
    global _waiting
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _waiting = None
