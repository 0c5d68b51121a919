"""Threads that take tasks from a list together with their caller."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable
from functools import cache
from queue import SimpleQueue
from typing import Any, TypeVar

from wheelrail.support.interrupts import Helper, check_interrupt

R = TypeVar("R")


class Threads:
    """Threads that take tasks from a list together with their caller.

    Parameters:
        count: of threads beside the caller.

    They are woken once for all tasks, not for each as those of `concurrent.futures`: it matters for tasks of 1 ms.
    """

    def __init__(self, count: int) -> None:
        self._orders: SimpleQueue[Callable[[], None] | None] = SimpleQueue()
        self._threads = [Helper(target=self._serve, name=f"helper {k}", daemon=True) for k in range(1, count + 1)]
        for thread in self._threads:
            thread.start()

    def each(self, function: Callable[..., R], tasks: Iterable[tuple[Any, ...]]) -> list[R]:
        """Values of a function of the arguments of each task, in their order.

        Raises the first error of a task; others are not begun after it.
        """
        left, done = deque(enumerate(tasks)), SimpleQueue[int]()
        count = len(left)
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

        for _ in range(min(len(self._threads), count - 1)):
            self._orders.put(work)
        work()
        for _ in range(count):
            done.get()
        if errors:
            check_interrupt()  # raised here if it has ended a task
            raise errors[0]
        return [values[number] for number in range(count)]

    def close(self) -> None:
        """End the threads after their present tasks."""
        for _ in self._threads:
            self._orders.put(None)
        for thread in self._threads:
            thread.join()

    def _serve(self) -> None:
        while (work := self._orders.get()) is not None:
            work()


@cache
def one_more() -> Threads:
    """One thread beside the caller, until the process ends; none where the process has a single processor."""
    return Threads(min(len(os.sched_getaffinity(0)), 2) - 1)
