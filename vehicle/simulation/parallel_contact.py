"""Contacts of several wheels at the same time, in threads: the core solves without the interpreter's lock."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from queue import SimpleQueue
from typing import Any

from wheelrail.contact.results.vehicle_contact import R, VehicleContact, WrappedContact
from wheelrail.support.interrupts import Helper, check_interrupt


class Threads:
    """Threads that take tasks from a list together with their caller.

    Parameters:
        count: of threads beside the caller.

    They are woken once for all tasks, not for each as those of `concurrent.futures`: it matters for tasks of 1 ms.
    """

    def __init__(self, count: int) -> None:
        self._orders: SimpleQueue[Callable[[], None] | None] = SimpleQueue()
        self._threads = [Helper(target=self._serve, name=f"contacts {k}", daemon=True) for k in range(1, count + 1)]
        for thread in self._threads:
            thread.start()

    def each(self, function: Callable[..., R], tasks: Sequence[tuple[Any, ...]]) -> list[R]:
        """Values of a function of the arguments of each task, in their order.

        Raises the first error of a task; others are not begun after it.
        """
        left, done = deque(enumerate(tasks)), SimpleQueue[int]()
        values: dict[int, R] = {}
        errors: list[BaseException] = []

        def work() -> None:
            while left:
                try:
                    number, task = left.popleft()
                except IndexError:  # another thread was quicker
                    return
                try:
                    if not errors:
                        values[number] = function(*task)
                except BaseException as error:
                    errors.append(error)
                done.put(number)

        for _ in range(min(len(self._threads), len(tasks) - 1)):
            self._orders.put(work)
        work()
        for _ in tasks:
            done.get()
        if errors:
            check_interrupt()  # raised here if it has ended a task
            raise errors[0]
        return [values[number] for number in range(len(tasks))]

    def close(self) -> None:
        """End the threads after their present tasks."""
        for _ in self._threads:
            self._orders.put(None)
        for thread in self._threads:
            thread.join()

    def _serve(self) -> None:
        while (work := self._orders.get()) is not None:
            work()


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
