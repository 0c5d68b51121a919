"""Solution of a contact problem: one Dataset, with tables, figures and 3D views."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wheelrail.api.solution_plots import SolutionPlots
from wheelrail.api.stored_dataset import StoredDataset

if TYPE_CHECKING:
    from pandas import DataFrame

    from wheelrail.contact.results.result import ContactResult
    from wheelrail.scenes.builders.wheelset import SideProfiles
    from wheelrail.scenes.contacts.side_solution import SideSolution
    from wheelrail.scenes.datasets.result_table import TextTable
    from wheelrail.scenes.schema.scene import HertzScene, WheelsetScene


@dataclass(frozen=True, repr=False)
class Origin:
    """Scene, solution by side with its pose, and profiles of a solution."""

    scene: HertzScene | WheelsetScene
    sides: Mapping[str, SideSolution]
    profiles: SideProfiles | None


@dataclass(frozen=True, repr=False)
class Solution(StoredDataset):
    """Contact solution of a Hertz pair or of both wheels of a wheelset.

    Parameters:
        data: Dataset in SI units over side (left and right, or "contact"), patch (by decreasing load, padded with NaN)
            and point (of side point_side and patch point_patch).
        results: contact results by side; empty for a solution from a file.
        origin: scene, poses and profiles; None for a solution from a file.
    """

    results: Mapping[str, ContactResult] = field(default_factory=dict)
    origin: Origin | None = None

    @property
    def status(self) -> str:
        """ "converged", "separated", or "failed: ..." with the reason, of all sides."""
        return str(self.data.attrs["status"])

    @property
    def ok(self) -> bool:
        """Whether no side failed."""
        return not self.status.startswith("failed")

    @property
    def patches(self) -> DataFrame:
        """Table with one row per patch, in SI units: side, patch, area m2, max_pressure Pa, normal_force N, ..."""
        from wheelrail.scenes.quantities import PATCH

        rows = self.data[[name for name in PATCH if name != "patch_strips"]].to_dataframe().reset_index()
        present = rows["patch_normal_force"].notna()
        return rows[present].rename(columns=lambda name: name.removeprefix("patch_")).reset_index(drop=True)

    @property
    def plot(self) -> SolutionPlots:
        """Figures: `plot()`, `plot.pressure()`, `plot.tractions()`, `plot.section()`, `plot.profiles()`."""
        return SolutionPlots(self.data)

    def view(
        self,
        side: str | None = None,
        *,
        body: str = "both",
        scale: float | None = None,
        file: str | Path | None = None,
    ) -> Any:
        """3D view of one contact: deformed bodies, pressure, von Mises stress on cut planes.

        Parameters:
            side: "left", "right" or "contact"; by default the first side in contact.
            body: "wheel", "rail", "upper", "lower" or "both".
            scale: displacement magnification factor; a round number by default.
            file: image (.png) or interactive 3D view (.html) to save; needs no display.

        Computing takes seconds. Returns a PyVista plotter, for `.show()`. Raises ValueError for a solution from a file
        and for one without contact; SceneError for another side or body, and for the standard model; OSError.
        """
        from wheelrail.scenes.schema.errors import SceneError
        from wheelrail.scenes.views.view import ViewOptions, largest_pressure, view_side

        if self.origin is None:
            raise ValueError("view: a solution from a file contains no bodies; solve the contact again")
        touching = [name for name, result in self.results.items() if result.status == "converged"]
        if not touching:
            raise ValueError("view: no side is in contact")
        chosen = touching[0] if side is None else side
        if chosen not in touching:
            raise SceneError(f"side = {chosen!r}: must be {' or '.join(map(repr, touching))}")
        if file is not None and Path(file).suffix.lower() not in (".png", ".html"):
            raise SceneError(f"file = {str(file)!r}: must end in .png or .html")
        scene, sides, profiles = self.origin.scene, self.origin.sides, self.origin.profiles
        title = (
            "Hertz pair" if chosen == "contact" else " on ".join(profile.name for profile in (profiles or {})[chosen])
        )
        plotter = view_side(
            scene,
            chosen,
            sides[chosen],
            ViewOptions(title, body, scale, None if file is None else True, largest_pressure(sides.values())),
        )
        if file is not None:
            from wheelrail.scenes.views.html import save_view

            save_view(plotter, Path(file))
        return plotter

    def export(self, folder: str | Path) -> list[Path]:
        """Write displacement, stress, pressure and traction of all sides in contact, for ParaView.

        Parameters:
            folder: for the files, which are returned: a body and its cuts as .vtu, the patches as .vtp, meshed solids
                as .xdmf; lengths in mm.

        Computing takes seconds. Raises ValueError for a solution from a file and for one without contact, SceneError
        for the standard model, OSError.
        """
        from wheelrail.scenes.views.export import export_side

        if self.origin is None:
            raise ValueError("export: a solution from a file contains no bodies; solve the contact again")
        scene, sides = self.origin.scene, self.origin.sides
        touching = [name for name, result in self.results.items() if result.status == "converged"]
        if not touching:
            raise ValueError("export: no side is in contact")
        return [file for name in touching for file in export_side(scene, name, sides[name], Path(folder))]

    @property
    def _tables(self) -> list[TextTable]:
        from wheelrail.scenes.contacts.table import table

        return [table(self.data)]


def solved(
    scene: HertzScene | WheelsetScene,
    sides: Mapping[str, SideSolution],
    profiles: SideProfiles | None,
    arguments: Mapping[str, Any],
) -> Solution:
    """Solution from the solved sides of a scene."""
    from wheelrail.scenes.contacts.solution import solution_dataset

    data = solution_dataset(scene, sides, profiles, arguments)
    return Solution(data, {name: side.result for name, side in sides.items()}, Origin(scene, sides, profiles))
