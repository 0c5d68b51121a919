"""HTML report of a folder of results."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.schema.errors import SceneError
from wheelrail.support.atomic_file import atomic_file
from wheelrail.support.text_file import FileRefused, json_value, read_text

if TYPE_CHECKING:
    from wheelrail.scenes.html_report.elements import Page

RUN, STUDY, WEAR, COMPARISON = "run.nc", "study.nc", "wear.nc", "differences.json"
ALLOWED = (
    f"must be the folder of a run ({RUN}, by wheelrail run), of a study ({STUDY}, by wheelrail study), of wear "
    f"({WEAR}, by wheelrail wear), or of a comparison ({COMPARISON}, by wheelrail compare)"
)
PAGE = "report.html"
MOST = 10.0  # MB, of the table of a comparison


def write_report(folder: str | Path, file: str | Path | None = None, *, view: bool = True) -> Path:
    """Write the self-contained HTML report of a run, a study, wear or a comparison, atomically; returns its path.

    Parameters:
        folder: of the results.
        file: the report; report.html in the folder by default.
        view: whether to include an interactive 3D view, some MB.

    Raises SceneError for a folder without results or with damaged ones, OSError if the report cannot be written.
    """
    folder = Path(folder)
    report = page(folder, view=view)
    target = folder / PAGE if file is None else Path(file)
    write_page(report, target)
    return target


def write_page(page: Page, file: Path) -> None:
    """Write a page atomically. Raises OSError if the file cannot be written."""
    with atomic_file(file) as part:
        part.write_text(rendered(page), encoding="utf-8")


def page(folder: Path, *, view: bool = True) -> Page:
    """Page of the results in a folder. Raises SceneError."""
    if not folder.is_dir():
        raise SceneError(f"{folder}: {'is a file' if folder.exists() else 'folder does not exist'}; {ALLOWED}")
    if (folder / RUN).exists():
        from wheelrail.scenes.datasets.run_file import read_run
        from wheelrail.scenes.html_report.run_page import run_page

        return run_page(read_run(folder / RUN), folder / RUN, view=view)
    if (folder / STUDY).exists():
        from wheelrail.scenes.html_report.study_page import study_page
        from wheelrail.scenes.studies.results import read_study

        return study_page(read_study(folder / STUDY), folder / STUDY, view=view)
    if (folder / WEAR).exists():
        from wheelrail.scenes.datasets.netcdf import read
        from wheelrail.scenes.html_report.wear_page import wear_page

        return wear_page(read(folder / WEAR), folder / WEAR)
    if (folder / COMPARISON).exists():
        from wheelrail.scenes.datasets.run_file import read_run
        from wheelrail.scenes.html_report.comparison_page import comparison_page

        names = _models(folder / COMPARISON)
        runs = read_run(folder / names[0] / RUN), read_run(folder / names[1] / RUN)
        return comparison_page(runs, names, folder, view=view)
    raise SceneError(f"{folder}: contains no results; {ALLOWED}")


def rendered(page: Page) -> str:
    """The page as HTML, by the template page.html."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template("page.html").render(page=page)


def _models(file: Path) -> tuple[str, str]:
    """Names of the compared models and of their subfolders."""
    from wheelrail.scenes.schema.scene import MODELS

    try:
        comparison = json_value(read_text(file, MOST))
        first, second = (str(comparison[key]) for key in ("first", "second"))
    except FileRefused as error:
        raise SceneError(str(error)) from None
    except (ValueError, LookupError, TypeError):
        raise SceneError(f"{file}: is no valid table of a comparison; {ALLOWED}") from None
    for name in (first, second):
        if name not in MODELS:
            raise SceneError(f"{file}: {name!r}: must be a contact model, {', '.join(MODELS)}")
    return first, second
