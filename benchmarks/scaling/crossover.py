"""Number of contact points from which BiCGStab would be faster than LU, and FFT products than dense ones."""

from __future__ import annotations

from collections.abc import Sequence

from benchmarks.common.measurement import Row
from benchmarks.common.measurement_tables import grouped, phase
from benchmarks.common.power_law import crossover


def crossovers(points: Sequence[Row], floors: Sequence[Row]) -> str:
    """Number of points from which each alternative is faster.

    LU: steps of the tangential Newton iteration only, the additional cost of friction. FFT: only for patches with equal
    cells.
    """
    lines = ["\n## Crossovers, in contact points\n"]
    by = grouped(points, "family", "task")
    for family in grouped(points, "family"):
        normal, lu, bicgstab = (
            {row["wanted"]: row for row in by.get(f"{family}, {task}", [])}
            for task in ("normal", "rolling, LU", "rolling, BiCGStab")
        )
        counts = [n for n in lu if n in bicgstab and n in normal]
        if not counts:
            continue
        direct, krylov = ([phase("solve")(rows[n]) for n in counts] for rows in (lu, bicgstab))
        lines.append(f"- {family}: BiCGStab faster than LU in the whole solve: {crossover(counts, direct, krylov)}")
        bounds = [row for row in floors if row.get("points") in counts]
        if not family.startswith("grid") or not bounds:
            continue
        n = [row["points"] for row in bounds]
        steps = [lu[k]["newton"] - normal[k]["newton"] for k in n]
        products = [2 * bicgstab[k]["linear"] for k in n]
        direct = [k * row["dgesv 2n"] for k, row in zip(steps, bounds, strict=True)]
        dense = [k * row["dense"] for k, row in zip(products, bounds, strict=True)]
        lines.append(
            f"- {family}, linear algebra alone: BiCGStab with dense products faster than dgesv: "
            f"{crossover(n, direct, dense)}; at {n[-1]}: {steps[-1]} dgesv {1e3 * direct[-1]:.3g} ms, "
            f"{products[-1]} dense products {1e3 * dense[-1]:.3g} ms"
        )
        for name in ("FFT along x", "FFT over x and y"):
            fast = [k * row[name] for k, row in zip(products, bounds, strict=True)]
            lines.append(
                f"- {family}, {name}: a product faster than the dense one: {crossover(n, dense, fast)}; BiCGStab "
                f"with it faster than dgesv: {crossover(n, direct, fast)}; at {n[-1]}: {1e3 * fast[-1]:.3g} ms"
            )
    return "\n".join(lines)
