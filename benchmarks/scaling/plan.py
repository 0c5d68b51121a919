"""Measurements: sizes by family, task, method and ranks; a series ends at the first failure."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from benchmarks.common.measurement import Row
from benchmarks.scaling.isolated import rows

SIZES = (50, 100, 200, 400, 800, 1500, 3000)  # contact points
QUICK_SIZES = SIZES[:3]
# the most points by family (points, bodies) and task
POINTS: dict[tuple[str, str], dict[str, int]] = {
    ("grid", "waveguide"): {"normal": 3000, "rolling, LU": 1500, "rolling, BiCGStab": 800},
    ("lattice", "half-space"): {"normal": 3000, "rolling, LU": 3000},
    ("lattice", "waveguide"): {"normal": 1500, "rolling, LU": 800},
}
POINTS_LIMIT, FULL_LIMIT = 120.0, 100.0  # seconds a case
# elements across the patch by method and ranks: 4, 5, 6, 8, 12, 16, 20 are 25e3 to 1e6 unknowns of one body
ELASTIC: dict[tuple[str, int], tuple[int, ...]] = {
    ("CG + GAMG", 1): (4, 6, 8, 12, 16, 20),
    ("CG + GAMG", 2): (4, 6, 8),
    ("MUMPS", 1): (4, 6, 8, 12),
    ("MUMPS", 2): (4, 6, 8),
    ("CHOLMOD", 1): (4, 6, 8),
    ("BiCGStab + ICC", 1): (4, 6, 8, 12),
    ("BiCGStab + ICC", 2): (4, 6, 8),
}
# the same of two bodies, by method and friction
NEWTON: dict[tuple[str, bool], tuple[int, ...]] = {
    ("corrected Cholesky", False): (4, 5, 6, 8),
    ("Cholesky, eq. (19)", False): (4, 5, 6),
    ("MUMPS", False): (4, 6),
    ("ICC", False): (4, 5, 6),
    ("GAMG", False): (4, 5, 6),
    ("corrected Cholesky", True): (4, 5, 6),
    ("Cholesky, eq. (19)", True): (4,),
    ("ICC", True): (4,),
    ("GAMG", True): (4,),
}
QUICK_ACROSS = (3,)
Say = Callable[[str], None]


def point_rows(quick: bool, say: Say) -> Iterator[Row]:
    """Condensed contact, family by family."""
    for (points, bodies), limits in POINTS.items():
        failed: set[str] = set()
        for count in QUICK_SIZES if quick else SIZES:
            tasks = [task for task, largest in limits.items() if count <= largest and task not in failed]
            if not tasks:
                break
            say(f"{points} on {bodies}, {count} points")
            parameters: Row = {"points": points, "bodies": bodies, "wanted": count, "tasks": tasks}
            result_rows = rows("points", parameters, seconds=POINTS_LIMIT)
            for row in result_rows:
                row["family"] = f"{points}, {bodies}"
                if "failed" in row:  # in the first task that has no row; the others were not tried
                    row["points"] = count
                    row["task"] = tasks[len(result_rows) - 1]
                    failed.update(tasks[len(result_rows) - 1 :])
                yield row


def bound_rows(quick: bool, say: Say) -> Iterator[Row]:
    """Lower bounds for the same numbers of points."""
    say("lower bounds")
    yield from rows("floor", {"sizes": QUICK_SIZES if quick else SIZES}, seconds=POINTS_LIMIT)


def full_rows(kind: str, quick: bool, say: Say) -> Iterator[Row]:
    """Elastic solves ("elastic") or contact solves ("newton") with all nodal displacements."""
    series: list[tuple[Row, int, tuple[int, ...]]] = [
        ({"method": method}, ranks, all_across) for (method, ranks), all_across in ELASTIC.items()
    ]
    if kind == "newton":
        series = [({"method": name, "friction": friction}, 1, across) for (name, friction), across in NEWTON.items()]
    for fixed, ranks, all_across in series[:4] if quick else series:
        for across in QUICK_ACROSS if quick else all_across:
            say(f"{kind}, {fixed['method']}, {across} across, {ranks} ranks")
            result_rows = rows(kind, {**fixed, "across": across}, seconds=FULL_LIMIT, ranks=ranks)
            yield from result_rows
            if any("failed" in row for row in result_rows):
                break
