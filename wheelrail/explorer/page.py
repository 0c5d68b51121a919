"""Page of a contact: controls, views, and the jobs that a move starts."""

from __future__ import annotations

import asyncio
import tempfile
from base64 import b64decode
from collections.abc import Awaitable, Callable
from pathlib import Path
from time import monotonic
from typing import Any

from wheelrail.explorer import jobs
from wheelrail.explorer.engine import Cancelled, Latest, Worker
from wheelrail.explorer.layout import draw_layout
from wheelrail.explorer.subject import CHOSEN, Calls, Subject
from wheelrail.explorer.trace import Trace
from wheelrail.explorer.views import BESIDE, DRAWN, as_text

LARGEST = 10_000_000  # bytes of a dropped file
PAUSE, SHOWN_AFTER = 0.3, 0.4  # s: until a place counts as one of rest; until a text says that something is solved
FIRST_VIEWS = ("closeup", "pressure", "forces")
ON_REQUEST: dict[str, Callable[..., Any]] = {"stress": jobs.stress, "bodies": jobs.bodies}


class Page:
    """The page of one contact; all browsers that show it see the same state.

    Parameters:
        server: of trame.
        subject: contact to explore.
    """

    def __init__(self, server: Any, subject: Subject) -> None:
        self.state, self.server, self.subject = server.state, server, subject
        self.worker, self.beside = Worker(self._message), Worker(self._message)
        self.latest = Latest(self._serve, self._idle)
        self.folder = tempfile.TemporaryDirectory(prefix="wheelrail-explore-")
        self.calls: Calls | None = None
        self._requested: Calls | None = None  # of the stress or the bodies on the page
        self._job = ""  # text of the present job
        self._settled = True  # whether the last digits on the page are those of a solve without an earlier one
        self.trace: Trace | None = None
        self._traced = self._surveyed = ""  # what the trace and the contact geometry on the page are of
        self.worker.profiles |= subject.given
        self.beside.profiles |= subject.given
        names = list(self._start())
        draw_layout(self)
        self.state.change("asked", *names)(self._moved)
        server.controller.on_server_ready.add(lambda **_: self._moved())

    def _start(self) -> dict[str, Any]:
        """Set the first state; returns the variables that a change of asks for a solve."""
        moved = {**self.subject.initial, **{f"view_{view}": view in FIRST_VIEWS for view in (*DRAWN, *BESIDE)}}
        moved |= {"trace_of": "lateral_force" if self.subject.kind == "wheelset" else "patch_longitudinal_force"}
        moved |= {"trace_key": "y" if self.subject.kind == "wheelset" else "creepage.0"}
        self.state.update(
            {
                **moved,
                **{f"choices_{own.key}": list(own.choices or ()) for own in self.subject.controls},
                "panels": "",
                "tracing": "",
                "surveyed": "",
                "stress": "",
                "bodies": [],
                "requested_stale": False,
                "table": {"head": [], "rows": []},
                "values": {},
                "status": "",
                "reason": "",
                "stale": True,
                "busy": "",
                "notice": "",
                "python": "",
                "scene": "",
                "dark": False,
                "asked": 0,  # number of a move, for who waits until the page answers to it
                "answered": -1,
                "seconds": 0.0,
                "trame__title": "wheelrail explore",
            }
        )
        return moved

    def reset(self) -> None:
        """Put all values back to the first ones."""
        self.state.update(self.subject.initial)

    def place(self, key: str, value: float) -> None:
        """Move a slider by a click into a picture.

        Parameters:
            key: of its control.
            value: in its unit.
        """
        control = next(own for own in self.subject.controls if own.key == key)
        steps = round((float(value) - control.low) / control.step)
        kept = min(max(control.low + steps * control.step, control.low), control.high)
        self.state[control.name] = float(f"{kept:.9g}")

    def survey(self, at: dict[str, float]) -> None:
        """Move the wheelset to where the contact geometry was clicked."""
        self.place("y", at["x"])

    def follow(self, at: dict[str, float]) -> None:
        """Move the traced slider to where the trace was clicked."""
        self.place(self.state.trace_key, at["x"])

    def has_view(self, name: str) -> bool:
        """Whether this kind of contact has a view."""
        return self.subject.kind == "wheelset" or name not in ("profiles", "closeup", "geometry")

    def cancel(self) -> None:
        """End the jobs that run."""
        self.worker.cancel()
        self.beside.cancel()

    def drop(self, file: dict[str, Any]) -> None:
        """Read a profile that was dropped on the page.

        Parameters:
            file: name, size, kind ("wheel" or "rail"), and content in base 64.
        """
        name = Path(str(file.get("name", ""))).name or "profile"
        try:
            self._drop(name, str(file["kind"]), b64decode(file.get("content") or ""), int(file["size"]))
            self.state.notice = ""
        except Exception as error:
            self.state.notice = said(error).replace(f"{self.folder.name}/", "")

    def present(self) -> Calls:
        """Arguments of the present values. Raises ValueError for a text that is not a number."""
        return self.subject.calls({name: self.state[name] for name in self.subject.initial})

    def close(self) -> None:
        """End the processes, and remove files."""
        self.worker.stop()
        self.beside.stop()
        self.folder.cleanup()

    def _drop(self, name: str, kind: str, content: bytes, size: int) -> None:
        from wheelrail.api.files import profile

        if max(size, len(content)) > LARGEST:
            raise ValueError(f"{name}: {size / 1e6:.1f} MB: must be at most {LARGEST / 1e6:.0f} MB")
        file = Path(self.folder.name, name)
        file.write_bytes(content)
        try:
            read = profile(file, "wheel" if kind == "wheel" else "rail")
        finally:
            file.unlink()
        before = self.subject.given.keys()
        self.subject, known = self.subject.with_profile(read, name)
        replaced = before - self.subject.given.keys()
        for worker in (self.worker, self.beside):
            worker.know({known: read})
        choices = [own for own in self.state[f"choices_{kind}"] if own not in replaced]
        self.state[f"choices_{kind}"] = [*dict.fromkeys([*choices, known])]
        self.state[f"at_{kind}"] = known

    def _moved(self, **_: Any) -> None:
        """Ask for a solve with the present values."""
        self.latest.ask()

    async def _serve(self, moving: bool = True) -> None:
        """Solve with the present values and show the result, or why there is none.

        Parameters:
            moving: whether further moves are expected, so that a near solution may serve as a start.
        """
        asked, self._settled = self.state.asked, True
        try:
            calls = self.present()
            views = [view for view in DRAWN if self.state[f"view_{view}"]]
            found = await self._timed("solving", self.worker.run(jobs.solve, calls, views, moving))
            shown, self._settled = self._shown(calls, found), found["settled"]
        except Exception as error:
            shown = {"stale": True, "status": "", "reason": said(error)}
        with self.state:
            self.state.update({**shown, "busy": "", **({"answered": asked} if self._settled else {})})

    def _shown(self, calls: Calls, found: dict[str, Any]) -> dict[str, Any]:
        """State after a solve; a failed one leaves the last pictures, greyed."""
        self.calls = calls
        texts = {"python": self.subject.python(calls), "scene": self.subject.scene(calls), "table": found["table"]}
        texts |= {"status": found["status"], "values": found["values"], "seconds": found["seconds"]}
        if not found["ok"]:
            return {**texts, "stale": True, "reason": found["status"], "requested_stale": True}
        texts["requested_stale"] = calls != self._requested
        return {**texts, "stale": False, "reason": "", "panels": found["panels"]}

    async def _idle(self) -> bool:
        """Last digits, or one step of the contact geometry or of the trace; returns whether there is more to do."""
        if not self._settled:
            if await self.latest.quiet(PAUSE):
                await self._serve(moving=False)
            return True
        if self.calls is None or self.state.stale:
            return False
        try:
            if self.state.view_geometry and self._geometry_key not in ("", self._surveyed):
                if not await self.latest.quiet(PAUSE):
                    return True
                self._surveyed = self._geometry_key
                drawn = await self._timed("contact geometry", self.worker.run(jobs.geometry, self.calls))
                with self.state:
                    self.state.update({"surveyed": drawn, "busy": ""})
                return True
            return await self._follow() if self.state.view_trace else False
        except Exception as error:
            with self.state:
                self.state.update({"notice": said(error), "busy": ""})
            return False

    @property
    def _geometry_key(self) -> str:
        calls = self.calls
        return "" if calls is None or calls.kind != "wheelset" else calls.key + repr(calls.solve.get("y"))

    async def _follow(self) -> bool:
        """One more place of the trace."""
        control = next((own for own in self.subject.controls if own.key == self.state.trace_key), None)
        if control is None or self.state[control.name] is None:
            return False
        if control.key in self.subject.alternatives and control.key != self.state[CHOSEN]:
            return False  # a load that is not the given one changes nothing
        values = {name: self.state[name] for name in self.subject.initial}
        now = float(values[control.name])
        key = repr((control.key, self.state.trace_of, {**values, control.name: None}))
        if self.trace is None or key != self._traced:
            self.trace, self._traced = Trace(control, self.state.trace_of, now), key
        trace, place = self.trace, self.trace.place
        if place is not None:
            at = self.subject.calls({**values, control.name: place})
            trace.put(await self.worker.run(jobs.trace, at, trace.quantity))
        if trace.values and (place is None or trace.due):
            with self.state:
                self.state.tracing = as_text([trace.panel(now)])
        return place is not None

    async def request(self, name: str) -> None:
        """Compute the stress, or the deformed bodies in 3D, which takes seconds, beside the moves."""
        if self.calls is None:
            return
        calls = self.calls
        arguments = (calls, self.folder.name) if name == "bodies" else (calls,)
        try:
            job = self.beside.run(ON_REQUEST[name], *arguments)
            found = await self._timed(BESIDE[name], job)
            shown: Any = found if name == "bodies" else found["panels"]
            self._requested = calls
            update: dict[str, Any] = {name: shown, "requested_stale": calls != self.calls}
        except Exception as error:
            update = {"notice": said(error)}
        with self.state:
            self.state.update({**update, "busy": ""})

    async def _timed(self, text: str, job: Awaitable[Any]) -> Any:
        """Result of a job; what it does and for how long is shown once it takes long."""
        self._job = text
        ticking = asyncio.get_running_loop().create_task(self._tick())
        try:
            return await job
        finally:
            ticking.cancel()

    async def _tick(self) -> None:
        start = monotonic()
        await asyncio.sleep(SHOWN_AFTER)
        while True:
            with self.state:
                self.state.busy = f"{self._job}, {monotonic() - start:.0f} s"
            await asyncio.sleep(1.0)

    def _message(self, text: str) -> None:
        self._job = text


def said(error: Exception) -> str:
    """Text of an error for the page, with its type where that is not one of refused arguments."""
    if isinstance(error, Cancelled):
        return "cancelled"
    return str(error) if isinstance(error, ValueError | ImportError) else f"{type(error).__name__}: {error}"
