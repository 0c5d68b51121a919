"""Cost of the interfaces of a contact element, and growth of memory over many calls.

    python -m benchmarks.interface [--calls N]

Microseconds of one call for both wheels: around a contact that computes nothing, and for wheels in the air, from Python
and from a program in C, whose difference is the cost of the C interface. Shortest of ten parts of the calls.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

import numpy as np

import wheelrail as wr
from benchmarks.common.machine import machine_description
from wheelrail.api.elements.variables import OUTPUTS
from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.export.library import export_library

HIGH = 0.05  # m, wheels in the air
PAIR = {"model": "standard", "z": HIGH}
PARTS = 10
PROGRAM = """
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <time.h>
#include "wheelrail.h"

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}

int main(int count, char **arguments)
{
    double in[WHEELRAIL_INPUTS], out[WHEELRAIL_OUTPUTS], shortest = 1e9, start;
    struct rusage before, after;
    long k, part, calls = atol(arguments[2]) / 10;
    int element = wheelrail_open(arguments[1], NULL);
    if (count < 3 || !element || wheelrail_start(element, in) || wheelrail_solve(element, in, out)) return 1;
    for (part = 0; part < 10; part++) {
        start = now();
        for (k = 0; k < calls; k++)
            if (wheelrail_solve(element, in, out) || wheelrail_accept(element)) return 1;
        if (part == 0) getrusage(RUSAGE_SELF, &before);
        if (now() - start < shortest) shortest = now() - start;
    }
    getrusage(RUSAGE_SELF, &after);
    printf("%g %ld\\n", shortest / calls, after.ru_maxrss - before.ru_maxrss);
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
    """Shortest mean time s of a call, of ten parts."""
    times = []
    for _ in range(PARTS):
        start = perf_counter()
        for _ in range(calls // PARTS):
            call()
        times.append(perf_counter() - start)
    return min(times) / (calls // PARTS)


def in_python(calls: int, *, computes: bool) -> dict[str, float]:
    """Seconds of a call by name of the method; computes: whether there is a contact model behind it."""
    element = wr.Wheelset(**PAIR).element()
    if not computes:
        element.contact = NoContact()
    inputs, outputs = element.start_array(), np.zeros(len(OUTPUTS))
    state = element.solve().state

    def solve_array_and_accept() -> None:
        element.solve_array(inputs, outputs)
        element.accept()

    methods: dict[str, Callable[[], object]] = {
        "solve_state": lambda: element.solve_state(state),
        "solve_array": lambda: element.solve_array(inputs, outputs),
        "solve_array and accept": solve_array_and_accept,
        "solve by names": lambda: element.solve(y=0.0, z=HIGH),
    }
    return {name: seconds(call, calls) for name, call in methods.items()}


def in_c(calls: int) -> tuple[float, int]:
    """Seconds of solve and accept from C for wheels in the air, and growth of memory kB after the first tenth."""
    with TemporaryDirectory() as work:
        folder = Path(work)
        export_library(folder)
        (folder / "program.c").write_text(PROGRAM, encoding="utf-8")
        link = ["-L.", "-lwheelrail", "-Wl,-rpath,$ORIGIN", "-o", "program"]
        subprocess.run(["cc", "-O2", "program.c", *link], cwd=folder, check=True)
        command = [folder / "program", json.dumps(PAIR), str(calls)]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
    time, growth = done.stdout.split()
    return float(time), int(growth)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--calls", type=int, default=100_000, help="number of calls from C, a tenth from Python")
    calls = parser.parse_args().calls
    print(machine_description(), "\n\n| call | contact | µs |\n|---|---|---|")
    for computes, contact in ((False, "none"), (True, "wheels in the air")):
        for name, time in in_python(calls // 10, computes=computes).items():
            print(f"| {name} | {contact} | {1e6 * time:.1f} |")
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    time, growth = in_c(calls)
    used = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    print(f"| C: wheelrail_solve and wheelrail_accept | wheels in the air | {1e6 * time:.1f} |")
    print(f"\n{calls} calls from C: memory grew by {growth} kB after the first tenth; {used:.0f} s of processor time.")


if __name__ == "__main__":
    main()
