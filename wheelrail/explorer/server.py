"""Server of a page: on this machine only, with a token, without files."""

from __future__ import annotations

import os
import secrets
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wheelrail.explorer.subject import Subject

HOST = "127.0.0.1"
BROWSER = Path(__file__).parent / "browser"
MODULE = {
    "serve": {"wheelrail_browser": str(BROWSER)},
    "scripts": ["wheelrail_browser/drawing.js", "wheelrail_browser/page.js"],
    "vue_use": ["wheelrail_explorer", "wheelrail_page"],
}
MISSING = 'explore needs the packages of the extra "view": pip install "wheelrail[view]"'


def serve(subject: Subject, port: int = 0, ready: Callable[[str], None] = print) -> None:
    """Serve the page of a subject until Ctrl-C, or until `stop_with` says so.

    Parameters:
        subject: contact to explore.
        port: to listen on; a free one by default.
        ready: called with the address, which has the token.

    Raises ImportError in one line where the packages are missing, OSError for a port that is taken.
    """
    try:
        from trame_server.core import Server

        from wheelrail.explorer.page import Page
    except ImportError as error:
        raise ImportError(f"{MISSING} ({error.name} is missing)") from None
    server = Server("wheelrail")
    token = secrets.token_urlsafe(24)
    server.client_type = "vue3"
    server.enable_module(MODULE)
    server.cli.set_defaults(host=HOST, authKey=token, timeout=0)
    page = Page(server, subject)
    server.controller.on_server_ready.add(
        lambda **_: ready(f"http://{HOST}:{server.port}/index.html?secret={token}")
    )
    try:
        with _alone():
            server.start(
                port=port, open_browser=False, show_connection_info=False, disable_logging=True, host=HOST, timeout=0
            )
    finally:
        page.close()


@contextmanager
def _alone() -> Iterator[None]:
    """Keep the arguments of this process from trame, which would read them as its own, and its greeting from stdout."""
    argv, sys.argv = sys.argv, sys.argv[:1]
    os.environ["WSLINK_READY_MSG"] = ""
    os.environ.pop("TRAME_ARGS", None)
    try:
        yield
    finally:
        sys.argv = argv


