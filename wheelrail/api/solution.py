"""What a contact solve gives: one Dataset, that can be looked at, drawn and kept."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wheelrail.api.solution_plots import SolutionPlots
from wheelrail.api.solution_tables import html, patch_table, text
from wheelrail.api.stored_dataset import StoredDataset

if TYPE_CHECKING:
    from pandas import DataFrame

    from wheelrail.contact.results.result import ContactResult
    from wheelrail.meshes.profiles.profile import Profile
    from wheelrail.scenes.contacts.solve import SideSolution
    from wheelrail.scenes.schema.scene import HertzScene, WheelsetScene


@dataclass(frozen=True, repr=False)
class Origin:
    """What a solution was solved from, and the poses found."""

    scene: HertzScene | WheelsetScene
    sides: Mapping[str, SideSolution]
    profiles: Sequence[Profile]


@dataclass(frozen=True, repr=False)
class Solution(StoredDataset):
    """The contact of both wheels of a wheelset, or of a Hertz pair.

    data: a Dataset with units in SI over side (left and right, or "contact"), patch (by falling load, padded with NaN)
    and point (found by point_side and point_patch). results: the same as computed, by side; empty for one from a file,
    which has no origin either: the scene, poses and profiles behind it.
    """

    results: Mapping[str, ContactResult] = field(default_factory=dict)
    origin: Origin | None = None

    @property
    def status(self) -> str:
        """ "converged", "separated", or "failed: ..." with the reason, of all sides together."""
        return str(self.data.attrs["status"])

    @property
    def ok(self) -> bool:
        """Whether no side failed."""
        return not self.status.startswith("failed")

    @property
    def patches(self) -> DataFrame:
        """A row for every patch, in SI units: side, patch, normal_force N, max_pressure Pa, area m2, ..."""
        return patch_table(self.data)

    @property
    def plot(self) -> SolutionPlots:
        """Pictures: `plot()`, `plot.pressure()`, `plot.tractions()`, `plot.section()`, `plot.profiles()`."""
        return SolutionPlots(self.data)

    def view(
        self,
        side: str | None = None,
        *,
        body: str = "both",
        scale: float | None = None,
        file: str | Path | None = None,
    ) -> Any:
        """A pyvista plotter of one contact in three dimensions: bodies deformed, pressure, von Mises stress on cuts.

        `.show()` it, in a notebook as a scene to turn; or give a file, a picture (.png) or a page to turn (.html): that
        needs no screen. side: "left", "right" or "contact", the first that touches unless given; body: "wheel", "rail",
        "upper", "lower" or "both"; scale of displacements, a round one unless given. Seconds of computing.

        Raises ValueError for a solution from a file, which has no bodies any more, and where nothing touches;
        SceneError for a side or a body that is not there, and for the standard model; OSError.
        """
        from wheelrail.scenes.schema.errors import SceneError
        from wheelrail.scenes.views.view import view_side

        if self.origin is None:
            raise ValueError("a solution from a file has no bodies to look at: solve it anew")
        touching = [name for name, found in self.results.items() if found.status == "converged"]
        if not touching:
            raise ValueError("nothing touches: there is nothing to look at")
        chosen = touching[0] if side is None else side
        if chosen not in touching:
            raise SceneError(f"side = {chosen!r}: must be {' or '.join(map(repr, touching))}")
        if file is not None and Path(file).suffix.lower() not in (".png", ".html"):
            raise SceneError(f"file = {str(file)!r}: must end in .png or .html")
        scene, sides, profiles = self.origin.scene, self.origin.sides, self.origin.profiles
        title = "Hertz pair" if chosen == "contact" else " on ".join(profile.name for profile in profiles)
        drawn = view_side(
            scene,
            chosen,
            sides[chosen],
            title=title,
            profiles=(profiles[0], profiles[1]) if profiles else None,
            body=body,
            scale=scale,
            off_screen=None if file is None else True,
        )
        if file is not None:
            from wheelrail.scenes.views.html import save_view

            save_view(drawn, Path(file))
        return drawn

    def __repr__(self) -> str:
        return text(self.data)

    def _repr_html_(self) -> str:
        return html(self.data)


def solved(
    scene: HertzScene | WheelsetScene,
    sides: Mapping[str, SideSolution],
    profiles: Sequence[Profile],
    arguments: Mapping[str, Any],
) -> Solution:
    """The solution of a scene whose sides are solved."""
    from wheelrail.scenes.datasets.solution import solution_dataset

    data = solution_dataset(scene, sides, profiles, arguments)
    return Solution(data, {side: found.result for side, found in sides.items()}, Origin(scene, sides, profiles))
