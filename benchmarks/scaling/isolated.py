"""One measurement in a separate process with limits on time and memory; a failure becomes a row of the table.

python -m benchmarks.scaling.isolated KIND JSON, under mpirun for several ranks; prints a line of JSON per row.
"""

from __future__ import annotations

import json
import logging
import os
import resource
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator

from benchmarks.common.measurement import Row

GIGABYTES = 8.0  # of all ranks together
MARK = "row: "
MPI = {  # Open MPI as root, two ranks on any number of cores
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
    "OMPI_MCA_hwloc_base_binding_policy": "none",
}


def rows(kind: str, parameters: Row, *, seconds: float, ranks: int = 1) -> list[Row]:
    """Rows of a case with their input; the last one holds `failed` with the reason if the case failed."""
    command = [sys.executable, "-m", "benchmarks.scaling.isolated", kind, json.dumps(parameters)]
    if ranks > 1:
        command = ["mpirun", "-n", str(ranks), *command]
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as errors:
        process = subprocess.Popen(
            command,
            stdout=out,
            stderr=errors,
            text=True,
            start_new_session=True,
            env={**os.environ, **MPI, "OMP_NUM_THREADS": "1"},
        )
        timed_out = False
        try:
            process.wait(seconds)
        except subprocess.TimeoutExpired:
            timed_out = True
            _end(process)
        except BaseException:  # an interrupted benchmark leaves no processes
            _end(process)
            raise
        out.seek(0)
        errors.seek(0)
        result_rows = [
            {**parameters, "ranks": ranks, **json.loads(line[len(MARK) :])} for line in out if line.startswith(MARK)
        ]
        if timed_out or process.returncode:
            reason = f"over {seconds:g} s" if timed_out else _reason(errors.read(), process.returncode)
            result_rows.append({**parameters, "ranks": ranks, "failed": reason})
    return result_rows


def _end(process: subprocess.Popen[str]) -> None:
    """Ends a case and, under mpirun, its ranks."""
    for sent in (signal.SIGTERM, signal.SIGKILL):
        try:
            os.killpg(process.pid, sent)
            process.wait(5)
            return
        except ProcessLookupError:
            return
        except subprocess.TimeoutExpired:
            continue


def _reason(errors: str, code: int) -> str:
    """Short reason why a case ended."""
    lines = [line for line in errors.splitlines() if "Error" in line or "error" in line]
    if "MemoryError" in errors or "Out of memory" in errors or "bad_alloc" in errors or "allocate" in errors:
        return f"out of memory ({GIGABYTES:g} GB)"
    return lines[-1][:90] if lines else f"ended with {code}"


def cases(kind: str, parameters: Row) -> Iterator[Row]:
    """Rows of a case, as they are measured."""
    if kind == "points":
        from benchmarks.scaling.condensed import solves

        return solves(**parameters)
    if kind == "floor":
        from benchmarks.scaling.lower_bounds import bounds

        return bounds(**parameters)
    if kind == "elastic":
        from benchmarks.scaling.elastic_solve import elastic

        return elastic(**parameters)
    if kind == "newton":
        from benchmarks.scaling.full import newton

        return newton(**parameters)
    raise ValueError(f"no kind of case {kind!r}")


def main() -> None:
    """Measures one case."""
    kind, parameters = sys.argv[1], json.loads(sys.argv[2])
    ranks = int(os.environ.get("OMPI_COMM_WORLD_SIZE", os.environ.get("PMI_SIZE", "1")))
    limit = int(GIGABYTES / ranks * 2**30)
    resource.setrlimit(resource.RLIMIT_DATA, (limit, limit))
    logging.disable(logging.WARNING)
    for row in cases(kind, parameters):
        print(MARK + json.dumps(row), flush=True)


if __name__ == "__main__":
    main()
