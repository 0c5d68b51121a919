"""Time from a move on the explorer's page to the new picture, in headless Chromium, and the cost of an idle page.

    python -m benchmarks.explore [--quick] [--breakdown] [--json FILE] [--picture FILE]

S1002 on 60E1, 8 x 10 strips and cells, all first views, one wheel and both; needs Chromium. The breakdown lists the
processor time of a move by process, and that of the worker's job by part.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from functools import partial, partialmethod
from pathlib import Path
from statistics import median, quantiles
from time import process_time, sleep
from typing import Any
from unittest.mock import patch

import wheelrail as wr
from benchmarks.common.browser import Tab, browser
from benchmarks.common.machine import machine_description

CONTACT: dict[str, Any] = {"wheel": "S1002", "rail": "60E1", "friction": 0.3, "strips": 8, "cells": 10}
MOVES, IDLE = 200, 10.0  # moves of the slider; s of an idle page
PATH = (0.0, 1.5, 3.0, 4.0, 5.0, 5.4, 5.8, 6.2, 6.6)  # mm, lateral positions of the picture
TARGETS = {"left wheel": 60.0, "both wheels": 100.0}  # ms
# One promise for all moves: the protocol of the browser is not in the times.
MOVE = """
(async (first, count) => {
  const state = window.trame.state, times = [], views = document.querySelector('.wr-views');
  const drawn = () => [...document.querySelectorAll('.wr-pressure canvas')].map(own => own.dataset.drawn).join();
  for (let k = first; k < first + count; k++) {
    const before = drawn(), start = performance.now();
    await new Promise(done => {
      const observer = new MutationObserver(() => { if (drawn() !== before) { observer.disconnect(); done(); } });
      observer.observe(views, { subtree: true, childList: true, attributeFilter: ['data-drawn'] });
      state.set('at_y', Math.round(1e3 * (0.05 * (k % 120) - 3.0 + (k >= 120 ? 0.025 : 0))) / 1e3);
    });
    times.push(performance.now() - start);
    await new Promise(done => setTimeout(done, 50));
  }
  return times;
})
"""
READY = "window.trame.state.get('answered') >= 0 && !window.trame.state.get('stale') && !window.trame.state.get('busy')"


@contextmanager
def opened(what: Any = None, size: tuple[int, int] = (1600, 1000), **options: Any) -> Iterator[tuple[Any, Tab]]:
    """Explorer and a tab of the browser that shows its page.

    Parameters:
        what, options: of `wheelrail.explore`.
        size: of the window, pixels.
    """
    explorer = wr.explore(what, **options)
    try:
        with browser() as running:
            tab = running.tab()
            tab.size(*size)
            tab.open(explorer.url)
            tab.wait("document.querySelectorAll('canvas').length > 0")
            yield explorer, tab
    finally:
        explorer.close()


def choose(tab: Tab, wheels: str) -> None:
    """Show some wheels, at rest."""
    tab.value(f"window.trame.state.set('at_sides', {wheels!r})")
    sleep(1.0)
    tab.wait(READY)


def times(tab: Tab, moves: int) -> list[float]:
    """Times ms from a move to the picture of the pressure."""
    found = []
    for first in range(0, moves, 25):  # shorter than the patience of the protocol
        found += tab.value(f"({MOVE})({first}, {min(25, moves - first)})")
    return found


def processor_seconds(pids: list[int]) -> float:
    """Processor time s of processes."""
    import psutil

    return sum(sum(psutil.Process(pid).cpu_times()[:2]) for pid in pids)


def processes(explorer: Any) -> dict[str, list[int]]:
    """Processes of a page: its server, the workers, the renderer and other parts of the browser."""
    import psutil

    own = {"server": [explorer.pid], "worker": [], "renderer": [], "rest of the browser": []}
    own["worker"] = [child.pid for child in psutil.Process(explorer.pid).children(recursive=True)]
    for child in psutil.Process().children(recursive=True):
        if child.pid not in own["server"] + own["worker"] and "chrom" in child.name():
            own["renderer" if "--type=renderer" in child.cmdline() else "rest of the browser"].append(child.pid)
    return own


def parts(wheels: str, moves: int) -> dict[str, float]:
    """Processor time of the worker's job of a move by part, medians over moves, ms."""
    from wheelrail.explorer import jobs, views
    from wheelrail.explorer.page import FIRST_VIEWS
    from wheelrail.explorer.subject import Subject
    from wheelrail.scenes.contacts import solution, table

    of = {
        "contact": (wr.Wheelset, "solved_sides"),
        "dataset": (solution, "solution_dataset"),
        "pictures": (views, "panels"),
        "their text": (views, "as_text"),
        "table": (table, "table"),
    }
    spent: dict[str, list[float]] = {"all": [], **{part: [] for part in of}}

    def timed(part: str, function: Any, *given: Any, **named: Any) -> Any:
        start = process_time()
        found = function(*given, **named)
        spent[part].append(1e3 * (process_time() - start))
        return found

    subject = Subject.of(wr.Wheelset(**CONTACT))
    with ExitStack() as stack:
        for part, (owner, name) in of.items():
            function = partial(timed, part, getattr(owner, name))
            stack.enter_context(
                patch.object(owner, name, partialmethod(function) if owner is wr.Wheelset else function)
            )
        for k in range(moves + 2):  # the first ones build tables
            calls = subject.calls({"at_sides": wheels, "at_y": round(0.05 * (k % 120) - 3.0, 3)})
            timed("all", jobs.solve, calls, FIRST_VIEWS, True)
    return {part: median(found[2:]) for part, found in spent.items()}


