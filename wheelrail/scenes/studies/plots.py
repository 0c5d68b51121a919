"""Figures of a study: quantities over the varied parameters, sensitivities, convergence."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.plots import errors as panels
from wheelrail.scenes.plots.style import SERIES, literal, save, styled
from wheelrail.scenes.plots.tornado import range_label, tornado
from wheelrail.scenes.studies.convergence import errors_of, finest_of, increasing_of, largest_errors, series_of
from wheelrail.scenes.studies.plan import SAMPLE, VARIATION, shown
from wheelrail.scenes.studies.quantities import QUANTITIES, varying
from wheelrail.scenes.studies.tables import dimensions, order_text, parameters, series_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from xarray import DataArray, Dataset

COLOURS, MARKERS = zip(*((look["color"], look["marker"]) for look in SERIES), strict=True)
SIDES: dict[Any, dict[str, Any]] = {"left": {}, "right": {"linestyle": "--", "fillstyle": "none"}}
PANELS, LINES = 6, 12  # largest numbers
DASHES = ("-", "--", ":", "-.")


def draw_study(data: Dataset, folder: Path) -> list[Path]:
    """Save the figures; returns the files: study.png, and convergence.png of a convergence study."""
    files = []
    with styled():
        for name, draw in drawings(data).items():
            figure = draw(data, None)
            if figure is not None:
                save(figure, folder / f"{name}.png")
                files.append(folder / f"{name}.png")
    return files


def drawings(data: Dataset) -> dict[str, Callable[[Dataset, Figure | None], Figure | None]]:
    """Functions that draw the figures of a study, by name."""
    alone = data["status"].dims == (VARIATION,)
    functions: dict[str, Callable[[Dataset, Figure | None], Figure | None]] = {
        "study": sensitivity if SAMPLE in data.dims else one_at_a_time if alone else lines
    }
    return functions | ({"convergence": convergence} if errors_of(data) else {})


def lines(data: Dataset, figure: Figure | None = None) -> Figure | None:
    """Main quantities over the longest numeric dimension, one colour per combination of the remaining dimensions."""
    from matplotlib.lines import Line2D

    names, dims = varying(data)[:PANELS], dimensions(data)
    if not names:
        return None
    over = max([dim for dim in dims if data[dim].dtype.kind in "if"] or dims, key=lambda dim: data.sizes[dim])
    other_dims = [dim for dim in dims if dim != over]
    combinations = list(np.ndindex(*(data.sizes[dim] for dim in other_dims)))[:LINES]
    figure, panels = _panels(figure, len(names))
    for panel, name in zip(panels, names, strict=True):
        own = QUANTITIES[name]
        for number, index in enumerate(combinations):
            array = data[name].isel(dict(zip(other_dims, index, strict=True)))
            for side in data["side"].values if "side" in array.dims else [None]:
                values = array if side is None else array.sel(side=side)
                panel.plot(
                    *_ordered(data[over], own.scale * values.values), **_line_style(number), **SIDES.get(side, {})
                )
        panel.set_ylabel(own.head)
        _along(panel, data[over])
    handles = [
        Line2D([], [], label=_combination(data, other_dims, index), **_line_style(i))
        for i, index in enumerate(combinations)
    ]
    handles = handles if other_dims else []
    if "side" in data.dims:
        handles += [Line2D([], [], color="0.4", marker="o", markersize=4.0, label=s, **SIDES[s]) for s in SIDES]
    if handles:
        count = int(np.prod([data.sizes[dim] for dim in other_dims]))
        title = f"first {LINES} of {count}" if count > LINES else None
        figure.legend(handles=handles, loc="outside lower center", ncols=min(5, len(handles)), title=title)
    return figure


def sensitivity(data: Dataset, figure: Figure | None = None) -> Figure | None:
    """Rank correlation (Spearman) of the main quantities with every parameter, and scatter over that of largest
    correlation.
    """
    from scipy.stats import spearmanr

    names = varying(data)[:4]
    sampled = [p for p in parameters(data) if data[p].dims == (SAMPLE,) and data[p].dtype.kind in "if"]
    if not names or not sampled:
        return None
    figure, panels = _panels(figure, 2 * len(names), columns=2)
    for row, name in enumerate(names):
        own = QUANTITIES[name]
        columns = (
            data[name].stack(line=[dim for dim in data[name].dims if dim != SAMPLE]) if data[name].ndim > 1 else None
        )
        series = [data[name].values] if columns is None else list(columns.transpose("line", SAMPLE).values[:4])
        texts = (
            [""] if columns is None else [", ".join(map(str, np.atleast_1d(i))) for i in columns.indexes["line"][:4]]
        )
        bars, dots = panels[2 * row], panels[2 * row + 1]
        correlations = np.array([[spearmanr(data[p].values, y, nan_policy="omit")[0] for p in sampled] for y in series])
        height = 0.8 / len(series)
        for index, (values, text) in enumerate(zip(correlations, texts, strict=True)):
            positions = np.arange(len(sampled)) + height * (index - 0.5 * (len(series) - 1))
            bars.barh(positions, values, 0.9 * height, color=COLOURS[index], label=text)
        bars.set_yticks(np.arange(len(sampled)), [data[p].attrs["long_name"] for p in sampled])
        bars.invert_yaxis()
        bars.set_xlim(-1.0, 1.0)
        bars.axvline(0.0, color="0.4", linewidth=0.8)
        bars.set_xlabel(f"rank correlation with {own.label} [-]")
        strongest = sampled[int(np.nanargmax(np.abs(correlations).max(axis=0)))]
        for index, (y, text) in enumerate(zip(series, texts, strict=True)):
            style: dict[str, Any] = {"color": COLOURS[index], "marker": MARKERS[index]}
            dots.plot(data[strongest].values, own.scale * y, linestyle="", markersize=3.0, label=text, **style)
        dots.set_ylabel(own.head)
        _along(dots, data[strongest])
        if columns is not None:
            dots.legend()
    return figure


def one_at_a_time(data: Dataset, figure: Figure | None = None) -> Figure | None:
    """Tornado diagrams of the main quantities, the larger one of both sides."""
    names, sampled = varying(data)[:4], parameters(data)
    if not names:
        return None
    ends = np.arange(1, data.sizes[VARIATION]).reshape(-1, 2)
    labels = [range_label(data[p].attrs, data[p].values[ends[k]]) for k, p in enumerate(sampled)]
    figure, axes = _panels(figure, len(names), columns=1)
    figure.set_size_inches(7.2, (0.9 + 0.22 * len(sampled)) * len(names))
    for ax, name in zip(axes, names, strict=True):
        values = data[name].max("side") if "side" in data[name].dims else data[name]
        own = QUANTITIES[name].scale * values.values
        tornado(ax, labels, own[ends], float(own[0]), QUANTITIES[name].head)
    axes[0].legend(loc="lower right")
    return figure


def convergence(data: Dataset, figure: Figure | None = None) -> Figure | None:
    """Relative errors over size and over computing time (work-precision): a line for each quantity; for several series,
    a row of panels for each quantity and a line for each series.
    """
    if not errors_of(data):
        return None
    return _of_quantities(data, figure) if len(series_of(data)) < 2 else _of_series(data, figure)


def _of_quantities(data: Dataset, figure: Figure | None) -> Figure:
    """Errors of all quantities of one series."""
    from matplotlib.ticker import NullLocator

    over = str(data.attrs["convergence_over"])
    others = [dim for dim in data["seconds"].dims if dim != over]
    figure, (left, right) = _panels(figure, 2)
    largest = {name.replace("_", " "): 100.0 * error for name, error in largest_errors(data).items()}
    spent, label = _spent(data), "relative error [%]"
    spent = spent.sum("side").mean(others) if "side" in spent.dims else spent.mean(others)
    rank = np.argsort(np.argsort(data[over].values * (-1 if increasing_of(data) else 1)))
    fitted = (rank < (finest_of(data) or len(rank))).tolist()
    sizes = data[over].values.tolist()
    panels.convergence(sizes, largest, xlabel=_label(data[over]), ylabel=label, fitted=fitted, ax=left)
    order = np.argsort(spent.values)
    series = {name: (spent.values[order].tolist(), error.values[order].tolist()) for name, error in largest.items()}
    time = _time_label(data)
    panels.work_precision(series, xlabel=time, ylabel=label, ax=right)
    _logarithmic(left, _label(data[over]), label)
    _logarithmic(right, time, label)
    if not increasing_of(data):
        left.invert_xaxis()
    handles, labels = left.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    if data[over].dtype.kind == "i":
        left.set_xticks(data[over].values, [shown(value.item()) for value in data[over].values])
        left.xaxis.set_minor_locator(NullLocator())
    return figure


def _of_series(data: Dataset, figure: Figure | None) -> Figure:
    """Errors of each quantity, with a line for each series and its fitted order."""
    from matplotlib.lines import Line2D

    over, time = str(data.attrs["convergence_over"]), _time_label(data)
    series, errors = series_of(data)[:LINES], dict(list(errors_of(data).items())[:PANELS])
    styles = _series_styles(series)
    figure, axes = _panels(figure, 2 * len(errors), columns=2)
    for (name, error), left, right in zip(errors.items(), axes[::2], axes[1::2], strict=True):
        for index, style in zip(series, styles, strict=True):
            values, spent = 100.0 * error.isel(index), _spent(data).isel(index, missing_dims="ignore")
            spent = spent.mean([dim for dim in spent.dims if dim != over])
            left.plot(*_ordered(data[over], values.values), **style)
            right.plot(spent.values, values.values, **style, linewidth=0.6)
        orders = [order_text(data, name, index) for index in series]
        _logarithmic(left, _label(data[over]), f"error of {name.replace('_', ' ')} [%]")
        _logarithmic(right, time, "")
        handles = [Line2D([], [], **style, label=text) for style, text in zip(styles, orders, strict=True)]
        right.legend(handles=handles, title="order", loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=7.5)
        if not increasing_of(data):
            left.invert_xaxis()
    labels = [series_label(data, index) for index in series]
    handles = [Line2D([], [], **style, label=text) for style, text in zip(styles, labels, strict=True)]
    count = len(series_of(data))
    more = f"first {LINES} of {count}" if count > LINES else None
    figure.legend(handles=handles, loc="outside lower center", ncols=2, title=more)
    return figure


def _series_styles(series: Sequence[Mapping[str, int]]) -> list[dict[str, Any]]:
    """Style of each series: colours and markers by the longest dimension, dashes and fill by the others."""
    longest = max(series[0], key=lambda dim: len({index[dim] for index in series}))
    others = [tuple(i for dim, i in index.items() if dim != longest) for index in series]
    groups = {other: number for number, other in enumerate(dict.fromkeys(others))}
    return [
        {
            **_line_style(index[longest]),
            "linestyle": DASHES[groups[other] % len(DASHES)],
            "fillstyle": "none" if groups[other] else "full",
        }
        for index, other in zip(series, others, strict=True)
    ]


def _spent(data: Dataset) -> DataArray:
    """Time of the contact solves: warm where it was measured."""
    return next(data[name] for name in ("warm_seconds", "solve_seconds", "seconds") if name in data)


def _time_label(data: Dataset) -> str:
    return f"{'warm ' * ('warm_seconds' in data)}time of the contact solves [s]"


def _logarithmic(panel: Axes, xlabel: str, ylabel: str) -> None:
    """Logarithmic axes; those of less than two decades have more ticks than powers of ten."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    panel.set(xscale="log", yscale="log", xlabel=xlabel, ylabel=ylabel)
    panel.grid(visible=True, which="minor", linewidth=0.3)
    for axis in (panel.xaxis, panel.yaxis):
        low, high = axis.get_view_interval()
        if high < 100.0 * low:
            subs = (1.0, 2.0, 5.0) if high > 10.0 * low else (1.0, 1.5, 2.0, 3.0, 5.0, 7.0)
            axis.set_major_locator(LogLocator(subs=subs))
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axis.set_minor_locator(NullLocator())


