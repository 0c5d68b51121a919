"""A quantity of results: dimensions, SI unit and meaning in files; label, unit and digits for readers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import isfinite
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from xarray import Variable

# SI unit and number of a unit for readers in it.
SCALES = {
    "kN": ("N", 1e-3),
    "kN m": ("N m", 1e-3),
    "kW": ("W", 1e-3),
    "km": ("m", 1e-3),
    "mm": ("m", 1e3),
    "µm": ("m", 1e6),
    "mm²": ("m2", 1e6),
    "mrad": ("rad", 1e3),
    "MPa": ("Pa", 1e-6),
    "%": ("1", 1e2),
    "‰": ("1", 1e3),
    "1e-3": ("1", 1e3),
}


class Quantity(NamedTuple):
    """A quantity of results.

    Parameters:
        dims: names of the dimensions of its variable.
        unit: SI unit of the values in files; empty for texts.
        text: meaning.
        needed: whether a file without it is refused.
        label: name for readers.
        shown: unit for readers; the SI unit by default.
        digits: decimals for readers; None: significant figures.
        symbol: of a force or quotient.
        sign: positive direction.
    """

    dims: tuple[str, ...]
    unit: str = ""
    text: str = ""
    needed: bool = True
    label: str = ""
    shown: str = ""
    digits: int | None = None
    symbol: str = ""
    sign: str = ""

    @property
    def attributes(self) -> dict[str, str]:
        """Attributes of the variable."""
        return {name: value for name, value in (("units", self.unit), ("long_name", self.text)) if value}

    @property
    def scale(self) -> float:
        """Number of the unit for readers in the SI unit."""
        return SCALES[self.shown][1] if self.shown in SCALES else 1.0

    @property
    def name(self) -> str:
        """Label, symbol and positive direction."""
        symbol = "" if self.symbol in self.label.split() else self.symbol
        return ", ".join(filter(None, (f"{self.label} {symbol}".strip(), self.sign)))

    @property
    def head(self) -> str:
        """Label and unit of a table."""
        return f"{self.label} [{self.shown or self.unit}]"

    def texts(self, values: Iterable[float], between: str = "  ") -> str:
        """Values for readers; empty without values."""
        numbers = (self.scale * value for value in values)
        return between.join(significant(n, 4) if self.digits is None else fixed(n, self.digits) for n in numbers)

    @property
    def title(self) -> str:
        """Meaning without remarks, with a capital."""
        text = self.text.partition(";")[0].partition(":")[0]
        return text[:1].upper() + text[1:]

    @property
    def axis(self) -> str:
        """Label of an axis: symbol, positive direction, unit."""
        return f"{', '.join(filter(None, (self.symbol or self.label, self.sign)))} [{self.shown or self.unit}]"

    @property
    def caption(self) -> str:
        """Meaning, positive direction and unit."""
        return f"{', '.join(filter(None, (self.title, self.sign)))} [{self.shown or self.unit}]"


Schema = Mapping[str, Quantity]


def filled(schema: Schema, values: Mapping[str, Any]) -> dict[str, Variable]:
    """Variables of declared names with their dimensions, units and meanings; raises KeyError for another name.

    Parameters:
        schema: declarations.
        values: arrays by name.
    """
    from xarray import Variable

    return {
        name: Variable(schema[name].dims, getattr(value, "data", value), schema[name].attributes)
        for name, value in values.items()
    }


def fixed(value: float, digits: int) -> str:
    """A value with a number of decimals: -0.001 with two is `0.00`."""
    return f"{round(value, digits) + 0.0:.{digits}f}"


def significant(value: float, digits: int = 3) -> str:
    """A value with a number of significant digits, above 1 without exponent: 320.4 with two is `320`."""
    text = f"{value + 0.0:.{digits}g}"
    return f"{float(text):.0f}" if "e+" in text and isfinite(value) else text
