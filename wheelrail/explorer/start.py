"""Start of an explorer from Python: a process of its own serves the page, and ends with the one that started it."""

from __future__ import annotations

import pickle
import subprocess
import sys
import weakref
from contextlib import suppress
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wheelrail.explorer.process import receive, send
from wheelrail.scenes.schema.errors import SceneError

if TYPE_CHECKING:
    from wheelrail.api.solution import Solution


class Explorer:
    """Page of a contact or of a run, shown in the output of a notebook's cell and under `url` in any browser.

    Parameters:
        what: Subject, or file of a run.
        port: to listen on; 0: a free one.
        height: of the page in a notebook, pixels.
    """

    def __init__(self, what: Any, port: int, height: int) -> None:
        self.height = height
        command = [sys.executable, "-m", "wheelrail.explorer.process"]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self._end = weakref.finalize(self, _end, self._process)  # also when Python ends
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._to, self._from = self._process.stdin, self._process.stdout
        kind, answer = self._asked((what, port))
        if kind != "url":
            self.close()
            raise answer
        self.url: str = answer

    def solution(self) -> Solution:
        """Solution of the contact now on the page, solved anew in this process.

        Raises ValueError for values that are not allowed and for a run, RuntimeError where the page has ended.
        """
        from wheelrail.explorer.subject import CLASSES, with_profiles

        kind, found = self._asked("calls")
        if kind != "calls":
            raise found
        if found is None:
            raise ValueError("explore: the page shows a run, which has no contact to solve")
        own, profiles = found
        return CLASSES[own.kind](**with_profiles(own.contact, profiles)).solve(**own.solve)

    @property
    def pid(self) -> int:
        """Number of the process that serves the page."""
        return self._process.pid

    def close(self) -> None:
        """End the page and its processes."""
        self._end()

    def _asked(self, question: Any) -> tuple[str, Any]:
        try:
            send(self._to, question)
            return receive(self._from)  # type: ignore[no-any-return]
        except (EOFError, OSError, ValueError):  # the last one of a stream that was closed
            return "ended", RuntimeError("explore: the process of the page has ended")

    def _repr_html_(self) -> str:
        return (
            f'<iframe src="{escape(self.url)}" style="width:100%;height:{self.height}px;border:0"></iframe>'
            f'<a href="{escape(self.url)}" target="_blank">in a tab of its own</a>'
        )

    def __repr__(self) -> str:
        return f"Explorer at {self.url}"


def explore(what: Any = None, rail: Any = None, *, port: int = 0, height: int = 900) -> Explorer:
    """Page on which a contact is moved by sliders, or a run is played; in Jupyter it is shown below the cell.

    Parameters:
        what: `wheelrail.Hertz`, `wheelrail.Wheelset`, scene file, results of a run (run.nc or its folder), or a wheel
            profile; by default a wheelset with standard profiles.
        rail: rail profile, for a wheel profile.
        port: to listen on, on this machine only; a free one by default.
        height: of the page in a notebook, pixels.

    Raises SceneError naming what is allowed, ImportError where the packages of the extra "view" are missing.
    """
    if not isinstance(port, int) or not 0 <= port <= 65535:
        raise SceneError(f"explore: port = {port!r}: must be a whole number from 0 (a free one) to 65535")
    return Explorer(subject(what, rail), port, height)


def subject(what: Any, rail: Any = None) -> Any:
    """Subject of a page: a contact, or the file of a run. Raises SceneError."""
    from wheelrail.api.hertz import Hertz
    from wheelrail.api.wheelset import Wheelset
    from wheelrail.explorer.server import check_packages
    from wheelrail.explorer.subject import Subject
    from wheelrail.meshes.profiles.profile import Profile
    from wheelrail.scenes.schema.scene import RunScene, load_scene

    check_packages()
    if rail is not None:
        what = Wheelset(wheel=what, rail=rail)
    elif isinstance(what, Profile):
        what = Wheelset(wheel=what) if what.kind == "wheel" else Wheelset(rail=what)
    if what is None or isinstance(what, Wheelset | Hertz):
        found = Subject.of(Wheelset() if what is None else what)
        try:
            pickle.dumps(found)
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            raise SceneError(f"explore: friction: a law of a notebook's own must be in a module ({error})") from None
        return found
    if not isinstance(what, str | Path):
        raise SceneError(f"explore: {what!r}: must be a Hertz, a Wheelset, a profile, a scene or results of a run")
    file = Path(what)
    if file.is_dir() or file.suffix == ".nc":
        return file / "run.nc" if file.is_dir() else file
    from wheelrail.api.files import load

    if isinstance(load_scene(file), RunScene):
        raise SceneError(f'{file}: kind = "run": explore its results, run.nc; wheelrail run makes them')
    return Subject.of(load(file))


def _end(process: subprocess.Popen[bytes]) -> None:
    """End a process by closing its input."""
    for stream in (process.stdin, process.stdout):
        if stream is not None:
            with suppress(OSError):
                stream.close()
    try:
        process.wait(5)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
