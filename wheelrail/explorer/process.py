"""Process of a page that another Python process started: it ends when its input does."""

from __future__ import annotations

import os
import pickle
import struct
import sys
import threading
from typing import IO, Any

SIZE = struct.Struct("<Q")


def send(stream: IO[bytes], what: Any) -> None:
    """Write an object; raises OSError where nobody reads."""
    data = pickle.dumps(what)
    stream.write(SIZE.pack(len(data)) + data)
    stream.flush()


def receive(stream: IO[bytes]) -> Any:
    """The next object; raises EOFError at the end."""
    head = stream.read(SIZE.size)
    if len(head) < SIZE.size:
        raise EOFError
    return pickle.loads(stream.read(SIZE.unpack(head)[0]))


def main() -> None:
    """Serve the contact or run that comes first on the input, and answer questions, until the input ends."""
    output = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # against prints of libraries
    what, port = receive(sys.stdin.buffer)
    from wheelrail.explorer.server import Served, serve

    def answer(served: Served) -> None:
        try:
            while receive(sys.stdin.buffer) == "calls":
                try:
                    send(output, ("calls", served.calls()))
                except ValueError as error:
                    send(output, ("error", error))
        except EOFError:
            served.stop()

    def ready(served: Served) -> None:
        send(output, ("url", served.url))
        threading.Thread(target=answer, args=(served,), daemon=True).start()

    try:
        serve(what, port, ready)
    except (OSError, ImportError, ValueError) as error:
        send(output, ("error", type(error)(*error.args)))


if __name__ == "__main__":
    main()
