"""Fig. 9 of the paper reproduced, and time over error of all variants."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.paper.error import Ran
from benchmarks.paper.variants import SOLID, PaperVariant

# Okabe and Ito's colours, distinct for all colour vision; markers by integrator
COLOURS = ("#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9", "#000000")
MARKERS = {"ode23": "o", "ode45": "s"}


def picture(path: Path, done: list[tuple[PaperVariant, Ran, float]]) -> None:
    """Draws the runs: variant, outcome, and length s of its part. Variants on the short part are omitted."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(13, 5.2), layout="constrained")
    long = [(v, r, s) for v, r, s in done if not (v.full or v.short or r.failure)]
    _fig_9(left, long)
    _precision(right, long)
    if long:
        figure.suptitle(f"{long[0][2]:g} s of the paper's curve")
    figure.savefig(path, dpi=120)
    plt.close(figure)


def _fig_9(axes: Any, long: list[tuple[PaperVariant, Ran, float]]) -> None:
    krylov = [(dict(v.options), r) for v, r, _ in long if (v.body, v.method) == (SOLID, "ode23")]
    etas = sorted(((float(o["forcing"]), r) for o, r in krylov if "linear" in o), key=lambda pair: -pair[0])
    axes.set(xscale="log", xlabel="forcing term eta, Eq. (18)", ylabel="time of the run, s", title="Fig. 9, reproduced")
    axes.invert_xaxis()
    if not etas:
        return
    eta = [item for item, _ in etas]
    axes.plot(eta, [r.cost.seconds for _, r in etas], "o-", color=COLOURS[0], label="time")
    axes.set_ylim(bottom=0)
    twin = axes.twinx()
    twin.plot(eta, [r.newton for _, r in etas], "s--", color=COLOURS[3], label="Newton per contact problem")
    twin.plot(eta, [r.linear for _, r in etas], "^:", color=COLOURS[2], label="BiCGStab per Newton iteration")
    twin.set(ylabel="iterations")
    twin.set_ylim(bottom=0)
    lines = [*axes.get_lines(), *twin.get_lines()]
    axes.legend(
        lines,
        [item.get_label() for item in lines],
        fontsize=7,
        loc="upper center",
        bbox_to_anchor=(0.5, -0.14),
        ncols=3,
    )


def _precision(axes: Any, long: list[tuple[PaperVariant, Ran, float]]) -> None:
    axes.set(
        xlabel="RMS error of the contact force, % of the wheel load",
        ylabel="time of the run, s",
        title="Time and error",
    )
    bodies = list(dict.fromkeys(v.body for v, _, _ in long))
    labelled: set[str] = set()
    for variant, ran, _ in long:
        if not np.isfinite(ran.force):
            continue
        colour = COLOURS[bodies.index(variant.body) % len(COLOURS)]
        direct = "linear" not in dict(variant.options)
        label = f"{variant.body.name}: {variant.method.upper()}, {'LU' if direct else 'BiCGStab'}"
        axes.loglog(
            100 * ran.force,
            ran.cost.seconds,
            MARKERS.get(variant.method, "D"),
            color=colour,
            markerfacecolor=colour if direct else "none",
            label=None if label in labelled else label,
        )
        labelled.add(label)
    axes.grid(True, which="both", alpha=0.25)
    if labelled:
        axes.legend(fontsize=7, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=2)
