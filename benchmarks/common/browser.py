"""Headless Chromium, driven by its developer protocol: pages are opened, looked at and measured."""

from __future__ import annotations

import asyncio
import base64
import json
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic, sleep
from typing import Any

NAMES = ("chromium", "chromium-browser", "google-chrome")
OPTIONS = ("--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--remote-debugging-port=0")
OPTIONS += ("--disable-extensions", "--disable-background-networking", "--disable-component-update")
WAIT = 60.0  # s, for a condition


class Tab:
    """One page of the browser.

    Parameters:
        address: of its developer protocol.
    """

    def __init__(self, address: str) -> None:
        import aiohttp

        self._loop = asyncio.new_event_loop()
        self._count = 0
        self.errors: list[str] = []  # of scripts, and messages of the console's level "error"
        self._session = aiohttp.ClientSession(loop=self._loop)
        self._socket = self._do(self._session.ws_connect(address, max_msg_size=0))
        for domain in ("Page", "Runtime"):
            self.call(f"{domain}.enable")

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Result of a method of the protocol; raises RuntimeError with its error."""
        self._count += 1
        return self._do(self._call(self._count, method, parameters))

    def open(self, address: str) -> None:
        """Load a page."""
        self.call("Page.navigate", url=address)

    def size(self, width: int, height: int, *, dark: bool = False) -> None:
        """Set the size of the window, pixels, and the preferred colours."""
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.call("Emulation.setEmulatedMedia", features=[scheme])

    def value(self, script: str) -> Any:
        """Value of an expression, of a promise the promised one; raises RuntimeError for an exception of the page."""
        found = self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in found:
            raise RuntimeError(json.dumps(found["exceptionDetails"])[:2000])
        return found["result"].get("value")

    def wait(self, script: str, seconds: float = WAIT) -> Any:
        """Value of an expression as soon as that is true; raises TimeoutError."""
        end = monotonic() + seconds
        while not (found := self.value(f"(() => {{ try {{ return {script} }} catch {{ return null }} }})()")):
            if monotonic() > end:
                raise TimeoutError(f"{script}: not true within {seconds:g} s; errors of the page: {self.errors}")
            sleep(0.02)
        return found

    def picture(self, file: Path) -> None:
        """Save a picture of the window (.png)."""
        file.write_bytes(base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"]))

    def close(self) -> None:
        """Close the connection; the page ends with the browser."""
        self._do(self._session.close())
        self._loop.close()

    async def _call(self, number: int, method: str, parameters: dict[str, Any]) -> dict[str, Any]:
        await self._socket.send_json({"id": number, "method": method, "params": parameters})
        while True:
            message = await self._socket.receive_json(timeout=WAIT)
            if message.get("method") == "Runtime.exceptionThrown":
                self.errors.append(json.dumps(message["params"]["exceptionDetails"])[:500])
            elif message.get("method") == "Runtime.consoleAPICalled" and message["params"]["type"] == "error":
                self.errors.append(json.dumps(message["params"]["args"])[:500])
            elif message.get("id") == number:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']['message']}")
                return dict(message["result"])

    def _do(self, awaitable: Any) -> Any:
        return self._loop.run_until_complete(awaitable)


class Browser:
    """A running browser.

    Parameters:
        address: of its developer protocol, over HTTP.
    """

    def __init__(self, address: str) -> None:
        self.address = address
        self.tabs: list[Tab] = []

    def tab(self) -> Tab:
        """A new page."""
        from urllib.request import Request, urlopen

        with urlopen(Request(f"{self.address}/json/new?about:blank", method="PUT")) as answer:
            self.tabs.append(Tab(json.load(answer)["webSocketDebuggerUrl"]))
        return self.tabs[-1]

    def close(self, tab: Tab) -> None:
        """End a page, which would follow its server's state for as long as the browser runs."""
        tab.call("Page.close")
        tab.close()
        self.tabs.remove(tab)


def chromium() -> str:
    """Path of the browser; raises FileNotFoundError."""
    found = next(filter(None, map(shutil.which, NAMES)), None)
    if found is None:
        raise FileNotFoundError("Chromium is missing: apt-get install chromium (make test does), or google-chrome")
    return found


@contextmanager
def browser() -> Iterator[Browser]:
    """A headless browser with an empty profile, ended with the block."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        command = [chromium(), *OPTIONS, f"--user-data-dir={folder}", "about:blank"]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            port, end = Path(folder, "DevToolsActivePort"), monotonic() + WAIT
            while not (port.is_file() and port.read_text().strip()):
                if monotonic() > end or process.poll() is not None:
                    raise TimeoutError(f"{command[0]} did not start")
                sleep(0.05)
            running = Browser(f"http://127.0.0.1:{port.read_text().splitlines()[0]}")
            try:
                yield running
            finally:
                for tab in running.tabs:
                    tab.close()
        finally:
            process.terminate()
            process.wait(10)
