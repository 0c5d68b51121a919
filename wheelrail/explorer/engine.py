"""Worker processes behind a page: the latest move wins, and what takes long runs beside."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import Pipe
from typing import TYPE_CHECKING, Any

from wheelrail.explorer.jobs import keep_profiles, prepare
from wheelrail.support.worker_process import WorkerProcess

if TYPE_CHECKING:
    from wheelrail.meshes.profiles.profile import Profile


class Cancelled(Exception):
    """The job was cancelled by the user."""


class Worker:
    """One worker process, started at its first job and replaced after a job was cancelled.

    Parameters:
        on_message: called with the text of each log message.
    """

    def __init__(self, on_message: Callable[[str], None]) -> None:
        self.on_message = on_message
        self.profiles: dict[str, Profile] = {}
        self._process: WorkerProcess | None = None
        self._cancelled = self._busy = False

    def start(self) -> WorkerProcess:
        """The process, which is started unless one runs."""
        if self._process is None:
            ours, theirs = Pipe(duplex=False)
            self._process = WorkerProcess("spawn", prepare, theirs)
            self._process.submit(keep_profiles, dict(self.profiles))
            asyncio.get_running_loop().add_reader(ours.fileno(), self._read, ours)
        return self._process

    def know(self, profiles: dict[str, Profile]) -> None:
        """Give the process profiles that are not in the library."""
        self.profiles |= profiles
        if self._process is not None:
            self._process.submit(keep_profiles, dict(profiles))

    async def run(self, job: Callable[..., Any], *arguments: Any) -> Any:
        """Result of a job. Raises Cancelled, and what the job raises; RuntimeError where its process died."""
        self._cancelled, self._busy = False, True
        process = self.start()
        try:
            return await asyncio.wrap_future(process.submit(job, *arguments))
        except BrokenProcessPool:
            if self._process is process:
                self.stop()
            if self._cancelled:
                raise Cancelled from None
            raise RuntimeError("the process that computes ended, perhaps for want of memory") from None
        finally:
            self._busy = False

    def cancel(self) -> None:
        """End the present job, if there is one, with its process."""
        if self._busy:
            self._cancelled = True
            self.stop()

    def stop(self) -> None:
        """End the process."""
        process, self._process = self._process, None
        if process is not None:
            process.stop()

    def _read(self, messages: Any) -> None:
        try:
            self.on_message(messages.recv())
        except (EOFError, OSError):  # the process has ended
            asyncio.get_running_loop().remove_reader(messages.fileno())
            messages.close()


class Latest:
    """Serves the present state; of several requests meanwhile one remains.

    Parameters:
        serve: computes and shows the present state.
        idle: one step of further work while nothing waits; returns whether there is more.
    """

    def __init__(self, serve: Callable[[], Awaitable[None]], idle: Callable[[], Awaitable[bool]]) -> None:
        self.serve, self.idle = serve, idle
        self._asked = asyncio.Event()
        self._task: asyncio.Task[None] | None = None

    def ask(self) -> None:
        """Ask for the present state, which is read when the one before is done."""
        self._asked.set()
        if self._task is None or self._task.done():
            self._task = asyncio.get_running_loop().create_task(self._run())

    async def quiet(self, seconds: float) -> bool:
        """Whether nothing is asked for within some seconds; a request ends the wait."""
        try:
            await asyncio.wait_for(self._asked.wait(), seconds)
        except TimeoutError:
            return True
        return False

    async def _run(self) -> None:
        more = True
        while more or self._asked.is_set():
            if self._asked.is_set():
                self._asked.clear()
                more = True
                await self.serve()
            else:
                more = await self.idle()
