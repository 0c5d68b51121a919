"""Contacts of several wheels at the same time, in threads: the core solves without the interpreter's lock."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from wheelrail.contact.results.vehicle_contact import R, VehicleContact, WrappedContact
from wheelrail.support.threads import Threads


class Parallel(WrappedContact):
    """A contact model whose wheels are solved by several threads.

    Parameters:
        contact: the wrapped model.
        threads: that solve, and evaluate tangents and patches.

    Results are those of one thread to the last bit. The first evaluation is that of one thread: it makes tables that
    all use.
    """

    def __init__(self, contact: VehicleContact, threads: Threads) -> None:
        super().__init__(contact)
        self.threads, self.begun = threads, False

    def each(self, function: Callable[..., R], tasks: Sequence[tuple[Any, ...]]) -> list[R]:
        if self.begun and len(tasks) > 1 and self.contact.concurrent and not self.contact.together:
            return self.threads.each(function, tasks)
        values = list(self.contact.each(function, tasks))
        self.begun = True
        return values


@contextmanager
def in_threads(contact: VehicleContact, count: int) -> Iterator[VehicleContact]:
    """The contact model, solved by so many threads until the end of the block."""
    if count == 1:
        yield contact
        return
    threads = Threads(count - 1)
    try:
        yield Parallel(contact, threads)
    finally:
        threads.close()