def _panels(figure: Figure | None, count: int, columns: int | None = None) -> tuple[Figure, list[Axes]]:
    """Grid of panels; figure: is resized, a new one by default."""
    from matplotlib.figure import Figure

    columns = columns or min(count, 3 if count > 4 else 2)
    rows = -(-count // columns)
    figure = figure or Figure(layout="constrained")
    figure.set_size_inches(4.0 * columns, 2.7 * rows + 0.4)
    panels = figure.subplots(rows, columns, squeeze=False)
    for panel in panels.flat[count:]:
        panel.set_visible(False)
    return figure, list(panels.flat[:count])


def _line_style(number: int) -> dict[str, Any]:
    """Style of a line: colours repeat, with shifted markers."""
    marker = MARKERS[(number + number // len(COLOURS)) % len(MARKERS)]
    return {"color": COLOURS[number % len(COLOURS)], "marker": marker, "markersize": 4.0}


def _ordered(x: DataArray, y: Any) -> tuple[Any, Any]:
    """Points by increasing x; unordered for texts."""
    if x.dtype.kind not in "if":
        return x.values.astype(str), y
    order = np.argsort(x.values)
    return x.values[order], np.asarray(y)[order]


def _along(panel: Axes, x: DataArray) -> None:
    panel.set_xlabel(_label(x))
    values = x.values
    if x.dtype.kind == "f" and len(values) > 2 and values.min() > 0 and values.max() / values.min() > 20:
        panel.set_xscale("log")


def _label(x: DataArray) -> str:
    unit = x.attrs.get("units")
    return f"{x.attrs.get('long_name', x.name)} [{'-' if unit in (None, '1') else unit}]"


def _combination(data: Dataset, dims: list[str], index: tuple[int, ...]) -> str:
    values = (
        f"{data[dim].attrs['long_name']} = {shown(data[dim].values[i].item())}"
        for dim, i in zip(dims, index, strict=True)
    )
    return literal(", ".join(values))
