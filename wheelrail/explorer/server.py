"""Server of a page: on this machine only, with a token, without files."""

from __future__ import annotations

import asyncio
import os
import secrets
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wheelrail.explorer.subject import Subject

HOST = "127.0.0.1"
MESSAGE = 14_000_000  # bytes of one message from a browser, a dropped file of 10 MB in base 64 included
BROWSER = Path(__file__).parent / "browser"
MODULE = {
    "serve": {"wheelrail_browser": str(BROWSER)},
    "scripts": ["wheelrail_browser/drawing.js", "wheelrail_browser/page.js"],
    "vue_use": ["wheelrail_explorer", "wheelrail_page"],
}


class Served:
    """A page that is served.

    Parameters:
        server: of trame, running.
        page: of a contact or of a run.
        token: without which no browser is answered.
    """

    def __init__(self, server: Any, page: Any, token: str) -> None:
        self.server, self.page = server, page
        self.url = f"http://{HOST}:{server.port}/index.html?secret={token}"
        self._loop = asyncio.get_running_loop()

    def calls(self) -> Any:
        """Arguments of the contact on the page and profiles by name, asked from another thread; None for a run.

        Raises ValueError for values of the page that are no numbers.
        """
        return asyncio.run_coroutine_threadsafe(self._calls(), self._loop).result()

    async def _calls(self) -> Any:
        page = self.page
        return (page.present(), dict(page.subject.given)) if hasattr(page, "present") else None

    def stop(self) -> None:
        """End the server, from any thread."""
        asyncio.run_coroutine_threadsafe(self.server.stop(), self._loop)


def check_packages() -> None:
    """Raises ImportError in one line where the packages of the extra "view" are missing."""
    missing = [name for name in ("trame", "trame_vuetify") if find_spec(name) is None]
    if missing:
        raise ImportError(f'explore needs {" and ".join(missing)}: pip install "wheelrail[view]"')


def serve(what: Subject | Path, port: int, ready: Callable[[Served], None]) -> None:
    """Serve the page of a contact, or of the results of a run, until Ctrl-C or `Served.stop`.

    Parameters:
        what: contact, or file of a run.
        port: to listen on; 0: a free one.
        ready: called when the page can be opened.

    Raises OSError for a port that is taken, ImportError, SceneError for a file without a run.
    """
    check_packages()
    from trame_server.core import Server

    server = Server("wheelrail")
    token = secrets.token_urlsafe(24)
    server.client_type = "vue3"
    server.enable_module(MODULE)
    server.options["ws_max_msg_size"] = MESSAGE
    server.cli.set_defaults(host=HOST, authKey=token, timeout=0)
    if isinstance(what, Path):
        from wheelrail.explorer.player import Player

        page: Any = Player(server, what)
    else:
        from wheelrail.explorer.page import Page

        page = Page(server, what)

    def begin(**_: Any) -> None:
        asyncio.get_running_loop().set_exception_handler(_report)
        ready(Served(server, page, token))

    server.controller.on_server_ready.add(begin)
    try:
        with _alone():
            server.start(port=port, open_browser=False, show_connection_info=False, disable_logging=True, host=HOST)
    finally:
        page.close()


def _report(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
    """Report an exception of a task, but for that of a message to a page that was closed."""
    if not isinstance(context.get("exception"), ConnectionError):
        loop.default_exception_handler(context)


@contextmanager
def _alone() -> Iterator[None]:
    """Keep the arguments of this process from trame, and trame's greeting from standard output."""
    argv, sys.argv = sys.argv, sys.argv[:1]
    os.environ["WSLINK_READY_MSG"] = ""
    os.environ.pop("TRAME_ARGS", None)
    try:
        yield
    finally:
        sys.argv = argv
