"""Tables in Markdown and exponents of the scaling benchmark."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from benchmarks.common.measurement import Row
from benchmarks.common.power_law import power

Column = tuple[str, Callable[[Row], Any]]


def table(title: str, columns: Sequence[Column], rows: Sequence[Row]) -> str:
    """Rows under a title; failed ones with their reason."""
    names = [name for name, _ in columns]
    lines = [f"\n## {title}\n", f"| {' | '.join(names)} |", "|---" * len(names) + "|"]
    for row in rows:
        cells = [_text(of(row)) for _, of in columns]
        lines.append(f"| {' | '.join(cells)} |" + (f" {row['failed']}" if "failed" in row else ""))
    return "\n".join(lines)


def _text(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.3g}" if abs(value) < 1e3 else f"{value:.0f}"
    return str(value)


def _of(name: str, factor: float = 1.0) -> Callable[[Row], Any]:
    return lambda row: row[name] * factor if isinstance(row.get(name), float) else row.get(name)


def phase(*names: str) -> Callable[[Row], Any]:
    """Milliseconds of phases of a solve; None without them."""

    def of(row: Row) -> Any:
        times = [1e3 * row["phases"][name] for name in names if name in row.get("phases", {})]
        return sum(times) if times else None

    return of


POINT_COLUMNS: list[Column] = [
    ("points, bodies", _of("family")),
    ("task", _of("task")),
    ("n", _of("points")),
    ("candidates", _of("candidates")),
    ("ms", _of("seconds", 1e3)),
    ("projection", phase("points")),
    ("compliance", phase("compliance")),
    ("solve", phase("solve")),
    ("Newton", _of("newton")),
    ("BiCGStab", _of("linear")),
    ("MB", _of("memory")),
    ("normal force error %", _of("force error")),
    ("creep force error % of mu F_n", _of("creep error")),
]
BOUND_COLUMNS: list[Column] = [("n", _of("points"))] + [
    (f"{name}, ms", _of(name, 1e3))
    for name in ("dgesv 2n", "dgesv n", "gather", "dense", "FFT along x", "FFT over x and y")
]
ELASTIC_COLUMNS: list[Column] = [
    ("method", _of("method")),
    ("ranks", _of("ranks")),
    ("across", _of("across")),
    ("unknowns", _of("unknowns")),
    ("assembly s", _of("assembly")),
    ("set-up s", _of("set-up")),
    ("solve s", _of("solve")),
    ("iterations", _of("iterations")),
    ("MB", _of("memory")),
    ("residual", _of("residual")),
    ("work error %", _of("work error")),
]
NEWTON_COLUMNS: list[Column] = [
    ("preconditioner", _of("method")),
    ("friction", lambda row: "paper's" if row["friction"] else "none"),
    *ELASTIC_COLUMNS[2:7],
    ("Newton", _of("newton")),
    ("BiCGStab", _of("linear")),
    ("MB", _of("memory")),
    ("residual", _of("residual")),
    ("normal force error %", _of("force error")),
    ("creep force error %", _of("creep error")),
]


def grouped(rows: Sequence[Row], *keys: str) -> dict[str, list[Row]]:
    """Rows that did not fail, by the values of some keys."""
    groups: dict[str, list[Row]] = {}
    for row in rows:
        if "failed" not in row:
            groups.setdefault(", ".join(_text(row[key]) for key in keys), []).append(row)
    return groups


def exponents(title: str, groups: dict[str, list[Row]], size: str, costs: Sequence[Column]) -> str:
    """Fitted exponents of costs, with the range of sizes."""
    lines = [f"\n## {title}\n", f"| | {' | '.join(name for name, _ in costs)} |", "|---" * (len(costs) + 1) + "|"]
    for name, rows in groups.items():
        cells = []
        for _, of in costs:
            points = [(row[size], of(row)) for row in rows if of(row)]
            cells.append(str(power(*zip(*points, strict=True)) or "") if points else "")
        if any(cells):
            lines.append(f"| {name} | {' | '.join(cells)} |")
    return "\n".join(lines)


POINT_COSTS: list[Column] = [
    ("time", _of("seconds")),
    *[(name, of) for name, of in POINT_COLUMNS if name in ("projection", "compliance", "solve", "MB")],
]
FULL_COSTS: list[Column] = [(name, of) for name, of in ELASTIC_COLUMNS if name in ("set-up s", "solve s", "MB")]
BOUND_COSTS: list[Column] = [(name.removesuffix(", ms"), of) for name, of in BOUND_COLUMNS[1:]]