def measured(moves: int = MOVES, idle: float = IDLE) -> dict[str, Any]:
    """Times by wheels, ms, processor time of a move by process, ms, and the share of a processor of an idle page."""
    import psutil

    with opened(wr.Wheelset(**CONTACT)) as (explorer, tab):
        tab.wait(READY)
        found: dict[str, Any] = {"processes": {}}
        for wheels in TARGETS:
            choose(tab, wheels)
            of = processes(explorer)
            before = {name: processor_seconds(pids) for name, pids in of.items()}
            found[wheels] = times(tab, moves)
            spent = {name: 1e3 * (processor_seconds(pids) - before[name]) / moves for name, pids in of.items()}
            found["processes"][wheels] = spent
        sleep(1.0)
        pids = [explorer.pid, *(child.pid for child in psutil.Process(explorer.pid).children(recursive=True))]
        before = processor_seconds(pids)
        sleep(idle)
        return {**found, "idle": (processor_seconds(pids) - before) / idle, "errors": tab.errors}


def picture(file: Path, size: tuple[int, int] = (1180, 700)) -> None:
    """Draw the moving picture of the documentation (.gif): a wheelset that is moved to the flange and back."""
    from PIL import Image

    contact = wr.Wheelset(wheel="S1002", rail="60E1", friction=0.3)
    with opened(contact, size) as (_, tab), tempfile.TemporaryDirectory() as folder:
        tab.wait(READY)
        tab.value("window.trame.state.update({ at_sides: 'left wheel', view_forces: true })")
        frames = []
        for number, y in enumerate([*PATH, *PATH[-2:0:-1]]):
            tab.value(f"window.trame.state.update({{ at_y: {y}, asked: {number + 1} }})")
            tab.wait(f"window.trame.state.get('answered') === {number + 1} && !window.trame.state.get('busy')")
            sleep(0.3)
            still = Path(folder, "still.png")
            tab.picture(still)
            frames.append(Image.open(still).convert("RGB").quantize(128, dither=Image.Dither.NONE))
        frames[0].save(file, save_all=True, append_images=frames[1:], duration=300, loop=0, optimize=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="25 moves")
    parser.add_argument(
        "--breakdown", action="store_true", help="processor time by process and by part of the job, too"
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all times to a file")
    parser.add_argument("--picture", type=Path, metavar="FILE", help="draw the documentation's picture (.gif) instead")
    given = parser.parse_args()
    if given.picture is not None:
        picture(given.picture)
        return
    moves = 25 if given.quick else MOVES
    found = measured(moves)
    if given.breakdown:
        found["parts"] = {wheels: parts(wheels, moves) for wheels in TARGETS}
    print(f"{machine_description()}\n\n| wheels | median, ms | 90 % | worst | target |\n|---|---|---|---|---|")
    for wheels, target in TARGETS.items():
        own = found[wheels]
        print(f"| {wheels} | {median(own):.0f} | {quantiles(own, n=10)[-1]:.0f} | {max(own):.0f} | {target:.0f} |")
    for what in ("processes", "parts") if given.breakdown else ():
        names = list(found[what]["left wheel"])
        print(f"\n| processor time of a move, ms | {' | '.join(names)} |\n|---|{'---|' * len(names)}")
        for wheels, own in found[what].items():
            print(f"| {wheels} | {' | '.join(f'{own[name]:.1f}' for name in names)} |")
    print(f"\nIdle: {100 * found['idle']:.2f} % of a processor. Errors of the page: {found['errors'] or 'none'}.")
    if given.json is not None:
        given.json.write_text(json.dumps(found))


if __name__ == "__main__":
    main()
