"""Values of one side of a contact solution, read from its Dataset."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.quantities import ERRORS, LARGEST_OVERLAP

if TYPE_CHECKING:
    from xarray import Dataset


@dataclass(frozen=True)
class SideValues:
    """Values of one side, in SI units, as numbers and lists of Python.

    Parameters:
        data: Dataset of `wheelrail.scenes.contacts.solution`.
        side: name of the side.
    """

    data: Dataset
    side: str

    def __getitem__(self, name: str) -> Any:
        """Value of a variable on this side, a list for further dimensions."""
        return self.data.variables[name].values[self._row].tolist()

    def vector(self, names: tuple[str, ...]) -> list[float]:
        """Values of several variables."""
        return [self[name] for name in names]

    @property
    def ok(self) -> bool:
        """Whether the force can be used."""
        return self["status"] in ("converged", "separated")

    @property
    def placed(self) -> bool:
        """Whether a position was found; without one there is no last solve."""
        return bool(np.isfinite(self["z"]))

    @property
    def patches(self) -> int:
        """Number of patches; none for a failed solve."""
        return int(self["patches"]) if self.ok else 0

    def by_patch(self, name: str) -> list[Any]:
        """Values of a variable of the patches, without the padding."""
        return list(self[name][: self.patches])

    def strips(self, patch: int) -> int:
        """Number of strips or points across a patch; 0 for models without, and for a patch that there is not."""
        return int(self.by_patch("patch_strips")[patch]) if patch < self.patches else 0

    def turn(self, patch: int) -> float:
        """Angle rad of `patch_turn`; NaN for bodies that are no half-spaces, and for a patch that there is not."""
        return float(self["patch_turn"][patch]) if patch < self.patches and "patch_turn" in self.data else math.nan

    @property
    def unsolved(self) -> str:
        """Depth and place of an overlap that the model should have solved; empty without."""
        depth = self["unsolved_overlap"] if "unsolved_overlap" in self.data else 0.0
        if not (self.patches and depth > LARGEST_OVERLAP * self["approach"]):
            return ""
        return (
            f"overlap of {1e6 * depth:.1f} µm not solved at y = {1e3 * self['unsolved_overlap_y']:.1f} mm of the wheel"
        )

    @property
    def error_estimate(self) -> dict[str, float]:
        """Estimated errors, NaN if unknown, by name as in `ErrorEstimate`; empty unless requested and in contact."""
        if not self.patches:
            return {}
        return {name: self[f"{name}_error"] for name in ERRORS if f"{name}_error" in self.data}

    @property
    def stressed_bodies(self) -> list[str]:
        """Names of the bodies with stress below the patches."""
        return self.data["body"].values.tolist() if self.patches and "von_mises" in self.data else []

    def below(self, name: str, body: str, patch: int) -> Any:
        """Value of a variable of the stress: list over the depths below a patch."""
        return self[name][self.data["body"].values.tolist().index(body)][patch]

    def largest_von_mises(self, body: str, patch: int) -> tuple[float, float]:
        """Largest von Mises stress below a patch, Pa, and its depth, m."""
        mises = self.below("von_mises", body, patch)
        maximum = int(np.argmax(mises))
        return mises[maximum], float(self.data["depth"].values[maximum])

    @cached_property
    def _row(self) -> int:
        return int(self.data.variables["side"].values.tolist().index(self.side))
