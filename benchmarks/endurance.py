"""Resident memory of a program in C over many calls of an exported library, with wild inputs in between.

    python -m benchmarks.endurance SCENE [--calls N]

Loaded wheels follow a lateral path from accepted state to accepted state, at most 50 nm each. Every 1000th call a wild
value is in place of one input: undefined, infinite, 1e300, -1e300 or -0.05; tangent, patches and a stored state are
asked for, too. The first four have to be refused, with the last one forces have to be finite or refused. The program
ends at a call that does otherwise.
"""

from __future__ import annotations

import argparse
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.common.machine import machine_description
from benchmarks.interface import SIZE
from wheelrail.export.library import export_library
from wheelrail.export.native import DEFAULT_FILE

STEP = 1e-4  # rad
PROGRAM = r"""
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include "wheelrail.h"

static long resident(void) /* kB */
{
    long all, own = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%ld %ld", &all, &own) != 2) exit(1);
    fclose(file);
    return own * (sysconf(_SC_PAGESIZE) / 1024);
}

static void end(int element, long call)
{
    char text[500];
    wheelrail_error(element, text, sizeof text);
    fprintf(stderr, "call %ld: %s\n", call, text);
    exit(1);
}

/* Options, folder, calls, m of lateral motion about the start, rad of its steps. */
int main(int count, char **arguments)
{
    const double wild[] = {NAN, INFINITY, 1e300, -1e300, -0.05};
    double start[WHEELRAIL_INPUTS], in[WHEELRAIL_INPUTS], out[WHEELRAIL_OUTPUTS], column[WHEELRAIL_FORCES];
    double patches[2 * WHEELRAIL_PATCH_VALUES];
    long call, next = 1000, refused = 0, calls = count == 6 ? atol(arguments[3]) : 0;
    double size = calls ? atof(arguments[4]) : 0.0, step = calls ? atof(arguments[5]) : 0.0;
    int i, status, finite = 1, element = calls ? wheelrail_open(arguments[1], arguments[2]) : 0;
    if (!element || wheelrail_start(element, start)) end(element, 0);
    for (call = 1; call <= calls; call++) {
        memcpy(in, start, sizeof in);
        in[WHEELRAIL_IN_Y] += size * sin(step * call);
        if (wheelrail_solve(element, in, out) || wheelrail_accept(element)) end(element, call);
        if (call % 1000 == 0) {
            long number = call / 1000;
            if (wheelrail_tangent(element, number % WHEELRAIL_INPUTS, column)) end(element, call);
            if (wheelrail_patches(element, patches) || wheelrail_save(element, 1)) end(element, call);
            in[number % WHEELRAIL_INPUTS] = wild[number % 5];
            status = wheelrail_solve(element, in, out);
            for (finite = 1, i = 0; i < WHEELRAIL_FORCES; i++) finite = finite && isfinite(out[i]);
            if (status ? status != 1 : !finite || number % 5 < 4) end(element, call);
            refused += status;
            if (wheelrail_restore(element, 1)) end(element, call);
        }
        if (call == next || call == calls) {
            printf("| %ld | %ld | %ld | %.0f |\n", call, resident(), refused, (double)clock() / CLOCKS_PER_SEC);
            fflush(stdout);
            next *= 10;
        }
    }
    return 0;
}
"""


def endure(scene: Path, folder: Path, calls: int) -> list[list[float]]:
    """Rows by number of calls of a scene's library: calls, resident memory kB, refused inputs, processor time s."""
    export_library(folder, scene)
    (folder / "endurance.c").write_text(PROGRAM, encoding="utf-8")
    link = ["-L.", "-lwheelrail", "-lm", "-Wl,-rpath,$ORIGIN", "-o", "endurance"]
    subprocess.run(["cc", "-O2", "endurance.c", *link], cwd=folder, check=True)
    options = "{}" if (folder / DEFAULT_FILE).exists() else '{"scene": "scene.toml"}'
    command = [folder / "endurance", options, folder, str(calls), str(SIZE), str(STEP)]
    rows = []
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as program:
        assert program.stdout is not None
        for line in program.stdout:
            print(line, end="", flush=True)
            rows.append([float(cell) for cell in line.strip("| \n").split("|")])
    if program.returncode:
        raise RuntimeError("the program ended at a call that was not as it should be")
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene", type=Path, help="of a wheelset (TOML)")
    parser.add_argument("--calls", type=int, default=100_000, help="number of calls")
    given = parser.parse_args()
    print(f"{machine_description()}\n\n| calls | resident, kB | refused | processor, s |", flush=True)
    print("|---|---|---|---|", flush=True)
    with TemporaryDirectory() as work:
        endure(given.scene, Path(work), given.calls)


if __name__ == "__main__":
    main()
