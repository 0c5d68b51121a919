"""A figure with its tolerance."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Check:
    """A figure that must be at most, or at least, a tolerance."""

    text: str
    figure: float
    tolerance: float
    at_least: bool = False

    @property
    def passed(self) -> bool:
        """Whether it holds; not for NaN."""
        return self.figure >= self.tolerance if self.at_least else self.figure <= self.tolerance

    @property
    def row(self) -> str:
        """Row of a Markdown table, without its first bar."""
        sign = ">=" if self.at_least else "<="
        return f"{self.text} | {self.figure:.3g} | {sign} {self.tolerance:g} | {'yes' if self.passed else 'NO'} |"
