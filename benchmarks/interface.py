"""Cost of the interfaces of a contact element, times of loaded wheels from Python and C, and growth of memory.

    python -m benchmarks.interface [--calls N]

Microseconds of processor time of a call for both wheels: around a contact that computes nothing, and for an input that
is refused, from Python and from a program in C, whose difference is the cost of the C interface. Loaded wheels follow a
path from accepted state to accepted state, 10 to 30 um each; the library solves them without Python. Means of the
shortest of ten parts. Memory is that of the programs in C after the first tenth of their calls.
"""

from __future__ import annotations

import argparse
import json
import subprocess
from collections.abc import Callable
from math import sin
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import cast

import numpy as np

import wheelrail as wr
from benchmarks.common.machine import machine_description
from wheelrail.api.elements.variables import OUTPUTS
from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.export.host import loaded_inputs
from wheelrail.export.library import export_library

HIGH = 0.05  # m, wheels in the air
PAIR = {"model": "standard", "z": HIGH}
PARTS = 10
SIZE, STEP = 5e-4, 0.05  # m and rad: the lateral motion of loaded wheels about that of the scene, and its steps
REFUSED = -1.0  # in place of the step
STRIPS = "strips = 6\ncells = 10\n"
LOADED = {
    "standard": 'model = "standard"\n',
    "half-spaces, 6 x 10": f'bodies = "half-space"\n{STRIPS}',
    "waveguides, 6 x 10": STRIPS,
}
SCENE = 'kind = "wheelset"\n{}[profiles]\nwheel = "S1002"\nrail = "60E1"\n[wheelset]\nspeed = 20.0\nwheel_load = 57e3\n'
PROGRAM = """
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <time.h>
#include "wheelrail.h"

/* Options, calls, m of lateral motion about the start, rad of its steps; or, negative: an input that is refused. */
int main(int count, char **arguments)
{
    double in[WHEELRAIL_INPUTS], out[WHEELRAIL_OUTPUTS], y, time = 1e9;
    struct rusage before, after;
    long k, part, calls = atol(arguments[2]) / 10;
    double size = atof(arguments[3]), step = atof(arguments[4]);
    int element = wheelrail_open(arguments[1], NULL);
    if (count < 5 || !element || wheelrail_start(element, in)) return 1;
    y = in[WHEELRAIL_IN_Y];
    for (part = 0; part < 10; part++) {
        clock_t start = clock();
        for (k = 0; k < calls; k++) {
            in[WHEELRAIL_IN_Y] = step < 0.0 ? 1.0 : y + size * sin(step * (part * calls + k));
            if (wheelrail_solve(element, in, out) != (step < 0.0)) return 1;
            if (step >= 0.0 && wheelrail_accept(element)) return 1;
        }
        if (clock() - start < time) time = clock() - start;
        getrusage(RUSAGE_SELF, part ? &after : &before);
    }
    printf("%g %ld\\n", time / CLOCKS_PER_SEC / calls, after.ru_maxrss - before.ru_maxrss);
    return 0;
}
"""


class NoContact(VehicleContact):
    """A contact that computes nothing."""

    def __init__(self) -> None:
        self.result = ContactResult(np.ones(3), np.ones(3), status="converged")

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        return self.result


def seconds(call: Callable[[], object], calls: int) -> float:
    """Shortest mean processor time s of a call, of ten parts."""
    times = []
    for _ in range(PARTS):
        start = process_time()
        for _ in range(calls // PARTS):
            call()
        times.append(process_time() - start)
    return min(times) / (calls // PARTS)


def in_python(calls: int) -> dict[str, float]:
    """Seconds of a call around a contact that computes nothing, and of one with an input that is refused."""
    element = wr.Wheelset(**PAIR).element()
    element.contact = NoContact()
    inputs, outputs = element.start_array(), np.zeros(len(OUTPUTS))
    state, refused = element.solve().state, inputs.copy()
    refused[0] = 1.0
    methods: dict[str, Callable[[], object]] = {
        "solve_state": lambda: element.solve_state(state),
        "solve by names": lambda: element.solve(y=0.0, z=HIGH),
        "solve_array": lambda: element.solve_array(inputs, outputs),
        "solve_array, refused input": lambda: element.solve_array(refused, outputs),
    }
    return {name: seconds(call, calls) for name, call in methods.items()}


def loaded_in_python(wheelset: wr.Wheelset, calls: int) -> float:
    """Seconds of a call and its acceptance along the path of loaded wheels."""
    element = wheelset.element()
    inputs, outputs = loaded_inputs(wheelset), np.zeros(len(OUTPUTS))
    y, number = inputs[0], iter(range(calls))

    def follow() -> None:
        inputs[0] = y + SIZE * sin(STEP * next(number))
        element.solve_array(inputs, outputs)
        element.accept()

    return seconds(follow, calls)


def in_c(folder: Path, calls: int, options: str = "{}", step: float = STEP) -> tuple[float, int]:
    """Seconds of a call from C of the library in a folder, and growth of memory kB after the first tenth."""
    (folder / "program.c").write_text(PROGRAM, encoding="utf-8")
    link = ["-L.", "-lwheelrail", "-lm", "-Wl,-rpath,$ORIGIN", "-o", "program"]
    subprocess.run(["cc", "-O2", "program.c", *link], cwd=folder, check=True)
    command = [folder / "program", options, str(calls), str(SIZE), str(step)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    time, growth = done.stdout.split()
    return float(time), int(growth)


def loaded(kind: str, folder: Path, calls: int) -> str:
    """Row of a table: a kind of contact from Python and from the library without Python, and its growth of memory."""
    scene = folder / "scene.toml"
    scene.write_text(SCENE.format(LOADED[kind]), encoding="utf-8")
    export_library(folder, scene)
    time, growth = in_c(folder, calls)
    python = loaded_in_python(cast(wr.Wheelset, wr.load(scene)), calls)
    return f"| {kind} | {1e6 * python:.0f} | {1e6 * time:.0f} | {growth} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--calls", type=int, default=20_000, help="number of calls")
    calls = parser.parse_args().calls
    times = in_python(calls)
    with TemporaryDirectory() as work:
        export_library(Path(work))
        times["wheelrail_solve in C, refused input"], growth = in_c(Path(work), calls, json.dumps(PAIR), REFUSED)
    print(machine_description(), "\n\n| call | µs |\n|---|---|")
    for name, time in times.items():
        print(f"| {name} | {1e6 * time:.1f} |")
    print(f"\n{calls} calls of the library that starts Python: memory grew by {growth} kB.")
    print("\n| loaded wheels | Python, µs | C, µs | growth, kB |\n|---|---|---|---|")
    for kind in LOADED:
        with TemporaryDirectory() as work:
            print(loaded(kind, Path(work), calls), flush=True)


if __name__ == "__main__":
    main()
