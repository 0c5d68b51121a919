"""The explorer's page in headless Chromium: moved, dropped on, opened twice, closed in the middle, ended."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from http.client import HTTPConnection
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import numpy as np
import psutil
import pytest

import wheelrail as wr
from benchmarks.common.browser import Browser, Tab, browser
from wheelrail.support.arrays import Array

STATE = "const get = name => window.trame.state.get(name); return "
FORCES = ("longitudinal_force", "lateral_force", "vertical_force")


def wait(tab: Tab, condition: str, seconds: float = 60.0) -> Any:
    return tab.wait(f"(() => {{ {STATE} {condition} }})()", seconds)


def get(tab: Tab, name: str) -> Any:
    return tab.value(f"(() => {{ {STATE} get({name!r}) }})()")


def move(tab: Tab, **values: Any) -> None:
    """Set values of the page and wait until they are solved."""
    number = get(tab, "asked") + 1
    tab.value(f"window.trame.state.update({json.dumps({**values, 'asked': number})})")
    wait(tab, f"get('answered') === {number} && !get('busy')")


@pytest.fixture(scope="module")
def chromium() -> Iterator[Browser]:
    with browser() as running:
        yield running


@pytest.fixture(scope="module")
def contact() -> wr.Wheelset:
    return wr.Wheelset(friction=0.3, bodies="half-space", strips=6, cells=8, speed=20.0)


@pytest.fixture(scope="module")
def page(contact: wr.Wheelset) -> Iterator[Any]:
    explorer = wr.explore(contact)
    yield explorer
    explorer.close()


@pytest.fixture(scope="module")
def opened(chromium: Browser, page: Any) -> Iterator[Tab]:
    own = chromium.tab()
    own.size(1200, 900)
    own.open(page.url)
    own.wait("document.querySelectorAll('.wr-pressure canvas').length > 0")
    yield own
    chromium.close(own)


@pytest.fixture
def tab(opened: Tab) -> Iterator[Tab]:
    """The page as at its start; loading it takes a second of the processor."""
    opened.value("document.querySelector('.wr-reset').click()")
    move(opened)
    yield opened
    assert opened.errors == []


def test_numbers_of_the_page_are_those_of_the_api(tab: Tab, page: Any, contact: wr.Wheelset) -> None:
    move(tab, at_y=-6.35, at_yaw=1.5, at_wheel_load=80.0)
    found = contact.solve(y=-6.35e-3, yaw=1.5e-3, wheel_load=80e3).data
    shown = get(tab, "values")
    assert [shown[name] for name in FORCES] == [found[name].values.tolist() for name in FORCES]
    assert page.solution().data["pressure"].values.tolist() == found["pressure"].values.tolist()
    drawn = [panel for panel in json.loads(get(tab, "panels")) if panel["view"] == "pressure"]
    assert len(drawn) == int(found["patches"].sum())
    space: dict[str, Any] = {}
    exec(get(tab, "python"), space)
    assert space["solution"].data["traction"].values.tolist() == found["traction"].values.tolist()


def test_sliders_are_moved_by_keys(tab: Tab) -> None:
    tab.value("document.querySelector('.v-slider-thumb').focus()")
    for kind in ("keyDown", "keyUp"):
        tab.call("Input.dispatchKeyEvent", type=kind, key="ArrowRight", code="ArrowRight", windowsVirtualKeyCode=39)
    wait(tab, "get('at_y') === 0.05")
    tab.value("document.activeElement.blur()")
    for kind in ("keyDown", "keyUp"):
        tab.call("Input.dispatchKeyEvent", type=kind, key="r", code="KeyR", text="r" if kind == "keyDown" else "")
    wait(tab, "get('at_y') === 0")


def test_failed_solves_leave_the_last_picture_greyed_with_the_reason(tab: Tab) -> None:
    before = get(tab, "panels")
    move(tab, at_friction=-1.0)
    assert "friction = -1.0: must be" in get(tab, "reason")
    assert "friction = -1.0" in tab.value("document.querySelector('.wr-status').innerText")
    assert get(tab, "panels") == before
    assert get(tab, "stale")
    assert "grayscale" in tab.value("document.querySelector('.wr-pressure canvas').style.filter")
    move(tab, at_friction=0.25)
    assert not get(tab, "stale")


def test_emptied_fields_are_refused(tab: Tab) -> None:
    tab.value(
        """(() => { const field = document.querySelector('.wr-number input'); field.value = '';
        field.dispatchEvent(new Event('change', { bubbles: true })); })()"""
    )
    wait(tab, "get('reason').includes(\"to the left = '': must be a number\")")
    move(tab, at_y=0.0)
    assert not get(tab, "stale")


def test_unusual_values_are_said(tab: Tab) -> None:
    move(tab, at_friction=0.95)
    assert "friction = 0.95: unusual" in get(tab, "status")


def test_views_that_are_off_cost_nothing(tab: Tab) -> None:
    move(tab, view_pressure=False, view_closeup=False)
    assert {panel["view"] for panel in json.loads(get(tab, "panels"))} == {"forces"}
    move(tab, view_pressure=True, view_closeup=True)


def test_geometry_and_traces_follow(tab: Tab, contact: wr.Wheelset) -> None:
    move(tab, view_geometry=True, at_y=2.0)
    wait(tab, "get('surveyed')")
    difference = points(json.loads(get(tab, "surveyed"))[0]["drawing"])
    expected = wr.contact_geometry(y=[2e-3])["rolling_radius_difference"].item()
    assert np.interp(2.0, *difference.T) == pytest.approx(1e3 * expected, rel=1e-3)
    move(tab, view_geometry=False, view_trace=True, trace_of="lateral_force", trace_key="yaw")
    wait(tab, "JSON.parse(get('tracing'))[0]?.drawing.layers[0].points.filter(at => at !== null).length === 41", 120.0)
    at, force = points(json.loads(get(tab, "tracing"))[0]["drawing"]).T
    found = contact.solve(y=2e-3, yaw=1e-3 * at[24]).data["lateral_force"].values[0]
    assert force[24] == pytest.approx(1e-3 * found, abs=5e-4 * np.ptp(force))
    move(tab, view_trace=False)


def points(drawing: dict[str, Any]) -> Array:
    """Points (n, 2) of the first layer of a drawing on the page, in the units of its axes."""
    whole = [at for at in drawing["layers"][0]["points"] if at is not None]
    return np.array(whole) * drawing["unit"] + [drawing["x_limits"][0], drawing["y_limits"][0]]


def drop(tab: Tab, kind: str, name: str, text: str) -> None:
    """Drop a file with a text on the target of a profile."""
    tab.value(
        f"""(async () => {{
          const data = new DataTransfer(); data.items.add(new File([{json.dumps(text)}], {json.dumps(name)}));
          window.dispatchEvent(new DragEvent("dragover", {{ dataTransfer: data, bubbles: true }}));
          await new Promise(done => setTimeout(done, 200));
          document.querySelector(".wr-target-{kind}").dispatchEvent(
            new DragEvent("drop", {{ dataTransfer: data, bubbles: true, cancelable: true }}));
        }})()"""
    )


def test_dropped_profiles(tab: Tab, tmp_path: Path) -> None:
    profile = wr.profile("S1002")
    points = 1e3 * profile.point(np.linspace(*profile.span, 400)) if hasattr(profile, "span") else None
    points = 1e3 * profile.point(profile.samples(0.2e-3)) if points is None else points
    text = "".join(f"{y:.6f} {z:.6f}\n" for y, z in points)
    drop(tab, "wheel", "turned.txt", text)
    wait(tab, "get('at_wheel').startsWith('turned')")
    move(tab)
    assert get(tab, "notice") == ""
    (tmp_path / "turned.txt").write_text(text)
    read = wr.profile(tmp_path / "turned.txt", "wheel")
    found = wr.Wheelset(wheel=read, friction=0.3, bodies="half-space", strips=6, cells=8, speed=20.0).solve().data
    assert get(tab, "values")["lateral_force"] == found["lateral_force"].values.tolist()
    assert "wr.profile('turned.txt', 'wheel')" in get(tab, "python")
    drop(tab, "rail", "bad.txt", "nothing to see\n1 2\n")
    assert "bad.txt" in wait(tab, "get('notice')")
    assert "/tmp" not in get(tab, "notice")
    assert get(tab, "at_rail") == "UIC60"
    drop(tab, "rail", "many.txt", "0.000001 0\n" * 200_000)
    wait(tab, "get('notice').includes('many.txt')", 20.0)
    drop(tab, "rail", "large.txt", "0 0\n" * 2_600_000)
    wait(tab, "get('notice').includes('10.4 MB: must be at most 10 MB')")


def test_two_pages_show_the_same_contact_until_one_is_closed_during_a_solve(
    tab: Tab, chromium: Browser, page: Any
) -> None:
    other = chromium.tab()
    other.open(page.url)
    other.wait("document.querySelectorAll('.wr-pressure canvas').length > 0")
    move(other, at_y=3.0)
    wait(tab, f"get('answered') === {get(other, 'answered')}")
    assert get(tab, "at_y") == 3.0
    assert get(tab, "values") == get(other, "values")
    other.value("window.trame.state.update({ at_y: 4.0, at_strips: 24, at_cells: 24 })")
    wait(tab, "get('at_strips') === 24 && get('busy')")
    chromium.close(other)
    move(tab)  # a page that was closed stops nobody
    assert not get(tab, "stale")


def test_what_takes_long_is_shown_and_cancelled(tab: Tab) -> None:
    tab.value("window.trame.state.update({ at_bodies: 'bodies of the profiles', at_radius: 417.0 })")
    wait(tab, "get('busy').includes('s')")
    sleep(0.5)
    tab.value("document.querySelector('.wr-cancel').click()")
    wait(tab, "get('reason') === 'cancelled'")
    assert get(tab, "stale")
    move(tab, at_bodies="half-spaces", at_radius=460.0)
    assert not get(tab, "stale")


def test_stress_of_a_hertz_pair_on_request(chromium: Browser) -> None:
    # a small patch: three times as few lines of the section as one of 6 mm
    pair = wr.Hertz((0.1, 0.1), (float("inf"), float("inf")), load=1e3, friction=0.0, strips=12, cells=14)
    explorer = wr.explore(pair)
    try:
        own = chromium.tab()
        own.open(explorer.url)
        wait(own, "get('answered') === 0 && !get('busy')")
        move(own, view_stress=True)
        own.value("document.querySelector('.wr-request-stress').click()")
        wait(own, "get('stress') && !get('busy')", 120.0)
        (panel,) = json.loads(get(own, "stress"))
        stress, depth = points(panel["drawing"]).T
        exact = pair.closed_form(load=1e3)
        assert stress.max() == pytest.approx(0.62e-6 * exact.peak, rel=0.02)  # of a circle, nu = 0.3
        assert -depth[stress.argmax()] == pytest.approx(0.48e3 * exact.semi_axes[0], rel=0.25)  # among 24 depths
        assert not get(own, "requested_stale")
        move(own, at_load=12.0)
        assert get(own, "requested_stale")
        assert own.errors == []
    finally:
        explorer.close()


def test_a_run_is_played(chromium: Browser, tmp_path: Path) -> None:
    scene = Path(wr.__file__).parents[1] / "scenes" / "curve.toml"
    lengths = {"track.tangent": 5.0, "track.transition_length": 10.0, "track.curve": 5.0}
    changes = {"model": "standard", "strips": None, "cells": None, **lengths}
    wr.run(scene, tmp_path, **changes)
    explorer = wr.explore(tmp_path)
    try:
        own = chromium.tab()
        own.open(explorer.url)
        wait(own, "get('curves') && get('painted') === 0")
        own.value("window.trame.state.set('jump_to', 'lateral_force')")
        own.value("document.querySelector('.wr-jump').click()")
        data = wr.open(tmp_path / "run.nc").data
        force = np.abs(data["lateral_force"]).transpose("time", "wheelset", "side").values
        sample = int(np.unravel_index(force.argmax(), force.shape)[0])
        wait(own, f"get('drawn') === {sample} && get('painted') === {sample}")
        panels = json.loads(get(own, "patches"))
        load = data["patch_normal_force"].isel(time=sample).sum().item()
        shown = sum(float(layer["label"].split()[0]) for panel in panels for layer in panel["drawing"]["layers"])
        assert shown == pytest.approx(1e-3 * load, rel=1e-3)
        own.value("window.trame.state.set('sample', 0)")
        own.value("document.querySelector('.wr-play').click()")
        wait(own, f"get('sample') === {data.sizes['time'] - 1} && !get('playing')")
        assert own.errors == []
    finally:
        explorer.close()


def test_nobody_without_the_token_is_answered(page: Any, chromium: Browser) -> None:
    port = int(re.findall(r":(\d+)/", page.url)[0])
    addresses = {own.laddr.ip for own in psutil.Process(page.pid).net_connections() if own.status == "LISTEN"}
    assert addresses == {"127.0.0.1"}
    stranger = chromium.tab()
    stranger.open(page.url.partition("?")[0])
    sleep(2.0)
    assert stranger.value("document.querySelectorAll('canvas').length") == 0
    stranger.errors.clear()
    for path in ("/wheelrail_browser/../jobs.py", "/..%2f..%2f..%2fetc/passwd", "/wheelrail_browser/%2e%2e/server.py"):
        request = HTTPConnection("127.0.0.1", port, timeout=10)
        request.request("GET", path)
        assert request.getresponse().status in (403, 404)


def running(pid: int) -> list[psutil.Process]:
    """The server of a page, and its processes."""
    server = psutil.Process(pid)
    return [server, *server.children(recursive=True)]


def test_nothing_is_left_of_a_killed_session() -> None:
    program = "import sys, wheelrail as wr; page = wr.explore(wr.Hertz(load=1e4, strips=6, cells=8)); print(page.pid)"
    program += "; sys.stdout.flush(); page.solution(); print(); sys.stdout.flush(); sys.stdin.read()"
    started = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, stdin=subprocess.PIPE)
    assert started.stdout is not None
    pid = int(started.stdout.readline())
    started.stdout.readline()
    processes = running(pid)
    os.kill(started.pid, signal.SIGKILL)
    started.wait(60)
    _, alive = psutil.wait_procs(processes, timeout=20)
    assert alive == []


def test_command_line_ends_with_ctrl_c() -> None:
    command = [sys.executable, "-m", "wheelrail.cli", "explore", "--no-browser"]
    started = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert started.stdout is not None
    assert started.stdout.readline().startswith("http://127.0.0.1:")
    server = psutil.Process(started.pid)
    end = monotonic() + 30.0
    while not server.children() and monotonic() < end:
        sleep(0.1)
    processes = server.children(recursive=True)
    started.send_signal(signal.SIGINT)
    _, errors = started.communicate(timeout=30)
    assert "Traceback" not in errors
    _, alive = psutil.wait_procs(processes, timeout=20)
    assert alive == []


def test_what_cannot_be_explored_is_named(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="explore: 3: must be a Hertz, a Wheelset, a profile, a scene or results"):
        wr.explore(3)
    scene = Path(wr.__file__).parents[1] / "scenes" / "curve.toml"
    with pytest.raises(ValueError, match=r'curve.toml: kind = "run": explore its results, run.nc'):
        wr.explore(scene)
    with pytest.raises((ValueError, OSError), match=r"missing\.nc"):
        wr.explore(tmp_path / "missing.nc")
    with pytest.raises(ValueError, match=r"explore: port = 99999: must be a whole number"):
        wr.explore(port=99999)


def test_closed_pages_leave_nothing_and_say_so() -> None:
    page = wr.explore(wr.Hertz(load=1e4, model="standard"))
    assert page.solution().ok
    processes = running(page.pid)
    page.close()
    _, alive = psutil.wait_procs(processes, timeout=20)
    assert alive == []
    with pytest.raises(RuntimeError, match="the process of the page has ended"):
        page.solution()
