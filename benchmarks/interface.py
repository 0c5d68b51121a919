"""Cost of the interfaces of a contact element, and growth of memory over many calls.

    python -m benchmarks.interface [--calls N]

Microseconds of processor time of a call for both wheels: around a contact that computes nothing, and for an input that
is refused, from Python and from a program in C, whose difference is the cost of the C interface. Shortest of ten parts.
Memory is that of a program in C with wheels in the air.
"""

from __future__ import annotations

import argparse
import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

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

static double shortest(int element, const double in[], long calls)
{
    double out[WHEELRAIL_OUTPUTS], time = 1e9;
    long k, part;
    for (part = 0; part < 10; part++) {
        clock_t start = clock();
        for (k = 0; k < calls / 10; k++) wheelrail_solve(element, in, out);
        if (clock() - start < time) time = clock() - start;
    }
    return time / CLOCKS_PER_SEC / (calls / 10);
}

int main(int count, char **arguments)
{
    double in[WHEELRAIL_INPUTS], out[WHEELRAIL_OUTPUTS], refused[WHEELRAIL_INPUTS];
    struct rusage before, after;
    long k, calls = atol(arguments[2]);
    int element = wheelrail_open(arguments[1], NULL);
    if (count < 3 || !element || wheelrail_start(element, in) || wheelrail_start(element, refused)) return 1;
    for (k = 0; k < calls; k++) {
        if (wheelrail_solve(element, in, out) || wheelrail_accept(element)) return 1;
        if (k == calls / 10) getrusage(RUSAGE_SELF, &before);
    }
    getrusage(RUSAGE_SELF, &after);
    refused[WHEELRAIL_IN_Y] = 1.0;
    printf("%g %ld\\n", shortest(element, refused, calls), after.ru_maxrss - before.ru_maxrss);
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


def in_c(calls: int) -> tuple[float, int]:
    """Seconds of a call from C with an input that is refused, and growth of memory kB after the first tenth."""
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
    parser.add_argument("--calls", type=int, default=20_000, help="number of calls")
    calls = parser.parse_args().calls
    times = in_python(calls)
    times["wheelrail_solve in C, refused input"], growth = in_c(calls)
    print(machine_description(), "\n\n| call | µs |\n|---|---|")
    for name, time in times.items():
        print(f"| {name} | {1e6 * time:.1f} |")
    print(f"\n{calls} calls from C: memory grew by {growth} kB after the first tenth.")


if __name__ == "__main__":
    main()
