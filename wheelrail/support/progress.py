"""What long work says of itself, to whoever listens: nobody, unless told otherwise."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from time import monotonic

PERIOD = 10.0  # s between two words about the same work

_listener: Callable[[str], None] | None = None


@contextmanager
def heard_by(listener: Callable[[str], None]) -> Iterator[None]:
    """The listener hears what is told until the block is done."""
    global _listener
    before, _listener = _listener, listener
    try:
        yield
    finally:
        _listener = before


def tell(text: str) -> None:
    """Say something to the listener, if there is one."""
    if _listener is not None:
        _listener(text)


@dataclass
class Countdown:
    """Tells from time to time how many of a total are done, and how long the rest will take at the same pace.

    The first of them may have had more to do than the rest, and does not count.
    """

    what: str
    total: int
    _start: tuple[int, float] | None = field(init=False, default=None)
    _said: float = field(init=False, default=0.0)

    def __call__(self, done: int) -> None:
        now = monotonic()
        if self._start is None:
            self._start, self._said = (done, now), now
        elif now - self._said >= PERIOD:
            first, start = self._start
            self._said = now
            left = (now - start) / (done - first) * (self.total - done)
            tell(f"{self.what}: {done} of {self.total}, {left:.0f} s left")
