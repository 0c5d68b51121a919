"""Assessment of runs after EN 14363 and EN 12299."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from wheelrail.scenes.assessment.assess import Assessment


@dataclass(frozen=True, repr=False)
class RunAssessment:
    """Assessment of runs; printed: verdict, zones, estimates with limits and their sources, comfort.

    Parameters:
        found: sections, estimates, comfort and remarks.
    """

    found: Assessment

    @property
    def verdict(self) -> str:
        """Whether the estimates keep their limits, and which sections a complete test lacks."""
        return self.found.verdict

    @property
    def data(self) -> dict[str, Any]:
        """All numbers in SI units, as by `wheelrail assess --json`."""
        from wheelrail.scenes.assessment.tables import assessment_results

        return assessment_results(self.found).report

    def plot(self) -> Figure:
        """Section values and estimates over their limits."""
        from wheelrail.scenes.plots.assessment import utilisation
        from wheelrail.scenes.plots.style import styled

        with styled():
            return utilisation(self.found.sections, self.found.estimates)

    def plot_run(self, number: int = 0) -> Figure:
        """Sum of Y, Y/Q, Q and lateral acceleration along the track of a run; number: of the run, from 0."""
        from wheelrail.scenes.plots.assessment import along_track
        from wheelrail.scenes.plots.style import styled

        with styled():
            return along_track(self.found.runs[number], self.found.sections, self.found.options.alpha)

    def save(self, folder: str | Path) -> list[Path]:
        """Write assessment.html, .json and .csv to a folder; returns the files. Raises OSError."""
        from wheelrail.scenes.html_report.assessment_page import write_assessment

        return write_assessment(self.found, Path(folder))

    def __repr__(self) -> str:
        from wheelrail.scenes.assessment.tables import assessment_results

        parts = assessment_results(self.found).parts
        return "\n\n".join(str(getattr(part, "as_text", part)) for part in parts)


def assess(
    runs: str | Path | Sequence[str | Path],
    *,
    alpha: float = 1.0,
    length: float | None = None,
    deficiency: float | None = None,
    floor: float = 1.2,
) -> RunAssessment:
    """Assess stored runs of one vehicle after EN 14363 and EN 12299.

    Parameters:
        runs: run.nc or its folder, one or several.
        alpha: factor of the limit of the sum of Y: 1, for freight wagons 0.85.
        length: of all sections, m; by default that of the zone.
        deficiency: of cant, m, at which curves are estimated by regression; None: no two-dimensional estimates.
        floor: height of the floor of car bodies above top of rail, m.

    Raises SceneError for files that are no runs, runs of different vehicles and options out of range.
    """
    from wheelrail.scenes.assessment.assess import Options, assessment_of

    files = [runs] if isinstance(runs, str | Path) else list(runs)
    return RunAssessment(assessment_of([Path(file) for file in files], Options(alpha, length, deficiency, floor)))
