"""Ctrl-C in callbacks, while the command is loaded, and repeatedly."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import weakref
from collections.abc import Iterator
from pathlib import Path

import pytest

from wheelrail.support import interrupts
from wheelrail.support.interrupts import check_interrupt, deferred_interrupts

ROOT = Path(__file__).parents[2]


def ctrl_c() -> None:
    os.kill(os.getpid(), signal.SIGINT)


@pytest.fixture(autouse=True)
def handler() -> Iterator[object]:
    """Restores Python's handler of Ctrl-C after each test."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    after = signal.signal(signal.SIGINT, before)
    assert after is signal.default_int_handler
    assert interrupts._waiting is None


def test_ctrl_c_is_deferred_to_the_next_check() -> None:
    done = []
    with deferred_interrupts():
        check_interrupt()
        ctrl_c()
        done.append("went on")
        with pytest.raises(KeyboardInterrupt):
            check_interrupt()
        check_interrupt()  # one Ctrl-C only
    assert done == ["went on"]


def test_ctrl_c_is_raised_at_the_end_of_an_unchecked_block() -> None:
    done = []
    with pytest.raises(KeyboardInterrupt), deferred_interrupts():  # noqa: PT012
        with deferred_interrupts():
            ctrl_c()
        done.append("an inner block is part of it")
    assert done
    with pytest.raises(KeyboardInterrupt):
        ctrl_c()


def test_repeated_ctrl_c_counts_once_then_is_immediate(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [0.0]
    monkeypatch.setattr(interrupts, "monotonic", lambda: now[0])
    done = []
    with pytest.raises(KeyboardInterrupt), deferred_interrupts():  # noqa: PT012
        for now[0] in (0.0, 0.1, 0.9, 1.0):
            ctrl_c()
            done.append(now[0])
    assert done == [0.0, 0.1, 0.9]


def test_ignored_ctrl_c_stays_ignored() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with deferred_interrupts():
        ctrl_c()
        check_interrupt()
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    signal.signal(signal.SIGINT, signal.default_int_handler)


def test_other_threads_are_not_interrupted() -> None:
    done = []

    def work() -> None:
        with deferred_interrupts():
            check_interrupt()
        done.append(1)

    with pytest.raises(KeyboardInterrupt), deferred_interrupts():  # noqa: PT012
        ctrl_c()
        thread = threading.Thread(target=work)
        thread.start()
        thread.join()
    assert done == [1]


def test_ctrl_c_is_not_lost_in_the_callback_of_a_weak_reference() -> None:
    class Thing:
        pass

    thing = Thing()
    weakref.finalize(thing, ctrl_c)
    with pytest.raises(KeyboardInterrupt), deferred_interrupts():  # noqa: PT012
        del thing
        check_interrupt()


LOADING = """
import builtins, os, signal
kept = builtins.__import__
def at(name, *given, **options):
    if name == {name!r}:
        os.kill(os.getpid(), signal.SIGINT)
    return kept(name, *given, **options)
builtins.__import__ = at
"""


WHILE_LOADING = [
    *(
        ("wheelrail.cli.entry", name)
        for name in ("wheelrail.support.interrupts", "wheelrail.cli.main", "typer", "wheelrail.cli.mpi_launcher")
    ),
    # python -m wheelrail.cli loads its own imports before it reaches the entry point
    *(("wheelrail.cli", name) for name in ("wheelrail.support.interrupts", "wheelrail.cli.main")),
    *((start, "wheelrail.scenes.schema.messages") for start in ("wheelrail.cli.entry", "wheelrail.cli")),
]


@pytest.mark.parametrize(("start", "name"), WHILE_LOADING)
def test_ctrl_c_while_the_command_is_loaded(name: str, start: str, tmp_path: Path) -> None:
    (tmp_path / "sitecustomize.py").write_text(LOADING.format(name=name))
    way = ["-m", start] if start == "wheelrail.cli" else ["-c", f"from {start} import main; main()"]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), str(ROOT)])}
    line = [sys.executable, *way, "contact", "none.toml"]
    done = subprocess.run(line, capture_output=True, text=True, env=environment, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted\n")
