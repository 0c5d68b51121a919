"""Worker processes that judge situations: one that exceeds its time limit, or dies, is replaced."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from pathlib import Path
from time import monotonic

from benchmarks.population.draw import situation
from benchmarks.population.judge import Verdict, judged, model_of

TURN = 100  # situations of one process, whose caches grow
SLOWER = 3.0  # times the limit, of bodies whose compliance is computed
FIRST = 5.0  # times the limit, of the first situation of a process: machine code
BUSY = 10.0  # times the limit, in which a process that shares its processor has spent it
TICKS = os.sysconf("SC_CLK_TCK")  # 1/s


@dataclass(frozen=True)
class Plan:
    """How situations are judged.

    Parameters:
        processes: their number.
        limit: s of processor time of one situation.
        measured: files of measured profiles.
        quick: cheap models only.
    """

    processes: int = 1
    limit: float = 120.0
    measured: tuple[Path, ...] = ()
    quick: bool = False


class _Worker:
    """A process and the situation that it judges."""

    def __init__(self, plan: Plan) -> None:
        context = get_context("spawn")
        self.pipe, other = context.Pipe()
        self.process: SpawnProcess = context.Process(target=_serve, args=(other, plan), daemon=True)
        self.process.start()
        other.close()
        self.plan, self.seed, self.done = plan, -1, 0
        self.limit, self.deadline, self.spent = plan.limit, 0.0, 0.0

    def give(self, seed: int) -> None:
        bodies = situation(seed, self.plan.measured, self.plan.quick).wheelset.get("bodies", "half-space")
        self.limit = self.plan.limit * (1.0 if bodies == "half-space" else SLOWER) * (1.0 if self.done else FIRST)
        self.seed, self.deadline, self.spent = seed, monotonic() + BUSY * self.limit, self.processor_time()
        self.pipe.send(seed)

    @property
    def late(self) -> bool:
        return monotonic() > self.deadline or self.processor_time() - self.spent > self.limit

    def processor_time(self) -> float:
        """Seconds that the process has worked; 0 where the system does not tell."""
        try:
            fields = Path(f"/proc/{self.process.pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
        except OSError:
            return 0.0
        return (int(fields[11]) + int(fields[12])) / TICKS

    def lost(self, reason: str) -> Verdict:
        """Verdict on the situation of a process that is ended."""
        self.process.kill()
        self.process.join()
        own = situation(self.seed, self.plan.measured, self.plan.quick)
        return Verdict(self.seed, str(own), "unexplained failure", reason, (0.0, 0.0), model_of(own))

    def end(self) -> None:
        self.pipe.close()
        self.process.join(5.0)
        self.process.kill()


def _serve(pipe: Connection, plan: Plan) -> None:
    """Judge situations until the pipe closes."""
    logging.disable(logging.WARNING)
    while True:
        try:
            seed = pipe.recv()
        except EOFError:
            return
        pipe.send(judged(situation(seed, plan.measured, plan.quick)))


def verdicts(seeds: Sequence[int], plan: Plan) -> Iterator[Verdict]:
    """Verdicts in the order in which they are found."""
    left = iter(seeds)
    if plan.processes < 2 and plan.limit == float("inf"):
        yield from (judged(situation(seed, plan.measured, plan.quick)) for seed in left)
        return
    workers: list[_Worker] = []

    def started() -> None:
        seed = next(left, None)
        if seed is not None:
            workers.append(_Worker(plan))
            workers[-1].give(seed)

    for _ in range(plan.processes):
        started()
    while workers:
        ready = wait([worker.pipe for worker in workers], timeout=min(1.0, plan.limit))
        for worker in [*workers]:
            if worker.pipe in ready:
                try:
                    verdict = worker.pipe.recv()
                except EOFError:
                    verdict = worker.lost("the process died")
                else:
                    worker.done += 1
                    seed = next(left, None) if worker.done < TURN else None
                    if seed is not None:
                        worker.give(seed)
                        yield verdict
                        continue
                    worker.end()
            elif worker.late:
                verdict = worker.lost(f"no result in {worker.limit:g} s")
            else:
                continue
            workers.remove(worker)
            started()
            yield verdict
