"""One style for every picture."""

from __future__ import annotations

from typing import Any

STYLE = {
    "font.size": 9.0,
    "axes.titlesize": 9.0,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "0.9",
    "axes.axisbelow": True,
    "legend.frameon": False,
    "lines.linewidth": 1.1,
    "savefig.dpi": 150,
}
# Okabe and Ito's colours, told apart by every kind of sight; dashes say the same in black and white.
SIDES: dict[str, dict[str, Any]] = {
    "left": {"color": "#0072B2", "linestyle": "-"},
    "right": {"color": "#D55E00", "linestyle": (0, (5, 1.5))},
}
PRESSURE_MAP = "viridis"
