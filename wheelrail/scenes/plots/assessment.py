"""Figures of an assessment: estimates in relation to their limits, signals along the track, regressions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wheelrail.scenes.plots.style import SERIES, literal
from wheelrail.support.arrays import Array
from wheelrail.vehicle.evaluation.criteria import CRITERIA
from wheelrail.vehicle.evaluation.running_safety import QUOTIENT_LIMIT, STEP, WINDOW, sliding_mean, track_shifting_limit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from wheelrail.vehicle.evaluation.estimates import Estimate
    from wheelrail.vehicle.evaluation.on_track import RunSignals, Section

ZONE_STYLE = {zone: SERIES[k] for k, zone in enumerate("12345")}
SHADES = {"1": "#EAF3F9", "2": "#FDF1E3", "3": "#E4F4EE", "4": "#F7E9F1", "5": "#F3F3F3"}


def utilisation(sections: Sequence[Section], estimates: Sequence[Estimate]) -> Figure:
    """Section values and estimates over their limits, one row for each quantity and zone."""
    from matplotlib.figure import Figure

    rows = sorted(estimates, key=lambda own: (list(CRITERIA).index(own.criterion), own.zone))
    figure = Figure(figsize=(7.2, 1.2 + 0.2 * len(rows)), layout="constrained")
    ax = figure.subplots()
    for k, own in enumerate(rows):
        values = [
            s.values[own.criterion].get(own.signal)
            for s in sections
            if s.zone == own.zone and own.criterion in s.values
        ]
        shares = np.array([one.value for one in values if one is not None]) / own.limit
        style = ZONE_STYLE[own.zone]
        ax.plot(shares, np.full(len(shares), k), ".", color=style["color"], markersize=3, alpha=0.6)
        face = style["color"] if CRITERIA[own.criterion].confirmed else "white"
        ax.plot(own.assessed / own.limit, k, style["marker"], color=style["color"], markerfacecolor=face, markersize=6)
    ax.axvline(1.0, color="0.15", linewidth=1.4)
    labels = [f"{CRITERIA[own.criterion].label}, zone {own.zone}" for own in rows]
    ax.set_yticks(range(len(rows)), labels, fontsize=7)
    ax.set_ylim(len(rows) - 0.5, -0.5)
    ax.set(xlabel="value over limit [-]", ylabel="quantity")
    ax.set_xlim(0.0, max(1.1, 1.05 * max((own.assessed / own.limit for own in rows), default=1.0)))
    title = "Dots: sections, markers: estimates, hollow: limit not confirmed"
    figure.suptitle(title, fontsize=9, x=0.01, ha="left")
    ax.grid(axis="y", visible=False)
    return figure


def along_track(signals: RunSignals, sections: Sequence[Section], alpha: float) -> Figure:
    """Sum of Y, Y/Q, Q and lateral acceleration along the track, zones of the sections shaded.

    Parameters:
        signals: of a run.
        sections: of all runs.
        alpha: factor of the limit of the sum of Y.
    """
    from matplotlib.figure import Figure

    count = 4 if signals.points else 3
    figure = Figure(figsize=(7.2, 1.7 * count + 0.4), layout="constrained")
    axes = list(figure.subplots(count, 1, sharex=True))
    (y, q), places = signals.forces, signals.places
    middles = places[0] + 0.5 * WINDOW + STEP * np.arange(len(sliding_mean(places, places)))
    for k, (name, offset) in enumerate(signals.wheelsets.items()):
        style = {"color": SERIES[k % len(SERIES)]["color"], "linewidth": 0.7}
        axes[0].plot(
            middles + offset, 1e-3 * sliding_mean(places, y[:, k, 1] - y[:, k, 0]), label=literal(name), **style
        )
        ratio = y[:, k] / np.maximum(q[:, k], 1.0)
        for side, dashes in enumerate(("-", (0, (4, 1.5)))):
            axes[1].plot(middles + offset, sliding_mean(places, ratio[:, side]), linestyle=dashes, **style)
            axes[2].plot(places[::5] + offset, 1e-3 * q[::5, k, side], linestyle=dashes, **style)
    limit = 1e-3 * track_shifting_limit(signals.wheel_load, alpha)
    titles = [
        f"Sum of Y, mean over 2 m, to the right [kN]; limits {limit:.1f} kN",
        f"Y/Q, mean over 2 m, left solid, right dashed; limit {QUOTIENT_LIMIT:g}",
        "Q [kN]",
    ]
    if signals.points:
        titles.append("Lateral acceleration on the floor, 0.4 to 10 Hz [m/s²]")
        for k, (name, offset) in enumerate(signals.points.items()):
            color = SERIES[k % len(SERIES)]["color"]
            values = signals.filtered["lateral"][::5, k]
            axes[3].plot(places[::5] + offset, values, color=color, linewidth=0.7, label=literal(name))
        axes[3].legend(loc="upper right", ncols=3, fontsize=7)
    for ax, title in zip(axes, titles, strict=True):
        ax.set_title(title)
        _shade(ax, [own for own in sections if own.run == signals.name])
    axes[0].legend(loc="upper right", ncols=4, fontsize=7)
    _limits(axes[0], limit)
    _limits(axes[1], QUOTIENT_LIMIT)
    axes[-1].set_xlabel("distance along the track [m]; shaded: sections, with their zone")
    return figure


def _shade(ax: Axes, sections: Sequence[Section]) -> None:
    for own in sections:
        ax.axvspan(own.start, own.end, color=SHADES[own.zone], zorder=0, linewidth=0)
        ax.axvline(own.start, color="0.8", linewidth=0.5, zorder=0)
        ax.text(
            0.5 * (own.start + own.end), 0.02, own.zone, transform=ax.get_xaxis_transform(), ha="center", fontsize=7
        )


def _limits(ax: Axes, limit: float) -> None:
    """Limits of both signs, unless far from the values."""
    low, high = ax.get_ylim()
    for value in (-limit, limit):
        if 1.6 * low <= value <= 1.6 * high:
            ax.axhline(value, color="0.15", linewidth=1.2)


def regressions(sections: Sequence[Section], estimates: Sequence[Estimate], deficiency: float) -> Figure | None:
    """Section values over cant deficiency with the two-dimensional estimates at a deficiency m; None without."""
    from matplotlib.figure import Figure

    rows = [own for own in estimates if np.isfinite(own.two)]
    if not rows:
        return None
    count = (len(rows) + 2) // 3
    figure = Figure(figsize=(7.2, 1.9 * count), layout="constrained")
    axes = np.ravel(figure.subplots(count, 3, squeeze=False)).tolist()
    for ax, own in zip(axes, rows, strict=False):
        found = [(s.deficiency, s.values[own.criterion][own.signal].value) for s in sections if _has(s, own)]
        x, y = np.array(found).T
        style = ZONE_STYLE[own.zone]
        ax.plot(1e3 * x, y, style["marker"], color=style["color"], markersize=3)
        ends = np.array([min(x.min(), deficiency), max(x.max(), deficiency)])
        ax.plot(1e3 * ends, _line(x, y, ends), color="0.5")
        ax.plot(1e3 * deficiency, own.two, "o", color="0.15", markersize=4)
        ax.set_title(f"{CRITERIA[own.criterion].label},\nzone {own.zone} [{CRITERIA[own.criterion].unit}]", fontsize=7)
        ax.tick_params(labelsize=7)
    for ax in axes[len(rows) :]:
        ax.set_visible(False)
    figure.supxlabel("cant deficiency [mm]; black: estimate", fontsize=8)
    return figure


def _has(section: Section, own: Estimate) -> bool:
    return section.zone == own.zone and own.signal in section.values.get(own.criterion, {})


def _line(x: Array, y: Array, at: Array) -> Array:
    """Regression line at (n,)."""
    slope = float((x - x.mean()) @ (y - y.mean()) / ((x - x.mean()) @ (x - x.mean())))
    return np.asarray(y.mean() + slope * (at - x.mean()))
